//! One enum over all shapes, generated from the list in `sdf/mod.rs`.

use super::Form;
use super::keys::Keys;
use crate::world::file::{Problem, Read, Reader};

/// Generates [`Sdf`](super::Sdf) and [`WrittenSdf`](super::WrittenSdf) from a list of `Name(path::Of)`,
/// where `Name` is the name in world files.
macro_rules! forms {
    ($($name:ident($($form:ident)::+),)+) => {
        $(pub use $($form)::+;)+

        /// A signed distance function: a tree of shapes. Lengths in voxels, world space; negative
        /// inside the solid. The struct of each shape describes its meaning.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Sdf {
            $($name($($form)::+),)+
        }

        /// A tree as the RON parser leaves it: every value is text with its position.
        #[derive(Debug)]
        pub enum WrittenSdf {
            $($name(<$($form)::+ as keys::Keys>::Written),)+
        }

        $(impl From<$($form)::+> for Sdf {
            fn from(form: $($form)::+) -> Self {
                Self::$name(form)
            }
        })+

        impl Sdf {
            /// Every shape: its name in world files and its keys.
            pub const FORMS: &'static [(&'static str, &'static [&'static str])] =
                &[$((stringify!($name), <$($form)::+ as keys::Keys>::NAMES)),+];

            /// The shape's name in world files.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$name(_) => stringify!($name),)+
                }
            }

            /// The sub-trees of this node.
            pub fn children(&self) -> &[Self] {
                match self {
                    $(Self::$name(form) => keys::Keys::children(form),)+
                }
            }

            fn check_keys(&self, noises: &[NoiseField]) -> Result<(), Fault> {
                match self {
                    $(Self::$name(form) => keys::Keys::check_keys(form, noises),)+
                }
            }

            fn form(&self) -> &dyn Form {
                match self {
                    $(Self::$name(form) => form,)+
                }
            }
        }

        impl WrittenSdf {
            /// Resolves the tree to its description; names are looked up in the parts that the reader
            /// has read so far.
            ///
            /// # Errors
            /// The first invalid value, with its position.
            pub fn read(&self, reader: &mut Reader<'_>) -> Read<Sdf> {
                match self {
                    $(Self::$name(written) => {
                        forms::read::<$($form)::+>(stringify!($name), written, reader).map(Sdf::from)
                    })+
                }
            }
        }

        impl<'de> serde::Deserialize<'de> for WrittenSdf {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                #[derive(serde::Deserialize)]
                #[serde(variant_identifier)]
                enum Name {
                    $($name,)+
                }

                struct Forms;

                impl<'de> serde::de::Visitor<'de> for Forms {
                    type Value = WrittenSdf;

                    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                        f.write_str("a shape")
                    }

                    fn visit_enum<A: serde::de::EnumAccess<'de>>(
                        self,
                        data: A,
                    ) -> Result<WrittenSdf, A::Error> {
                        let (name, keys) = data.variant()?;
                        let keys = VariantKeys(keys);
                        match name {
                            $(Name::$name => serde::Deserialize::deserialize(keys)
                                .map(WrittenSdf::$name),)+
                        }
                    }
                }

                deserializer.deserialize_enum("Shape", &[$(stringify!($name)),+], Forms)
            }
        }
    };
}

pub(super) use forms;

/// Reads a shape and checks it, including its sub-trees.
///
/// # Errors
/// The first invalid value, with its position.
pub fn read<F: Form + Keys>(name: &str, written: &F::Written, reader: &mut Reader<'_>) -> Read<F> {
    let form = F::read(written, reader)?;
    let Err(fault) = form.check(&reader.noises) else {
        return Ok(form);
    };
    let source = reader.source;
    let message = format!("{name}: {}", fault.message);
    let mut keys = fault.keys.iter();
    Err(
        match keys.find_map(|key| F::place(written, key, &source.text)) {
            Some((offset, length)) => source.at_bytes(offset, length, message, fault.remedy),
            None => Problem::of_file(format!("{}: {message}", source.name), fault.remedy),
        },
    )
}
