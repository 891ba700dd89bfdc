//! All that free bodies meet at one moment, and their moves in it.

use std::sync::Arc;

use glam::{DVec3, I64Vec3, IVec3};

use super::{
    Aabb, Boxes, LEAST_SHARE, Measures, ONE, Obstacles, Pusher, QUANTUM, Terrain, meet, to_units,
    to_voxels, whole_quanta,
};

/// How far a body gives way to one that moves into it, at most (units).
const LONGEST: i64 = 2 * ONE;
/// What bears a body may sink by this much in a step (units), and the body stays on it.
const SINKING: i64 = ONE / 4;
/// The directions in which it gives way: up first, never down.
const WAYS: [(usize, i64); 5] = [(1, 1), (0, 1), (0, -1), (2, 1), (2, -1)];

/// Free bodies, and all that stops them.
pub struct Scene<'a, T> {
    pub stone: &'a T,
    /// Bodies that are not free.
    pub others: &'a Obstacles<'a>,
    /// Of each body that is free.
    pub boxes: Vec<Option<Arc<Boxes>>>,
    /// Where the pivots of all bodies are.
    pub at: Vec<I64Vec3>,
    pub player: Option<Aabb>,
}

impl<T: Terrain> Terrain for Scene<'_, T> {
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.stone.is_solid(voxel)
    }

    fn in_the_way(&self) -> &Obstacles<'_> {
        self.others
    }
}

