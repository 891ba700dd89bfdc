//! Rust source as tokens: enough of the language to find paths and inline modules.

/// A name, `::`, or a single other character, with its line (1-based).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token<'a> {
    pub text: &'a str,
    pub line: usize,
}

/// The tokens of a source file, without comments, strings, characters and lifetimes.
pub fn tokens(source: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    let (mut rest, mut line) = (source, 1);
    while let Some(first) = rest.chars().next() {
        let (length, is_token) = match first {
            '/' if rest.starts_with("//") => (rest.find('\n').unwrap_or(rest.len()), false),
            '/' if rest.starts_with("/*") => (block_comment(rest), false),
            '"' => (string(rest, 1), false),
            '\'' => (character_or_lifetime(rest), false),
            ':' if rest.starts_with("::") => (2, true),
            _ if is_name(first) => match raw_string(rest) {
                Some(length) => (length, false),
                None => (rest.find(|c| !is_name(c)).unwrap_or(rest.len()), true),
            },
            _ => (first.len_utf8(), !first.is_whitespace()),
        };
        let (text, after) = rest.split_at(length);
        if is_token {
            tokens.push(Token { text, line });
        }
        line += text.matches('\n').count();
        rest = after;
    }
    tokens
}

fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Length of the nested block comment that the text begins with.
fn block_comment(text: &str) -> usize {
    let mut depth = 0;
    for (at, _) in text.char_indices() {
        if text[at..].starts_with("/*") {
            depth += 1;
        } else if text[..at].ends_with("*/") && at > 2 {
            depth -= 1;
            if depth == 0 {
                return at;
            }
        }
    }
    text.len()
}

/// Length of a string literal whose opening quote ends at `opened`.
fn string(text: &str, opened: usize) -> usize {
    let mut escaped = false;
    for (at, c) in text[opened..].char_indices() {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return opened + at + 1,
            _ => {}
        }
    }
    text.len()
}

/// Length of a raw, byte or C string, prefix included; `None` if the text begins with a name.
fn raw_string(text: &str) -> Option<usize> {
    let prefix = text.find(|c: char| !is_name(c))?;
    let is_raw = matches!(&text[..prefix], "r" | "br" | "cr");
    let hashes = text[prefix..]
        .bytes()
        .take_while(|&byte| byte == b'#')
        .count();
    let body = prefix + hashes + 1;
    if !text[prefix + hashes..].starts_with('"') {
        return None;
    }
    if is_raw {
        let end = format!("\"{}", "#".repeat(hashes));
        return Some(
            text[body..]
                .find(&end)
                .map_or(text.len(), |at| body + at + end.len()),
        );
    }
    (hashes == 0 && matches!(&text[..prefix], "b" | "c")).then(|| string(text, body))
}

/// Length of a character literal, or of the quote and name of a lifetime.
fn character_or_lifetime(text: &str) -> usize {
    let mut inside = text[1..].chars();
    match (inside.next(), inside.next()) {
        (Some('\\'), _) => 3 + text[3..].find('\'').map_or(0, |at| at + 1),
        (Some(c), Some('\'')) => 2 + c.len_utf8(),
        _ => 1 + text[1..].find(|c| !is_name(c)).unwrap_or(text.len() - 1),
    }
}

#[test]
fn tokens_leave_out_what_is_not_code() {
    let source = "use a::B; // c\n/* d /* e */ f */ 'g' '\\'' \"h\\\"i\" r#\"j\"k\"# b\"l\" &'m n";
    let texts: Vec<&str> = tokens(source).iter().map(|token| token.text).collect();
    assert_eq!(texts, ["use", "a", "::", "B", ";", "&", "n"]);
    assert_eq!(tokens(source)[5].line, 2);
}
