//! Bodies of voxels that stand in the way of the player's box.
//!
//! Each solid voxel is a cube that may be turned. A box that moves along one axis meets it where the projections on all
//! separating axes begin to overlap (Gottschalk, Lin & Manocha 1996, section 5: fifteen axes for two boxes). The
//! box keeps half a unit away, so that rounding never puts it inside.

use glam::{DMat3, DVec3, IVec3};

use super::sweep::{Aabb, ONE, to_voxels};
use crate::world::bodies::{Bodies, BodyModel};

/// Cubes that overlap by less than this (voxels) only touch: it is less than the gap that a box keeps.
const TOUCHING: f64 = 1e-7;
/// Least gap between a box and a cube (units). A box that stops keeps less than one more.
const GAP: f64 = 0.5;
/// A cube that is nearer than this (units) bears and stops a box that keeps its gap, whatever rounding says.
const BORNE: f64 = 2.0;
/// Sines of smaller angles are rounding: edges are parallel.
const PARALLEL: f64 = 1e-6;

/// All bodies of a world at one moment.
#[derive(Clone, Debug, Default)]
pub struct Obstacles<'a> {
    bodies: Vec<Obstacle<'a>>,
}

/// A world without bodies.
pub static NONE: Obstacles<'static> = Obstacles { bodies: Vec::new() };

#[derive(Clone, Debug)]
struct Obstacle<'a> {
    model: &'a BodyModel,
    /// Model space: voxels from the lowest corner.
    pivot_ms: DVec3,
    /// World space.
    pivot_ws: DVec3,
    /// Turns model space into world space.
    turn: DMat3,
}

/// A solid voxel of a body.
#[derive(Clone, Copy, Debug)]
struct Cube {
    centre_ws: DVec3,
    turn: DMat3,
}

impl<'a> Obstacles<'a> {
    /// The bodies of a world at a world time (seconds).
    pub fn at(bodies: &'a Bodies, time_s: f64) -> Self {
        Self::of(bodies, time_s, |_| true)
    }

