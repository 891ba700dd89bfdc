//! The keys of shapes. [`keys!`] declares them once; it generates the struct, the type that the RON
//! parser fills, the messages that point into the file, and the check of a tree that is built in code.

use std::fmt;
use std::marker::PhantomData;

use glam::DVec3;
use serde::de::DeserializeOwned;

use super::{Fault, NoiseId, Sdf, WrittenSdf};
use crate::world::file::{Leaf, Located, Read, Reader, Vector, or};
use crate::world::noise::NoiseField;

/// What a key takes: its text form, its value, and its valid range.
pub trait Key {
    /// As the RON parser leaves it: text with its position.
    type Written: Located;
    /// Its type in the description.
    type Value;

    /// The value, or a message that points at the text.
    ///
    /// # Errors
    /// The text is not a valid value.
    fn read(written: &Self::Written, key: &str, reader: &mut Reader<'_>) -> Read<Self::Value>;

    /// Checks a value that may have been built in code.
    ///
    /// # Errors
    /// What it must be and what it is, as a phrase that follows the name of the key.
    fn check(value: &Self::Value, noises: &[NoiseField]) -> Result<(), String>;

    /// The sub-trees in a value.
    fn children(_value: &Self::Value) -> &[Sdf] {
        &[]
    }
}

/// `Ok` if a rule holds, otherwise the phrase that follows the name of the key.
pub fn require(holds: bool, wanted: &str, found: impl fmt::Display) -> Result<(), String> {
    if holds {
        Ok(())
    } else {
        Err(format!("must be {wanted}, not {found}"))
    }
}

/// A single number. It is read as an f32, the precision of the GPU, and stored as an f64.
pub trait Scalar {
    /// What [`Self::holds`] requires, as a phrase after "must be".
    const WANTED: &'static str;

    fn read(leaf: &Leaf, key: &str, reader: &Reader<'_>) -> Read<f32>;

    /// Whether a finite number is allowed.
    fn holds(value: f64) -> bool;
}

/// A number above 0.
pub struct Positive;

impl Scalar for Positive {
    const WANTED: &'static str = "finite and above 0";

    fn read(leaf: &Leaf, key: &str, reader: &Reader<'_>) -> Read<f32> {
        reader.source.positive(leaf, key)
    }

    fn holds(value: f64) -> bool {
        value > 0.0
    }
}

/// A number of at least 0.
pub struct NotNegative;

impl Scalar for NotNegative {
    const WANTED: &'static str = "finite and at least 0";

    fn read(leaf: &Leaf, key: &str, reader: &Reader<'_>) -> Read<f32> {
        reader.source.not_negative(leaf, key)
    }

    fn holds(value: f64) -> bool {
        value >= 0.0
    }
}

/// A coordinate, an angle or a signed length.
pub struct Length;

impl Scalar for Length {
    const WANTED: &'static str = "finite";

    fn read(leaf: &Leaf, key: &str, reader: &Reader<'_>) -> Read<f32> {
        reader.source.length(leaf, key)
    }

    fn holds(_value: f64) -> bool {
        true
    }
}

/// A number in 0 … 1.
pub struct Share;

impl Scalar for Share {
    const WANTED: &'static str = "in 0 … 1";

    fn read(leaf: &Leaf, key: &str, reader: &Reader<'_>) -> Read<f32> {
        Ok(reader.source.number_in(leaf, key, 0.0..=1.0)? as f32)
    }

    fn holds(value: f64) -> bool {
        (0.0..=1.0).contains(&value)
    }
}

impl<S: Scalar> Key for S {
    type Written = Leaf;
    type Value = f64;

    fn read(written: &Leaf, key: &str, reader: &mut Reader<'_>) -> Read<f64> {
        Ok(S::read(written, key, reader)?.into())
    }

    fn check(&value: &f64, _noises: &[NoiseField]) -> Result<(), String> {
        require(value.is_finite() && S::holds(value), S::WANTED, value)
    }
}

/// Three numbers, each of this kind.
pub struct Three<S>(PhantomData<S>);

/// A point or an offset.
pub type Point = Three<Length>;

impl<S: Scalar> Key for Three<S> {
    type Written = Vector;
    type Value = DVec3;

