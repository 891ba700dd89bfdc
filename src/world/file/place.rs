//! Places for scattered things: on the floors and under the ceilings of a shape.

use std::collections::HashMap;

use glam::{DVec3, IVec2, IVec3, Vec3};
use rayon::prelude::*;

use super::schema::Ground;
use crate::world::materials::hash::{hash, unit};
use crate::world::sdf::Shape;

/// Places tried per requested thing before the scatter gives up.
const TRIES: u32 = 32;

/// Most places tried at a time; if a batch of this size finds none, the scatter gives up.
const BATCH: u32 = 4096;

/// Fewest places tried at a time, and most for each place that is missing.
const LEAST_BATCH: u32 = 16;
const MOST_AHEAD: u32 = 16;

/// The requirements of a scatter.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ask {
    pub count: u32,
    /// Lowest and highest corner, world space.
    pub bounds: (Vec3, Vec3),
    pub ground: Ground,
    /// Free voxels above the floor or below the ceiling.
    pub clearance: u32,
    /// Least horizontal distance between two places, voxels.
    pub spacing: f32,
    pub seed: u32,
}

/// A suitable place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    /// The free voxel on the floor or under the ceiling.
    pub voxel: IVec3,
    /// A hash for further random choices at this place.
    pub chance: u32,
}

/// Places that scatters have tried, so that scatters with the same seed and bounds look at each column once. The world's
/// shape must be the same for all.
#[derive(Default)]
pub(super) struct Tried {
    scatters: Vec<(Ask, Vec<Option<Found>>)>,
}

impl Tried {
    /// The candidates of `ask` so far: a batch begins where they end, or has been tried.
    fn of(&mut self, ask: &Ask) -> &mut Vec<Option<Found>> {
        let alike = |(other, _): &(Ask, Vec<Option<Found>>)| other.has_same_columns(ask);
        let place = self.scatters.iter().position(alike).unwrap_or_else(|| {
            self.scatters.push((ask.clone(), Vec::new()));
            self.scatters.len() - 1
        });
        &mut self.scatters[place].1
    }
}

/// The occupied places, in squares of the plane as wide as the spacing.
struct Taken {
    spacing: f32,
    squares: HashMap<IVec2, Vec<IVec3>>,
}

impl Taken {
    fn new(spacing: f32) -> Self {
        Self {
            spacing,
            squares: HashMap::new(),
        }
    }

    /// Occupies a place, unless it is occupied or too close to an occupied one.
    fn take(&mut self, voxel: IVec3) -> bool {
        let plane = IVec2::new(voxel.x, voxel.z);
        let square = (plane.as_vec2() / self.spacing.max(1.0)).floor().as_ivec2();
        let near = |other: &IVec3| {
            let between = (IVec2::new(other.x, other.z) - plane).as_vec2();
            between.length() < self.spacing || *other == voxel
        };
        for x in -1..=1 {
            for z in -1..=1 {
                let others = self.squares.get(&(square + IVec2::new(x, z)));
                if others.is_some_and(|others| others.iter().any(near)) {
                    return false;
                }
            }
        }
        self.squares.entry(square).or_default().push(voxel);
        true
    }
}

impl Ask {
    /// Finds up to `count` places. The same for the same seed and shape, on any number of threads.
    pub fn places(
        &self,
        shape: &Shape,
        world: (IVec3, IVec3),
        tried_before: &mut Tried,
    ) -> Vec<Found> {
        let known = tried_before.of(self);
        let mut found: Vec<Found> = Vec::new();
        let mut taken = Taken::new(self.spacing);
        let most = self.count.saturating_mul(TRIES);
        let mut tried = 0;
        while found.len() < self.count as usize && tried < most {
            let missing = self.count - found.len() as u32;
            let batch = tried..most.min(tried + batch_size(missing, tried, found.len() as u32));
            let before = found.len();
            tried = batch.end;
            let full = batch.len() as u32 == BATCH;
            let unknown = (known.len() as u32).max(batch.start)..batch.end;
            known.par_extend(
                unknown
                    .into_par_iter()
                    .map(|index| self.candidate(index, shape, world)),
            );
            for candidate in known[batch.start as usize..batch.end as usize]
                .iter()
                .flatten()
            {
                if found.len() < self.count as usize && taken.take(candidate.voxel) {
                    found.push(*candidate);
                }
            }
            if full && found.len() == before {
                break;
            }
        }
        found
    }

    /// Whether another scatter finds the same floors (ceilings) in the same order.
    fn has_same_columns(&self, other: &Self) -> bool {
        let columns = |ask: &Self| Self {
            count: 0,
            spacing: 0.0,
            ..ask.clone()
        };
        columns(self) == columns(other)
    }

