//! From the schema to the world: names become indices, defaults are filled in, and everything that
//! cannot be is refused in place.

use std::path::Path;

use glam::{IVec3, UVec3, Vec3};

use super::Overrides;
use super::diagnostics::{Problem, Source};
use super::leaf::Leaf;
use super::schema;
use super::values::{Read, or};
use crate::world::generate::FeatureBins;
use crate::world::materials::hash::hash;
use crate::world::noise::{Basis, Fractal, NoiseBank, NoiseField};
use crate::world::sdf::{NoiseId, Shape};
use crate::world::{Colour, Material, Pattern, Rule, Sky, World};

/// Longest edge of a world, voxels.
pub const MAX_EDGE: u32 = 4096;
/// Most voxels of a world.
pub const MAX_VOXELS: u64 = 1 << 32;
/// Most materials: voxels name them by a byte, and 0 is air.
pub const MAX_MATERIALS: usize = 255;

/// What has been read so far; the parts of the file are read in an order in which names are known
/// before they are referred to.
pub(super) struct Reader<'a> {
    pub source: &'a Source,
    /// Where models are looked for; without it they are refused.
    pub folder: Option<&'a Path>,
    pub size: UVec3,
    pub origin: IVec3,
    pub voxel_m: f32,
    pub seed: u32,
    pub noises: Vec<NoiseField>,
    pub materials: Vec<Material>,
    /// How many scatters have taken a seed of their own.
    pub seeds_given: u32,
}

/// The whole world.
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
    let lamp_presets = reader.lamp_presets(&file.lamps, &shape)?;
    let cameras = reader.cameras(&file.cameras, &shape)?;
    let layouts = reader.layouts(&file.layouts)?;
    let sun = file.sun.as_ref().map(|sun| reader.sun(sun)).transpose()?;
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
        name: stem.map_or_else(|| source.name.clone(), |s| s.to_string_lossy().into_owned()),
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
        sky,
        sun,
        lamp_presets,
        cameras,
        layouts,
    })
}

