//! Free bodies: those that stand where they were put, until a player pushes them. They slide over the ground, fall, and
//! stop at voxels, at the edges of the world, at other bodies and at the player. They move along the axes and never
//! turn.
//!
//! A step happens before each step of the player. Places are whole multiples of [`QUANTUM`], which `f32` holds exactly, so
//! the picture shows the very place that the simulation knows.

mod boxes;
mod scene;
#[cfg(test)]
mod tests;

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DVec3, I64Vec3, IVec3};

use super::{
    measures::Measures,
    obstacles::Obstacles,
    sweep::{Aabb, ONE, point_to_units, to_units, to_voxels},
    terrain::Terrain,
};
use crate::world::bodies::{Bodies, PutBy, WholeBody};
use boxes::{Boxes, parts};
use scene::Scene;

/// Ways of free bodies are multiples of this (units): 1/1024 voxel.
pub const QUANTUM: i64 = ONE >> 10;
/// Bodies farther than this from the origin (voxels) cannot be pushed: `f32` would round their places.
const FARTHEST: f32 = 16_000.0;
/// A course with a smaller share along an axis does not push along it.
const LEAST_SHARE: f64 = 0.05;

/// The player, as free bodies meet him.
#[derive(Clone, Copy, Debug)]
pub struct Pusher {
    pub shape: Aabb,
    /// Where he wants to go: a unit vector, or zero.
    pub course: DVec3,
    /// Voxels per second.
    pub velocity: DVec3,
}

/// What a step of the free bodies did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moved {
    /// Whether any body moved.
    pub any: bool,
    /// How fast what the player pushed went along each axis (voxels per second).
    pub pushed: DVec3,
}

/// Boxes that free bodies take.
#[derive(Clone, Debug, Default)]
pub struct Taken(Vec<Aabb>);

impl Taken {
    /// All voxels (world space) of which a part is taken. Some come more than once.
    pub fn voxels(&self) -> impl Iterator<Item = IVec3> {
        self.0.iter().flat_map(|own| {
            let (low, high) = own.voxels();
            let rows = (low.z..=high.z).flat_map(move |z| (low.y..=high.y).map(move |y| (y, z)));
            rows.flat_map(move |(y, z)| (low.x..=high.x).map(move |x| IVec3::new(x, y, z)))
        })
    }

    /// Whether a part of a voxel (world space) is taken.
    pub fn has(&self, voxel: IVec3) -> bool {
        let low = voxel.as_i64vec3() * ONE;
        let shape = Aabb {
            min: low,
            max: low + ONE,
        };
        self.0.iter().any(|own| meet(own, &shape))
    }
}

/// What is known of the bodies of a world besides their places. In the order of [`Bodies::bodies`].
#[derive(Clone, Debug, Default)]
pub struct FreeBodies {
    states: Vec<State>,
}

#[derive(Clone, Debug)]
struct State {
    name: String,
    /// `None` for a body that moves by itself, or is turned between the axes: it is an obstacle.
    boxes: Option<Arc<Boxes>>,
    /// Speed of its fall (voxels per second, downwards).
    fall: f64,
    /// Whether a body that may sink bears it.
    rides: bool,
    /// Nothing has changed around it since it was borne.
    is_at_rest: bool,
}

impl FreeBodies {
    pub fn of(bodies: &Bodies) -> Self {
        let mut all = Self::default();
        all.follow(bodies);
        all
    }

    /// Takes the bodies of a world to which some were added, or from which some were removed. Those that fall keep
    /// falling.
    pub fn follow(&mut self, bodies: &Bodies) {
        let parts: Vec<_> = bodies.models.iter().map(parts).collect();
        let old = std::mem::take(&mut self.states).into_iter();
        let falls: HashMap<String, f64> = old.map(|state| (state.name, state.fall)).collect();
        let states = bodies.bodies.iter().map(|body| {
            let is_free = body.is_still() && body.rest.position.abs().max_element() < FARTHEST;
            let boxes = is_free.then(|| Boxes::of(body, &parts[body.model]));
            State {
                name: body.name.clone(),
                boxes: boxes.flatten().map(Arc::new),
                fall: falls.get(&body.name).copied().unwrap_or(0.0),
                rides: false,
                is_at_rest: false,
            }
        });
        self.states = states.collect();
    }

