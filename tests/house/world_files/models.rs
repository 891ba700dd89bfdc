//! MagicaVoxel models in worlds.

use std::fs;

use glam::{IVec3, Vec3};
use grotto::world::file::{self, Overrides};
use grotto::world::{Colour, World};

use super::refused;
use crate::support::folder;

fn dict(entries: &[(&str, &str)]) -> dot_vox::Dict {
    let owned = |(key, value): &(&str, &str)| ((*key).to_owned(), (*value).to_owned());
    entries.iter().map(owned).collect()
}

/// A red and a glowing green voxel side by side along x, and a blue one two above the red.
fn model(scenes: Vec<dot_vox::SceneNode>) -> Vec<u8> {
    let colour = |r, g, b| dot_vox::Color { r, g, b, a: 255 };
    let voxel = |x, y, z, i| dot_vox::Voxel { x, y, z, i };
    let data = dot_vox::DotVoxData {
        version: 150,
        index_map: Vec::new(),
        models: vec![dot_vox::Model {
            size: dot_vox::Size { x: 2, y: 1, z: 3 },
            voxels: vec![voxel(0, 0, 0, 0), voxel(1, 0, 0, 1), voxel(0, 0, 2, 2)],
        }],
        palette: vec![colour(255, 0, 0), colour(0, 255, 0), colour(0, 0, 255)],
        materials: vec![dot_vox::Material {
            id: 2,
            properties: dict(&[("_type", "_emit"), ("_emit", "0.5"), ("_flux", "1")]),
        }],
        scenes,
        layers: Vec::new(),
    };
    let mut bytes = Vec::new();
    data.write_vox(&mut bytes).expect("written");
    bytes
}

fn read(bytes: &[u8]) -> World {
    let folder = folder();
    fs::create_dir(folder.path().join("models")).expect("a folder");
    fs::write(folder.path().join("models/three.vox"), bytes).expect("written");
    let text = "(title: \"\", size: (32, 32, 32), shape: Empty,
        models: [(file: \"models/three.vox\", at: (4, 5, 6))])";
    let world = file::parse(text, "t.ron", Some(folder.path()), &Overrides::default());
    world.unwrap_or_else(|report| panic!("{report:?}"))
}

/// Colour and emission of a voxel that a feature fills.
fn at(world: &World, voxel: [i32; 3]) -> Option<(Colour, Vec3)> {
    let mut parts = world.features.iter();
    let part = parts.find(|part| part.contains(IVec3::from(voxel)))?;
    let material = &world.materials[usize::from(part.material) - 1];
    Some((material.a.clone(), material.emission))
}

#[test]
fn models_become_boxes_and_materials() {
    let world = read(&model(Vec::new()));
    assert_eq!(world.features.len(), 3);
    // Their z is our y.
    let (red, green, blue) = (
        Colour::Flat(Vec3::X),
        Colour::Flat(Vec3::Y),
        Colour::Flat(Vec3::Z),
    );
    assert_eq!(at(&world, [4, 5, 6]), Some((red, Vec3::ZERO)));
    assert_eq!(
        at(&world, [5, 5, 6]),
        Some((green, Vec3::new(0.0, 5.0, 0.0)))
    );
    assert_eq!(at(&world, [4, 7, 6]), Some((blue, Vec3::ZERO)));
}

#[test]
fn equal_colours_of_models_share_a_material() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("three.vox"), model(Vec::new())).expect("written");
    // Under another name the colours are the same.
    fs::write(folder.path().join("copy.vox"), model(Vec::new())).expect("written");
    let copies: String = (0..100)
        .map(|i| {
            format!(
                "(file: \"three.vox\", at: ({i}, 0, 0)), (file: \"copy.vox\", at: ({i}, 8, 0)),"
            )
        })
        .collect();
    let text = format!(
        "(title: \"\", size: (128, 32, 32), shape: Empty,
        materials: {{\"red\": (a: Flat(1, 0, 0)), \"stone\": (a: Flat(0.5, 0.5, 0.5))}},
        models: [{copies}])"
    );
    let world = file::parse(&text, "t.ron", Some(folder.path()), &Overrides::default());
    let world = world.unwrap_or_else(|report| panic!("{report:?}"));
    let names: Vec<&str> = world.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["red", "stone", "three.vox 3", "three.vox 2"]);
    assert_eq!(
        at(&world, [0, 0, 0]).map(|(colour, _)| colour),
        Some(Colour::Flat(Vec3::X))
    );
    assert_eq!(
        at(&world, [99, 10, 0]).map(|(colour, _)| colour),
        Some(Colour::Flat(Vec3::Z))
    );
}

#[test]
fn scenes_turn_and_repeat_models() {
    use dot_vox::{Frame, SceneNode, ShapeModel};
    let transform = |child, entries: &[(&str, &str)]| SceneNode::Transform {
        attributes: dict(&[]),
        frames: vec![Frame::new(dict(entries))],
        child,
        layer_id: 0,
    };
    let shape = || SceneNode::Shape {
        attributes: dict(&[]),
        models: vec![ShapeModel {
            model_id: 0,
            attributes: dict(&[]),
        }],
    };
    // 17 is the row permutation (y, x, z) with the first sign flipped: a quarter turn about z that
    // takes +x to +y, which is −z in our axes.
    let world = read(&model(vec![
        transform(1, &[]),
        SceneNode::Group {
            attributes: dict(&[]),
            children: vec![2, 4],
        },
        transform(3, &[]),
        shape(),
        transform(5, &[("_r", "17"), ("_t", "10 0 0")]),
        shape(),
    ]));
    let solid: i32 = world
        .features
        .iter()
        .map(|part| (part.max - part.min + 1).element_product())
        .sum();
    assert_eq!(solid, 6);
    let reds =
        |material: &u8| world.materials[usize::from(*material) - 1].a == Colour::Flat(Vec3::X);
    let greens =
        |material: &u8| world.materials[usize::from(*material) - 1].a == Colour::Flat(Vec3::Y);
    let place = |is: &dyn Fn(&u8) -> bool| -> Vec<IVec3> {
        world
            .features
            .iter()
            .filter(|part| is(&part.material))
            .map(|part| part.min)
            .collect()
    };
    let mut apart: Vec<IVec3> = place(&reds)
        .iter()
        .zip(&place(&greens))
        .map(|(r, g)| *g - *r)
        .collect();
    apart.sort_by_key(|apart| apart.x);
    assert_eq!(apart, [IVec3::NEG_Z, IVec3::X]);
}