    /// The lowest and highest voxels that decide about places within the bounds: with the floor below, or the ceiling
    /// above, and with room for the clearance.
    fn range(&self, world: (IVec3, IVec3)) -> (i32, i32) {
        let clearance = i32::try_from(self.clearance).unwrap_or(i32::MAX);
        let (below, above) = match self.ground {
            Ground::Floor => (1, clearance),
            Ground::Ceiling => (clearance, 1),
        };
        let low = (self.bounds.0.y.floor() as i32).saturating_sub(below);
        let high = (self.bounds.1.y.ceil() as i32).saturating_add(above);
        (low.max(world.0.y), high.min(world.1.y))
    }

    /// A random column, and in it a random floor (ceiling).
    fn candidate(&self, index: u32, shape: &Shape, world: (IVec3, IVec3)) -> Option<Found> {
        let first = hash(self.seed ^ hash(index));
        let (x, z) = (hash(first), hash(first ^ 0x9e37_79b9));
        let along = Vec3::new(unit(x), 0.0, unit(z));
        let (low, high) = self.bounds;
        let place = (low + along * (high - low)).floor().as_ivec3();
        let place = place.clamp(world.0, world.1 - 1);
        let mut spots = Vec::new();
        let (lowest, highest) = self.range(world);
        let mut start = lowest;
        let mut solid_below = false;
        for (end, solid) in column(shape, place.x, place.z, lowest, highest) {
            if !solid {
                let solid_above = end < world.1.y;
                let free = end - start;
                let (touches, y) = match self.ground {
                    Ground::Floor => (solid_below, start),
                    Ground::Ceiling => (solid_above, end - 1),
                };
                // Above the top of the world there is enough room.
                let open = self.ground == Ground::Floor && !solid_above;
                let within = (low.y..high.y).contains(&(y as f32));
                if touches && within && (open || free >= self.clearance as i32) {
                    spots.push(y);
                }
            }
            solid_below = solid;
            start = end;
        }
        let chance = hash(x ^ z);
        let y = *spots.get(chance as usize % spots.len().max(1))?;
        Some(Found {
            voxel: place.with_y(y),
            chance: hash(chance),
        })
    }
}

/// How many candidates to try next: about as many as the share of suitable ones so far says, so that all threads have work
/// where few are suitable. Sizes below BATCH change no result: only a batch of BATCH candidates without a place ends the
/// search early, and such a batch is tried only while at least BATCH places are missing.
fn batch_size(missing: u32, tried: u32, found: u32) -> u32 {
    if missing >= BATCH {
        return BATCH;
    }
    let tries_per_place = (tried / found.max(1)).clamp(1, MOST_AHEAD);
    (missing * tries_per_place).clamp(LEAST_BATCH, BATCH - 1)
}