    /// Whether any body could be pushed.
    pub fn exist(&self) -> bool {
        self.states.iter().any(|state| state.boxes.is_some())
    }

    /// Voxels were changed: what bore a body may be gone.
    pub fn wake(&mut self) {
        for state in &mut self.states {
            state.is_at_rest = false;
        }
    }

    /// Moves all free bodies by a step that ends at world time `time_s`. `stone` is solid outside of the world, too.
    pub fn step(
        &mut self,
        bodies: &mut Bodies,
        stone: &impl Terrain,
        time_s: f64,
        player: Option<&Pusher>,
        measures: &Measures,
        dt_s: f64,
    ) -> Moved {
        let mut moved = Moved::default();
        let before: Vec<I64Vec3> = places(bodies);
        let after = {
            let boxes = self.states.iter().map(|state| state.boxes.clone());
            let boxes: Vec<_> = boxes.collect();
            let others = Obstacles::of(bodies, time_s, |index| boxes[index].is_none());
            let mut scene = Scene {
                stone,
                others: &others,
                boxes: boxes.clone(),
                at: before.clone(),
                player: player.map(|player| player.shape),
            };
            for (index, state) in self.states.iter_mut().enumerate() {
                if state.boxes.is_none() {
                    continue;
                }
                if let Some(player) = player {
                    let pushed = scene.push(index, player, measures, dt_s);
                    moved.pushed = DVec3::select(pushed.cmpne(DVec3::ZERO), pushed, moved.pushed);
                }
                let is_pushed = scene.at[index] != before[index];
                if bodies.bodies[index].put_by != PutBy::WorldFile || is_pushed {
                    state.is_at_rest &= !is_pushed && others.is_empty();
                    if !state.is_at_rest {
                        if state.rides {
                            scene.sink(index);
                        }
                        scene.give_way(index);
                        state.is_at_rest = scene.fall(index, &mut state.fall, measures, dt_s)
                            && others.is_empty()
                            && !scene.is_near_player(index);
                        state.rides = scene.rides(index);
                    }
                }
            }
            scene.at
        };
        for index in 0..before.len() {
            if after[index] == before[index] {
                continue;
            }
            moved.any = true;
            let body = &mut bodies.bodies[index];
            body.rest.position = DVec3::from(after[index].to_array().map(to_voxels)).as_vec3();
            if body.put_by == PutBy::WorldFile {
                body.put_by = PutBy::Pushed;
            }
            self.wake_around(index, &before, &after);
        }
        moved
    }

    /// What a body bore, or stopped, is not at rest when that body moves.
    fn wake_around(&mut self, moved: usize, before: &[I64Vec3], after: &[I64Vec3]) {
        let Some(boxes) = self.states[moved].boxes.clone() else {
            return;
        };
        let (from, to) = (
            boxes.bounds.moved(before[moved]),
            boxes.bounds.moved(after[moved]),
        );
        let around = Aabb {
            min: from.min.min(to.min) - ONE,
            max: from.max.max(to.max) + ONE,
        };
        for (index, state) in self.states.iter_mut().enumerate() {
            if let Some(boxes) = &state.boxes {
                let own = boxes.bounds.moved(after[index]);
                state.is_at_rest &= index != moved && !meet(&own, &around);
            }
        }
    }

    /// What free bodies other than `except` take between two voxels (world space, both ends inclusive).
    pub fn within(&self, bodies: &Bodies, [low, high]: [IVec3; 2], except: Option<usize>) -> Taken {
        let region = Aabb {
            min: low.as_i64vec3() * ONE,
            max: (high.as_i64vec3() + 1) * ONE,
        };
        let others = self
            .placed(bodies)
            .filter(|(index, ..)| Some(*index) != except);
        let near = others.filter(|(_, at, boxes)| meet(&boxes.bounds.moved(*at), &region));
        let boxes =
            near.flat_map(|(_, at, boxes)| boxes.boxes.iter().map(move |own| own.moved(at)));
        Taken(boxes.filter(|own| meet(own, &region)).collect())
    }

