//! From the schema to the world: names become indices, defaults are filled in, and every invalid value
//! is refused with its position.

use std::path::Path;

use glam::{IVec3, UVec3, Vec3};

use super::Overrides;
use super::diagnostics::{Problem, Source};
use super::leaf::Leaf;
use super::place::Tried;
use super::printable::shown;
use super::schema;
use super::values::{Read, or};
use crate::world::bodies::Bodies;
use crate::world::generate::FeatureBins;
use crate::world::materials::hash::hash;
use crate::world::noise::{Basis, Fractal, NoiseBank, NoiseField};
use crate::world::sdf::{NoiseId, Shape};
use crate::world::{Colour, Material, PLAYER_HEIGHT_M, Restored, Sky, World};

/// Longest edge of a world, voxels.
pub const MAX_EDGE: u32 = 4096;
/// Most voxels of a world.
pub const MAX_VOXELS: u64 = 1 << 32;

/// What has been read so far. The parts of the file are read in an order that defines names before
/// their use.
pub struct Reader<'a> {
    pub source: &'a Source,
    /// Folder with the models; without it models are refused.
    pub folder: Option<&'a Path>,
    pub size: UVec3,
    pub origin: IVec3,
    pub voxel_m: f32,
    pub seed: u32,
    pub noises: Vec<NoiseField>,
    pub materials: Vec<Material>,
    /// Number of scatters that have taken a seed of their own.
    pub seeds_given: u32,
    pub(super) tried: Tried,
}

/// Resolves the whole world.
pub(super) fn resolve(
    source: &Source,
    folder: Option<&Path>,
    file: &schema::World,
    overrides: &Overrides,
) -> Read<World> {
    let origin = or(&file.origin, IVec3::ZERO, |v| source.voxel(v, "origin"))?;
    let seed = or(&file.seed, 0, |leaf| source.seed(leaf))?;
    let mut reader = Reader {
        source,
        folder,
        size: size(source, file, overrides)?,
        origin,
        voxel_m: or(&file.voxel_m, 1.0, |leaf| {
            Ok(source.number_in(leaf, "voxel_m", 1e-3..=1e3)? as f32)
        })?,
        seed: overrides.seed.unwrap_or(seed),
        noises: Vec::new(),
        materials: Vec::new(),
        seeds_given: 0,
        tried: Tried::default(),
    };
    let title = source.text(&file.title, "title")?;
    reader.read_noises(&file.noises)?;
    let sdf = reader.shape(&file.shape)?;
    sdf.check(&reader.noises)
        .map_err(|error| Problem::of_file(format!("{}: {error}", source.name), ""))?;
    let shape = Shape::new(&sdf, &reader.noises);
    reader.read_materials(&file.materials)?;
    let mut features = reader.features(&file.features, &shape)?;
    reader.models(&file.models, &mut features)?;
    let crowding = FeatureBins::count(&features, origin, reader.size);
    if crowding > FeatureBins::MOST {
        return Err(Problem::of_file(
            format!(
                "{}: the boxes of its features overlap {crowding} cells of 8³ voxels",
                source.name
            ),
            format!(
                "{} are allowed: make the boxes smaller, or part of the shape",
                FeatureBins::MOST
            ),
        ));
    }
    let rules = reader.rules(&file.rules)?;
    let mut bodies = reader.bodies(&file.bodies, &rules)?;
    if overrides.without_bodies {
        bodies = Bodies::default();
    }
    let lamp_presets = reader.lamp_presets(&file.lamps, &shape)?;
    let cameras = reader.cameras(&file.cameras, &shape)?;
    let layouts = reader.layouts(&file.layouts)?;
    let response = reader.response(&file.response, &lamp_presets, overrides.size.is_some())?;
    let sun = file.sun.as_ref().map(|sun| reader.sun(sun)).transpose()?;
    let player_height = reader.player_height(&file.player)?;
    let sky = or(&file.sky, DIM_SKY, |sky| reader.sky(sky))?;
    for material in &mut reader.materials {
        if let Some(albedo) = overrides.albedo {
            material.a = Colour::Flat(albedo);
            material.b = Colour::Flat(albedo);
        }
        if let Some(emission) = overrides.emission {
            material.emission = emission;
        }
    }
    let stem = Path::new(&source.name).file_stem();
    Ok(World {
        name: stem.map_or_else(|| source.name.clone(), |s| shown(&s.to_string_lossy())),
        title,
        size: reader.size,
        origin,
        voxel_m: reader.voxel_m,
        seed: reader.seed,
        shape: sdf,
        noises: reader.noises,
        materials: reader.materials,
        rules,
        features,
        bodies,
        player_height,
        sky,
        sun,
        lamp_presets,
        cameras,
        layouts,
        response,
        restored: Restored::default(),
    })
}

/// Heights that a world may give its player (voxels).
const PLAYER_HEIGHTS: std::ops::RangeInclusive<f64> = 0.1..=100.0;

/// Bright enough to see.
const DIM_SKY: Sky = Sky {
    zenith: Vec3::splat(0.25),
    horizon: Vec3::splat(0.25),
    ground: Vec3::splat(0.25),
};

