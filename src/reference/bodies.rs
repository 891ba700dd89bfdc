//! Bodies that rays can hit: each is a grid of its own, which the ray enters in the body's space.
//!
//! `_gs` is the space of the world's grid, `_ms` that of a model: voxels from its lowest corner. A pose neither
//! stretches nor shears, so distances along a ray are the same in both.

use glam::{DMat3, DVec3, IVec3, UVec3};

use super::march::{FACE_NORMALS, Hit, Outcome, Ray, march};
use crate::world::bodies::{Bodies, BodyModel, Pose};
use crate::world::voxels::{BRICK_VOXELS, CELL, NewCell, Voxels, brick_index};

/// Components of a normal below this are rounding.
const ROUNDING: f64 = 1e-9;

/// The bodies of a world at one moment.
#[derive(Clone, Debug, Default)]
pub struct PosedBodies {
    models: Vec<Voxels>,
    bodies: Vec<PosedBody>,
}

#[derive(Clone, Debug)]
struct PosedBody {
    model: usize,
    pivot_ms: DVec3,
    pivot_gs: DVec3,
    /// Turns model space into grid space.
    turn: DMat3,
    /// A sphere around the whole model.
    middle_gs: DVec3,
    radius: f64,
}

/// A point of a body's surface. It belongs to one face of one voxel.
#[derive(Clone, Copy, Debug)]
pub struct BodyPoint {
    pub body: usize,
    pub position_ms: DVec3,
    /// The cell of the model before the face: rays that leave the surface start in it.
    pub air_ms: IVec3,
}

/// Where a ray enters a voxel of a body.
#[derive(Clone, Copy, Debug)]
pub struct BodyHit {
    /// Its voxel is one of the model.
    pub hit: Hit,
    pub point: BodyPoint,
    pub position_gs: DVec3,
    /// Outward unit normal of the face, in grid space.
    pub normal: DVec3,
}

/// What a ray meets among the bodies.
#[derive(Clone, Copy, Debug)]
pub enum BodyOutcome {
    /// The ray starts in a solid voxel of this material.
    Inside(u8),
    Hit(BodyHit),
    Miss,
}

impl PosedBodies {
    /// The bodies of a world whose grid begins at `origin`, with a pose for each.
    ///
    /// # Panics
    /// If there are fewer or more poses than bodies.
    pub fn new(bodies: &Bodies, origin: IVec3, poses: &[Pose]) -> Self {
        assert_eq!(bodies.bodies.len(), poses.len(), "a pose for each body");
        let posed = bodies.bodies.iter().zip(poses).map(|(body, pose)| {
            let half = bodies.models[body.model].size.as_dvec3() / 2.0;
            let pivot_ms = body.pivot.as_dvec3();
            let pivot_gs = pose.position.as_dvec3() - origin.as_dvec3();
            let turn = DMat3::from_quat(pose.rotation.as_dquat().normalize());
            PosedBody {
                model: body.model,
                pivot_ms,
                pivot_gs,
                turn,
                middle_gs: turn * (half - pivot_ms) + pivot_gs,
                radius: half.length(),
            }
        });
        Self {
            models: bodies.models.iter().map(voxels_of).collect(),
            bodies: posed.collect(),
        }
    }

    /// Turns a direction from the space of a body into that of the grid.
    pub fn direction_gs(&self, body: usize, direction_ms: DVec3) -> DVec3 {
        self.bodies[body].turn * direction_ms
    }

    /// The nearest body along a ray of grid space. The ray leaves a surface with this normal, if it leaves one; and if
    /// that is a body's, it starts exactly before the face, whatever rounding says of its origin.
    pub fn march(
        &self,
        ray: &Ray,
        normal: Option<DVec3>,
        leaving: Option<&BodyPoint>,
    ) -> BodyOutcome {
        let mut nearest = BodyOutcome::Miss;
        let mut max_distance = ray.max_distance;
        for (index, body) in self.bodies.iter().enumerate() {
            if !body.may_be_hit(ray) {
                continue;
            }
            let (origin, start) = match leaving {
                Some(point) if point.body == index => (point.position_ms, point.air_ms),
                _ => {
                    let origin_ms = body.to_model(ray.origin);
                    let normal_ms = normal.map(|normal| body.turn.transpose() * normal);
                    (origin_ms, cell_before(origin_ms, normal_ms))
                }
            };
            let ray_ms = Ray {
                origin,
                direction: body.turn.transpose() * ray.direction,
                start,
                max_distance,
            };
            match march(&self.models[body.model], &ray_ms) {
                Outcome::Inside(material) => return BodyOutcome::Inside(material),
                Outcome::Miss => {}
                Outcome::Hit(hit) => {
                    max_distance = hit.distance;
                    let position_ms = hit.position(&ray_ms);
                    let normal_ms = FACE_NORMALS[usize::from(hit.face)];
                    nearest = BodyOutcome::Hit(BodyHit {
                        point: BodyPoint {
                            body: index,
                            position_ms,
                            air_ms: hit.voxel + normal_ms,
                        },
                        position_gs: body.turn * (position_ms - body.pivot_ms) + body.pivot_gs,
                        normal: body.turn * normal_ms.as_dvec3(),
                        hit,
                    });
                }
            }
        }
        nearest
    }
}

impl PosedBody {
    fn to_model(&self, position_gs: DVec3) -> DVec3 {
        self.turn.transpose() * (position_gs - self.pivot_gs) + self.pivot_ms
    }