    /// Whether a body would stand inside a free body other than `except`.
    pub fn has_in_the_way(
        &self,
        bodies: &Bodies,
        whole: &WholeBody,
        except: Option<usize>,
    ) -> bool {
        let own = whole.boxes();
        let others = self
            .placed(bodies)
            .filter(|(index, ..)| Some(*index) != except);
        let mut others =
            others.flat_map(|(_, at, boxes)| boxes.boxes.iter().map(move |b| b.moved(at)));
        others.any(|other| own.iter().any(|own| meet(own, &other)))
    }

    /// The bodies that are not free, at a world time (seconds).
    pub fn others<'a>(&self, bodies: &'a Bodies, time_s: f64) -> Obstacles<'a> {
        Obstacles::of(bodies, time_s, |index| self.states[index].boxes.is_none())
    }

    /// The free body that a ray (world space, unit direction) meets first, and how far away (voxels).
    pub fn met(&self, bodies: &Bodies, origin: DVec3, direction: DVec3) -> Option<(usize, f64)> {
        let near = self.placed(bodies).filter_map(|(index, at, boxes)| {
            let enters = |own: &Aabb| enters(&own.moved(at), origin, direction);
            enters(&boxes.bounds)?;
            let met = boxes.boxes.iter().filter_map(enters);
            Some((index, met.min_by(f64::total_cmp)?))
        });
        near.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The lowest and the highest corner of a free body (world space, voxels).
    pub fn bounds(&self, bodies: &Bodies, index: usize) -> Option<[DVec3; 2]> {
        let (_, at, boxes) = self.placed(bodies).find(|(found, ..)| *found == index)?;
        let bounds = boxes.bounds.moved(at);
        Some([bounds.min, bounds.max].map(|at| DVec3::from(at.to_array().map(to_voxels))))
    }

    /// The free bodies: their indices, where their pivots are, and their boxes.
    fn placed<'a>(
        &'a self,
        bodies: &'a Bodies,
    ) -> impl Iterator<Item = (usize, I64Vec3, &'a Boxes)> {
        let all = self.states.iter().zip(&bodies.bodies).enumerate();
        all.filter_map(|(index, (state, body))| {
            let boxes = state.boxes.as_deref()?;
            Some((index, point_to_units(body.rest.position.as_dvec3()), boxes))
        })
    }
}

fn places(bodies: &Bodies) -> Vec<I64Vec3> {
    let places = bodies.bodies.iter().map(|body| body.rest.position);
    places.map(|at| point_to_units(at.as_dvec3())).collect()
}

impl WholeBody {
    /// Boxes that the body takes (world space); none if its axes lie between those of the world.
    fn boxes(&self) -> Vec<Aabb> {
        let at = point_to_units(self.body.rest.position.as_dvec3());
        let boxes = Boxes::of(&self.body, &parts(&self.model));
        let boxes = boxes.map_or_else(Vec::new, |boxes| boxes.boxes);
        boxes.into_iter().map(|own| own.moved(at)).collect()
    }

    /// What the body takes.
    pub fn taken(&self) -> Taken {
        Taken(self.boxes())
    }
}

/// Whether two boxes share more than a face.
fn meet(a: &Aabb, b: &Aabb) -> bool {
    a.min.cmplt(b.max).all() && b.min.cmplt(a.max).all()
}

/// How far away (voxels) a ray enters a box: 0 from inside, `None` if it misses. By slabs (Kay & Kajiya 1986).
fn enters(shape: &Aabb, origin: DVec3, direction: DVec3) -> Option<f64> {
    let [low, high] = [shape.min, shape.max].map(|at| DVec3::from(at.to_array().map(to_voxels)));
    let (mut first, mut last) = (0.0f64, f64::INFINITY);
    for axis in 0..3 {
        if direction[axis] == 0.0 {
            if origin[axis] <= low[axis] || origin[axis] >= high[axis] {
                return None;
            }
            continue;
        }
        let [a, b] = [low, high].map(|end| (end[axis] - origin[axis]) / direction[axis]);
        first = first.max(a.min(b));
        last = last.min(a.max(b));
    }
    (first < last).then_some(first)
}

/// A length in voxels as units, without what is less than a quantum.
fn whole_quanta(voxels: f64) -> i64 {
    let units = to_units(voxels);
    units - units % QUANTUM
}
