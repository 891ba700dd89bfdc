//! `--shard I/N`: one of several parts of a command's work, so that several adapters or machines can share it.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Part `index` of `count`, counted from 1. The parts together equal the whole, whatever their number, because
/// seeds make every piece of work independent of the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// From 1 to `count`.
    pub index: u32,
    pub count: u32,
}

/// Most parts of a command's work.
const MOST: u32 = 10_000;

impl Shard {
    /// The only part, with all of the work.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Reads `I/N`.
    ///
    /// # Errors
    /// A message with the right form.
    pub fn parse(text: &str) -> Result<Self, String> {
        let read = || {
            let (index, count) = text.split_once('/')?;
            let (index, count) = (index.trim().parse().ok()?, count.trim().parse().ok()?);
            ((1..=MOST).contains(&count) && (1..=count).contains(&index))
                .then_some(Self { index, count })
        };
        read().ok_or_else(|| {
            format!("write I/N, as in 2/4: part I, from 1 to N, of N parts, at most {MOST}")
        })
    }

    /// Whether this is all of the work.
    pub fn is_whole(self) -> bool {
        self.count == 1
    }

    /// Whether piece `piece` (counted from 0) belongs to this part. Pieces are dealt out in turn, so that all
    /// parts take about the same time.
    pub fn has(self, piece: usize) -> bool {
        piece % self.count as usize == self.index as usize - 1
    }

    /// The pieces of this part as one consecutive range within 0…`all`, start and end.
    pub fn range(self, all: u32) -> std::ops::Range<u32> {
        let edge = |part: u32| (u64::from(all) * u64::from(part) / u64::from(self.count)) as u32;
        edge(self.index - 1)..edge(self.index)
    }

    /// Checks that parts make a whole.
    ///
    /// # Errors
    /// Names the part that is missing or given twice, or two different numbers of parts.
    pub fn check_complete(parts: &[Self]) -> Result<(), String> {
        let Some(first) = parts.first() else {
            return Err("there are no parts".to_owned());
        };
        if let Some(other) = parts.iter().find(|part| part.count != first.count) {
            return Err(format!(
                "part {other} is one of {} parts, and part {first} one of {}",
                other.count, first.count
            ));
        }
        for index in 1..=first.count {
            let wanted = Self { index, ..*first };
            match parts.iter().filter(|part| **part == wanted).count() {
                0 => return Err(format!("part {wanted} is missing")),
                1 => {}
                times => return Err(format!("part {wanted} is there {times} times")),
            }
        }
        Ok(())
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_share_all_pieces() {
        for count in 1..9 {
            let parts: Vec<Shard> = (1..=count).map(|index| Shard { index, count }).collect();
            for piece in 0..40 {
                assert_eq!(parts.iter().filter(|part| part.has(piece)).count(), 1);
            }
            let mut next = 0;
            for part in &parts {
                let range = part.range(u32::MAX);
                assert_eq!(range.start, next);
                next = range.end;
            }
            assert_eq!(next, u32::MAX);
            assert_eq!(Shard::check_complete(&parts), Ok(()));
        }
    }

    #[test]
    fn what_is_no_part_is_refused() {
        for text in [
            "", "3", "0/4", "5/4", "1/0", "-1/4", "1/4/2", "1/10001", "a/b",
        ] {
            let message = Shard::parse(text).expect_err(text);
            assert!(message.contains("2/4"), "{message}");
        }
        assert_eq!(Shard::parse("2/4"), Ok(Shard { index: 2, count: 4 }));
    }

    #[test]
    fn missing_and_doubled_parts_are_named() {
        let part = |index, count| Shard { index, count };
        let refused = |parts: &[Shard]| Shard::check_complete(parts).expect_err("not a whole");
        assert!(refused(&[part(1, 3), part(3, 3)]).contains("2/3 is missing"));
        assert!(refused(&[part(1, 2), part(2, 2), part(1, 2)]).contains("1/2 is there 2 times"));
        assert!(refused(&[part(1, 2), part(2, 3)]).contains("one of 3"));
        assert!(refused(&[]).contains("no parts"));
    }
}
