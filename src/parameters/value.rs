//! Values of parameters: their kinds and ranges, their text form, and the types behind them.

use std::fmt;

use glam::{UVec3, Vec3};

/// What a key accepts. The panel builds its widgets from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Flag,
    Count {
        min: u32,
        max: u32,
    },
    Number {
        min: f32,
        max: f32,
    },
    /// One of `words`.
    Choice {
        words: &'static [&'static str],
    },
    /// A name that only the world can check.
    Name,
    /// A random seed, or the file's.
    Seed,
    /// Linear RGB, each channel from 0 to `max`, or the file's.
    Colour {
        max: f32,
    },
    /// Voxels along x, y and z, each from 1 to `max`, or the file's.
    Size {
        max: u32,
    },
}

/// A value of any key. `None` stands for the value in the world file.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Flag(bool),
    Count(u32),
    Number(f32),
    Choice(&'static str),
    Name(String),
    Seed(Option<u32>),
    Colour(Option<Vec3>),
    Size(Option<UVec3>),
}

/// The word for "the value in the world file".
const FILE: &str = "file";

impl Kind {
    /// Whether a value is of this kind and within its range.
    pub fn holds(&self, value: &Value) -> bool {
        match (self, value) {
            (Self::Flag, Value::Flag(_))
            | (Self::Name, Value::Name(_))
            | (Self::Seed, Value::Seed(_)) => true,
            (Self::Count { min, max }, Value::Count(count)) => (min..=max).contains(&count),
            (Self::Number { min, max }, Value::Number(number)) => (min..=max).contains(&number),
            (Self::Choice { words, .. }, Value::Choice(word)) => words.contains(word),
            (Self::Colour { max }, Value::Colour(colour)) => colour.is_none_or(|colour| {
                let channels = colour.to_array();
                channels
                    .iter()
                    .all(|channel| (0.0..=*max).contains(channel))
            }),
            (Self::Size { max }, Value::Size(size)) => size.is_none_or(|size| {
                let edges = size.to_array();
                edges.iter().all(|edge| (1..=*max).contains(edge))
            }),
            _ => false,
        }
    }

    /// Parses text for this kind; [`Kind::holds`] checks the range.
    pub(super) fn parse(&self, text: &str) -> Option<Value> {
        let unless_file = |text: &str| (text != FILE).then(|| text.to_owned());
        Some(match self {
            Self::Flag => Value::Flag(match text {
                "on" | "true" => true,
                "off" | "false" => false,
                _ => return None,
            }),
            Self::Count { .. } => Value::Count(text.parse().ok()?),
            Self::Number { .. } => Value::Number(text.parse().ok()?),
            Self::Choice { words, .. } => Value::Choice(words.iter().find(|word| **word == text)?),
            Self::Name => Value::Name(text.to_owned()),
            Self::Seed => Value::Seed(match unless_file(text) {
                Some(text) => Some(text.parse().ok()?),
                None => None,
            }),
            Self::Colour { .. } => Value::Colour(match unless_file(text) {
                Some(text) => Some(colour(&text)?),
                None => None,
            }),
            Self::Size { .. } => Value::Size(match unless_file(text) {
                Some(text) => Some(size(&text)?),
                None => None,
            }),
        })
    }

    /// The range in short, for tables: `8…4096`, `none | chebyshev`.
    pub fn range(&self) -> String {
        match self {
            Self::Flag => "on | off".to_owned(),
            Self::Count { min, max } => format!("{min}…{max}"),
            Self::Number { min, max } => format!("{}…{}", plain(*min), plain(*max)),
            Self::Choice { words, .. } => words.join(" | "),
            Self::Name => "name".to_owned(),
            Self::Seed => format!("0…{}", u32::MAX),
            Self::Colour { max } => format!("R,G,B in 0…{max}"),
            Self::Size { max } => format!("WxHxD in 1…{max}"),
        }
    }
}

/// A number without a row of leading zeros.
fn plain(number: f32) -> String {
    if number != 0.0 && number.abs() < 1e-3 {
        format!("{number:e}")
    } else {
        number.to_string()
    }
}

/// `R,G,B`, or one number for all three.
fn colour(text: &str) -> Option<Vec3> {
    let channels: Vec<f32> = text
        .split(',')
        .map(|channel| channel.trim().parse().ok())
        .collect::<Option<_>>()?;
    match channels[..] {
        [grey] => Some(Vec3::splat(grey)),
        [r, g, b] => Some(Vec3::new(r, g, b)),
        _ => None,
    }
}

/// `WIDTHxHEIGHTxDEPTH`.
fn size(text: &str) -> Option<UVec3> {
    let edges: Vec<u32> = text
        .split(['x', 'X', '×'])
        .map(|edge| edge.trim().parse().ok())
        .collect::<Option<_>>()?;
    <[u32; 3]>::try_from(edges).ok().map(UVec3::from_array)
}

/// A phrase that fits after "takes".
impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag => f.write_str("on or off"),
            Self::Count { min, max } => write!(f, "a whole number from {min} to {max}"),
            Self::Number { min, max } => {
                write!(f, "a number from {} to {}", plain(*min), plain(*max))
            }
            Self::Choice { words: [word], .. } => write!(f, "only {word}"),
            Self::Choice { words, .. } => write!(f, "one of {}", words.join(", ")),
            Self::Name => f.write_str("a name"),
            Self::Seed => write!(f, "a whole number from 0 to {} or `{FILE}`", u32::MAX),
            Self::Colour { max } => {
                write!(f, "R,G,B or one number, each from 0 to {max}, or `{FILE}`")
            }
            Self::Size { max } => {
                write!(f, "WIDTHxHEIGHTxDEPTH, each from 1 to {max}, or `{FILE}`")
            }
        }
    }
}

/// In the form that can be read back.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(flag) => f.write_str(if *flag { "on" } else { "off" }),
            Self::Count(count) => write!(f, "{count}"),
            Self::Number(number) => f.write_str(&plain(*number)),
            Self::Choice(word) => f.write_str(word),
            Self::Name(name) => f.write_str(name),
            Self::Seed(Some(seed)) => write!(f, "{seed}"),
            Self::Colour(Some(colour)) => write!(f, "{},{},{}", colour.x, colour.y, colour.z),
            Self::Size(Some(size)) => write!(f, "{}x{}x{}", size.x, size.y, size.z),
            Self::Seed(None) | Self::Colour(None) | Self::Size(None) => f.write_str(FILE),
        }
    }
}

/// Ties a field's type to its variant, both ways.
macro_rules! carried {
    ($($type:ty => $Variant:ident),+ $(,)?) => {$(
        impl From<$type> for Value {
            fn from(value: $type) -> Self {
                Self::$Variant(value)
            }
        }

        impl TryFrom<Value> for $type {
            type Error = Value;

            fn try_from(value: Value) -> Result<Self, Value> {
                match value {
                    Value::$Variant(value) => Ok(value),
                    other => Err(other),
                }
            }
        }
    )+};
}

carried! {
    bool => Flag,
    u32 => Count,
    f32 => Number,
    String => Name,
    Option<u32> => Seed,
    Option<Vec3> => Colour,
    Option<UVec3> => Size,
}
