//! A number, name or text as written in the file: read later, when a message can point at it.

use ron::value::RawValue;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::schema::Vector;
use crate::world::sdf::WrittenSdf;

/// One value of the file, kept as text together with its position.
///
/// Reading numbers and names only after the whole file is parsed lets every message about their meaning
/// (a negative radius, an unknown material) point at the exact characters.
#[derive(Clone, Debug)]
pub struct Leaf {
    /// The RON text, which may include comments before and after the value.
    text: String,
    /// Address of the text's first byte in the buffer it was parsed from. Never dereferenced.
    address: usize,
}

impl Leaf {
    fn new(text: &str) -> Self {
        Self {
            text: text.to_owned(),
            address: text.as_ptr() as usize,
        }
    }

    /// The text of the value, without comments.
    pub fn text(&self) -> &str {
        let (start, end) = self.token();
        &self.text[start..end]
    }

    /// The whole RON text, comments included.
    pub fn ron(&self) -> &str {
        &self.text
    }

    /// Byte offset and length of the value in `source`, the text that it was parsed from.
    pub fn place_in(&self, source: &str) -> Option<(usize, usize)> {
        let (start, end) = self.token();
        let offset = self.address.checked_sub(source.as_ptr() as usize)? + start;
        let found = source.get(offset..offset + (end - start))?;
        (found == self.text()).then_some((offset, end - start))
    }

    /// Where the value begins and ends within the text.
    fn token(&self) -> (usize, usize) {
        let start = self.text.len() - skip_blank(&self.text).len();
        let rest = &self.text[start..];
        let simple = |c: char| c.is_alphanumeric() || "+-._#".contains(c);
        let end = match rest.find(|c| !simple(c)) {
            // A string, a list or similar: all of it, up to trailing blanks.
            Some(0) => rest.trim_end().len(),
            Some(end) if skip_blank(&rest[end..]).is_empty() => end,
            Some(_) => rest.trim_end().len(),
            None => rest.len(),
        };
        (start, start + end)
    }
}

/// A value of the file, or several together, with a known position.
pub trait Located {
    /// Byte offset and length in `source`, the text that it was parsed from; `None` if nothing is
    /// written, or if a message should point at a part instead.
    fn place_in(&self, source: &str) -> Option<(usize, usize)>;
}

impl Located for Leaf {
    fn place_in(&self, source: &str) -> Option<(usize, usize)> {
        self.place_in(source)
    }
}

impl Located for Vector {
    fn place_in(&self, source: &str) -> Option<(usize, usize)> {
        (&self.0, &self.2).place_in(source)
    }
}

impl Located for (Leaf, Leaf) {
    fn place_in(&self, source: &str) -> Option<(usize, usize)> {
        (&self.0, &self.1).place_in(source)
    }
}

/// From the first to the last.
impl Located for (&Leaf, &Leaf) {
    fn place_in(&self, source: &str) -> Option<(usize, usize)> {
        let (start, _) = self.0.place_in(source)?;
        let (last, length) = self.1.place_in(source)?;
        Some((start, last + length - start))
    }
}

impl<T: Located> Located for Option<T> {
    fn place_in(&self, source: &str) -> Option<(usize, usize)> {
        self.as_ref()?.place_in(source)
    }
}

impl Located for Box<WrittenSdf> {
    fn place_in(&self, _source: &str) -> Option<(usize, usize)> {
        None
    }
}

impl Located for Vec<WrittenSdf> {
    fn place_in(&self, _source: &str) -> Option<(usize, usize)> {
        None
    }
}

/// The text after leading white space and comments.
pub fn skip_blank(mut text: &str) -> &str {
    loop {
        text = text.trim_start();
        if text.starts_with("//") {
            text = text.find('\n').map_or("", |end| &text[end..]);
        } else if text.starts_with("/*") {
            text = &text[block_comment_length(text)..];
        } else {
            return text;
        }
    }
}

/// Length of the block comment that `text` begins with; comments nest in RON.
pub fn block_comment_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let (mut depth, mut at) = (0, 0);
    while at + 1 < bytes.len() {
        match &bytes[at..at + 2] {
            b"/*" => (depth, at) = (depth + 1, at + 2),
            b"*/" => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
    bytes.len()
}

impl<'de> Deserialize<'de> for Leaf {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(Self::new(
            <&'de RawValue>::deserialize(deserializer)?.get_ron(),
        ))
    }
}

/// One number for all three axes, or `(x, y, z)`.
#[derive(Clone, Debug)]
pub enum OneOrThree {
    One(Leaf),
    Three(Vector),
}

impl<'de> Deserialize<'de> for OneOrThree {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = <&'de RawValue>::deserialize(deserializer)?.get_ron();
        // Parsed again from the same buffer, so that the leaves know their position in it.
        if skip_blank(text).starts_with('(') {
            let three = ron::from_str(text).map(Self::Three);
            three.map_err(|_| D::Error::custom("expected one number, or three: (x, y, z)"))
        } else {
            Ok(Self::One(Leaf::new(text)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Deserialize)]
    struct Pair {
        a: Leaf,
        b: Leaf,
    }

    #[test]
    fn points_at_the_value_alone() {
        let source = "(a: /* x, /* y */ */ 1.5e3 // z\n , b : \"q // r\" )";
        let pair: Pair = ron::from_str(source).expect("valid");
        assert_eq!(pair.a.text(), "1.5e3");
        assert_eq!(pair.a.place_in(source), Some((21, 5)));
        assert_eq!(pair.b.text(), "\"q // r\"");
        assert_eq!(pair.b.place_in(source), Some((39, 8)));
        assert_eq!(pair.b.place_in(&source.to_owned()[1..]), None);
    }
}