fn size(source: &Source, file: &schema::World, overrides: &Overrides) -> Read<UVec3> {
    let written = UVec3::new(
        source.count(&file.size.0, "size", 1..=MAX_EDGE)?,
        source.count(&file.size.1, "size", 1..=MAX_EDGE)?,
        source.count(&file.size.2, "size", 1..=MAX_EDGE)?,
    );
    let size = overrides.size.unwrap_or(written);
    let voxels: u64 = size.to_array().map(u64::from).iter().product();
    let fits = size.min_element() > 0 && size.max_element() <= MAX_EDGE && voxels <= MAX_VOXELS;
    if fits {
        return Ok(size);
    }
    let [x, y, z] = size.to_array();
    let message = format!("a world of {x} × {y} × {z} voxels cannot be built");
    let help = format!("an edge may have 1 to {MAX_EDGE} voxels, and a world {MAX_VOXELS} in all");
    Err(match overrides.size {
        Some(_) => Problem::of_file(format!("{message} (from `world.size`)"), help),
        None => source.at_vector(&file.size, message, help),
    })
}

impl Reader<'_> {
    /// Lowest and highest corner in world space.
    pub(in crate::world) fn world_box(&self) -> (Vec3, Vec3) {
        let low = self.origin.as_vec3();
        (low, low + self.size.as_vec3())
    }

    /// A seed for a scatter that names none: derived from the world's, different for each.
    pub(in crate::world) fn next_seed(&mut self) -> u32 {
        self.seeds_given += 1;
        hash(self.seed ^ hash(self.seeds_given))
    }

    pub(in crate::world) fn noise(&self, leaf: &Leaf) -> Read<NoiseId> {
        let names = self.noises.iter().map(|noise| noise.name.as_str());
        self.source.find(leaf, "noise", names)
    }

    /// 1-based index of a material.
    pub(super) fn material(&self, leaf: &Leaf) -> Read<u8> {
        let names = self.materials.iter().map(|material| material.name.as_str());
        let index = self.source.find(leaf, "material", names)?;
        Ok(u8::try_from(index + 1).expect("there are at most 255 materials"))
    }

    /// A person is 1.77 m high, where the edge of a voxel allows.
    fn player_height(&self, player: &schema::Player) -> Read<f64> {
        let (low, high) = (*PLAYER_HEIGHTS.start(), *PLAYER_HEIGHTS.end());
        let person = (PLAYER_HEIGHT_M / f64::from(self.voxel_m)).clamp(low, high);
        or(&player.height, person, |leaf| {
            self.source.number_in(leaf, "height", PLAYER_HEIGHTS)
        })
    }

    fn read_noises(&mut self, noises: &schema::Named<schema::Noise>) -> Read<()> {
        let source = self.source;
        let mut names = Vec::new();
        for (name, noise) in &noises.0 {
            names.push(source.name(name, "noise", &names)?);
            let frequency = source.frequency(&noise.frequency, "frequency")?;
            let offset = or(&noise.offset, Vec3::ZERO, |v| source.point(v, "offset"))?;
            self.noises.push(NoiseField {
                name: names.last().expect("one was just pushed").clone(),
                basis: match noise.basis {
                    schema::Basis::Perlin => Basis::Perlin,
                    schema::Basis::OpenSimplex => Basis::OpenSimplex,
                    schema::Basis::Worley => Basis::Worley,
                    schema::Basis::Value => Basis::Value,
                },
                fractal: fractal(source, &noise.fractal)?,
                frequency,
                offset: offset.as_dvec3(),
                seed: or(&noise.seed, self.seed, |leaf| source.seed(leaf))?,
            });
        }
        Ok(())
    }
}

fn fractal(source: &Source, fractal: &schema::Fractal) -> Read<Fractal> {
    use schema::Fractal as Written;
    let read = |octaves: &Leaf, lacunarity: &Option<Leaf>, persistence: &Option<Leaf>| {
        Ok::<_, Box<Problem>>((
            source.count(octaves, "octaves", 1..=NoiseBank::MAX_OCTAVES)?,
            or(lacunarity, 2.0, |leaf| {
                source.number_in(leaf, "lacunarity", 1.0..=8.0)
            })?,
            or(persistence, 0.5, |leaf| {
                source.number_in(leaf, "persistence", 0.01..=1.0)
            })?,
        ))
    };
    Ok(match fractal {
        Written::Plain => Fractal::None,
        Written::Fbm {
            octaves,
            lacunarity,
            persistence,
        } => {
            let (octaves, lacunarity, persistence) = read(octaves, lacunarity, persistence)?;
            Fractal::Fbm {
                octaves,
                lacunarity,
                persistence,
            }
        }
        Written::Ridged {
            octaves,
            lacunarity,
            persistence,
        } => {
            let (octaves, lacunarity, persistence) = read(octaves, lacunarity, persistence)?;
            Fractal::Ridged {
                octaves,
                lacunarity,
                persistence,
            }
        }
        Written::Billow {
            octaves,
            lacunarity,
            persistence,
        } => {
            let (octaves, lacunarity, persistence) = read(octaves, lacunarity, persistence)?;
            Fractal::Billow {
                octaves,
                lacunarity,
                persistence,
            }
        }
    })
}
