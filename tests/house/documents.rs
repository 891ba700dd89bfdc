//! The documents name things that exist: every relative link, every path of the repository, every pass. The map and
//! the README stay short.

use std::{
    collections::BTreeSet,
    fs,
    path::{Component, Path, PathBuf},
};

use super::{declared_passes, files, root};

/// Documents outside of `docs/`.
const DOCUMENTS: [&str; 4] = [
    "README.md",
    "ARCHITECTURE.md",
    "CONTRIBUTING.md",
    "worlds/README.md",
];

/// Prefixes of paths in the repository.
const FOLDERS: [&str; 7] = [
    "src/", "shaders/", "tests/", "docs/", "worlds/", "scripts/", "benches/",
];

/// Documents to be read in one sitting, and the limit of their lines.
const SHORT: [&str; 2] = ["README.md", "ARCHITECTURE.md"];
const MOST_LINES: usize = 150;

/// All documents, by their path in the repository.
fn documents() -> Vec<(PathBuf, String)> {
    let read = |path: &str| {
        let text = fs::read_to_string(root().join(path)).expect("a document");
        (PathBuf::from(path), text)
    };
    let mut all: Vec<_> = DOCUMENTS.into_iter().map(read).collect();
    all.extend(files("docs", "md"));
    all
}

/// One line of a document, prepared for finding paths.
struct Line<'a> {
    number: usize,
    text: &'a str,
    /// Whether the line is within a fenced block: there every word counts, and nothing is a link.
    is_fenced: bool,
}

fn lines(text: &str) -> Vec<Line<'_>> {
    let mut is_fenced = false;
    let mut found = Vec::new();
    for (index, text) in text.lines().enumerate() {
        if text.trim_start().starts_with("```") {
            is_fenced = !is_fenced;
            continue;
        }
        found.push(Line {
            number: index + 1,
            text,
            is_fenced,
        });
    }
    found
}

/// Texts between backticks.
fn code_spans(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// Targets of `[text](target)`, code spans left out.
fn links(text: &str) -> Vec<String> {
    let prose: String = text.split('`').step_by(2).collect();
    let targets = prose.split("](").skip(1);
    targets
        .filter_map(|rest| rest.split_once(')'))
        .map(|(target, _)| target.to_owned())
        .collect()
}

/// The anchor that GitHub makes for a heading.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter_map(|c| match c {
        ' ' => Some('-'),
        '-' | '_' => Some(c),
        _ => c.is_alphanumeric().then(|| c.to_ascii_lowercase()),
    });
    kept.collect()
}

fn anchors(text: &str) -> BTreeSet<String> {
    let headings = lines(text).into_iter().filter(|line| !line.is_fenced);
    headings
        .filter(|line| line.text.starts_with('#'))
        .map(|line| anchor(line.text.trim_start_matches('#')))
        .collect()
}

/// `a/../b` as `b`.
fn tidy(path: &Path) -> PathBuf {
    let mut parts = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                parts.pop();
            }
            Component::CurDir => {}
            part => parts.push(part),
        }
    }
    parts
}

/// `a{b,c}` as `ab` and `ac`.
fn expanded(path: &str) -> Vec<String> {
    let Some((before, rest)) = path.split_once('{') else {
        return vec![path.to_owned()];
    };
    let Some((choices, after)) = rest.split_once('}') else {
        return vec![path.to_owned()];
    };
    choices
        .split(',')
        .flat_map(|choice| expanded(&format!("{before}{choice}{after}")))
        .collect()
}

/// Whether a part of a path is a placeholder for any name: `*`, or a word in capitals such as `SUBJECT` or `NAME.wesl`.
fn is_placeholder(part: &str) -> bool {
    let stem = part.split('.').next().unwrap_or(part);
    let is_word = stem.len() > 1 && stem.chars().all(|c| c.is_ascii_uppercase() || c == '_');
    part.contains('*') || (is_word && stem != "README")
}

/// Whether a path of the repository exists; if parts of it are placeholders, whether any path matches.
fn exists(folder: &Path, path: &str) -> bool {
    let (part, rest) = path.split_once('/').unwrap_or((path, ""));
    if part.is_empty() {
        return folder.is_dir();
    }
    let mut candidates = vec![folder.join(part)];
    if is_placeholder(part) {
        let extension = Path::new(part).extension();
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        candidates = entries
            .map(|entry| entry.path())
            .filter(|path| extension.is_none() || path.extension() == extension)
            .collect();
    }
    let mut found = candidates.iter();
    match rest {
        "" => found.any(|path| path.exists()),
        rest => found.any(|path| exists(path, rest)),
    }
}

/// The word as a path, if it begins like a path of the repository.
fn as_path(word: &str) -> Option<&str> {
    let word = word.trim_matches(|c: char| "\"'(),;:.".contains(c));
    let is_path = FOLDERS.iter().any(|folder| word.starts_with(folder));
    is_path.then_some(word)
}