    /// Those of the bodies that are wanted, by their indices.
    pub fn of(bodies: &'a Bodies, time_s: f64, is_wanted: impl Fn(usize) -> bool) -> Self {
        let all = bodies.bodies.iter().enumerate();
        let all = all.filter(|(index, _)| is_wanted(*index));
        let all = all.map(|(_, body)| (body, body.pose(time_s)));
        let all = all.map(|(body, pose)| Obstacle {
            model: &bodies.models[body.model],
            pivot_ms: body.pivot.as_dvec3(),
            pivot_ws: pose.position.as_dvec3(),
            turn: DMat3::from_quat(pose.rotation.as_dquat().normalize()),
        });
        Self {
            bodies: all.collect(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Whether a voxel of a body overlaps the box.
    pub fn overlaps(&self, shape: &Aabb) -> bool {
        let mut found = false;
        self.cubes_near(shape, |cube| {
            found |= contact(shape, cube, 1, 1.0).is_some_and(|(from, to)| from < 0.0 && to > 0.0);
        });
        found
    }

    /// How far the box can move along `axis` (0 … 2), of `distance` units. Cubes that it is in already do not stop it.
    pub fn sweep(&self, shape: &Aabb, axis: usize, distance: i64) -> i64 {
        let mut free = distance.abs();
        let sign = distance.signum();
        self.cubes_near(&shape.along(axis, distance), |cube| {
            if let Some((from, _)) = contact(shape, cube, axis, sign as f64)
                && from > 0.0
            {
                let reached = match from * ONE as f64 {
                    ..BORNE => 0,
                    units => (units - GAP).floor() as i64,
                };
                free = free.min(reached);
            }
        });
        sign * free
    }

    /// Whether a body bears the box.
    pub fn supports(&self, shape: &Aabb) -> bool {
        self.sweep(shape, 1, -1) == 0
    }

    /// The shortest way (units) along `axis`, up or down it by `sign`, after which the box overlaps no body; `None` if
    /// that is farther than `longest`.
    pub fn way_out(&self, shape: &Aabb, axis: usize, sign: i64, longest: i64) -> Option<i64> {
        let mut contacts = Vec::new();
        self.cubes_near(&shape.along(axis, sign * longest), |cube| {
            contacts.extend(contact(shape, cube, axis, sign as f64));
        });
        contacts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut way = 0;
        for (from, to) in contacts {
            let [from, to] = [from, to].map(|voxels| voxels * ONE as f64);
            if from - GAP < way as f64 && to + GAP > way as f64 {
                way = (to + GAP).ceil() as i64;
            }
        }
        (way <= longest).then_some(way)
    }

    /// How far away (voxels) a ray (world space, unit direction) enters the first solid voxel; 0 from inside of one.
    pub fn met(&self, origin_ws: DVec3, direction_ws: DVec3) -> Option<f64> {
        let met = self.bodies.iter();
        let met = met.filter_map(|body| body.met(origin_ws, direction_ws));
        met.min_by(f64::total_cmp)
    }

    /// Calls `each` with all solid voxels of bodies that may touch a box.
    fn cubes_near(&self, shape: &Aabb, mut each: impl FnMut(&Cube)) {
        if self.bodies.is_empty() {
            return;
        }
        let (middle_ws, half_ws) = extent(shape);
        for body in &self.bodies {
            // The box around the box, in the space of the model; what bears it is a gap away.
            let back = body.turn.transpose();
            let middle = back * (middle_ws - body.pivot_ws) + body.pivot_ms;
            let half = DMat3::from_cols(back.x_axis.abs(), back.y_axis.abs(), back.z_axis.abs())
                * half_ws
                + BORNE / ONE as f64;
            let size = body.model.size.as_ivec3();
            let low = (middle - half).floor().as_ivec3().max(IVec3::ZERO);
            let high = (middle + half).floor().as_ivec3().min(size - 1);
            for z in low.z..=high.z {
                for y in low.y..=high.y {
                    for x in low.x..=high.x {
                        let voxel = IVec3::new(x, y, z);
                        if body.model.material(voxel) == 0 {
                            continue;
                        }
                        let offset = voxel.as_dvec3() + 0.5 - body.pivot_ms;
                        each(&Cube {
                            centre_ws: body.turn * offset + body.pivot_ws,
                            turn: body.turn,
                        });
                    }
                }
            }
        }
    }
}

impl Obstacle<'_> {
    /// How far away (voxels) a ray enters the first solid voxel. Amanatides & Woo 1987, in model space: a pose neither
    /// stretches nor shears, so distances are the same.
    fn met(&self, origin_ws: DVec3, direction_ws: DVec3) -> Option<f64> {
        let back = self.turn.transpose();
        let origin = back * (origin_ws - self.pivot_ws) + self.pivot_ms;
        let direction = back * direction_ws;
        // A ray along an axis never comes to a border across that axis.
        let is_across = direction.abs().cmplt(DVec3::splat(PARALLEL));
        let borders = |at: DVec3| (at - origin) / direction;
        let size = self.model.size.as_ivec3();
        let (a, b) = (borders(DVec3::ZERO), borders(size.as_dvec3()));
        let enters = DVec3::select(is_across, DVec3::ZERO, a.min(b));
        let leaves = DVec3::select(is_across, DVec3::INFINITY, a.max(b));
        let mut distance = enters.max_element().max(0.0);
        let start = (origin + distance * direction).floor().as_ivec3();
        let is_beside = start.cmplt(IVec3::ZERO) | start.cmpge(size);
        if distance >= leaves.min_element() || (is_beside & is_across).any() {
            return None;
        }
        // Rounding may leave the start a little outside.
        let mut voxel = start.clamp(IVec3::ZERO, size - 1);
        let step = IVec3::from(direction.cmpgt(DVec3::ZERO)) * 2 - 1;
        let is_inside = |at: IVec3| at.cmpge(IVec3::ZERO).all() && at.cmplt(size).all();
        while is_inside(voxel) {
            if self.model.material(voxel) != 0 {
                return Some(distance);
            }
            let ahead = borders((voxel + (step + 1) / 2).as_dvec3());
            let ahead = DVec3::select(is_across, DVec3::INFINITY, ahead);
            let axis = ahead.min_position();
            distance = distance.max(ahead[axis]);
            voxel[axis] += step[axis];
        }
        None
    }
}

/// The middle of a box and half of its extent (voxels).
fn extent(shape: &Aabb) -> (DVec3, DVec3) {
    let [low, high] = [shape.min, shape.max].map(|at| DVec3::from(at.to_array().map(to_voxels)));
    ((low + high) / 2.0, (high - low) / 2.0)
}

/// From where to where the box overlaps a cube as it moves along a line (voxels, from its place; both may be
/// negative); `None` if it never does.
fn contact(shape: &Aabb, cube: &Cube, axis: usize, sign: f64) -> Option<(f64, f64)> {
    let (middle, half) = extent(shape);
    let offset = cube.centre_ws - middle;
    let edges = [cube.turn.x_axis, cube.turn.y_axis, cube.turn.z_axis];
    let own = [DVec3::X, DVec3::Y, DVec3::Z];
    let crossed = own.iter().flat_map(|a| edges.iter().map(|b| a.cross(*b)));
    let crossed = crossed
        .filter(|normal| normal.length() > PARALLEL)
        .map(|normal| normal.normalize());
    let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
    for normal in own.into_iter().chain(edges).chain(crossed) {
        let cube_reach: f64 = edges.iter().map(|edge| edge.dot(normal).abs()).sum();
        let reach = half.dot(normal.abs()) + 0.5 * cube_reach - TOUCHING;
        let apart = offset.dot(normal);
        let speed = sign * normal[axis];
        if speed.abs() < PARALLEL {
            if apart.abs() >= reach {
                return None;
            }
            continue;
        }
        let [a, b] = [(apart - reach) / speed, (apart + reach) / speed];
        from = from.max(a.min(b));
        to = to.min(a.max(b));
        if from >= to {
            return None;
        }
    }
    Some((from, to))
}

#[cfg(test)]
mod tests {
    use glam::{I64Vec3, Quat, UVec3, Vec3};

    use super::super::sweep::point_to_units;
    use super::*;
    use crate::world::bodies::{Body, Pose};

    /// One voxel about (4, 0, 0), turned about +Y.
    fn cube(degrees: f32) -> Bodies {
        Bodies {
            models: vec![BodyModel {
                size: UVec3::ONE,
                materials: vec![1],
            }],
            bodies: vec![Body {
                name: "cube".into(),
                model: 0,
                pivot: Vec3::splat(0.5),
                rest: Pose {
                    position: Vec3::X * 4.0,
                    rotation: Quat::from_rotation_y(degrees.to_radians()),
                },
                motion: Vec::new(),
                put_by: Default::default(),
            }],
            gone: Vec::new(),
        }
    }

    fn unit_box(low: DVec3) -> Aabb {
        let min = point_to_units(low);
        Aabb {
            min,
            max: min + I64Vec3::splat(ONE),
        }
    }

    #[test]
    fn a_box_stops_before_a_turned_cube_and_gets_out_of_it() {
        // Half of the cube's width along x, as the box in the middle of its side meets it.
        for (degrees, half_width) in [(0.0f32, 0.5), (45.0, 0.5f64.sqrt()), (90.0, 0.5)] {
            let bodies = cube(degrees);
            let obstacles = Obstacles::at(&bodies, 0.0);
            let start = unit_box(DVec3::new(0.0, -0.5, -0.5));
            let free = obstacles.sweep(&start, 0, 10 * ONE);
            let gap = (4.0 - half_width - 1.0) * ONE as f64 - free as f64;
            assert!((0.4..1.7).contains(&gap), "{degrees}: {gap} units");
            let stopped = start.moved(I64Vec3::X * free);
            assert!(!obstacles.overlaps(&stopped));
            assert_eq!(obstacles.sweep(&stopped, 0, 1), 0, "it stays stopped");
            assert_eq!(obstacles.sweep(&stopped, 0, -ONE), -ONE, "and may go back");
            let inside = start.moved(I64Vec3::X * (free + ONE / 4));
            assert!(obstacles.overlaps(&inside));
            let back = obstacles
                .way_out(&inside, 0, -1, ONE)
                .expect("a quarter away");
            assert!((back - ONE / 4).abs() <= 2, "{back}");
            assert!(!obstacles.overlaps(&inside.moved(I64Vec3::NEG_X * back)));
            assert_eq!(obstacles.way_out(&inside, 0, -1, ONE / 8), None);
        }
    }

    #[test]
    fn a_box_passes_a_corner_that_only_its_bounds_reach() {
        let bodies = cube(45.0);
        let obstacles = Obstacles::at(&bodies, 0.0);
        // The cube's bounds end at x = 3.29 and z = ±0.71; its corner there is empty.
        let beside = unit_box(DVec3::new(2.4, -0.5, 0.4));
        assert!(!obstacles.overlaps(&beside));
        assert!(obstacles.overlaps(&unit_box(DVec3::new(2.4, -0.5, 0.1))));
    }

    #[test]
    fn a_ray_meets_a_turned_cube_at_its_side_and_a_hollow_one_at_its_far_wall() {
        for degrees in [0.0f32, 30.0, 45.0, 90.0] {
            let bodies = cube(degrees);
            let obstacles = Obstacles::at(&bodies, 0.0);
            let angle = f64::from(degrees % 90.0).to_radians();
            // A ray along x through the cube's middle meets the side that it crosses first.
            let half = 0.5 / angle.cos().max(angle.sin());
            let met = obstacles.met(DVec3::new(-2.0, 0.1, 0.0), DVec3::X);
            let met = met.expect("it is ahead");
            assert!((met - (6.0 - half)).abs() < 1e-6, "{degrees}: {met}");
            assert_eq!(
                obstacles.met(DVec3::new(4.0, 0.1, 0.0), DVec3::X),
                Some(0.0)
            );
            assert_eq!(
                obstacles.met(DVec3::new(-2.0, 0.1, 0.0), DVec3::NEG_X),
                None
            );
            assert_eq!(obstacles.met(DVec3::new(-2.0, 0.6, 0.0), DVec3::X), None);
        }
        let mut hollow = cube(0.0);
        hollow.models[0] = BodyModel {
            size: UVec3::new(4, 1, 1),
            materials: vec![0, 0, 0, 1],
        };
        let obstacles = Obstacles::at(&hollow, 0.0);
        // Its voxels begin at x = 3.5.
        let met = obstacles
            .met(DVec3::ZERO, DVec3::X)
            .expect("the last voxel");
        assert!((met - 6.5).abs() < 1e-9, "{met}");
        assert_eq!(obstacles.met(DVec3::X * 5.0 + DVec3::Y, DVec3::NEG_Y), None);
    }
}
