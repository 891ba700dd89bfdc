//! Lamps, their motion, and the places of scattered lamps.

use glam::Vec3;

use super::leaf::Leaf;
use super::place::{Ask, Found};
use super::resolve::Reader;
use super::schema;
use super::values::{Read, or};
use crate::world::materials::hash::hash;
use crate::world::scenery::{MAX_LAMPS, MAX_SOFT_RADIUS};
use crate::world::sdf::Shape;
use crate::world::{Lamp, LampKind, LampPreset, Motion};

impl Reader<'_> {
    pub(super) fn lamp_presets(
        &mut self,
        presets: &[schema::Preset],
        shape: &Shape,
    ) -> Read<Vec<LampPreset>> {
        let source = self.source;
        let mut names = Vec::new();
        let mut resolved = Vec::new();
        for preset in presets {
            let name = source.name(&preset.name, "lamp preset", &names)?;
            names.push(name.clone());
            let mut lamps = Vec::new();
            for lamp in &preset.lamps {
                lamps.push(self.lamp(lamp, lamps.len())?);
            }
            for scatter in &preset.scatter {
                self.scatter_lamps(scatter, shape, &mut lamps)?;
            }
            if lamps.len() > MAX_LAMPS {
                return Err(source.at(
                    &preset.name,
                    format!("preset `{name}` has {} lamps", lamps.len()),
                    format!("a preset may have {MAX_LAMPS}"),
                ));
            }
            resolved.push(LampPreset { name, lamps });
        }
        if resolved.is_empty() {
            resolved.push(LampPreset {
                name: "none".into(),
                lamps: Vec::new(),
            });
        }
        Ok(resolved)
    }

    /// A lamp at its position in the file.
    fn lamp(&self, lamp: &schema::Lamp, before: usize) -> Read<Lamp> {
        if lamp.position.is_none() && !matches!(lamp.kind, schema::LampKind::Directional { .. }) {
            return Err(self.source.at(
                &lamp.power,
                "this lamp has no `position`",
                "add `position: (x, y, z)` to the lamp",
            ));
        }
        self.lamp_at(lamp, Vec3::ZERO, before)
    }

    fn lamp_at(&self, lamp: &schema::Lamp, offset: Vec3, before: usize) -> Read<Lamp> {
        let source = self.source;
        let kind = self.lamp_kind(&lamp.kind)?;
        let power = source.not_negative(&lamp.power, "power")?;
        let motion = lamp.motion.iter().map(|motion| self.motion(motion));
        Ok(Lamp {
            name: or(&lamp.name, format!("lamp {}", before + 1), |leaf| {
                source.text(leaf, "name")
            })?,
            // Distances are in voxels everywhere after loading: scale 1/d² back to metres.
            power: match kind {
                LampKind::Directional { .. } => power,
                LampKind::Point | LampKind::Spot { .. } => power / (self.voxel_m * self.voxel_m),
            },
            kind,
            position: offset + or(&lamp.position, Vec3::ZERO, |v| source.point(v, "position"))?,
            colour: or(&lamp.colour, Vec3::ONE, |v| {
                source.not_negative3(v, "colour")
            })?,
            radius: or(&lamp.radius, 0.5, |leaf| source.positive(leaf, "radius"))?,
            soft_radius: or(&lamp.soft_radius, 0.0, |leaf| self.soft_radius(leaf, lamp))?,
            motion: motion.collect::<Read<_>>()?,
        })
    }

    fn soft_radius(&self, leaf: &Leaf, lamp: &schema::Lamp) -> Read<f32> {
        let source = self.source;
        if matches!(lamp.kind, schema::LampKind::Directional { .. }) {
            return Err(source.at(
                leaf,
                "a directional lamp has no `soft_radius`: it is infinitely far away",
                "remove it, or make the lamp `Point` or `Spot(…)`",
            ));
        }
        let most = f64::from(MAX_SOFT_RADIUS);
        Ok(source.number_in(leaf, "soft_radius", 0.0..=most)? as f32)
    }

    fn lamp_kind(&self, kind: &schema::LampKind) -> Read<LampKind> {
        let source = self.source;
        Ok(match kind {
            schema::LampKind::Point => LampKind::Point,
            schema::LampKind::Directional { direction } => LampKind::Directional {
                direction: source.direction(direction, "direction")?,
            },
            schema::LampKind::Spot {
                direction,
                inner_deg,
                outer_deg,
            } => {
                let outer = source.number_in(outer_deg, "outer_deg", 0.1..=180.0)?;
                let inner = source.number_in(inner_deg, "inner_deg", 0.0..=180.0)?;
                if inner > outer {
                    return Err(source.at(
                        inner_deg,
                        format!("`inner_deg` is {inner}, more than the `outer_deg` of {outer}"),
                        "full light ends at `inner_deg`, all light at `outer_deg`: swap them",
                    ));
                }
                LampKind::Spot {
                    direction: source.direction(direction, "direction")?,
                    inner_deg: inner as f32,
                    outer_deg: outer as f32,
                }
            }
        })
    }

    fn motion(&self, motion: &schema::Motion) -> Read<Motion> {
        use schema::Motion as Written;
        let source = self.source;
        let amount =
            |leaf: &Leaf| -> Read<f32> { Ok(source.number_in(leaf, "amount", 0.0..=1.0)? as f32) };
        Ok(match motion {
            Written::Orbit {
                radius,
                rate,
                phase,
            } => Motion::Travel(source.orbit(radius, rate, phase)?),
            Written::Bob {
                amplitude,
                rate,
                phase,
            } => Motion::Travel(source.bob(amplitude, rate, phase)?),
            Written::Path { points, speed } => Motion::Travel(source.path(points, speed)?),
            Written::Flicker { amount: most, rate } => Motion::Flicker {
                amount: amount(most)?,
                rate: source.rate(rate)?,
            },
            Written::Pulse {
                amount: most,
                rate,
                phase,
            } => Motion::Pulse {
                amount: amount(most)?,
                rate: source.rate(rate)?,
                phase: source.phase(phase)?,
            },
            Written::HueCycle { rate } => Motion::HueCycle {
                rate: source.rate(rate)?,
            },
        })
    }

    fn scatter_lamps(
        &mut self,
        scatter: &schema::LampScatter,
        shape: &Shape,
        lamps: &mut Vec<Lamp>,
    ) -> Read<()> {
        let source = self.source;
        let walks = |motion: &schema::Motion| matches!(motion, schema::Motion::Path { .. });
        if scatter.lamp.motion.iter().any(walks) {
            return Err(source.at(
                &scatter.lamp.power,
                "a scattered lamp cannot follow a `Path`, whose points are places in the world",
                "use `Orbit` or `Bob`, which are relative to where the lamp hangs",
            ));
        }
        let height = or(&scatter.height, 2.0, |leaf| {
            source.not_negative(leaf, "height")
        })?;
        let colours = scatter.colours.iter();
        let colours: Vec<Vec3> = colours
            .map(|colour| source.not_negative3(colour, "colours"))
            .collect::<Read<_>>()?;
        let own_seed = self.next_seed();
        let ask = Ask {
            count: self.how_many(
                &scatter.count,
                &scatter.density,
                self.bounds(&scatter.min, &scatter.max)?,
                &scatter.lamp.power,
            )?,
            bounds: self.bounds(&scatter.min, &scatter.max)?,
            ground: scatter.on,
            clearance: self.clearance(&scatter.clearance, height as u32 + 1)?,
            spacing: or(&scatter.spacing, 0.0, |leaf| {
                source.not_negative(leaf, "spacing")
            })?,
            seed: or(&scatter.seed, own_seed, |leaf| source.seed(leaf))?,
        };
        // Read once even if no place is found, so that mistakes are reported.
        self.lamp_at(&scatter.lamp, Vec3::ZERO, lamps.len())?;
        for Found { voxel, chance } in ask.places(shape, self.world_voxels(), &mut self.tried) {
            let up = match scatter.on {
                schema::Ground::Floor => Vec3::new(0.5, height, 0.5),
                schema::Ground::Ceiling => Vec3::new(0.5, 1.0 - height, 0.5),
            };
            let mut lamp = self.lamp_at(&scatter.lamp, voxel.as_vec3() + up, lamps.len())?;
            if !colours.is_empty() {
                lamp.colour = colours[hash(chance) as usize % colours.len()];
            }
            lamps.push(lamp);
        }
        Ok(())
    }
}
