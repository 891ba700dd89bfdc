//! Text of world files that is safe in a terminal: files come from strangers, and a terminal interprets
//! some characters as commands.

/// Whether a terminal would act on the character: control characters, and those that change the text
/// direction.
pub fn is_obeyed(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

fn is_layout(c: char) -> bool {
    matches!(c, '\n' | '\t' | '\r')
}

/// The text with such characters written out, as in `\u{1b}`; line breaks stay.
pub fn shown(text: &str) -> String {
    let written_out = |c: char| {
        let (plain, escaped) = match is_obeyed(c) && !is_layout(c) {
            true => (None, Some(c.escape_unicode())),
            false => (Some(c), None),
        };
        plain.into_iter().chain(escaped.into_iter().flatten())
    };
    text.chars().flat_map(written_out).collect()
}

/// The text with each such character replaced by signs of the same number of bytes, so that byte
/// positions stay valid.
pub fn masked(text: &str) -> String {
    let mask = |c: char| match (is_obeyed(c) && !is_layout(c), c.len_utf8()) {
        (false, _) => c,
        (true, 1) => '?',
        (true, 2) => '¿',
        (true, _) => char::REPLACEMENT_CHARACTER,
    };
    text.chars().map(mask).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_characters_that_a_terminal_obeys_are_replaced() {
        let text = "a\u{1b}[31m\tb\u{9b}\nc\u{202e}d\u{7f} Höhle 洞窟";
        assert_eq!(
            shown(text),
            "a\\u{1b}[31m\tb\\u{9b}\nc\\u{202e}d\\u{7f} Höhle 洞窟"
        );
        assert_eq!(masked(text), "a?[31m\tb¿\nc\u{fffd}d? Höhle 洞窟");
        assert_eq!(masked(text).len(), text.len());
    }
}