    /// Whether a ray comes near the sphere around the model.
    fn may_be_hit(&self, ray: &Ray) -> bool {
        let to_middle = self.middle_gs - ray.origin;
        // Rounding must not lose a body that fills its sphere's corner.
        let outside = to_middle.length_squared() - (self.radius + ROUNDING).powi(2);
        let along = to_middle.dot(ray.direction);
        let squared = ray.direction.length_squared();
        outside <= 0.0 || (along > 0.0 && along * along >= outside * squared * (1.0 - ROUNDING))
    }
}

/// The voxel that a point lies in. On the border between two, the one on the side of the normal.
pub fn cell_before(position: DVec3, normal: Option<DVec3>) -> IVec3 {
    let normal = normal.unwrap_or(DVec3::ZERO);
    let below = position.ceil() - 1.0;
    DVec3::select(
        normal.cmplt(DVec3::splat(-ROUNDING)),
        below,
        position.floor(),
    )
    .as_ivec3()
}

/// A model in the form that rays march through.
fn voxels_of(model: &BodyModel) -> Voxels {
    Voxels::from_cells(model.size, |cell| {
        let mut brick = Box::new([0; BRICK_VOXELS]);
        for index in 0..BRICK_VOXELS as u32 {
            let local = UVec3::new(index % CELL, index / CELL % CELL, index / (CELL * CELL));
            brick[brick_index(local)] = model.material((cell * CELL + local).as_ivec3());
        }
        NewCell::Voxels(brick)
    })
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};

    use super::*;
    use crate::world::bodies::Body;

    /// One plate of 4 × 1 × 2 voxels that turns about its middle.
    fn plate(degrees: f32) -> PosedBodies {
        let size = UVec3::new(4, 1, 2);
        let bodies = Bodies {
            models: vec![BodyModel {
                size,
                materials: vec![3; 8],
            }],
            bodies: vec![Body {
                name: "plate".into(),
                model: 0,
                pivot: size.as_vec3() / 2.0,
                rest: Pose {
                    position: Vec3::new(10.0, 20.0, 30.0),
                    rotation: Quat::from_rotation_z(degrees.to_radians()),
                },
                motion: Vec::new(),
                put_by: Default::default(),
            }],
            gone: Vec::new(),
        };
        PosedBodies::new(&bodies, IVec3::new(0, 10, 0), &bodies.poses(0.0))
    }

    /// A ray from above meets the turned top where geometry says, with the turned normal.
    #[test]
    fn a_turned_plate_is_hit_where_it_is() {
        for degrees in [0.0f32, 30.0, 45.0, -60.0] {
            let ray = Ray::new(DVec3::new(10.0, 18.0, 30.1), DVec3::NEG_Y);
            let BodyOutcome::Hit(found) = plate(degrees).march(&ray, None, None) else {
                panic!("missed at {degrees}°");
            };
            let angle = f64::from(degrees).to_radians();
            let height = 0.5 / angle.cos();
            assert!(
                (found.hit.distance - (8.0 - height)).abs() < 1e-6,
                "{found:?}"
            );
            assert!((found.position_gs - DVec3::new(10.0, 10.0 + height, 30.1)).length() < 1e-6);
            let normal = DVec3::new(-angle.sin(), angle.cos(), 0.0);
            assert!((found.normal - normal).length() < 1e-6, "{found:?}");
            assert_eq!((found.hit.material, found.hit.face), (3, 3));
        }
    }

    /// Rays that leave a face of a turned body never meet that body, if it is convex: nothing starts inside.
    #[test]
    fn a_ray_that_leaves_a_convex_body_does_not_meet_it() {
        let bodies = plate(27.0);
        let mut met = 0;
        for step in 0..400 {
            let angle = f64::from(step) * 0.7;
            let from = DVec3::new(10.0, 10.0, 30.0)
                + 9.0 * DVec3::new(angle.cos(), angle.sin(), 0.4 * (angle * 1.3).sin());
            let towards = DVec3::new(10.0, 10.0, 30.0) + 0.4 * DVec3::splat((angle * 3.1).sin());
            let ray = Ray::new(from, (towards - from).normalize());
            let BodyOutcome::Hit(found) = bodies.march(&ray, None, None) else {
                continue;
            };
            met += 1;
            for aside in [
                DVec3::X,
                DVec3::Y,
                DVec3::Z,
                -DVec3::X,
                -DVec3::Y,
                -DVec3::Z,
            ] {
                let direction =
                    (found.normal + 0.999 * aside.reject_from(found.normal)).normalize();
                let leaving = Ray::new(found.position_gs, direction);
                let again = bodies.march(&leaving, Some(found.normal), Some(&found.point));
                assert!(matches!(again, BodyOutcome::Miss), "{found:?} {again:?}");
            }
        }
        assert!(met > 200, "{met}");
    }

    #[test]
    fn a_point_on_a_border_belongs_to_the_side_of_its_normal() {
        let at = DVec3::new(2.0, 2.5, 3.0);
        assert_eq!(cell_before(at, None), IVec3::new(2, 2, 3));
        assert_eq!(cell_before(at, Some(DVec3::NEG_X)), IVec3::new(1, 2, 3));
        assert_eq!(cell_before(at, Some(DVec3::NEG_Y)), IVec3::new(2, 2, 3));
        assert_eq!(cell_before(at, Some(DVec3::Z)), IVec3::new(2, 2, 3));
    }
}
