//! Bodies: their models, where they rest, and how they move.

use std::collections::BTreeMap;

use glam::{DMat3, DQuat, DVec3, EulerRot, IVec3, UVec3};

use super::leaf::Leaf;
use super::resolve::Reader;
use super::schema::{self, Vector};
use super::values::{Read, or};
use crate::world::bodies::{
    Bodies, Body, BodyModel, BodyMotion, Cycle, Ease, MAX_BODIES, MAX_BODY_EDGE, MAX_MODEL_VOXELS,
    Pose, PutBy,
};
use crate::world::rules::RuleSet;
use crate::world::sdf::{Shape, Translate, WrittenSdf};
use crate::world::{Rule, Sdf};

/// A turn is at most this many degrees: a thousand rounds.
const MAX_DEGREES: f64 = 360_000.0;
/// Times lie within ± this many seconds: a day.
const MAX_SECONDS: f64 = 86_400.0;
/// Shortest period of a motion that repeats (seconds).
const SHORTEST_S: f64 = 0.01;

/// The bodies that have been read so far.
#[derive(Default)]
struct Known {
    bodies: Bodies,
    /// The index of each body by its name.
    names: BTreeMap<String, usize>,
    /// Voxels of all models that were read, whether or not two are equal.
    voxels: u32,
}

