//! Voxels as a MagicaVoxel model: the inverse of `vox`.
//!
//! A model of the format has at most 256³ voxels: larger worlds become several, which a scene places beside each
//! other. Format: github.com/ephtracy/voxel-model, `MagicaVoxel-file-format-vox.txt` and its extension.

use std::io::{self, Write};

use dot_vox::{
    Color, Dict, DotVoxData, Frame, Layer, Material as VoxMaterial, Model, SceneNode, ShapeModel,
    Size, Voxel,
};
use glam::{IVec3, UVec3, Vec3};

use super::vox::MAX_WORK;
use crate::world::{Colour, Material, World, voxels::Voxels};

/// Longest edge of a model.
const MODEL_EDGE: u32 = 256;
/// The version of the format that the program itself has written since 2018.
const VERSION: u32 = 150;

/// Why voxels cannot become a model.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    #[error("there are no voxels: a model cannot be empty")]
    Empty,
    #[error(
        "there are {0} voxels, more than the {MAX_WORK} of a model that can be opened again; --surface leaves out those \
         that no air touches"
    )]
    TooMany(usize),
}

/// Which voxels a model gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chosen {
    All,
    /// Only voxels that air touches, or the outside of the world: the model looks the same.
    Surface,
}

/// Voxels as a model, with the colour and emission of their materials. With the number of voxels.
///
/// # Errors
/// [`ModelError`].
pub fn model(
    world: &World,
    voxels: &Voxels,
    chosen: Chosen,
) -> Result<(DotVoxData, usize), ModelError> {
    let size = voxels.size();
    let counts = size.map(|edge| edge.div_ceil(MODEL_EDGE));
    let mut models = Vec::new();
    let mut places = Vec::new();
    let mut count = 0;
    for index in 0..counts.element_product() {
        let chunk = UVec3::new(
            index % counts.x,
            index / counts.x % counts.y,
            index / (counts.x * counts.y),
        );
        let low = chunk * MODEL_EDGE;
        let edge = (size - low).min(UVec3::splat(MODEL_EDGE));
        let found = chunk_voxels(voxels, low, edge, chosen);
        if found.is_empty() {
            continue;
        }
        count += found.len();
        models.push(Model {
            // Their z is up, and their y goes where our −z goes.
            size: Size {
                x: edge.x,
                y: edge.z,
                z: edge.y,
            },
            voxels: found,
        });
        // The world's middle becomes the middle of the scene: places reach ±1000 only.
        let low = low.as_ivec3() - size.as_ivec3() / 2;
        let edge = edge.as_ivec3();
        places.push(IVec3::new(
            low.x + edge.x / 2,
            -(low.z + edge.z) + edge.z / 2,
            low.y + edge.y / 2,
        ));
    }
    match count {
        0 => return Err(ModelError::Empty),
        count if count + places.len() * 2 + 2 > MAX_WORK => return Err(ModelError::TooMany(count)),
        _ => {}
    }
    let mut palette: Vec<Color> = world.materials.iter().map(colour).collect();
    palette.resize(
        256,
        Color {
            r: 0,
            g: 0,
            b: 0,
            a: 255,
        },
    );
    let materials = world.materials.iter().zip(1..);
    let data = DotVoxData {
        version: VERSION,
        index_map: Vec::new(),
        models,
        palette,
        materials: materials
            .filter_map(|(material, number)| emitter(material, number))
            .collect(),
        scenes: scene(&places),
        layers: vec![Layer {
            attributes: dict([("_name", "voxels".to_owned())]),
        }],
    };
    Ok((data, count))
}

/// Writes a model as a file.
///
/// # Errors
/// Those of the writer.
pub fn write(data: &DotVoxData, writer: &mut impl Write) -> io::Result<()> {
    data.write_vox(writer)
}