impl<T: Terrain> Scene<'_, T> {
    /// Moves a body that the player walks against, and returns how fast it went along each axis (voxels per second).
    pub fn push(&mut self, index: usize, player: &Pusher, measures: &Measures, dt_s: f64) -> DVec3 {
        let mut went = DVec3::ZERO;
        for axis in [0, 2] {
            let share = player.course[axis];
            if share.abs() < LEAST_SHARE {
                continue;
            }
            let sign = share.signum();
            // The speed of sneaking: nobody pushes as fast as they walk.
            let speed = measures.sneak * share.abs();
            // As far as the player may come in this step, so that the body moves before it stops him.
            let reach_s = (player.velocity[axis] * sign).max(speed) * dt_s;
            let reach = to_units(reach_s) + 2 * QUANTUM;
            let before = player.shape.along(axis, sign as i64 * reach);
            let is_pushed = self.meets(index, &before) && !self.meets(index, &player.shape);
            if !is_pushed || !self.snap(index) {
                continue;
            }
            let way = sign as i64 * whole_quanta(speed * dt_s).max(QUANTUM);
            let free = self.sweep(index, axis, way, self.player);
            self.at[index][axis] += free;
            went[axis] = to_voxels(free) / dt_s;
        }
        went
    }

    /// Lets a body fall, and returns whether something bears it. `fall`: its speed downwards (voxels per second).
    pub fn fall(&mut self, index: usize, fall: &mut f64, measures: &Measures, dt_s: f64) -> bool {
        if !self.snap(index) || self.sweep(index, 1, -QUANTUM, self.player) == 0 {
            *fall = 0.0;
            return true;
        }
        let way = *fall * dt_s + 0.5 * measures.gravity * dt_s * dt_s;
        *fall = (*fall + measures.gravity * dt_s).min(measures.fastest_fall);
        let way = -whole_quanta(way);
        let free = self.sweep(index, 1, way, self.player);
        self.at[index].y += free;
        if free != way {
            *fall = 0.0;
        }
        false
    }

    /// Whether a body that is not free bears it.
    pub fn rides(&self, index: usize) -> bool {
        let way = -2 * QUANTUM;
        let mut own = self.own(index);
        !self.others.is_empty() && own.any(|own| self.others.sweep(&own, 1, way) != way)
    }

    /// Stays on what it rides.
    pub fn sink(&mut self, index: usize) {
        let sunk = self.sweep(index, 1, -SINKING, self.player);
        if sunk != -SINKING {
            self.at[index].y += sunk;
        }
    }

    /// Lets a body give way to one that moved into it: the shortest way without stone or another free body in between, up
    /// if none is shorter. Where there is none, it stays. The player gives way by himself.
    pub fn give_way(&mut self, index: usize) {
        if self.others.is_empty() || !self.is_taken(index) {
            return;
        }
        let Some(boxes) = self.boxes[index].clone() else {
            return;
        };
        let at = self.at[index];
        let ways = WAYS.into_iter().filter_map(|(axis, sign)| {
            let out = |own: &Aabb| self.others.way_out(&own.moved(at), axis, sign, LONGEST);
            let ways: Option<Vec<i64>> = boxes.boxes.iter().map(out).collect();
            let way = ways?.into_iter().max()?;
            let way = sign * ((way + QUANTUM - 1) / QUANTUM * QUANTUM);
            // What moved into it does not stop it.
            (self.sweep_alone(index, axis, way, None) == way).then_some((axis, way))
        });
        if let Some((axis, way)) = ways.min_by_key(|(_, way)| way.abs()) {
            self.at[index][axis] += way;
            if self.is_taken(index) {
                self.at[index] = at;
            }
        }
    }

    pub fn is_near_player(&self, index: usize) -> bool {
        let (Some(player), Some(boxes)) = (&self.player, &self.boxes[index]) else {
            return false;
        };
        let around = Aabb {
            min: player.min - ONE,
            max: player.max + ONE,
        };
        meet(&boxes.bounds.moved(self.at[index]), &around)
    }

    /// Whether a body that is not free overlaps it.
    fn is_taken(&self, index: usize) -> bool {
        self.own(index).any(|own| self.others.overlaps(&own))
    }

    fn own(&self, index: usize) -> impl Iterator<Item = Aabb> {
        let at = self.at[index];
        let boxes = self.boxes[index].iter().flat_map(|boxes| &boxes.boxes);
        boxes.map(move |own| own.moved(at))
    }

    fn meets(&self, index: usize, shape: &Aabb) -> bool {
        self.own(index).any(|own| meet(&own, shape))
    }

    /// Brings a body to a place of whole quanta, and returns whether it is at one: there may be no room.
    fn snap(&mut self, index: usize) -> bool {
        for axis in 0..3 {
            let past = self.at[index][axis].rem_euclid(QUANTUM);
            if past == 0 {
                continue;
            }
            let mut ways = [-past, QUANTUM - past].into_iter();
            let is_free = |way: &i64| self.exact_sweep(index, axis, *way, self.player) == *way;
            let Some(way) = ways.find(is_free) else {
                return false;
            };
            self.at[index][axis] += way;
        }
        true
    }

    /// How far a body can move along an axis, in whole quanta: to stone, another body or `player`. What it is in already
    /// does not stop it.
    fn sweep(&self, index: usize, axis: usize, way: i64, player: Option<Aabb>) -> i64 {
        let free = self.exact_sweep(index, axis, way, player);
        free - free % QUANTUM
    }

    fn exact_sweep(&self, index: usize, axis: usize, way: i64, player: Option<Aabb>) -> i64 {
        let free = self.sweep_alone(index, axis, way, player);
        self.own(index)
            .fold(free, |free, own| self.others.sweep(&own, axis, free))
    }

    /// The same without bodies that are not free.
    fn sweep_alone(&self, index: usize, axis: usize, way: i64, player: Option<Aabb>) -> i64 {
        let mut free = way;
        for own in self.own(index) {
            free = own.sweep_voxels(self.stone, axis, free);
            if free == 0 {
                return 0;
            }
            free = player.map_or(free, |player| gap(&own, &player, axis, free));
        }
        let Some(boxes) = &self.boxes[index] else {
            return free;
        };
        let passed = boxes.bounds.moved(self.at[index]).along(axis, free);
        for (other, boxes) in self.boxes.iter().enumerate() {
            let Some(boxes) = boxes.as_ref().filter(|_| other != index) else {
                continue;
            };
            let bounds = boxes.bounds.moved(self.at[other]);
            if !meet(&bounds, &passed) {
                continue;
            }
            let near: Vec<Aabb> = self
                .own(other)
                .filter(|other| meet(other, &passed))
                .collect();
            for own in self.own(index) {
                if meet(&own.along(axis, free), &bounds) {
                    let stops = near.iter();
                    free = stops.fold(free, |free, other| gap(&own, other, axis, free));
                }
            }
        }
        free
    }
}

/// How far a box can move along an axis until it touches another, which does not stop it if they overlap.
fn gap(own: &Aabb, other: &Aabb, axis: usize, way: i64) -> i64 {
    let is_beside = |side: usize| {
        side != axis && (own.max[side] <= other.min[side] || own.min[side] >= other.max[side])
    };
    if (0..3).any(is_beside) {
        return way;
    }
    let ahead = other.min[axis] - own.max[axis];
    let behind = other.max[axis] - own.min[axis];
    match way {
        1.. if ahead >= 0 => way.min(ahead),
        ..=0 if behind <= 0 => way.max(behind),
        _ => way,
    }
}
