//! Lamps, sun, sky, cameras and layouts.

use glam::{UVec3, Vec3};

use super::leaf::Leaf;
use super::place::{Ask, Found};
use super::resolve::Reader;
use super::schema;
use super::values::{Read, or};
use crate::world::materials::hash::hash;
use crate::world::scenery::{MAX_LAMPS, MAX_PROBES};
use crate::world::sdf::Shape;
use crate::world::{Camera, Lamp, LampKind, LampPreset, LayoutSpec, Motion, Sky, Sun};

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
                    format!("a preset may have {MAX_LAMPS}: every lamp costs a shadow ray"),
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

    /// A lamp where the file puts it.
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
            // Distances are in voxels everywhere behind the file: scale 1/d² back to metres.
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
            motion: motion.collect::<Read<_>>()?,
        })
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
        let rate = |leaf: &Leaf| -> Read<f32> {
            Ok(source.number_in(leaf, "rate", -1000.0..=1000.0)? as f32)
        };
        let phase = |phase: &Option<Leaf>| or(phase, 0.0, |leaf| source.length(leaf, "phase"));
        let amount =
            |leaf: &Leaf| -> Read<f32> { Ok(source.number_in(leaf, "amount", 0.0..=1.0)? as f32) };
        Ok(match motion {
            Written::Orbit {
                radius,
                rate: turns,
                phase: start,
            } => Motion::Orbit {
                radius: source.point(radius, "radius")?,
                rate: rate(turns)?,
                phase: phase(start)?,
            },
            Written::Bob {
                amplitude,
                rate: turns,
                phase: start,
            } => Motion::Bob {
                amplitude: source.point(amplitude, "amplitude")?,
                rate: rate(turns)?,
                phase: phase(start)?,
            },
            Written::Flicker {
                amount: most,
                rate: turns,
            } => Motion::Flicker {
                amount: amount(most)?,
                rate: rate(turns)?,
            },
            Written::Pulse {
                amount: most,
                rate: turns,
                phase: start,
            } => Motion::Pulse {
                amount: amount(most)?,
                rate: rate(turns)?,
                phase: phase(start)?,
            },
            Written::Path { points, speed } => {
                let speed_read = source.not_negative(speed, "speed")?;
                if points.len() < 2 {
                    return Err(source.at(
                        speed,
                        format!("this path has {} points", points.len()),
                        "a path goes round through at least 2 points",
                    ));
                }
                let points = points.iter().map(|point| source.point(point, "points"));
                Motion::Path {
                    points: points.collect::<Read<_>>()?,
                    speed: speed_read,
                }
            }
            Written::HueCycle { rate: turns } => Motion::HueCycle { rate: rate(turns)? },
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
        // Read once even if no place is found, so that mistakes show.
        self.lamp_at(&scatter.lamp, Vec3::ZERO, lamps.len())?;
        for Found { voxel, chance } in ask.places(shape, self.world_voxels()) {
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

    pub(super) fn sun(&self, sun: &schema::Sun) -> Read<Sun> {
        Ok(Sun {
            towards: self.source.direction(&sun.towards, "towards")?.normalize(),
            irradiance: self.source.not_negative3(&sun.irradiance, "irradiance")?,
        })
    }

    pub(super) fn sky(&self, sky: &schema::Sky) -> Read<Sky> {
        let source = self.source;
        let zenith = source.not_negative3(&sky.zenith, "zenith")?;
        Ok(Sky {
            zenith,
            horizon: or(&sky.horizon, zenith, |v| source.not_negative3(v, "horizon"))?,
            ground: or(&sky.ground, zenith, |v| source.not_negative3(v, "ground"))?,
        })
    }

    pub(super) fn cameras(&self, cameras: &[schema::Camera], shape: &Shape) -> Read<Vec<Camera>> {
        let source = self.source;
        let mut names = Vec::new();
        let mut resolved = Vec::new();
        for camera in cameras {
            let name = source.name(&camera.name, "camera", &names)?;
            names.push(name.clone());
            let position = source.point(&camera.position, "position")?;
            let yaw = or(&camera.yaw_deg, 0.0, |leaf| source.length(leaf, "yaw_deg"))?;
            let pitch = or(&camera.pitch_deg, 0.0, |leaf| {
                Ok(source.number_in(leaf, "pitch_deg", -90.0..=90.0)? as f32)
            })?;
            let (yaw_deg, pitch_deg) = match &camera.look_at {
                None => (yaw, pitch),
                Some(target) => {
                    if let Some(angle) = camera.yaw_deg.as_ref().or(camera.pitch_deg.as_ref()) {
                        return Err(source.at(
                            angle,
                            format!("camera `{name}` has both `look_at` and an angle"),
                            "keep `look_at`, or the angles `yaw_deg` and `pitch_deg`",
                        ));
                    }
                    let along = source.point(target, "look_at")? - position;
                    if along.length() < 1e-6 {
                        return Err(source.at_vector(
                            target,
                            format!("camera `{name}` looks at the place where it stands"),
                            "`look_at` is the point that comes to the middle of the picture",
                        ));
                    }
                    towards(along)
                }
            };
            resolved.push(Camera {
                name,
                position,
                yaw_deg,
                pitch_deg,
                fov_deg: or(&camera.fov_deg, DEFAULT_FOV_DEG, |leaf| {
                    Ok(source.number_in(leaf, "fov_deg", 1.0..=170.0)? as f32)
                })?,
            });
        }
        if resolved.is_empty() {
            resolved.push(self.overview(shape));
        }
        Ok(resolved)
    }

    /// A camera in the air that looks at the middle of the box: the first of a few places, from the
    /// upper corners inwards, that lies well clear of stone.
    fn overview(&self, shape: &Shape) -> Camera {
        let (low, high) = self.world_box();
        let (centre, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let mut places = Vec::new();
        for share in [0.9, 0.6, 0.3] {
            for (x, y, z) in [
                (0.8, 0.6, 1.0),
                (-0.8, 0.6, 1.0),
                (0.8, 0.2, -1.0),
                (-0.8, -0.2, -1.0),
            ] {
                places.push(centre + half * Vec3::new(x, y, z) * share);
            }
        }
        let clear = |place: &&Vec3| shape.eval(place.as_dvec3()) > 2.0;
        // In a world without such a place: from outside.
        let outside = centre + half.length() * Vec3::new(0.8, 0.9, 1.2);
        let position = places.iter().find(clear).copied().unwrap_or(outside);
        let (yaw_deg, pitch_deg) = towards(centre - position);
        Camera {
            name: "overview".into(),
            position,
            yaw_deg,
            pitch_deg,
            fov_deg: DEFAULT_FOV_DEG,
        }
    }

    pub(super) fn layouts(&self, layouts: &[schema::Layout]) -> Read<Vec<LayoutSpec>> {
        let source = self.source;
        let (low, high) = self.world_box();
        let mut names = Vec::new();
        let mut resolved = Vec::new();
        for layout in layouts {
            let name = source.name(&layout.name, "layout", &names)?;
            names.push(name.clone());
            let [x, y, z] = layout.counts.leaves();
            let count = |leaf| source.count(leaf, "counts", 1..=MAX_PROBES);
            let counts = UVec3::new(count(x)?, count(y)?, count(z)?);
            let probes: u64 = counts.to_array().map(u64::from).iter().product();
            if probes > u64::from(MAX_PROBES) {
                return Err(source.at_vector(
                    &layout.counts,
                    format!("layout `{name}` has {probes} probes"),
                    format!("a layout may have {MAX_PROBES}; widen the spacing"),
                ));
            }
            let spacing = match &layout.spacing {
                super::leaf::OneOrThree::One(leaf) => {
                    Vec3::splat(source.positive(leaf, "spacing")?)
                }
                super::leaf::OneOrThree::Three(v) => source.positive3(v, "spacing")?,
            };
            let middle = (low + high) / 2.0;
            resolved.push(LayoutSpec {
                name,
                counts,
                spacing,
                centre: or(&layout.centre, middle, |v| source.point(v, "centre"))?,
            });
        }
        if resolved.is_empty() {
            let size = high - low;
            let spacing = (size.max_element() / 8.0).max(1.0);
            resolved.push(LayoutSpec {
                name: "auto".into(),
                counts: (size / spacing).ceil().as_uvec3().max(UVec3::splat(2)),
                spacing: Vec3::splat(spacing),
                centre: (low + high) / 2.0,
            });
        }
        Ok(resolved)
    }
}

const DEFAULT_FOV_DEG: f32 = 60.0;

/// Yaw and pitch in degrees of a camera that looks along a vector.
fn towards(along: Vec3) -> (f32, f32) {
    let yaw = (-along.x).atan2(-along.z);
    let pitch = along.y.atan2(along.x.hypot(along.z));
    (yaw.to_degrees(), pitch.to_degrees())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_looks_at_what_it_is_told_to() {
        for along in [Vec3::new(1.0, 2.0, -3.0), Vec3::X, Vec3::NEG_Y, Vec3::Z] {
            let (yaw_deg, pitch_deg) = towards(along);
            let camera = Camera {
                name: "test".into(),
                position: Vec3::ZERO,
                yaw_deg,
                pitch_deg,
                fov_deg: DEFAULT_FOV_DEG,
            };
            let forward = camera.basis(1.0).forward.as_vec3();
            assert!(
                forward.distance(along.normalize()) < 1e-5,
                "{along}: {forward}"
            );
        }
    }
}
