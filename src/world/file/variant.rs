//! The keys of an enum's variant, read by a type of their own.

use serde::de::{DeserializeSeed, Deserializer, Error as _, VariantAccess, Visitor};
use serde::forward_to_deserialize_any;

/// The keys after a variant's name, as a deserializer for a struct: `Sphere(radius: 5)` is read as the
/// variant `Sphere` that holds a struct with the key `radius`, without brackets of its own.
pub struct VariantKeys<A>(pub A);

impl<'de, A: VariantAccess<'de>> Deserializer<'de> for VariantKeys<A> {
    type Error = A::Error;

    fn deserialize_any<V: Visitor<'de>>(self, _visitor: V) -> Result<V::Value, A::Error> {
        Err(A::Error::custom("a variant holds a struct"))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        self.0.struct_variant(fields, visitor)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        self.0.newtype_variant_seed(Newtype(visitor))
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        self.0.unit_variant()?;
        visitor.visit_unit()
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit seq
        tuple tuple_struct map enum identifier ignored_any
    }
}

/// Passes the only value of a variant to the visitor of a struct around it.
struct Newtype<V>(V);

impl<'de, V: Visitor<'de>> DeserializeSeed<'de> for Newtype<V> {
    type Value = V::Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<V::Value, D::Error> {
        self.0.visit_newtype_struct(deserializer)
    }
}