fn chunk_voxels(voxels: &Voxels, low: UVec3, edge: UVec3, chosen: Chosen) -> Vec<Voxel> {
    const SIDES: [IVec3; 6] = [
        IVec3::X,
        IVec3::NEG_X,
        IVec3::Y,
        IVec3::NEG_Y,
        IVec3::Z,
        IVec3::NEG_Z,
    ];
    let mut found = Vec::new();
    for z in 0..edge.z {
        for y in 0..edge.y {
            for x in 0..edge.x {
                let at = (low + UVec3::new(x, y, z)).as_ivec3();
                let material = voxels.material(at);
                let is_wanted = material != 0
                    && (chosen == Chosen::All
                        || SIDES.iter().any(|side| voxels.material(at + *side) == 0));
                if is_wanted {
                    found.push(Voxel {
                        x: x as u8,
                        y: (edge.z - 1 - z) as u8,
                        z: y as u8,
                        i: material - 1,
                    });
                }
            }
        }
    }
    found
}

/// A transform for all, a group, and for each model a transform and a shape.
fn scene(places: &[IVec3]) -> Vec<SceneNode> {
    let moved = |child: u32, frame: Dict| SceneNode::Transform {
        attributes: Dict::default(),
        frames: vec![Frame { attributes: frame }],
        child,
        layer_id: 0,
    };
    let mut nodes = vec![
        moved(1, Dict::default()),
        SceneNode::Group {
            attributes: Dict::default(),
            children: (0..places.len() as u32)
                .map(|model| 2 + 2 * model)
                .collect(),
        },
    ];
    for (model, place) in (0..).zip(places) {
        let at = format!("{} {} {}", place.x, place.y, place.z);
        nodes.push(moved(3 + 2 * model, dict([("_t", at)])));
        nodes.push(SceneNode::Shape {
            attributes: Dict::default(),
            models: vec![ShapeModel {
                model_id: model,
                attributes: Dict::default(),
            }],
        });
    }
    nodes
}

fn dict<const N: usize>(entries: [(&str, String); N]) -> Dict {
    let owned = entries.map(|(key, value)| (key.to_owned(), value));
    owned.into_iter().collect()
}

/// The colour of a material without its pattern; of an emitter the colour of its light.
fn colour(material: &Material) -> Color {
    let brightest = material.emission.max_element();
    let linear = if brightest > 0.0 {
        material.emission / brightest
    } else {
        (average(&material.a) + average(&material.b)) / 2.0
    };
    let [r, g, b] = linear.to_array().map(encoded);
    Color { r, g, b, a: 255 }
}

fn average(colour: &Colour) -> Vec3 {
    match colour {
        Colour::Flat(colour) => *colour,
        Colour::Bands { below, above } => {
            let sum: Vec3 = below.iter().map(|(_, colour)| *colour).sum();
            (sum + *above) / (below.len() + 1) as f32
        }
        Colour::DitherX { low, high, .. } | Colour::Hash(low, high) => (*low + *high) / 2.0,
    }
}

/// Light as colour · `_emit` · 10^`_flux`, as `vox` reads it. `_emit` is at most 1.
fn emitter(material: &Material, number: u32) -> Option<VoxMaterial> {
    let brightest = material.emission.max_element();
    if brightest <= 0.0 {
        return None;
    }
    let flux = brightest.log10().ceil().clamp(0.0, 4.0);
    let emit = brightest / 10_f32.powf(flux);
    Some(VoxMaterial {
        id: number,
        properties: dict([
            ("_type", "_emit".to_owned()),
            ("_emit", format!("{emit}")),
            ("_flux", format!("{flux}")),
        ]),
    })
}

