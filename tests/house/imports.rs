//! Which modules of the crate a source file names.

use std::path::Path;

use super::source::{Token, tokens};

/// A path that begins at `crate`, `super`, `self` or `grotto`, or is part of a `use`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Import {
    /// The full path from the crate's root: `["world", "voxels", "Voxels"]`. Empty for the root itself.
    pub path: Vec<String>,
    pub line: usize,
    pub in_tests: bool,
}

/// The module that a file under src/ defines: `["world", "sdf"]` for `src/world/sdf/mod.rs`. `None`
/// for `lib.rs`, which only lists the modules.
pub fn module_of(path: &Path) -> Option<Vec<String>> {
    let inner = path.strip_prefix("src").ok()?.with_extension("");
    let mut module: Vec<String> = inner
        .iter()
        .map(|part| part.to_string_lossy().into_owned())
        .collect();
    if module.last().is_some_and(|last| last == "mod") {
        module.pop();
    }
    (module != ["lib"]).then_some(module)
}

/// Every path of a file that leads to a module of the crate.
pub fn of_source(module: &[String], source: &str) -> Vec<Import> {
    let tokens = tokens(source);
    let text = |at: usize| tokens.get(at).map_or("", |token: &Token| token.text);
    let mut imports = Vec::new();
    // Inline modules around the current token, each with the depth of its brace.
    let mut inline: Vec<(&str, usize)> = Vec::new();
    let mut depth = 0;
    let mut at = 0;
    while at < tokens.len() {
        let token = tokens[at];
        match token.text {
            "{" => depth += 1,
            "}" => {
                depth -= 1;
                inline.pop_if(|(_, opened)| *opened == depth);
            }
            "mod" if text(at + 2) == "{" => inline.push((text(at + 1), depth)),
            "use" if !matches!(text(at + 1), "::" | "<") => {
                // Without a root it names a child of this module or another crate; the rules tell which.
                let here = full(module, &inline);
                at = add(&tokens, at + 1, &here, Some(here.clone()), &mut imports);
                continue;
            }
            "crate" | "grotto" | "super" | "self"
                if text(at + 1) == "::" && (at == 0 || text(at - 1) != "::") =>
            {
                at = add(&tokens, at, &full(module, &inline), None, &mut imports);
                continue;
            }
            _ => {}
        }
        at += 1;
    }
    imports
}

/// The path of the module that contains the current token.
fn full(module: &[String], inline: &[(&str, usize)]) -> Vec<String> {
    let names = inline.iter().map(|(name, _)| (*name).to_owned());
    module.iter().cloned().chain(names).collect()
}

/// Adds the imports of the path or use tree at `at`, and returns the position behind it.
fn add(
    tokens: &[Token],
    at: usize,
    here: &[String],
    prefix: Option<Vec<String>>,
    imports: &mut Vec<Import>,
) -> usize {
    let mut paths = Vec::new();
    let after = tree(tokens, at, here, prefix, &mut paths);
    imports.extend(paths.into_iter().map(|path| Import {
        path,
        line: tokens[at].line,
        in_tests: here.iter().any(|part| part == "tests"),
    }));
    after
}

/// Reads the path or use tree at `at`, adds the full path of each of its leaves, and returns the
/// position behind it. `prefix` is the path so far; `None` at the start of a path.
fn tree(
    tokens: &[Token],
    mut at: usize,
    here: &[String],
    mut prefix: Option<Vec<String>>,
    leaves: &mut Vec<Vec<String>>,
) -> usize {
    while let Some(token) = tokens.get(at) {
        match token.text {
            "{" => {
                at += 1;
                while tokens.get(at).is_some_and(|token| token.text != "}") {
                    at = tree(tokens, at, here, prefix.clone(), leaves);
                    // A renaming `as` and the comma belong to no path.
                    while tokens
                        .get(at)
                        .is_some_and(|token| !matches!(token.text, "," | "}"))
                    {
                        at += 1;
                    }
                    at += usize::from(tokens.get(at).is_some_and(|token| token.text == ","));
                }
                return at + 1;
            }
            "*" | "self" if prefix.is_some() => {}
            "crate" | "grotto" => prefix = Some(Vec::new()),
            "self" => prefix = Some(here.to_vec()),
            "super" => {
                prefix.get_or_insert_with(|| here.to_vec()).pop();
            }
            name => prefix.get_or_insert_default().push(name.to_owned()),
        }
        at += 1;
        match tokens.get(at).map(|token| token.text) {
            // A turbofish ends the path as far as modules go.
            Some("::") if tokens.get(at + 1).is_some_and(|token| token.text != "<") => at += 1,
            _ => break,
        }
    }
    leaves.extend(prefix);
    at
}

#[test]
fn paths_are_found_in_full() {
    let module = ["passes".to_owned(), "shade".to_owned()];
    let found = |source: &str| -> Vec<String> {
        of_source(&module, source)
            .iter()
            .map(|import| import.path.join("::"))
            .collect()
    };
    assert_eq!(
        found("use crate::{a::{self, B as C}, d::*, e};\nfn f() { super::g::h::<u8>(1); }"),
        ["a", "a::B", "d", "e", "passes::g::h"]
    );
    assert_eq!(
        found("mod tests { use super::x; mod y { use super::super::z; } }"),
        ["passes::shade::x", "passes::shade::z"]
    );
    assert_eq!(
        found("use self::own::A; use super::super::world::W;"),
        ["passes::shade::own::A", "world::W"]
    );
    assert_eq!(
        found("fn f(self) { self.x } pub(crate) fn g(&self) {}"),
        Vec::<String>::new()
    );
    assert_eq!(
        found("use {own::A, crate::b}; use c::D as E;"),
        ["passes::shade::own::A", "b", "passes::shade::c::D"]
    );
}
