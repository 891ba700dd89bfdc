//! World files as people write them: valid ones, and all the ways in which they can be wrong.

mod damage;
mod documentation;
mod files;
mod mistakes;
mod models;

use glam::{IVec3, UVec3, Vec3};
use grotto::world::bodies::Bodies;
use grotto::world::file::{self, Overrides, Problem};
use grotto::world::sdf::SmoothUnion;
use grotto::world::{Colour, ResponseSpec, Sdf, World};

/// A world that uses every part of the schema.
const FULL: &str = include_str!("full.ron");

fn read(text: &str) -> Result<World, miette::Report> {
    file::parse(text, "test.ron", None, &Overrides::default())
}

fn sound(text: &str) -> World {
    read(text).unwrap_or_else(|report| panic!("{report:?}"))
}

/// The single problem of a text that must be refused.
#[track_caller]
fn refused(result: Result<World, miette::Report>) -> Problem {
    let report = result.expect_err("must be refused");
    let rendered = format!("{report:?}");
    let problem: Problem = report.downcast().expect("a problem of the file");
    assert!(!problem.remedy().is_empty(), "no remedy: {rendered}");
    println!("{rendered}\n");
    problem
}

/// The full world with one piece of text replaced, which must occur in it once.
#[track_caller]
fn with(old: &str, new: &str) -> String {
    assert_eq!(FULL.matches(old).count(), 1, "{old}");
    FULL.replace(old, new)
}

#[test]
fn every_part_of_the_schema_is_read() {
    let world = sound(FULL);
    assert_eq!(world.name, "test");
    assert_eq!(world.title, "Everything at once.");
    assert_eq!(world.size.to_array(), [64, 48, 64]);
    assert!(matches!(&world.shape, Sdf::SmoothUnion(SmoothUnion { of, .. }) if of.len() == 7));
    assert_eq!(world.noises.len(), 4);
    assert_eq!(world.noises[0].seed, 7, "the world's");
    assert_eq!(world.noises[1].seed, 4);
    let names: Vec<&str> = world.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names[..3], ["rock", "moss", "cap"], "in the file's order");
    assert_eq!(world.rules.len(), 6);
    assert_eq!(world.rules[1].material, 5);
    // A lamp of 100 W in voxels of half a metre.
    assert_eq!(world.lamp_presets[0].lamps[0].power, 400.0);
    assert_eq!(world.lamp_presets[0].lamps[2].power, 1.0, "directional");
    assert_eq!(world.lamp_presets[1].lamps.len(), 7);
    assert_eq!(world.layouts[1].spacing, Vec3::new(7.0, 6.0, 7.0));
    assert_eq!(world.layouts[0].centre, Vec3::ZERO);
    assert!(!world.layouts[0].follow && world.layouts[0].cascades == 1);
    assert!(world.layouts[2].follow && world.layouts[2].cascades == 3);
    assert_eq!(world.layouts[2].centre, Vec3::ZERO, "where the camera is");
    assert!(world.cameras[0].pitch_deg < 0.0 && world.cameras[0].yaw_deg.abs() < 1e-5);
    let tiny_at_first_place = &world.features[..2];
    assert_eq!(tiny_at_first_place[0].min.to_array(), [-1, 6, -1]);
    assert!(tiny_at_first_place[0].without_corners);
    assert_eq!(tiny_at_first_place[1].max.to_array(), [0, 5, 0]);
    let bodies = &world.bodies;
    assert_eq!(bodies.bodies.len(), 4);
    assert_eq!(bodies.models.len(), 2, "two are like another");
    let leaf = &bodies.bodies[0];
    assert_eq!(bodies.models[leaf.model].size.to_array(), [5, 7, 1]);
    assert!(bodies.models[0].materials.iter().all(|m| *m == 7), "bricks");
    assert_eq!(leaf.pivot, Vec3::new(0.0, 3.5, 0.5), "at the hinge");
    assert_eq!(bodies.bodies[3].name, "body 4");
    let stone = &bodies.models[1];
    assert_eq!(stone.material(IVec3::new(4, 4, 3)), 1, "rock, by the rules");
    assert_eq!(stone.material(IVec3::ZERO), 0, "a ball in a box");
    assert_eq!(world.response.lamp.as_deref(), Some("key"));
    assert_eq!(world.response.lamp_to, Some(Vec3::new(1.0, 2.0, 3.0)));
    let wall = world.response.wall.expect("a wall");
    assert_eq!(wall.min.to_array(), [-4, 0, 2]);
    assert_eq!(wall.max.to_array(), [4, 6, 2]);
    assert_eq!(world.materials[wall.material as usize - 1].name, "moss");
}

#[test]
fn three_keys_make_a_world() {
    let world = sound("(title: \"Least.\", size: (32, 32, 32), shape: Sphere(radius: 9))");
    assert_eq!(world.lamp_presets[0].name, "none");
    assert_eq!(world.layouts[0].counts.to_array(), [8, 8, 8]);
    assert_eq!(world.materials.len(), 1);
    assert_eq!(world.rules.len(), 1);
    assert_eq!(world.cameras.len(), 1);
    assert_eq!(world.response, ResponseSpec::default());
}

#[test]
fn reading_twice_gives_the_same_world_and_another_seed_another() {
    let (first, second) = (sound(FULL), sound(FULL));
    assert_eq!(first.features, second.features);
    assert_eq!(first.lamp_presets, second.lamp_presets);
    let overrides = Overrides {
        seed: Some(8),
        ..Overrides::default()
    };
    let other = file::parse(FULL, "test.ron", None, &overrides).expect("sound");
    assert_eq!(other.seed, 8);
    assert_ne!(other.features, first.features);
}

#[test]
fn overrides_take_the_place_of_what_the_file_says() {
    let overrides = Overrides {
        size: Some(UVec3::new(128, 48, 128)),
        albedo: Some(Vec3::splat(0.9)),
        emission: Some(Vec3::ONE),
        ..Overrides::default()
    };
    let world = file::parse(FULL, "test.ron", None, &overrides).expect("sound");
    assert_eq!(world.size, UVec3::new(128, 48, 128));
    assert_eq!(world.origin.to_array(), [-32, -24, -32]);
    // The scatter without a box fills the larger world: 4 for each 1000 of 128² columns.
    let farthest = world.features.iter().map(|part| part.max.x).max();
    assert!(farthest > Some(40), "{farthest:?}");
    for material in &world.materials {
        assert_eq!(material.a, Colour::Flat(Vec3::splat(0.9)));
        assert_eq!(material.b, Colour::Flat(Vec3::splat(0.9)));
        assert_eq!(material.emission, Vec3::ONE);
    }
    assert!(!world.bodies.bodies.is_empty());
    let without = Overrides {
        without_bodies: true,
        ..Overrides::default()
    };
    let world = file::parse(FULL, "test.ron", None, &without).expect("sound");
    assert_eq!(world.bodies, Bodies::default());
    let too_large = Overrides {
        size: Some(UVec3::splat(8192)),
        ..Overrides::default()
    };
    let problem = refused(file::parse(FULL, "test.ron", None, &too_large));
    assert!(problem.to_string().contains("8192"));
}