/// Runs of equal voxels up a column, as (first voxel above the run, whether the run is solid). Skips
/// all voxels that the Lipschitz constant proves to be equal to the last one.
fn column(shape: &Shape, x: i32, z: i32, low: i32, high: i32) -> Vec<(i32, bool)> {
    let lipschitz = shape.lipschitz();
    let mut runs = Vec::new();
    let mut last = None;
    let mut y = low;
    while y < high {
        let centre = DVec3::new(f64::from(x), f64::from(y), f64::from(z)) + 0.5;
        let value = shape.eval(centre);
        let solid = value < 0.0;
        if let Some(before) = last
            && before != solid
        {
            runs.push((y, before));
        }
        last = Some(solid);
        // No sign change within |value| / lipschitz; 0/0 counts as one voxel.
        let safe = (value.abs() / lipschitz - 1e-6).ceil().max(1.0);
        y = y.saturating_add(safe.min(f64::from(high - low)) as i32);
    }
    runs.extend(last.map(|solid| (high, solid)));
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::noise::{Basis, Fractal, NoiseField};
    use crate::world::sdf::{Cuboid, Cylinder, Displace, Empty, Sdf, Subtraction, Union};

    const WORLD: (IVec3, IVec3) = (IVec3::splat(-32), IVec3::splat(32));

    /// A cave with an uneven floor and ceiling, and a pillar.
    fn cave() -> Shape {
        let noise = NoiseField {
            name: "floor".into(),
            basis: Basis::Perlin,
            fractal: Fractal::None,
            frequency: DVec3::splat(0.1),
            offset: DVec3::ZERO,
            seed: 5,
        };
        let air = Sdf::from(Displace {
            noise: 0,
            amplitude: 4.0,
            of: Box::new(Sdf::from(Cuboid {
                half: DVec3::new(26.0, 12.0, 26.0),
            })),
        });
        let rock = Sdf::from(Subtraction(vec![
            Sdf::from(Cuboid {
                half: DVec3::splat(40.0),
            }),
            air,
        ]));
        let pillar = Sdf::from(Cylinder {
            radius: 3.0,
            half_height: 40.0,
        });
        Shape::new(&Sdf::from(Union(vec![rock, pillar])), &[noise])
    }

    fn is_solid(shape: &Shape, voxel: IVec3) -> bool {
        shape.eval(voxel.as_dvec3() + 0.5) < 0.0
    }

    #[test]
    fn columns_skip_no_change_of_sign() {
        let shape = cave();
        for (x, z) in [(0, 0), (2, 3), (-13, 7), (25, -25), (31, 31), (-30, 4)] {
            let mut start = WORLD.0.y;
            for (end, solid) in column(&shape, x, z, WORLD.0.y, WORLD.1.y) {
                for y in start..end {
                    let voxel = IVec3::new(x, y, z);
                    assert_eq!(is_solid(&shape, voxel), solid, "{voxel}");
                }
                start = end;
            }
            assert_eq!(start, WORLD.1.y);
        }
    }

    fn ask(ground: Ground) -> Ask {
        Ask {
            count: 60,
            bounds: (Vec3::splat(-24.0), Vec3::splat(24.0)),
            ground,
            clearance: 6,
            spacing: 3.0,
            seed: 1,
        }
    }

    #[test]
    fn places_lie_on_floors_and_ceilings_with_clearance_and_spacing() {
        let shape = cave();
        for (ground, away) in [(Ground::Floor, IVec3::Y), (Ground::Ceiling, IVec3::NEG_Y)] {
            let places = ask(ground).places(&shape, WORLD, &mut Tried::default());
            assert_eq!(places.len(), 60);
            for (index, place) in places.iter().enumerate() {
                assert!(is_solid(&shape, place.voxel - away), "{place:?}");
                for step in 0..6 {
                    assert!(!is_solid(&shape, place.voxel + away * step), "{place:?}");
                }
                for other in &places[..index] {
                    let between = (other.voxel - place.voxel).with_y(0).as_vec3();
                    assert!(between.length() >= 3.0, "{place:?} {other:?}");
                }
            }
        }
    }

    #[test]
    fn columns_that_were_tried_before_give_the_same_places() {
        let shape = cave();
        let mut tried = Tried::default();
        for (count, spacing) in [(60, 3.0), (10, 3.0), (90, 1.0), (60, 5.0)] {
            let ask = Ask {
                count,
                spacing,
                ..ask(Ground::Floor)
            };
            let alone = ask.places(&shape, WORLD, &mut Tried::default());
            assert_eq!(ask.places(&shape, WORLD, &mut tried), alone, "{count}");
        }
    }

    #[test]
    fn narrow_bounds_find_what_wide_bounds_find_there() {
        let shape = cave();
        for ground in [Ground::Floor, Ground::Ceiling] {
            let within = |low: f32, high: f32| Ask {
                count: 4000,
                spacing: 0.0,
                bounds: (Vec3::new(-24.0, low, -24.0), Vec3::new(24.0, high, 24.0)),
                ..ask(ground)
            };
            let found = |ask: Ask| -> Vec<IVec3> {
                let places = ask.places(&shape, WORLD, &mut Tried::default());
                places.into_iter().map(|found| found.voxel).collect()
            };
            let (low, high) = (-16, 14);
            let mut wide = found(within(-32.0, 32.0));
            wide.retain(|voxel| (low..high).contains(&voxel.y));
            let mut narrow = found(within(low as f32, high as f32));
            wide.sort_by_key(IVec3::to_array);
            narrow.sort_by_key(IVec3::to_array);
            assert!(wide.len() > 100);
            assert!(wide.iter().all(|voxel| {
                narrow
                    .binary_search_by_key(&voxel.to_array(), IVec3::to_array)
                    .is_ok()
            }));
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_places_and_a_full_world_none() {
        let shape = cave();
        let places = ask(Ground::Floor).places(&shape, WORLD, &mut Tried::default());
        assert_eq!(
            places,
            ask(Ground::Floor).places(&shape, WORLD, &mut Tried::default())
        );
        let other = Ask {
            seed: 2,
            ..ask(Ground::Floor)
        };
        assert_ne!(places, other.places(&shape, WORLD, &mut Tried::default()));
        let crowded = Ask {
            count: 100_000,
            ..ask(Ground::Floor)
        };
        let crowded = crowded.places(&shape, WORLD, &mut Tried::default());
        assert!((100..400).contains(&crowded.len()), "{}", crowded.len());
        let solid = Shape::new(
            &Sdf::from(Cuboid {
                half: DVec3::splat(99.0),
            }),
            &[],
        );
        assert!(
            ask(Ground::Floor)
                .places(&solid, WORLD, &mut Tried::default())
                .is_empty()
        );
        let empty = Shape::new(&Sdf::from(Empty), &[]);
        assert!(
            ask(Ground::Floor)
                .places(&empty, WORLD, &mut Tried::default())
                .is_empty()
        );
    }
}
