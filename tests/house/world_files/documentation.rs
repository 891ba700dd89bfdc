//! `worlds/README.md` names every key, and its example is sound.

use super::sound;

const README: &str = include_str!("../../../worlds/README.md");

/// Field names and variants of the schema, from its source.
fn schema_words() -> Vec<&'static str> {
    let source = include_str!("../../../src/world/file/schema.rs");
    let (_, declarations) = source.split_once("/// The whole file.").expect("the keys");
    let lines = declarations.lines().map(str::trim);
    let declares = |line: &&str| {
        !["//", "#", "use ", "pub struct", "pub enum"]
            .iter()
            .any(|start| line.starts_with(start))
    };
    let mut words = Vec::new();
    for line in lines.filter(declares) {
        // One-line variants hold several fields; what follows a colon is a type.
        for piece in line.split([',', '{']) {
            let piece = piece.trim().trim_start_matches("pub ");
            let end = piece.find(|c: char| !(c.is_alphanumeric() || c == '_'));
            words.push(&piece[..end.unwrap_or(piece.len())]);
        }
    }
    words.retain(|word| !word.is_empty() && !["Leaf", "Vector"].contains(word));
    words
}

#[test]
fn every_key_is_documented() {
    let words = schema_words();
    assert!(words.len() > 120, "{words:?}");
    for known in [
        "title",
        "Sphere",
        "half_height",
        "without_corners",
        "places",
        "fov_deg",
    ] {
        assert!(
            words.contains(&known),
            "{known} is not found in the schema: {words:?}"
        );
    }
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let documented: Vec<&str> = README.split(|c| !is_part(c)).collect();
    let missing = words.iter().filter(|word| !documented.contains(word));
    let missing: Vec<_> = missing.collect();
    assert!(
        missing.is_empty(),
        "worlds/README.md does not name {missing:?}"
    );
}

#[test]
fn the_example_is_sound() {
    let example = README.split("```ron\n").nth(1);
    let example = example.and_then(|rest| rest.split("```").next());
    let world = sound(example.expect("it opens with an example"));
    assert_eq!(world.title, "A ball of rock.");
}
