//! What is wrong with a world file: a message, its position in the file, and a remedy.

use std::fmt;
use std::sync::Arc;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use ron::error::{Position, SpannedError};

use super::explain::explain;
use super::leaf::{Leaf, Located, block_comment_length};
use super::printable::{masked, shown};
use super::schema::Vector;

/// Longer lines are not shown as a whole; the message quotes a part of them.
const LONGEST_SHOWN_LINE: usize = 400;

/// Brackets may nest this deep. It keeps all recursion over a world far from the end of its stack.
pub const MAX_NESTING: usize = 64;

/// One thing that is wrong with a world file.
#[derive(Debug)]
pub struct Problem {
    message: String,
    help: String,
    place: Option<Place>,
}

#[derive(Debug)]
struct Place {
    source: NamedSource<Arc<str>>,
    /// Bytes.
    offset: usize,
    length: usize,
    line: usize,
    column: usize,
    /// Whether the line is short enough to be shown.
    shown: bool,
}

impl Problem {
    /// A problem of the whole file.
    pub fn of_file(message: impl Into<String>, help: impl Into<String>) -> Box<Self> {
        Box::new(Self {
            message: shown(&message.into()),
            help: shown(&help.into()),
            place: None,
        })
    }

    /// Line and column of the offending text, both from 1; `None` for a problem of the whole file.
    pub fn line_and_column(&self) -> Option<(usize, usize)> {
        self.place.as_ref().map(|place| (place.line, place.column))
    }

    /// The offending text.
    pub fn offending_text(&self) -> Option<&str> {
        let place = self.place.as_ref()?;
        place
            .source
            .inner()
            .get(place.offset..place.offset + place.length)
    }

