//! Materials, their colours and patterns, and the rules that place them.

use glam::Vec3;

use super::diagnostics::Source;
use super::leaf::Leaf;
use super::resolve::Reader;
use super::schema;
use super::values::{Read, or};
use crate::world::materials::{Condition, MaterialSound};
use crate::world::{Colour, Material, Pattern, Rule};

/// Most materials: a voxel stores its material in a byte, and 0 is air.
pub const MAX_MATERIALS: usize = 255;

impl Reader<'_> {
    pub(super) fn read_materials(
        &mut self,
        materials: &schema::Named<schema::Material>,
    ) -> Read<()> {
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
            let name_text = names.last().expect("one was just pushed").clone();
            let emission = or(&material.emission, Vec3::ZERO, |v| {
                source.not_negative3(v, "emission")
            })?;
            let by_look = || MaterialSound::of_look(&name_text, &a, emission);
            self.materials.push(Material {
                b: or(&material.b, a.clone(), |b| colour(source, b))?,
                pattern: self.pattern(name, &material.pattern)?,
                emission,
                sound: material.sound.unwrap_or_else(by_look),
                name: name_text,
                a,
            });
        }
        if self.materials.is_empty() {
            self.materials.push(Material {
                name: "rock".into(),
                a: Colour::Flat(Vec3::splat(0.5)),
                b: Colour::Flat(Vec3::splat(0.5)),
                pattern: Pattern::Plain,
                emission: Vec3::ZERO,
                sound: MaterialSound::Stone,
            });
        }
        Ok(())
    }

    pub(super) fn rules(&mut self, rules: &[schema::Rule]) -> Read<Vec<Rule>> {
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

    fn condition(&mut self, when: &schema::Condition) -> Read<Condition> {
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

    fn conditions(&mut self, of: &[schema::Condition]) -> Read<Vec<Condition>> {
        of.iter().map(|when| self.condition(when)).collect()
    }

    fn pattern(&self, name: &Leaf, written: &schema::Pattern) -> Read<Pattern> {
        use schema::Pattern as Written;
        let source = self.source;
        let number = |leaf, key| -> Read<f32> { Ok(source.number(leaf, key)? as f32) };
        let count = |leaf, key| source.count(leaf, key, 0..=u32::MAX);
        // Messages about the pattern point at its first number.
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