/// Enough to see by.
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
    pub(super) fn world_box(&self) -> (Vec3, Vec3) {
        let low = self.origin.as_vec3();
        (low, low + self.size.as_vec3())
    }

    /// A seed for a scatter that names none: another for each, all from the world's.
    pub(super) fn next_seed(&mut self) -> u32 {
        self.seeds_given += 1;
        hash(self.seed ^ hash(self.seeds_given))
    }

    pub(super) fn noise(&self, leaf: &Leaf) -> Read<NoiseId> {
        let names = self.noises.iter().map(|noise| noise.name.as_str());
        self.source.find(leaf, "noise", names)
    }

    /// 1-based.
    pub(super) fn material(&self, leaf: &Leaf) -> Read<u8> {
        let names = self.materials.iter().map(|material| material.name.as_str());
        let index = self.source.find(leaf, "material", names)?;
        Ok(u8::try_from(index + 1).expect("there are at most 255 materials"))
    }

    fn read_noises(&mut self, noises: &schema::Named<schema::Noise>) -> Read<()> {
        let source = self.source;
        let mut names = Vec::new();
        for (name, noise) in &noises.0 {
            names.push(source.name(name, "noise", &names)?);
            let frequency = source.one_or_three(&noise.frequency, "frequency")?;
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

    fn read_materials(&mut self, materials: &schema::Named<schema::Material>) -> Read<()> {
        let source = self.source;
        let mut names = Vec::new();
        for (name, material) in &materials.0 {
            if names.len() == MAX_MATERIALS {
                return Err(source.at(
                    name,
                    format!("there are more than {MAX_MATERIALS} materials"),
                    "a voxel names its material by a byte; let materials share colours by `Hash` \
                     or `Bands`",
                ));
            }
            names.push(source.name(name, "material", &names)?);
            let a = colour(source, &material.a)?;
            self.materials.push(Material {
                name: names.last().expect("one was just pushed").clone(),
                b: or(&material.b, a.clone(), |b| colour(source, b))?,
                a,
                pattern: self.pattern(name, &material.pattern)?,
                emission: or(&material.emission, Vec3::ZERO, |v| {
                    source.not_negative3(v, "emission")
                })?,
            });
        }
        if self.materials.is_empty() {
            self.materials.push(Material {
                name: "rock".into(),
                a: Colour::Flat(Vec3::splat(0.5)),
                b: Colour::Flat(Vec3::splat(0.5)),
                pattern: Pattern::Plain,
                emission: Vec3::ZERO,
            });
        }
        Ok(())
    }

    fn rules(&mut self, rules: &[schema::Rule]) -> Read<Vec<Rule>> {
        use crate::world::materials::Condition;
        let mut resolved = Vec::with_capacity(rules.len() + 1);
        for rule in rules {
            resolved.push(Rule {
                material: self.material(&rule.material)?,
                when: self.condition(&rule.when)?,
            });
        }
        let holds_always = |rule: &Rule| rule.when == Condition::Always;
        if !resolved.last().is_some_and(holds_always) {
            resolved.push(Rule {
                material: 1,
                when: Condition::Always,
            });
        }
        Ok(resolved)
    }

    fn condition(&mut self, when: &schema::Condition) -> Read<crate::world::materials::Condition> {
        use crate::world::materials::Condition;
        use schema::Condition as Written;
        let source = self.source;
        Ok(match when {
            Written::Always => Condition::Always,
            Written::Below(height) => Condition::Below(source.length(height, "Below")?),
            Written::Above(height) => Condition::Above(source.length(height, "Above")?),
            Written::InBox { min, max } => Condition::InBox {
                min: source.point(min, "min")?,
                max: source.point(max, "max")?,
            },
            Written::Inside(shape) => Condition::Inside(self.shape(shape)?),
            Written::NoiseBelow { noise, value } => Condition::NoiseBelow {
                noise: self.noise(noise)?,
                value: source.length(value, "value")?,
            },
            Written::ShallowerThan(depth) => {
                Condition::ShallowerThan(source.length(depth, "ShallowerThan")?)
            }
            Written::FacesUp => Condition::FacesUp,
            Written::FacesDown => Condition::FacesDown,
            Written::All(of) => Condition::All(self.conditions(of)?),
            Written::Any(of) => Condition::Any(self.conditions(of)?),
            Written::Not(of) => Condition::Not(Box::new(self.condition(of)?)),
        })
    }

    fn conditions(
        &mut self,
        of: &[schema::Condition],
    ) -> Read<Vec<crate::world::materials::Condition>> {
        of.iter().map(|when| self.condition(when)).collect()
    }

    fn pattern(&self, name: &Leaf, written: &schema::Pattern) -> Read<Pattern> {
        use schema::Pattern as Written;
        let source = self.source;
        let number = |leaf, key| -> Read<f32> { Ok(source.number(leaf, key)? as f32) };
        let count = |leaf, key| source.count(leaf, key, 0..=u32::MAX);
        // The first number of the pattern stands for it in messages.
        let (pattern, place) = match written {
            Written::Plain => (Pattern::Plain, name),
            Written::Stripes { pitch, width } => (
                Pattern::Stripes {
                    pitch: number(pitch, "pitch")?,
                    width: number(width, "width")?,
                },
                pitch,
            ),
            Written::Dots {
                radius,
                pitch,
                angle_deg,
            } => (
                Pattern::Dots {
                    radius: number(radius, "radius")?,
                    pitch: number(pitch, "pitch")?,
                    angle_deg: number(angle_deg, "angle_deg")?,
                },
                radius,
            ),
            Written::Checker { squares } => (
                Pattern::Checker {
                    squares: count(squares, "squares")?,
                },
                squares,
            ),
            Written::Bricks { rows, joint } => (
                Pattern::Bricks {
                    rows: count(rows, "rows")?,
                    joint: number(joint, "joint")?,
                },
                rows,
            ),
            Written::Worley { cells, radius } => (
                Pattern::Worley {
                    cells: count(cells, "cells")?,
                    radius: number(radius, "radius")?,
                },
                cells,
            ),
            Written::Fbm { cells, octaves } => (
                Pattern::Fbm {
                    cells: count(cells, "cells")?,
                    octaves: count(octaves, "octaves")?,
                },
                cells,
            ),
            Written::StripesFbm { cells, octaves } => (
                Pattern::StripesFbm {
                    cells: count(cells, "cells")?,
                    octaves: count(octaves, "octaves")?,
                },
                cells,
            ),
            Written::Radial { rings } => (
                Pattern::Radial {
                    rings: count(rings, "rings")?,
                },
                rings,
            ),
        };
        match pattern.fault() {
            None => Ok(pattern),
            Some(fault) => {
                let (message, help) = fault.split_once("; ").unwrap_or((&fault, ""));
                Err(source.at(place, format!("pattern: {message}"), help))
            }
        }
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

fn colour(source: &Source, colour: &schema::Colour) -> Read<Colour> {
    use schema::Colour as Written;
    let albedo = |vector: &schema::Vector, key| source.albedo(vector.leaves(), key);
    Ok(match colour {
        Written::Flat(r, g, b) => Colour::Flat(source.albedo([r, g, b], "Flat")?),
        Written::Bands { below, above } => {
            let mut stops: Vec<(f32, Vec3)> = Vec::with_capacity(below.len());
            for (height, colour) in below {
                let top = source.length(height, "below")?;
                if let Some((last, _)) = stops.last()
                    && *last >= top
                {
                    return Err(source.at(
                        height,
                        format!("this band ends at {top}, and the one before it at {last}"),
                        "list the bands from the lowest to the highest",
                    ));
                }
                stops.push((top, albedo(colour, "below")?));
            }
            Colour::Bands {
                below: stops,
                above: albedo(above, "above")?,
            }
        }
        Written::DitherX {
            from,
            to,
            low,
            high,
        } => {
            let (start, end) = (source.length(from, "from")?, source.length(to, "to")?);
            if start >= end {
                return Err(source.at(
                    to,
                    format!("this dither goes from {start} to {end}"),
                    "`from` must be less than `to`",
                ));
            }
            Colour::DitherX {
                from: start,
                to: end,
                low: albedo(low, "low")?,
                high: albedo(high, "high")?,
            }
        }
        Written::Hash(low, high) => Colour::Hash(albedo(low, "Hash")?, albedo(high, "Hash")?),
    })
}