    /// What to do about it.
    pub fn remedy(&self) -> &str {
        &self.help
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place
            && !place.shown
        {
            let name = place.source.name();
            write!(f, "{name}:{}:{}: ", place.line, place.column)?;
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for Problem {}

impl Diagnostic for Problem {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        (!self.help.is_empty()).then(|| Box::new(&self.help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        let place = self.place.as_ref().filter(|place| place.shown)?;
        Some(&place.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.place.as_ref().filter(|place| place.shown)?;
        let span = LabeledSpan::new(Some("here".into()), place.offset, place.length);
        Some(Box::new(std::iter::once(span)))
    }
}

/// The text of a world file and its name in messages.
#[derive(Clone, Debug)]
pub struct Source {
    pub name: String,
    pub text: Arc<str>,
}

impl Source {
    /// A problem at a value of the file.
    pub fn at(
        &self,
        leaf: &Leaf,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<Problem> {
        match leaf.place_in(&self.text) {
            Some((offset, length)) => self.at_bytes(offset, length, message, help),
            None => Problem::of_file(format!("{}: {}", self.name, message.into()), help),
        }
    }

    /// A problem of three numbers as a group.
    pub fn at_vector(
        &self,
        vector: &Vector,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<Problem> {
        match vector.place_in(&self.text) {
            Some((offset, length)) => self.at_bytes(offset, length, message, help),
            None => self.at(&vector.0, message, help),
        }
    }

    /// A problem at a range of bytes.
    pub fn at_bytes(
        &self,
        offset: usize,
        length: usize,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<Problem> {
        let before = &self.text[..offset];
        let line_start = before.rfind('\n').map_or(0, |end| end + 1);
        let line_end = self.text[offset..]
            .find('\n')
            .map_or(self.text.len(), |length| offset + length);
        Box::new(Problem {
            message: shown(&message.into()),
            help: shown(&help.into()),
            place: Some(Place {
                source: NamedSource::new(shown(&self.name), masked(&self.text).into()),
                offset,
                length,
                line: 1 + before.matches('\n').count(),
                column: 1 + before[line_start..].chars().count(),
                shown: line_end - line_start <= LONGEST_SHOWN_LINE,
            }),
        })
    }

    /// Refuses brackets that nest too deep, before anything recurses over them.
    pub fn check_nesting(&self) -> Result<(), Box<Problem>> {
        let bytes = self.text.as_bytes();
        let (mut depth, mut at) = (0usize, 0);
        while at < bytes.len() {
            match bytes[at] {
                b'(' | b'[' | b'{' => {
                    depth += 1;
                    if depth > MAX_NESTING {
                        return Err(self.at_bytes(
                            at,
                            1,
                            format!("brackets nest more than {MAX_NESTING} deep"),
                            "a list in one Union or Intersection does what a chain of pairs does",
                        ));
                    }
                }
                b')' | b']' | b'}' => depth = depth.saturating_sub(1),
                b'"' => at += string_length(&bytes[at..]) - 1,
                b'\'' if bytes.get(at + 2) == Some(&b'\'') => at += 2,
                b'/' if bytes.get(at + 1) == Some(&b'/') => {
                    let rest = &bytes[at..];
                    at += rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
                }
                b'/' if bytes.get(at + 1) == Some(&b'*') => {
                    at += block_comment_length(&self.text[at..]) - 1;
                }
                b'r' if matches!(bytes.get(at + 1), Some(b'#' | b'"')) => {
                    at += raw_string_length(&self.text[at..]) - 1;
                }
                _ => {}
            }
            at += 1;
        }
        Ok(())
    }

    /// The RON parser's error, in the terms of this format.
    pub fn of_parser(&self, error: SpannedError) -> Box<Problem> {
        let start = self.offset_of(error.span.start);
        let end = self.offset_of(error.span.end).max(start);
        let (message, help, word) = explain(error.code);
        let (start, length) = match word {
            Some(word) => self.find_word(&word, start, end),
            None => self.shrink(start, end),
        };
        self.at_bytes(start, length, message, help)
    }

    fn offset_of(&self, position: Position) -> usize {
        let mut lines = self.text.split_inclusive('\n');
        let before: usize = lines
            .by_ref()
            .take(position.line.saturating_sub(1))
            .map(str::len)
            .sum();
        let line = lines.next().unwrap_or("");
        let mut chars = line.char_indices().map(|(offset, _)| offset);
        before
            + chars
                .nth(position.col.saturating_sub(1))
                .unwrap_or(line.len())
    }

    /// The parser has sometimes read past the key that it objects to: search backwards for the word.
    fn find_word(&self, word: &str, start: usize, end: usize) -> (usize, usize) {
        let is_part = |c: char| c.is_alphanumeric() || c == '_';
        let alone = |at: &usize| {
            let before = self.text[..*at].chars().next_back();
            let after = self.text[at + word.len()..].chars().next();
            !before.is_some_and(is_part) && !after.is_some_and(is_part)
        };
        let until = (end + word.len()).min(self.text.len());
        let until = &self.text[..self.text.floor_char_boundary(until)];
        let places = until.rmatch_indices(word).map(|(at, _)| at);
        match places.filter(|at| *at <= end).find(alone) {
            Some(at) => (at, word.len()),
            None => self.shrink(start, end),
        }
    }

    /// The range without surrounding blanks, on one line, and not empty where there is text.
    fn shrink(&self, start: usize, end: usize) -> (usize, usize) {
        let text = &self.text[start..end];
        let trimmed = text.trim_start();
        let start = start + text.len() - trimmed.len();
        let trimmed = trimmed.lines().next().unwrap_or("").trim_end();
        if !trimmed.is_empty() {
            return (start, trimmed.len());
        }
        // A position between characters: take the word or the sign that begins there.
        let rest = &self.text[start..];
        let word = rest.find(|c: char| !(c.is_alphanumeric() || "_.+-".contains(c)));
        let sign = rest.chars().next().map_or(0, char::len_utf8);
        (start, word.unwrap_or(rest.len()).max(sign))
    }
}

/// Length in bytes of the string literal that `bytes` begins with.
pub fn string_length(bytes: &[u8]) -> usize {
    let mut at = 1;
    while at < bytes.len() {
        match bytes[at] {
            b'"' => return at + 1,
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
    bytes.len()
}

/// Length in bytes of the raw string literal that `text` begins with; 1 if there is none.
pub fn raw_string_length(text: &str) -> usize {
    let hashes = text[1..].bytes().take_while(|&b| b == b'#').count();
    if text.as_bytes().get(1 + hashes) != Some(&b'"') {
        return 1;
    }
    let close = format!("\"{}", "#".repeat(hashes));
    let body = &text[2 + hashes..];
    body.find(&close)
        .map_or(text.len(), |end| 2 + hashes + end + close.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_no_brackets_in_strings_and_comments() {
        let open = "(".repeat(MAX_NESTING + 1);
        let source = |text: String| Source {
            name: "test".into(),
            text: text.into(),
        };
        for harmless in [
            format!("\"\\\"{open}\""),
            format!("// {open}\n"),
            format!("/* /* */ {open} */"),
            format!("r#\"{open}\"#"),
            "()".repeat(500),
        ] {
            assert!(
                source(harmless.clone()).check_nesting().is_ok(),
                "{harmless}"
            );
        }
        let problem = source(format!("\n {open}"))
            .check_nesting()
            .expect_err("too deep");
        assert_eq!(problem.line_and_column(), Some((2, 2 + MAX_NESTING)));
    }
}