impl Reader<'_> {
    pub(super) fn bodies(&mut self, written: &[schema::Body], rules: &[Rule]) -> Read<Bodies> {
        let source = self.source;
        let mut known = Known::default();
        for body in written {
            if known.bodies.bodies.len() == MAX_BODIES {
                return Err(source.at_vector(
                    &body.position,
                    format!("there are {} bodies", written.len()),
                    format!("a world may have {MAX_BODIES}"),
                ));
            }
            let name = self.body_name(body, &known)?;
            let position = source.point(&body.position, "position")?;
            let pivot = or(&body.pivot, DVec3::ZERO, |v| {
                Ok(source.point(v, "pivot")?.as_dvec3())
            })?;
            let degrees = or(&body.degrees, DVec3::ZERO, |v| {
                Ok(source.point(v, "degrees")?.as_dvec3())
            })?;
            let middle_ws = position.as_dvec3() - pivot;
            let model = self.body_model(&body.model, middle_ws, rules, &mut known)?;
            let size = known.bodies.models[model].size;
            let motion = body.motion.iter().map(|motion| self.body_motion(motion));
            known.names.insert(name.clone(), known.bodies.bodies.len());
            known.bodies.bodies.push(Body {
                name,
                model,
                pivot: (size.as_dvec3() / 2.0 + pivot).as_vec3(),
                rest: Pose {
                    position,
                    rotation: turned(degrees).as_quat(),
                },
                motion: motion.collect::<Read<_>>()?,
                put_by: PutBy::WorldFile,
            });
        }
        Ok(known.bodies)
    }

    fn body_name(&self, body: &schema::Body, known: &Known) -> Read<String> {
        let source = self.source;
        let Some(leaf) = &body.name else {
            let number = known.bodies.bodies.len() + 1;
            return Ok(format!("body {number}"));
        };
        let name = source.name(leaf, "body", &[])?;
        if known.names.contains_key(&name) {
            let message = format!("there are two bodies called `{name}`");
            return Err(source.at(leaf, message, "rename one of the two"));
        }
        Ok(name)
    }

    /// The index of a body's model. `middle_ws`: where the middle of the model rests, for rules.
    fn body_model(
        &mut self,
        written: &schema::BodyModel,
        middle_ws: DVec3,
        rules: &[Rule],
        known: &mut Known,
    ) -> Read<usize> {
        let source = self.source;
        let model = match written {
            schema::BodyModel::Like { body } => {
                let names = known.bodies.bodies.iter().map(|body| body.name.as_str());
                let index = source.find(body, "body further up", names)?;
                return Ok(known.bodies.bodies[index].model);
            }
            schema::BodyModel::Shape {
                size,
                shape,
                material,
            } => self.shape_model(size, shape, material.as_ref(), middle_ws, rules, known)?,
            schema::BodyModel::Vox { file } => self.vox_model(file, known)?,
        };
        let models = &mut known.bodies.models;
        if let Some(index) = models.iter().position(|other| *other == model) {
            return Ok(index);
        }
        models.push(model);
        Ok(models.len() - 1)
    }

    /// Voxels are solid where the shape is negative at their centres, as in the world.
    fn shape_model(
        &mut self,
        size: &Vector,
        shape: &WrittenSdf,
        material: Option<&Leaf>,
        middle_ws: DVec3,
        rules: &[Rule],
        known: &mut Known,
    ) -> Read<BodyModel> {
        let source = self.source;
        let edge = |leaf| source.count(leaf, "size", 1..=MAX_BODY_EDGE);
        let extent = UVec3::new(edge(&size.0)?, edge(&size.1)?, edge(&size.2)?);
        let sdf = self.shape(shape)?;
        sdf.check(&self.noises).map_err(|error| {
            let help = "correct the `shape` of this body";
            source.at_vector(size, error.to_string(), help)
        })?;
        let material = material.map(|leaf| self.material(leaf)).transpose()?;
        if !known.takes(extent) {
            return Err(source.at_vector(size, TOO_MANY_VOXELS, SHARE_MODELS));
        }
        // Rules ask for the shape and the height in world space.
        let placed = Sdf::Translate(Translate {
            by: middle_ws,
            of: Box::new(sdf),
        });
        let shape_ws = Shape::new(&placed, &self.noises);
        let rules = RuleSet::new(rules, &shape_ws);
        let low_ws = middle_ws - extent.as_dvec3() / 2.0;
        let mut materials = Vec::with_capacity(extent.element_product() as usize);
        for z in 0..extent.z {
            for y in 0..extent.y {
                for x in 0..extent.x {
                    let centre_ws = low_ws + UVec3::new(x, y, z).as_dvec3() + 0.5;
                    let value = shape_ws.eval(centre_ws);
                    materials.push(match material {
                        _ if value >= 0.0 => 0,
                        Some(material) => material,
                        None => rules.material(centre_ws, value, &shape_ws),
                    });
                }
            }
        }
        if materials.iter().all(|material| *material == 0) {
            return Err(source.at_vector(
                size,
                "this body has no voxels: its shape is empty within its `size`",
                "the middle of the box is (0, 0, 0) of the shape; make one of the two larger",
            ));
        }
        Ok(BodyModel {
            size: extent,
            materials,
        })
    }

    fn vox_model(&mut self, file: &Leaf, known: &mut Known) -> Read<BodyModel> {
        let source = self.source;
        let model = self.read_vox(file)?;
        let Some((low, high)) = model.corners() else {
            let message = format!("`{}` has no voxels", model.name);
            return Err(source.at(file, message, "name a model that has some"));
        };
        let extent = (high - low + 1).as_uvec3();
        if extent.max_element() > MAX_BODY_EDGE {
            let [x, y, z] = extent.to_array();
            return Err(source.at(
                file,
                format!("`{}` has {x} × {y} × {z} voxels", model.name),
                format!("an edge of a body may have {MAX_BODY_EDGE}: scale the model down"),
            ));
        }
        if !known.takes(extent) {
            return Err(source.at(file, TOO_MANY_VOXELS, SHARE_MODELS));
        }
        let mut by_colour = BTreeMap::new();
        let mut materials = vec![0; extent.element_product() as usize];
        for (&voxel, &colour) in &model.voxels {
            let material = self.vox_material(file, &model, colour, &mut by_colour)?;
            let at = (IVec3::from(voxel) - low).as_uvec3();
            materials[(at.x + extent.x * (at.y + extent.y * at.z)) as usize] = material;
        }
        Ok(BodyModel {
            size: extent,
            materials,
        })
    }

    fn body_motion(&self, motion: &schema::BodyMotion) -> Read<BodyMotion> {
        use schema::BodyMotion as Written;
        let source = self.source;
        let turn = |leaf: &Leaf| -> Read<f32> {
            Ok(source.number_in(leaf, "degrees", -MAX_DEGREES..=MAX_DEGREES)? as f32)
        };
        Ok(match motion {
            Written::Orbit {
                radius,
                rate,
                phase,
            } => BodyMotion::Travel(source.orbit(radius, rate, phase)?),
            Written::Bob {
                amplitude,
                rate,
                phase,
            } => BodyMotion::Travel(source.bob(amplitude, rate, phase)?),
            Written::Path { points, speed } => BodyMotion::Travel(source.path(points, speed)?),
            Written::Turn { axis, rate } => BodyMotion::Turn {
                axis: source.direction(axis, "axis")?,
                rate: source.rate(rate)?,
            },
            Written::TurnBetween {
                axis,
                degrees,
                start_s,
                end_s,
                ease,
            } => {
                let start = self.seconds(start_s, "start_s")?;
                let end = self.seconds(end_s, "end_s")?;
                if end <= start {
                    return Err(source.at(
                        end_s,
                        format!("this turn goes from {start} s to {end} s"),
                        "`start_s` must be less than `end_s`",
                    ));
                }
                BodyMotion::TurnBetween {
                    axis: source.direction(axis, "axis")?,
                    degrees: turn(degrees)?,
                    start_s: start,
                    end_s: end,
                    ease: match ease {
                        schema::Ease::Smooth => Ease::Smooth,
                        schema::Ease::Linear => Ease::Linear,
                    },
                }
            }
            Written::Swing {
                axis,
                degrees,
                period_s,
                rest_s,
                phase_s,
            } => BodyMotion::Swing {
                axis: source.direction(axis, "axis")?,
                degrees: turn(degrees)?,
                cycle: self.cycle(period_s, rest_s, phase_s)?,
            },
            Written::Lift {
                by,
                period_s,
                rest_s,
                phase_s,
            } => BodyMotion::Lift {
                by: source.point(by, "by")?,
                cycle: self.cycle(period_s, rest_s, phase_s)?,
            },
        })
    }

    fn seconds(&self, leaf: &Leaf, key: &str) -> Read<f32> {
        let seconds = self
            .source
            .number_in(leaf, key, -MAX_SECONDS..=MAX_SECONDS)?;
        Ok(seconds as f32)
    }

    fn cycle(&self, period: &Leaf, rest: &Option<Leaf>, phase: &Option<Leaf>) -> Read<Cycle> {
        let source = self.source;
        let period_s = source.number_in(period, "period_s", SHORTEST_S..=MAX_SECONDS)? as f32;
        let rest_s = or(rest, 0.0, |leaf| {
            let rest_s = source.not_negative(leaf, "rest_s")?;
            if rest_s < period_s / 2.0 {
                return Ok(rest_s);
            }
            Err(source.at(
                leaf,
                format!("two rests of {rest_s} s leave no time to move in {period_s} s"),
                "write a `rest_s` of less than half of `period_s`",
            ))
        })?;
        Ok(Cycle {
            period_s,
            rest_s,
            phase_s: or(phase, 0.0, |leaf| self.seconds(leaf, "phase_s"))?,
        })
    }
}

const TOO_MANY_VOXELS: &str = "with this body there are more than 16777216 voxels in models";
const SHARE_MODELS: &str =
    "let bodies that look the same share a model by `Like(body: \"…\")`, or make models smaller";
const _: () = assert!(MAX_MODEL_VOXELS == 16_777_216, "a message names it");

impl Known {
    /// Whether there is room for another model of this extent, which it takes.
    fn takes(&mut self, extent: UVec3) -> bool {
        self.voxels += extent.element_product();
        self.voxels <= MAX_MODEL_VOXELS
    }
}

/// Turned about x, then y, then z: the matrices multiply from the left, as those of `Rotate`.
fn turned(degrees: DVec3) -> DQuat {
    let [x, y, z] = degrees.to_array().map(f64::to_radians);
    DQuat::from_mat3(&DMat3::from_euler(EulerRot::ZYX, z, y, x))
}
