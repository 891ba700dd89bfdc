//! Exact marching of rays through voxels, in f64.
//!
//! [`march_plain`] is the judge: one voxel per step. [`march`] jumps over empty 8³ cells, and gives the
//! same answer bit for bit (a property test checks this). Everything is in grid space: one voxel is one
//! unit and the grid begins at 0.

use glam::{DVec3, IVec3};

use crate::world::voxels::{CELL, Cell, Voxels};

/// Outward normals of the faces 0…5: −x, +x, −y, +y, −z, +z.
pub const FACE_NORMALS: [IVec3; 6] = [
    IVec3::NEG_X,
    IVec3::X,
    IVec3::NEG_Y,
    IVec3::Y,
    IVec3::NEG_Z,
    IVec3::Z,
];

/// Marches do not go to cells farther out than this, so that cell numbers do not overflow.
const FARTHEST: IVec3 = IVec3::splat(1 << 29);

/// A ray in grid space, and the cell that it starts in.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub origin: DVec3,
    /// Of any length except zero: distances are multiples of it.
    pub direction: DVec3,
    /// The first voxel that the ray sees. A secondary ray starts on the border between two voxels,
    /// where rounding must not choose: it names the cell beyond the face.
    pub start: IVec3,
    /// Surfaces at this distance or beyond are not hit.
    pub max_distance: f64,
}

impl Ray {
    /// A ray without maximum distance, from the voxel that contains `origin`.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self {
            origin,
            direction,
            start: origin.floor().as_ivec3(),
            max_distance: f64::INFINITY,
        }
    }
}

/// Where a ray enters a solid voxel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    pub voxel: IVec3,
    /// 1-based index into the world's materials.
    pub material: u8,
    /// Index into [`FACE_NORMALS`].
    pub face: u8,
    /// In multiples of the ray's direction, at least 0.
    pub distance: f64,
}

impl Hit {
    /// The point where `ray` meets the face: exactly on its plane, and within the voxel.
    pub fn position(&self, ray: &Ray) -> DVec3 {
        let low = self.voxel.as_dvec3();
        let axis = usize::from(self.face / 2);
        let mut position =
            (ray.origin + self.distance * ray.direction).clamp(low, low + DVec3::ONE);
        position[axis] = low[axis] + f64::from(self.face % 2);
        position
    }
}

/// How a march ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// The ray starts in a solid voxel of this material.
    Inside(u8),
    Hit(Hit),
    /// The ray leaves the world, or reaches its maximum distance.
    Miss,
}

/// Amanatides & Woo 1987, one voxel per step. Ties step x, then y, then z.
///
/// Deviation: the distance to a boundary is computed from the boundary, not accumulated, so that it
/// does not depend on earlier steps. Rays may start outside the grid, which costs one step per voxel.
pub fn march_plain(voxels: &Voxels, ray: &Ray) -> Outcome {
    let mut state = TraversalState::new(voxels, ray);
    while state.distance < ray.max_distance && !state.has_left() {
        let material = voxels.material(state.cell);
        if material != 0 {
            return state.arrived(material);
        }
        state.cross_next_boundary();
    }
    Outcome::Miss
}

/// Like [`march_plain`], but crosses the space before the grid and every empty 8³ cell in one step.
pub fn march(voxels: &Voxels, ray: &Ray) -> Outcome {
    let mut state = TraversalState::new(voxels, ray);
    if !state.enter_grid() {
        return Outcome::Miss;
    }
    let edge = CELL as i32;
    while state.distance < ray.max_distance && !state.is_outside() {
        let block = state.cell.as_uvec3() / CELL;
        let low = block.as_ivec3() * edge;
        match voxels.cell(block) {
            Cell::Empty => state.leave_box(low, low + edge),
            Cell::Uniform(material) => return state.arrived(material),
            Cell::Brick(materials) => loop {
                let local = (state.cell - low).as_uvec3();
                let material = materials[(local.x | local.y << 3 | local.z << 6) as usize];
                if material != 0 {
                    return state.arrived(material);
                }
                state.cross_next_boundary();
                let same_block = (state.cell.as_uvec3() / CELL) == block;
                if !same_block || state.distance >= ray.max_distance || state.is_outside() {
                    break;
                }
            },
        }
    }
    Outcome::Miss
}

/// The state of a march: the voxel, and the next boundary on each axis.
struct TraversalState {
    origin: DVec3,
    direction: DVec3,
    size: IVec3,
    cell: IVec3,
    /// −1, 0 or 1 per axis.
    step: IVec3,
    /// Distance to the next boundary per axis; infinite where the ray is parallel to it.
    next: DVec3,
    /// Distance at which the ray entered `cell`.
    distance: f64,
    /// The axis of the last boundary; `None` until the first step.
    axis: Option<usize>,
}

impl TraversalState {
    fn new(voxels: &Voxels, ray: &Ray) -> Self {
        let direction = ray.direction;
        let sign = |d: f64| if d == 0.0 { 0 } else { d.signum() as i32 };
        let mut state = Self {
            origin: ray.origin,
            direction,
            size: voxels.size().as_ivec3(),
            cell: ray.start,
            step: IVec3::new(sign(direction.x), sign(direction.y), sign(direction.z)),
            next: DVec3::INFINITY,
            distance: 0.0,
            axis: None,
        };
        for axis in 0..3 {
            state.aim(axis);
        }
        state
    }