/// From linear to sRGB (IEC 61966-2-1).
fn encoded(linear: f32) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let encoded = if linear <= 0.003_130_8 {
        linear * 12.92
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    };
    (encoded * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use std::{fs, path::Path};

    use super::*;
    use crate::world::{
        file::{Overrides, load},
        generate::generate,
    };

    /// A world of nothing but this model, with its lowest corner at `at` (grid space).
    fn read_back(data: &DotVoxData, size: UVec3, at: IVec3) -> (World, Voxels) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut bytes = Vec::new();
        write(data, &mut bytes).expect("a Vec");
        fs::write(folder.path().join("m.vox"), bytes).expect("writable");
        let text = format!(
            "(title: \"A model.\", size: ({}, {}, {}), origin: (0, 0, 0), shape: Empty, \
             models: [(file: \"m.vox\", at: ({}, {}, {}))], \
             cameras: [(name: \"c\", position: (0, 0, 0), look_at: (1, 1, 1))])",
            size.x, size.y, size.z, at.x, at.y, at.z
        );
        let path = folder.path().join("m.ron");
        fs::write(&path, text).expect("writable");
        let world = load(&path, &Overrides::default()).expect("it loads");
        let voxels = generate(&world);
        (world, voxels)
    }

    fn world() -> World {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/minimal.ron");
        load(&path, &Overrides::default()).expect("it loads")
    }

    #[test]
    fn what_is_written_is_read_as_the_same_voxels_across_models() {
        let mut world = world();
        let mut glow = world.materials[0].clone();
        glow.emission = Vec3::new(12.0, 6.0, 3.0);
        world.materials.push(glow);
        let size = UVec3::new(300, 70, 270);
        let mut voxels = Voxels::empty(size);
        voxels.fill_box(IVec3::new(0, 0, 0), IVec3::new(2, 3, 4), 1);
        voxels.fill_sphere(Vec3::new(255.0, 30.0, 256.0), 12.5, 2);
        voxels.set(IVec3::new(299, 69, 269), 1);
        let (data, count) = model(&world, &voxels, Chosen::All).expect("it fits");
        assert_eq!(data.models.len(), 4);
        let (read_world, read) = read_back(&data, size, IVec3::ZERO);
        let mut seen = 0;
        for index in 0..size.element_product() {
            let at = UVec3::new(
                index % size.x,
                index / size.x % size.y,
                index / (size.x * size.y),
            );
            let (before, after) = (voxels.material(at.as_ivec3()), read.material(at.as_ivec3()));
            let name = |number: u8| read_world.materials[usize::from(number) - 1].name.clone();
            let same = match (before, after) {
                (0, 0) => true,
                (0, _) | (_, 0) => false,
                (before, after) => name(after) == format!("m.vox {before}"),
            };
            assert!(same, "{at}: {before} and {after}");
            seen += usize::from(before != 0);
        }
        assert_eq!(seen, count);
        let glows: Vec<Vec3> = read_world.materials.iter().map(|m| m.emission).collect();
        let light = glows.iter().find(|light| light.x > 0.0).expect("it glows");
        assert!(
            (*light - Vec3::new(12.0, 6.0, 3.0)).abs().max_element() < 0.06,
            "{light}"
        );
    }

    #[test]
    fn the_surface_is_what_air_touches() {
        let world = world();
        let mut voxels = Voxels::empty(UVec3::splat(16));
        voxels.fill_box(IVec3::splat(3), IVec3::splat(7), 1);
        let (_, count) = model(&world, &voxels, Chosen::Surface).expect("it fits");
        assert_eq!(count, 125 - 27);
        let empty = model(&world, &Voxels::empty(UVec3::splat(16)), Chosen::All);
        assert!(matches!(empty, Err(ModelError::Empty)));
    }

    #[test]
    fn a_model_stands_for_a_world_around_it() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/minimal.ron");
        let world = load(&path, &Overrides::default()).expect("it loads");
        let voxels = generate(&world);
        let (data, count) = model(&world, &voxels, Chosen::All).expect("it fits");
        let mut bytes = Vec::new();
        write(&data, &mut bytes).expect("a vector takes all");
        let file = folder.path().join("a \"model\".VOX");
        fs::write(&file, &bytes).expect("writable");
        let alone = load(&file, &Overrides::default()).expect("a world around it");
        let above_ground = |at: &UVec3| at.y as i32 + alone.origin.y >= 0;
        let shown = generate(&alone);
        let solid = shown.size();
        let mut found = 0;
        for z in 0..solid.z {
            for y in 0..solid.y {
                for x in 0..solid.x {
                    let at = UVec3::new(x, y, z);
                    found += usize::from(above_ground(&at) && shown.material(at.as_ivec3()) != 0);
                }
            }
        }
        assert_eq!(found, count);
        let eye = alone.cameras[0].position.floor().as_ivec3() - alone.origin;
        assert_eq!(shown.material(eye), 0, "the camera is in the air");
        fs::write(&file, "no model").expect("writable");
        let error = load(&file, &Overrides::default()).expect_err("no model");
        assert!(
            error.to_string().contains("not a MagicaVoxel model"),
            "{error}"
        );
    }
}
