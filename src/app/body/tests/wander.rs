//! Random moves in random worlds, checked by brute force.

use std::collections::HashSet;

use glam::{I64Vec3, IVec3};
use proptest::prelude::*;

use super::{
    super::{Body, Intent, Mode, sweep::point_to_units},
    DT_S, Grid, Random, in_the_middle,
};

/// What is wrong with where a body is: it must be in air that can be reached from where it began.
fn fault(body: &Body, reachable: &HashSet<IVec3>) -> Option<IVec3> {
    let (low, high) = body.shape().voxels();
    let mut voxels = (low.y..=high.y).flat_map(|y| {
        (low.z..=high.z).flat_map(move |z| (low.x..=high.x).map(move |x| IVec3::new(x, y, z)))
    });
    voxels.find(|voxel| !reachable.contains(voxel))
}

/// Plays random moves in a random room by `step`. Returns the first place where the body must not be.
fn wander(
    seed: u64,
    moves: usize,
    mut step: impl FnMut(&mut Body, &Grid, &Intent),
) -> Option<IVec3> {
    let mut random = Random(seed);
    let grid = Grid::room(random.share() * 0.6, random.next());
    let mut body = in_the_middle(&grid);
    body.mode = if random.next().is_multiple_of(2) {
        Mode::Walk
    } else {
        Mode::Fly
    };
    let reachable = grid.connected(body.shape().voxels().0);
    let mut intent = random.intent();
    for _ in 0..moves {
        if random.next().is_multiple_of(8) {
            intent = random.intent();
        }
        step(&mut body, &grid, &intent);
        if let Some(at) = fault(&body, &reachable) {
            return Some(at);
        }
    }
    None
}

/// A million moves in a thousand worlds.
#[test]
fn a_body_is_never_in_stone_and_never_goes_through_a_wall() {
    for seed in 0..1000 {
        let found = wander(seed, 1000, |body, grid, intent| {
            assert_eq!(body.step(grid, intent, DT_S), None);
        });
        assert_eq!(found, None, "in world {seed}");
    }
}

/// A body that looks only at where a move ends goes through walls: the check finds it.
#[test]
fn the_check_finds_a_body_that_tunnels_and_one_that_enters_stone() {
    let tunnels = |body: &mut Body, grid: &Grid, intent: &Intent| {
        let before = body.feet;
        body.feet += point_to_units(intent.heading * intent.fly_speed * DT_S);
        if body.shape().overlaps(grid) {
            body.feet = before;
        }
    };
    assert!((0..20).any(|seed| wander(seed, 1000, tunnels).is_some()));
    let enters = |body: &mut Body, grid: &Grid, intent: &Intent| {
        let _ = body.step(grid, intent, DT_S);
        body.feet += I64Vec3::X;
    };
    assert!((0..20).any(|seed| wander(seed, 1000, enters).is_some()));
}
proptest! {
    /// Whatever the numbers, nothing panics, and no place is out of range.
    #[test]
    fn wild_intents_and_steps_do_no_harm(
        seed in any::<u64>(),
        speed in prop::num::f64::ANY,
        dt_s in 0.0f64..1e6,
    ) {
        let grid = Grid::room(0.3, seed);
        let mut body = in_the_middle(&grid);
        let mut random = Random(seed);
        for mode in [Mode::Walk, Mode::Fly, Mode::NoClip] {
            body.set_mode(mode, &grid);
            for _ in 0..20 {
                let intent = Intent { fly_speed: speed, ..random.intent() };
                let _ = body.step(&grid, &intent, dt_s);
                prop_assert!(mode == Mode::NoClip || !body.shape().overlaps(&grid));
                prop_assert!(body.eye(&grid).is_finite());
            }
        }
    }
}
