//! Worlds and bodies for tests: `wander` checks random moves by brute force, `walk` asks one question each.

mod moved;
mod walk;
mod wander;

use std::collections::HashSet;

use glam::{DVec3, IVec3};

use super::{Body, Intent, Measures, Terrain};

pub(super) const DT_S: f64 = 1.0 / 120.0;
pub(super) const HEIGHT: f64 = 1.77;
/// Edge of the random worlds (voxels); their outermost layer is solid.
pub(super) const EDGE: i32 = 16;

/// Every voxel of a small world; everything else is solid or air.
#[derive(Clone)]
pub(super) struct Grid {
    solid: Vec<bool>,
    pub(super) outside: bool,
}

impl Grid {
    pub(super) fn new(solid: impl Fn(IVec3) -> bool) -> Self {
        let all = 0..EDGE * EDGE * EDGE;
        Self {
            solid: all.map(|index| solid(voxel(index))).collect(),
            outside: false,
        }
    }

    /// A closed room, with a share of its voxels solid, and a block of air in the middle to start in.
    pub(super) fn room(share: f64, seed: u64) -> Self {
        let inner = 1..EDGE - 1;
        Self::new(|at| {
            let is_inside = at.to_array().iter().all(|n| inner.contains(n));
            let is_start = (at - EDGE / 2).abs().max_element() <= 2;
            !is_inside || (!is_start && Random(seed ^ ((index(at) as u64) << 32)).share() < share)
        })
    }

    pub(super) fn set(&mut self, at: IVec3, solid: bool) {
        self.solid[index(at)] = solid;
    }

    /// The voxels of air that can be reached from `start` through faces.
    fn connected(&self, start: IVec3) -> HashSet<IVec3> {
        let mut found = HashSet::from([start]);
        let mut next = vec![start];
        while let Some(at) = next.pop() {
            for to in [IVec3::X, IVec3::Y, IVec3::Z]
                .into_iter()
                .flat_map(|n| [at + n, at - n])
            {
                if !self.is_solid(to) && found.insert(to) {
                    next.push(to);
                }
            }
        }
        found
    }
}

fn voxel(index: i32) -> IVec3 {
    IVec3::new(index % EDGE, index / EDGE % EDGE, index / (EDGE * EDGE))
}

fn index(at: IVec3) -> usize {
    (at.x + EDGE * (at.y + EDGE * at.z)) as usize
}

impl Terrain for Grid {
    fn is_solid(&self, at: IVec3) -> bool {
        match at.to_array().iter().all(|n| (0..EDGE).contains(n)) {
            true => self.solid[index(at)],
            false => self.outside,
        }
    }
}

/// splitmix64 (Steele et al. 2014).
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub(super) fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// −1, 0 or 1.
    fn sign(&mut self) -> i8 {
        (self.next() % 3) as i8 - 1
    }

    pub(super) fn intent(&mut self) -> Intent {
        let yaw = self.share() * std::f64::consts::TAU;
        let pitch = (self.share() - 0.5) * 3.0;
        let level = DVec3::new(yaw.sin(), 0.0, yaw.cos());
        Intent {
            forward: self.sign(),
            right: self.sign(),
            up: self.next().is_multiple_of(3),
            down: self.next().is_multiple_of(4),
            run: self.next().is_multiple_of(2),
            heading: level * pitch.cos() + DVec3::Y * pitch.sin(),
            rightwards: DVec3::new(-level.z, 0.0, level.x),
            // Up to twenty voxels in one step.
            fly_speed: 4.0 * 600.0f64.powf(self.share()),
        }
    }
}

fn body_at(eye: DVec3, terrain: &impl Terrain) -> Body {
    Body::with_eye_at(eye, Measures::of_height(HEIGHT), 0.0, terrain)
}

/// A body in the middle of a room.
fn in_the_middle(terrain: &impl Terrain) -> Body {
    body_at(DVec3::splat(f64::from(EDGE) / 2.0) + 0.5, terrain)
}

/// Walks or flies straight ahead.
pub(super) fn ahead(heading: DVec3) -> Intent {
    Intent {
        forward: 1,
        heading,
        rightwards: DVec3::Z,
        fly_speed: 4.0,
        ..Intent::default()
    }
}
