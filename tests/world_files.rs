//! World files as people write them: sound ones, and all the ways in which they can be wrong.

use grotto::world::file::{self, Overrides};
use grotto::world::{Sdf, World};

/// A world that uses every part of the schema.
const FULL: &str = include_str!("full.ron");

fn read(text: &str) -> Result<World, miette::Report> {
    file::parse(text, "test.ron", None, &Overrides::default())
}

#[test]
fn every_part_of_the_schema_is_read() {
    let world = read(FULL).unwrap_or_else(|report| panic!("{report:?}"));
    assert_eq!(world.name, "test");
    assert_eq!(world.size.to_array(), [64, 48, 64]);
    assert!(matches!(world.shape, Sdf::SmoothUnion { .. }));
}

#[test]
fn three_keys_make_a_world() {
    let world = read("(title: \"Least.\", size: (32, 32, 32), shape: Sphere(radius: 9))")
        .unwrap_or_else(|report| panic!("{report:?}"));
    assert_eq!(world.lamp_presets[0].name, "none");
    assert_eq!(world.layouts[0].counts.to_array(), [8, 8, 8]);
    assert_eq!(world.materials.len(), 1);
    assert_eq!(world.cameras.len(), 1);
}

#[test]
fn features_that_crowd_the_cells_are_refused() {
    let places = "(0, 0, 0), ".repeat(200);
    let text = format!(
        "(title: \"t\", size: (512, 512, 512), shape: Plane(normal: (0, 1, 0), offset: 0),
          materials: {{ \"stone\": (a: Flat(1, 1, 1)) }},
          features: (
            kinds: {{ \"all\": [(min: (0, 0, 0), max: (511, 511, 511), material: \"stone\")] }},
            place: [At(kind: \"all\", places: [{places}])],
          ))"
    );
    let error = format!("{:?}", read(&text).expect_err("52 million entries"));
    assert!(error.contains("overlap"), "{error}");
}
