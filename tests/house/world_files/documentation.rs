//! `worlds/README.md` names every key, and its example is valid.

use glam::DVec3;
use grotto::world::sdf::{Sdf, Shape};

use super::sound;
use crate::support::examples;

const README: &str = include_str!("../../../worlds/README.md");

/// Field names and variants of the schema, from its source; shapes and their keys.
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
    for (form, keys) in Sdf::FORMS {
        words.push(form);
        words.extend_from_slice(keys);
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

#[test]
fn what_can_only_be_guessed_from_a_picture_is_written_down() {
    let readme = README.split_whitespace().collect::<Vec<_>>().join(" ");
    let ground_edge = grotto::lights::sky::GROUND_EDGE;
    for part in [
        "(1 − (1 − y)³)".to_owned(),
        format!("min(−y / {ground_edge}, 1)"),
        "t = (cos angle − cos outer) / (cos inner − cos outer)".to_owned(),
        "(x, y, z) there is (x, z, −y) here".to_owned(),
        "in a solid voxel is dark".to_owned(),
    ] {
        assert!(readme.contains(&part), "worlds/README.md lacks {part}");
    }
}

#[test]
fn every_shape_has_an_example() {
    let examples = examples::shapes();
    let shown = |form: &str| {
        let smooth = form.strip_prefix("Smooth").unwrap_or(form);
        [form, smooth].iter().any(|form| {
            let mut texts = examples.iter().map(|(text, _)| text);
            texts.any(|text| text.split('(').next() == Some(form))
        })
    };
    for (form, _) in Sdf::FORMS {
        assert!(shown(form), "worlds/README.md has no `{form}(…)`");
    }
}

/// Culling relies on this: values change no faster than stated, and all solid voxels lie within the bounds.
#[test]
fn the_bounds_of_the_examples_hold() {
    for (text, world) in examples::shapes() {
        let shape = Shape::new(&world.shape, &world.noises);
        let bounds = shape.bounds();
        for i in 0..4000 {
            let at = |n: f64| (f64::from(i) + 0.5) * n;
            let turn = DVec3::new(8.191_725_134, 6.710_436_067, 5.497_004_779);
            let p = turn.map(|n| at(n) % 60.0 - 30.0);
            let radius = [1e-4, 0.05, 0.7, 2.6, 6.1][i as usize % 5];
            let q =
                p + radius * DVec3::new(at(2.4).cos(), at(3.7).sin(), at(5.1).cos()).normalize();
            let (value, other) = (shape.eval(p), shape.eval(q));
            assert!(
                value == other || (value - other).abs() <= shape.variation(radius) + 1e-9,
                "{text} at {p}: {value}, {other}"
            );
            let within = p.cmpge(bounds.min).all() && p.cmple(bounds.max).all();
            assert!(value >= 0.0 || within, "{text} at {p}: {bounds:?}");
        }
    }
}