/// Whether a word names a pass: a subject, a slash, a lower-case name.
fn looks_like_a_pass(word: &str, passes: &BTreeSet<String>) -> bool {
    let Some((subject, name)) = word.split_once('/') else {
        return false;
    };
    let is_name = !name.is_empty() && name.chars().all(|c| c.is_ascii_lowercase() || c == '_');
    let own = format!("{subject}/");
    is_name && passes.iter().any(|pass| pass.starts_with(&own))
}

/// `document:line: reason` for everything that a document names but that does not exist.
fn document_faults(document: &Path, text: &str, passes: &BTreeSet<String>) -> Vec<String> {
    let mut faults = Vec::new();
    for line in lines(text) {
        let mut fault = |what: String| {
            faults.push(format!("{}:{}: {what}", document.display(), line.number));
        };
        let words: Vec<&str> = if line.is_fenced {
            line.text.split_whitespace().collect()
        } else {
            code_spans(line.text)
                .flat_map(str::split_whitespace)
                .collect()
        };
        for word in words {
            let path = as_path(word);
            let wanted = path.map(expanded).unwrap_or_default();
            for path in wanted.iter().filter(|path| !exists(root(), path)) {
                fault(format!("`{path}` does not exist"));
            }
            let word = word.trim_matches(|c: char| "(),;:.".contains(c));
            if looks_like_a_pass(word, passes) && !passes.contains(word) {
                fault(format!("there is no pass `{word}`"));
            }
        }
        if line.is_fenced {
            continue;
        }
        for target in links(line.text) {
            if target.contains("://") {
                continue;
            }
            let (file, place) = target.split_once('#').unwrap_or((&target, ""));
            let folder = document.parent().unwrap_or(Path::new(""));
            let path = match file {
                "" => document.to_path_buf(),
                file => tidy(&folder.join(file)),
            };
            if !file.is_empty() && !root().join(&path).exists() {
                fault(format!("the link `{target}` leads nowhere"));
            } else if !place.is_empty() {
                let linked = match file {
                    "" => text.to_owned(),
                    _ => fs::read_to_string(root().join(&path)).unwrap_or_default(),
                };
                if !anchors(&linked).contains(place) {
                    fault(format!("the link `{target}` has no such heading"));
                }
            }
        }
    }
    faults
}

#[test]
fn documents_name_what_exists() {
    let passes = declared_passes();
    let all = documents();
    assert!(all.len() > 10, "documents are found");
    let faults: Vec<String> = all
        .iter()
        .flat_map(|(path, text)| document_faults(path, text, &passes))
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Documents that should be short but are too long.
fn long_documents(all: &[(PathBuf, String)]) -> Vec<(&Path, usize)> {
    all.iter()
        .filter(|(path, _)| SHORT.iter().any(|short| path == Path::new(short)))
        .map(|(path, text)| (path.as_path(), text.lines().count()))
        .filter(|(_, lines)| *lines > MOST_LINES)
        .collect()
}

#[test]
fn the_map_and_the_readme_stay_short() {
    assert_eq!(long_documents(&documents()), []);
    let long = vec![(PathBuf::from("README.md"), "a\n".repeat(MOST_LINES + 1))];
    assert_eq!(long_documents(&long).len(), 1, "a planted one is found");
}

#[test]
fn planted_faults_of_documents_are_found() {
    let passes = BTreeSet::from(["probes/trace".to_owned(), "view/shade".to_owned()]);
    let faults = |text: &str| document_faults(Path::new("docs/a.md"), text, &passes);
    for text in [
        "See `src/gone.rs`.",
        "See `src/gone/`.",
        "`shaders/{math,gone}/`",
        "`src/passes/SUBJECT/gone_*.nothing`",
        "`src/gone/NAME.rs`",
        "`docs/bench.md` and `docs/gone.md`",
        "```sh\ngrotto render worlds/gone.ron -o a.png\n```",
        "[a page](gone.md)",
        "[a page](bench.md), [another](../docs/gone.md)",
        "[a page](bench.md#gone)",
        "# Here\n[above](#there)",
        "Pass `probes/gone` traces.",
        "| `view/shaded` |",
    ] {
        assert_eq!(faults(text).len(), 1, "{text}: {:?}", faults(text));
    }
    for text in [
        "`src/lib.rs`, `src/passes/`, `src/passes`",
        "`src/{lib,main}.rs` and `shaders/*/trace.wesl`",
        "`src/passes/SUBJECT/NAME.rs`",
        "src/gone.rs without backticks, [a `b](c` d](bench.md)",
        "```sh\ngrotto render worlds/cave.ron -o cave.png\n```",
        "[a page](bench.md#method), [the web](https://example.org/gone)",
        "# Of a `b`, c\n[above](#of-a-b-c)",
        "`probes/trace`, `view/shade` and `world/gone`",
    ] {
        assert_eq!(faults(text), Vec::<String>::new(), "{text}");
    }
}