    fn read(written: &Vector, key: &str, reader: &mut Reader<'_>) -> Read<DVec3> {
        let axis = |leaf| S::read(leaf, key, reader).map(f64::from);
        let [x, y, z] = written.leaves();
        Ok(DVec3::new(axis(x)?, axis(y)?, axis(z)?))
    }

    fn check(&value: &DVec3, _noises: &[NoiseField]) -> Result<(), String> {
        let holds = value.is_finite() && value.to_array().into_iter().all(S::holds);
        require(holds, S::WANTED, value)
    }
}

/// A vector long enough to have a direction; its length does not matter.
pub struct Direction;

impl Key for Direction {
    type Written = Vector;
    type Value = DVec3;

    fn read(written: &Vector, key: &str, reader: &mut Reader<'_>) -> Read<DVec3> {
        Ok(reader.source.direction(written, key)?.as_dvec3())
    }

    fn check(&value: &DVec3, _noises: &[NoiseField]) -> Result<(), String> {
        let holds = value.is_finite() && value.length() > 1e-6;
        require(holds, "finite and longer than 0", value)
    }
}

/// A noise field: a name in the file, and an index into [`World::noises`](crate::world::World::noises)
/// in the description.
pub struct NoiseName;

impl Key for NoiseName {
    type Written = Leaf;
    type Value = NoiseId;

    fn read(written: &Leaf, _key: &str, reader: &mut Reader<'_>) -> Read<NoiseId> {
        reader.noise(written)
    }

    fn check(&value: &NoiseId, noises: &[NoiseField]) -> Result<(), String> {
        let wanted = format!("one of the {} noise fields", noises.len());
        require(
            value < noises.len(),
            &wanted,
            format_args!("noise field {value}"),
        )
    }
}

/// A key that may be omitted and then has this whole number.
pub struct Or<K, const DEFAULT: i32>(PhantomData<K>);

impl<K: Key<Value = f64>, const DEFAULT: i32> Key for Or<K, DEFAULT> {
    type Written = Option<K::Written>;
    type Value = f64;

    fn read(written: &Self::Written, key: &str, reader: &mut Reader<'_>) -> Read<f64> {
        or(written, DEFAULT.into(), |written| {
            K::read(written, key, reader)
        })
    }

    fn check(value: &f64, noises: &[NoiseField]) -> Result<(), String> {
        K::check(value, noises)
    }
}

/// One sub-tree.
pub struct SubTree;

impl Key for SubTree {
    type Written = Box<WrittenSdf>;
    type Value = Box<Sdf>;

    fn read(written: &Self::Written, _key: &str, reader: &mut Reader<'_>) -> Read<Box<Sdf>> {
        Ok(Box::new(reader.shape(written)?))
    }

    fn check(_value: &Box<Sdf>, _noises: &[NoiseField]) -> Result<(), String> {
        Ok(())
    }

    fn children(value: &Box<Sdf>) -> &[Sdf] {
        std::slice::from_ref(value)
    }
}

/// A list of sub-trees; an empty list acts like `Empty`.
pub struct SubTrees;

impl Key for SubTrees {
    type Written = Vec<WrittenSdf>;
    type Value = Vec<Sdf>;

    fn read(written: &Self::Written, _key: &str, reader: &mut Reader<'_>) -> Read<Vec<Sdf>> {
        written.iter().map(|shape| reader.shape(shape)).collect()
    }

    fn check(_value: &Vec<Sdf>, _noises: &[NoiseField]) -> Result<(), String> {
        Ok(())
    }

    fn children(value: &Vec<Sdf>) -> &[Sdf] {
        value
    }
}

/// What [`keys!`] generates from the keys of a shape.
pub trait Keys: Sized {
    /// The keys as the RON parser leaves them.
    type Written: fmt::Debug + DeserializeOwned;

    /// Their names in a world file; empty if only the value is written, as in `Union([…])`.
    const NAMES: &'static [&'static str];

