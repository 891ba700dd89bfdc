//! Whether a world file is still the same, comments and blanks aside.

use std::path::Path;

use miette::Report;

use super::{
    MAX_MODEL_BYTES,
    diagnostics::{raw_string_length, string_length},
    included,
    leaf::block_comment_length,
    source_file,
};

/// CRC-32 of a world file without its comments and blanks, and of the models that it includes.
///
/// # Errors
/// Those of [`super::load`], for files that are not text.
pub fn fingerprint(path: &Path) -> Result<u32, Report> {
    let source = source_file::read(path).map_err(|problem| *problem)?;
    let mut crc32 = crc32fast::Hasher::new();
    crc32.update(bare(&source.text).as_bytes());
    for model in included(path).unwrap_or_default() {
        // Models that cannot be read are found by the reader of the world.
        crc32.update(&source_file::read_bytes(&model, MAX_MODEL_BYTES).unwrap_or_default());
    }
    Ok(crc32.finalize())
}

/// A text of RON without comments, and without blanks except in strings.
fn bare(text: &str) -> String {
    let bytes = text.as_bytes();
    let mut bare = String::with_capacity(text.len());
    let mut at = 0;
    while let Some(character) = text[at..].chars().next() {
        let rest = &text[at..];
        let (length, is_kept) = match character {
            '"' => (string_length(&bytes[at..]), true),
            'r' if rest[1..].starts_with(['#', '"']) => (raw_string_length(rest), true),
            '/' if rest[1..].starts_with('/') => (rest.find('\n').unwrap_or(rest.len()), false),
            '/' if rest[1..].starts_with('*') => (block_comment_length(rest), false),
            character => (character.len_utf8(), !character.is_whitespace()),
        };
        let end = (at + length).min(text.len());
        if is_kept {
            bare.push_str(&text[at..end]);
        }
        at = end;
    }
    bare
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_blanks_do_not_count() {
        let text = "( // a\n name: \"a // b\", /* c /* d */ */ seed: 1, raw: r#\"x \" y\"#,\n)";
        let bare_text = "(name:\"a // b\",seed:1,raw:r#\"x \" y\"#,)";
        assert_eq!(bare(text), bare_text);
        assert_eq!(bare("/* ü */ 'ä' \"ö"), "'ä'\"ö");
        assert_eq!(bare("a // end"), "a");
        assert_eq!(bare("a /* open"), "a");
    }
}