#[test]
fn models_that_cannot_be_are_refused() {
    let folder = folder();
    let worlds = folder.path().join("worlds");
    fs::create_dir(&worlds).expect("a folder");
    let good = model(Vec::new());
    let mut nested = good.clone();
    // The first chunk within MAIN claims to have children.
    nested[28..32].copy_from_slice(&12_u32.to_le_bytes());
    let endless = model(vec![dot_vox::SceneNode::Group {
        attributes: dict(&[]),
        children: vec![0],
    }]);
    // Two paths from each group to the next: 2⁶⁰ paths in all.
    let mut doubling: Vec<_> = (1..=60)
        .map(|next| dot_vox::SceneNode::Group {
            attributes: dict(&[]),
            children: vec![next, next],
        })
        .collect();
    doubling.push(dot_vox::SceneNode::Shape {
        attributes: dict(&[]),
        models: Vec::new(),
    });
    let doubling = model(doubling);
    for (name, bytes) in [
        ("worlds/doubling.vox", &doubling[..]),
        ("worlds/good.vox", &good),
        ("worlds/cut.vox", &good[..good.len() - 9]),
        ("worlds/text.vox", b"hello"),
        ("worlds/nested.vox", &nested),
        ("worlds/endless.vox", &endless),
        ("outside.vox", &good),
    ] {
        fs::write(folder.path().join(name), bytes).expect("written");
    }
    let mut cases = vec![
        (
            "../outside.vox",
            "outside of the world's folder",
            "keep models",
        ),
        (
            "/etc/passwd",
            "outside of the world's folder",
            "keep models",
        ),
        ("missing.vox", "does not exist", "good.vox"),
        ("cut.vox", "ends in the middle", "export"),
        ("text.vox", "not a MagicaVoxel model", "export"),
        ("nested.vox", "nest deeper", "export"),
        ("endless.vox", "nests groups", "export"),
        ("doubling.vox", "shows more than", "export"),
        (".", "is not a file", "export"),
    ];
    if cfg!(unix) {
        #[cfg(unix)]
        std::os::unix::fs::symlink("../outside.vox", worlds.join("link.vox")).expect("linked");
        cases.push(("link.vox", "out of the world's folder", "keep models"));
    }
    for (name, message, remedy) in cases {
        let text = format!(
            "(title: \"\", size: (8, 8, 8), shape: Empty,\n\
             models: [(file: \"{name}\", at: (0, 0, 0))])"
        );
        let problem = refused(file::parse(
            &text,
            "t.ron",
            Some(&worlds),
            &Overrides::default(),
        ));
        assert!(
            problem.to_string().contains(message),
            "{problem} lacks {message}"
        );
        let help = problem.remedy();
        assert!(help.contains(remedy), "{help} lacks {remedy}");
        assert_eq!(problem.line_and_column(), Some((2, 17)));
        assert_eq!(problem.offending_text(), Some(&format!("\"{name}\"")[..]));
    }
}

#[test]
fn a_body_takes_its_voxels_from_a_model() {
    let folder = folder();
    fs::write(folder.path().join("three.vox"), model(Vec::new())).expect("written");
    let text = "(title: \"\", size: (32, 32, 32), shape: Empty,
        bodies: [(model: Vox(file: \"three.vox\"), position: (9, 9, 9))])";
    let world = file::parse(text, "t.ron", Some(folder.path()), &Overrides::default());
    let world = world.unwrap_or_else(|report| panic!("{report:?}"));
    let three = &world.bodies.models[0];
    assert_eq!(three.size.to_array(), [2, 3, 1]);
    assert_eq!(world.bodies.bodies[0].pivot, Vec3::new(1.0, 1.5, 0.5));
    let look = |voxel: [i32; 3]| match three.material(IVec3::from(voxel)) {
        0 => None,
        material => Some(world.materials[usize::from(material) - 1].a.clone()),
    };
    assert_eq!(look([0, 0, 0]), Some(Colour::Flat(Vec3::X)));
    assert_eq!(look([1, 0, 0]), Some(Colour::Flat(Vec3::Y)));
    assert_eq!(look([0, 2, 0]), Some(Colour::Flat(Vec3::Z)));
    assert_eq!(three.solid().count(), 3, "the rest is air");
    let path = folder.path().join("t.ron");
    fs::write(&path, text).expect("written");
    assert_eq!(
        file::included(&path),
        Some(vec![folder.path().join("three.vox")])
    );
    let before = file::fingerprint(&path).expect("a file");
    fs::write(folder.path().join("three.vox"), b"VOX other").expect("written");
    assert_ne!(
        file::fingerprint(&path).expect("a file"),
        before,
        "a save notices"
    );
}
