//! The parser's errors in the terms of this format.

use ron::error::Error as RonError;

use super::diagnostics::MAX_NESTING;
use crate::parameters::nearest;

/// "Did you mean", and the list of known names.
pub fn suggest<'a>(wanted: &str, known: impl Iterator<Item = &'a str> + Clone) -> String {
    let all: Vec<String> = known.clone().map(|name| format!("`{name}`")).collect();
    let near = nearest(wanted, known);
    match (near.first(), all.len()) {
        (_, 0) => "there is none yet".to_owned(),
        (Some(near), 1) => format!("did you mean `{near}`?"),
        (None, 1) => format!("there is only {}", all[0]),
        (Some(near), _) => format!("did you mean `{near}`? There are {}", all.join(", ")),
        (None, _) => format!("there are {}", all.join(", ")),
    }
}

/// Message, remedy, and the word that the message is about.
pub fn explain(error: RonError) -> (String, String, Option<String>) {
    let near = |found: &str, expected: &[&str]| suggest(found, expected.iter().copied());
    let of = |outer: Option<String>| outer.map_or(String::new(), |outer| format!(" of {outer}"));
    match error {
        RonError::NoSuchStructField {
            expected,
            found,
            outer,
        } => (
            format!("`{found}` is not a key{}", of(outer)),
            near(&found, expected),
            Some(found),
        ),
        RonError::NoSuchEnumVariant {
            expected, found, ..
        } => (
            format!("`{found}` is not known here"),
            near(&found, expected),
            Some(found),
        ),
        RonError::MissingStructField { field, outer } => (
            format!("the key `{field}`{} is missing", of(outer)),
            format!("add `{field}: …`; worlds/README.md describes it"),
            None,
        ),
        RonError::DuplicateStructField { field, .. } => (
            format!("the key `{field}` is given twice"),
            "remove one of the two".into(),
            Some(field.into()),
        ),
        RonError::ExpectedDifferentStructName { expected, found } => (
            format!("expected {expected}, found {found}"),
            format!("write `(…)` or `{expected}(…)`"),
            Some(found),
        ),
        RonError::ExpectedArray => (
            "expected a list".into(),
            "write the elements between `[` and `]`".into(),
            None,
        ),
        RonError::ExpectedStructLike | RonError::ExpectedNamedStructLike(_) => (
            "expected an opening `(`".into(),
            "three numbers are written (x, y, z), a group of keys (key: value, …)".into(),
            None,
        ),
        RonError::ExpectedBoolean => (
            "expected true or false".into(),
            "write `true` or `false`".into(),
            None,
        ),
        RonError::ExpectedDifferentLength { expected, found } => (
            format!("expected {expected}, found {found} values"),
            "a vector is three numbers (x, y, z), a pair two".into(),
            None,
        ),
        RonError::ExceededRecursionLimit => (
            "the file nests too deep".into(),
            format!("brackets may nest {MAX_NESTING} deep"),
            None,
        ),
        RonError::Eof | RonError::ExpectedStructLikeEnd | RonError::ExpectedArrayEnd => (
            format!("{error}"),
            "a bracket or a comma is missing here or just before".into(),
            None,
        ),
        RonError::ExpectedComma => (
            "expected a comma".into(),
            "separate keys and elements with `,`".into(),
            None,
        ),
        RonError::InvalidIdentifier(_)
        | RonError::SuggestRawIdentifier(_)
        | RonError::ExpectedIdentifier => (
            "expected the name of a key".into(),
            "write `key: value`, separated by commas".into(),
            None,
        ),
        RonError::TrailingCharacters => (
            "there is text after the end of the world".into(),
            "a world file is one group of keys: ( … )".into(),
            None,
        ),
        RonError::Message(message) => (
            message,
            "worlds/README.md says what every key takes".into(),
            None,
        ),
        error => (
            format!("this is not valid RON: {error}"),
            "worlds/minimal.ron is the smallest world to copy".into(),
            None,
        ),
    }
}