    /// Distance to the plane `axis` = `boundary`. It never falls as the boundary moves along the ray,
    /// because rounded subtraction and division are monotonic: the cell-skipping march depends on that.
    fn crossing(&self, axis: usize, boundary: i32) -> f64 {
        (f64::from(boundary) - self.origin[axis]) / self.direction[axis]
    }

    /// Sets the next boundary of an axis from the current cell.
    fn aim(&mut self, axis: usize) {
        if self.step[axis] != 0 {
            let boundary = self.cell[axis] + i32::from(self.step[axis] > 0);
            self.next[axis] = self.crossing(axis, boundary);
        }
    }

    fn cross_next_boundary(&mut self) {
        let axis = first_minimum(self.next);
        // A start cell named by the caller may lie ahead of the origin by a rounding error.
        self.distance = self.next[axis].max(0.0);
        self.axis = Some(axis);
        self.cell[axis] += self.step[axis];
        self.aim(axis);
    }

    fn is_outside(&self) -> bool {
        self.cell.cmplt(IVec3::ZERO).any() || self.cell.cmpge(self.size).any()
    }

    /// Whether the grid lies behind on some axis, so that the ray can no longer reach it, or so far
    /// ahead that cell numbers would overflow.
    fn has_left(&self) -> bool {
        (0..3).any(|axis| {
            let (cell, step) = (self.cell[axis], self.step[axis]);
            (cell < 0 && step <= 0) || (cell >= self.size[axis] && step >= 0)
        }) || self.cell.cmplt(-FARTHEST).any()
            || self.cell.cmpgt(FARTHEST).any()
    }

    /// Crosses every boundary up to the one where the ray enters the grid; false if it never does.
    fn enter_grid(&mut self) -> bool {
        if self.has_left() {
            return false;
        }
        let mut last: Option<(f64, usize)> = None;
        for axis in 0..3 {
            let before = self.cell[axis] < 0;
            if before || self.cell[axis] >= self.size[axis] {
                let distance = self.crossing(axis, if before { 0 } else { self.size[axis] });
                if last.is_none_or(|(greatest, _)| distance >= greatest) {
                    last = Some((distance, axis));
                }
            }
        }
        if let Some((distance, axis)) = last {
            let inner = if self.step[axis] > 0 {
                0
            } else {
                self.size[axis] - 1
            };
            // One cell beyond the grid is as good as any farther one: the ray has missed.
            let low = self.cell.min(IVec3::NEG_ONE);
            let high = self.cell.max(self.size);
            self.cross_all_before(distance, axis, inner, low, high);
        }
        !self.is_outside()
    }

    /// Crosses the empty box of voxels [low, high), which contains the current one.
    fn leave_box(&mut self, low: IVec3, high: IVec3) {
        let mut exits = DVec3::INFINITY;
        for axis in 0..3 {
            match self.step[axis] {
                0 => {}
                step => {
                    let boundary = if step > 0 { high[axis] } else { low[axis] };
                    exits[axis] = self.crossing(axis, boundary);
                }
            }
        }
        let axis = first_minimum(exits);
        let beyond = if self.step[axis] > 0 {
            high[axis]
        } else {
            low[axis] - 1
        };
        self.cross_all_before(exits[axis], axis, beyond, low, high - 1);
    }

    /// Makes the steps that a plain march would make up to and including the crossing of `axis` at
    /// `distance` into the coordinate `target`. A plain march takes crossings in the order of
    /// (distance, axis), so on each other axis exactly the earlier crossings are made. `low` and `high`
    /// (inclusive) bound the cells that the other axes may reach.
    fn cross_all_before(
        &mut self,
        distance: f64,
        axis: usize,
        target: i32,
        low: IVec3,
        high: IVec3,
    ) {
        for other in (0..3).filter(|&other| other != axis) {
            let step = self.step[other];
            if step == 0 {
                continue;
            }
            // A guess from the position, corrected exactly by comparing crossings, which are ordered.
            let guess = (self.origin[other] + distance * self.direction[other]).floor() as i32;
            let (first, last) = if step > 0 {
                (self.cell[other], high[other])
            } else {
                (low[other], self.cell[other])
            };
            self.cell[other] = guess.clamp(first, last);
            let comes_before = |at: f64| at < distance || (at == distance && other < axis);
            loop {
                let entered = self.cell[other] + i32::from(step < 0);
                let is_start = self.cell[other] == if step > 0 { first } else { last };
                if is_start || comes_before(self.crossing(other, entered)) {
                    break;
                }
                self.cell[other] -= step;
            }
            self.aim(other);
            let end = if step > 0 { last } else { first };
            while self.cell[other] != end && comes_before(self.next[other]) {
                self.cell[other] += step;
                self.aim(other);
            }
        }
        self.cell[axis] = target;
        self.aim(axis);
        self.distance = distance.max(0.0);
        self.axis = Some(axis);
    }

    /// The outcome of arriving in a solid voxel.
    fn arrived(&self, material: u8) -> Outcome {
        match self.axis {
            None => Outcome::Inside(material),
            Some(axis) => Outcome::Hit(Hit {
                voxel: self.cell,
                material,
                // A ray that goes up an axis hits the face that looks down it.
                face: 2 * axis as u8 + u8::from(self.step[axis] < 0),
                distance: self.distance,
            }),
        }
    }
}

/// Index of the smallest component, the first of equals.
fn first_minimum(v: DVec3) -> usize {
    if v.x <= v.y && v.x <= v.z {
        0
    } else if v.y <= v.z {
        1
    } else {
        2
    }
}