    /// The description, with each key checked separately.
    ///
    /// # Errors
    /// The first key whose value its type does not allow.
    fn read(written: &Self::Written, reader: &mut Reader<'_>) -> Read<Self>;

    /// Position of a key's value in the text that it was parsed from: byte offset and length.
    fn place(written: &Self::Written, key: &str, text: &str) -> Option<(usize, usize)>;

    /// Checks each key separately.
    ///
    /// # Errors
    /// The first key whose value its type does not allow.
    fn check_keys(&self, noises: &[NoiseField]) -> Result<(), Fault>;

    /// The sub-trees.
    fn children(&self) -> &[Sdf];
}

/// Declares a shape: a struct whose fields are its keys, with a [`Key`] in place of each type. `pub
/// struct A;` has no keys, `pub struct A(pub Kind);` has a value without a name.
macro_rules! keys {
    (@impl $form:ident, $written:ty, $names:expr, |$source:ident, $reader:ident| $read:expr,
     $([$name:expr, $kind:ty, $field:tt])*) => {
        impl $crate::world::sdf::keys::Keys for $form {
            type Written = $written;

            const NAMES: &'static [&'static str] = $names;

            fn read(
                $source: &Self::Written,
                $reader: &mut $crate::world::file::Reader<'_>,
            ) -> $crate::world::file::Read<Self> {
                Ok($read)
            }

            #[allow(unused_variables, reason = "a shape may have no keys")]
            fn place(written: &Self::Written, key: &str, text: &str) -> Option<(usize, usize)> {
                $(if key == $name {
                    return $crate::world::file::Located::place_in(&written.$field, text);
                })*
                None
            }

            #[allow(unused_variables, reason = "a shape may have no keys")]
            fn check_keys(
                &self,
                noises: &[$crate::world::noise::NoiseField],
            ) -> Result<(), $crate::world::sdf::Fault> {
                $(<$kind as $crate::world::sdf::keys::Key>::check(&self.$field, noises).map_err(
                    |rule| $crate::world::sdf::Fault {
                        keys: &[$name],
                        message: format!("{} {rule}", $name),
                        remedy: String::new(),
                    },
                )?;)*
                Ok(())
            }

            fn children(&self) -> &[$crate::world::sdf::Sdf] {
                $(
                    let of = <$kind as $crate::world::sdf::keys::Key>::children(&self.$field);
                    if !of.is_empty() {
                        return of;
                    }
                )*
                &[]
            }
        }
    };
    ($(#[$meta:meta])* pub struct $form:ident;) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $form;

        const _: () = {
            #[derive(Debug, serde::Deserialize)]
            pub struct Written;

            keys!(@impl $form, Written, &[], |_written, _reader| $form,);
        };
    };
    ($(#[$meta:meta])* pub struct $form:ident(pub $kind:ty);) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $form(pub <$kind as $crate::world::sdf::keys::Key>::Value);

        const _: () = {
            #[derive(Debug, serde::Deserialize)]
            pub struct Written(<$kind as $crate::world::sdf::keys::Key>::Written);

            keys!(@impl $form, Written, &[],
                |written, reader| $form(
                    <$kind as $crate::world::sdf::keys::Key>::read(&written.0, "", reader)?
                ),
                ["", $kind, 0]
            );
        };
    };
    ($(#[$meta:meta])* pub struct $form:ident {
        $($(#[$key_meta:meta])* pub $key:ident: $kind:ty,)*
    }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $form {
            $($(#[$key_meta])* pub $key: <$kind as $crate::world::sdf::keys::Key>::Value,)*
        }

        const _: () = {
            #[derive(Debug, serde::Deserialize)]
            #[serde(deny_unknown_fields)]
            pub struct Written {
                $($key: <$kind as $crate::world::sdf::keys::Key>::Written,)*
            }

            keys!(@impl $form, Written, &[$(stringify!($key)),*],
                |written, reader| $form {
                    $($key: <$kind as $crate::world::sdf::keys::Key>::read(
                        &written.$key,
                        stringify!($key),
                        reader,
                    )?,)*
                },
                $([stringify!($key), $kind, $key])*
            );
        };
    };
}

pub(super) use keys;
