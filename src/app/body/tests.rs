//! The body against brute force: random worlds and moves, and worlds made for one question each.

use std::collections::HashSet;

use glam::{DVec3, I64Vec3, IVec3};
use proptest::prelude::*;

use super::{
    Body, Event, Intent, Measures, Mode, Terrain,
    sweep::{ONE, point_to_units, to_voxels},
};

const DT_S: f64 = 1.0 / 120.0;
const HEIGHT: f64 = 1.77;
/// Edge of the random worlds (voxels); their outermost layer is solid.
const EDGE: i32 = 16;

/// Every voxel of a small world; everything else is solid or air.
#[derive(Clone)]
struct Grid {
    solid: Vec<bool>,
    outside: bool,
}

impl Grid {
    fn new(solid: impl Fn(IVec3) -> bool) -> Self {
        let all = 0..EDGE * EDGE * EDGE;
        Self {
            solid: all.map(|index| solid(voxel(index))).collect(),
            outside: false,
        }
    }

    /// A closed room, with a share of its voxels solid, and a block of air in the middle to start in.
    fn room(share: f64, seed: u64) -> Self {
        let inner = 1..EDGE - 1;
        Self::new(|at| {
            let is_inside = at.to_array().iter().all(|n| inner.contains(n));
            let is_start = (at - EDGE / 2).abs().max_element() <= 2;
            !is_inside || (!is_start && Random(seed ^ ((index(at) as u64) << 32)).share() < share)
        })
    }

    fn set(&mut self, at: IVec3, solid: bool) {
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
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// −1, 0 or 1.
    fn sign(&mut self) -> i8 {
        (self.next() % 3) as i8 - 1
    }

    fn intent(&mut self) -> Intent {
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
fn ahead(heading: DVec3) -> Intent {
    Intent {
        forward: 1,
        heading,
        rightwards: DVec3::Z,
        fly_speed: 4.0,
        ..Intent::default()
    }
}

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

/// Air above a floor that fills the voxels below `y` = 4.
fn floor() -> Grid {
    Grid::new(|at| at.y < 4)
}

/// Steps until nothing is pressed for a while.
fn rest(body: &mut Body, terrain: &impl Terrain) {
    for _ in 0..240 {
        body.step(terrain, &Intent::default(), DT_S);
    }
}

#[test]
fn speeds_and_jumps_are_luantis_and_grow_with_the_body() {
    for (height, scale) in [(HEIGHT, 1.0), (HEIGHT * 0.5, 0.5)] {
        let grid = floor();
        let measures = Measures::of_height(height);
        let eye = DVec3::new(1.0, 4.0 + 1.625 * scale, 8.0);
        let mut body = Body::with_eye_at(eye, measures, 0.0, &grid);
        assert_eq!(body.mode, Mode::Walk);
        for (intent, speed) in [
            (ahead(DVec3::X), 4.0),
            (
                Intent {
                    run: true,
                    ..ahead(DVec3::X)
                },
                6.0,
            ),
            (
                Intent {
                    down: true,
                    ..ahead(DVec3::X)
                },
                1.35,
            ),
            (
                Intent {
                    right: 1,
                    ..ahead(DVec3::X)
                },
                4.0,
            ),
        ] {
            body.feet = point_to_units(eye.with_y(4.0));
            for _ in 0..60 {
                body.step(&grid, &intent, DT_S);
            }
            let reached = body.velocity.length();
            assert!(
                (reached - speed * scale).abs() < 0.01 * speed,
                "{intent:?}: {reached}"
            );
        }
        rest(&mut body, &grid);
        let ground = body.eye(&grid).y;
        let jump = Intent {
            up: true,
            ..Intent::default()
        };
        body.step(&grid, &jump, DT_S);
        let mut highest = 0.0f64;
        for _ in 0..120 {
            body.step(&grid, &Intent::default(), DT_S);
            highest = highest.max(body.eye(&grid).y - ground);
        }
        assert!(
            (highest - 1.078 * scale).abs() < 0.01,
            "a jump rises {highest}"
        );
        assert_eq!(body.eye(&grid).y, ground, "and ends on the ground");
    }
}

#[test]
fn one_voxel_is_walked_up_and_down_smoothly_and_two_are_a_wall() {
    let stairs = Grid::new(|at| at.y < 4 + i32::from(at.x >= 8) - i32::from(at.x < 4));
    let mut body = body_at(DVec3::new(2.0, 4.625, 8.0), &stairs);
    let mut last = body.eye(&stairs).y;
    for heading in [DVec3::X, DVec3::NEG_X] {
        for _ in 0..300 {
            body.step(&stairs, &ahead(heading), DT_S);
            let eye = body.eye(&stairs).y;
            assert!(
                (eye - last).abs() < 0.2,
                "the eye leaps from {last} to {eye}"
            );
            assert_eq!(body.velocity.y, 0.0, "it neither jumps nor falls");
            last = eye;
            if (heading.x > 0.0 && to_voxels(body.feet.x) > 12.0)
                || (heading.x < 0.0 && to_voxels(body.feet.x) < 2.0)
            {
                break;
            }
        }
        let expected = if heading.x > 0.0 { 5 } else { 3 };
        assert_eq!(body.feet.y, expected * ONE);
    }
    let wall = Grid::new(|at| at.y < 4 || (at.x >= 8 && at.y < 6));
    let mut body = body_at(DVec3::new(6.0, 5.625, 8.0), &wall);
    for _ in 0..240 {
        body.step(&wall, &ahead(DVec3::X), DT_S);
    }
    assert_eq!(body.shape().max.x, 8 * ONE, "it stands at the wall");
}

#[test]
fn who_sneaks_stays_on_the_edge_and_who_walks_falls() {
    let table = Grid::new(|at| at.y < 4 && (5..8).contains(&at.x) && (5..8).contains(&at.z));
    for heading in [
        DVec3::X,
        DVec3::new(0.6, 0.0, -0.8),
        DVec3::new(-1.0, 0.0, 1.0).normalize(),
    ] {
        let mut body = body_at(DVec3::new(6.5, 5.625, 6.5), &table);
        let sneak = Intent {
            down: true,
            ..ahead(heading)
        };
        for _ in 0..600 {
            body.step(&table, &sneak, DT_S);
            assert!(body.shape().is_supported(&table), "{heading}");
        }
        let far = (body.feet - point_to_units(DVec3::new(6.5, 4.0, 6.5)))
            .as_dvec3()
            .length();
        assert!(to_voxels(far as i64) > 1.5, "it goes to the very edge");
        for _ in 0..60 {
            body.step(&table, &ahead(heading), DT_S);
        }
        assert!(body.feet.y < 4 * ONE, "and falls when it walks");
    }
}

#[test]
fn out_of_the_world_is_back_to_the_last_safe_place() {
    let table = Grid::new(|at| at.y < 4 && at.x < 8);
    let mut body = body_at(DVec3::new(6.0, 5.625, 8.0), &table);
    let events: Vec<Event> = (0..600)
        .filter_map(|_| body.step(&table, &ahead(DVec3::X), DT_S))
        .take(1)
        .collect();
    assert_eq!(events, [Event::Returned]);
    assert!(body.shape().is_supported(&table));
    assert_eq!((body.mode, body.velocity), (Mode::Walk, DVec3::ZERO));
    // Its ground is gone: it would fall for ever, so it flies.
    let nothing = Grid::new(|_| false);
    let fell = (0..600).find_map(|_| body.step(&nothing, &Intent::default(), DT_S));
    assert_eq!((fell, body.mode), (Some(Event::Returned), Mode::Fly));
    // Nothing was ever safe: back to the start.
    let eye = DVec3::splat(8.0);
    let mut body = body_at(eye, &nothing);
    assert_eq!(body.mode, Mode::Fly);
    assert!(body.set_mode(Mode::Walk, &nothing));
    let fell = (0..900).find_map(|_| body.step(&nothing, &Intent::default(), DT_S));
    assert_eq!((fell, body.mode), (Some(Event::Returned), Mode::Fly));
    assert!((body.eye(&nothing) - eye).length() < 1e-5);
}

#[test]
fn stone_that_closes_around_a_body_lets_it_out() {
    let mut grid = floor();
    let mut body = body_at(DVec3::new(8.5, 5.625, 8.5), &grid);
    for y in 4..9 {
        grid.set(IVec3::new(8, y, 8), true);
    }
    assert_eq!(
        body.step(&grid, &Intent::default(), DT_S),
        Some(Event::Freed)
    );
    assert!(!body.shape().overlaps(&grid));
    // In nothing but stone it waits, digs, and is free.
    let mut stone = Grid::new(|_| true);
    stone.outside = true;
    assert_eq!(
        body.step(&stone, &ahead(DVec3::X), DT_S),
        Some(Event::Stuck)
    );
    for _ in 0..30 {
        assert_eq!(
            body.step(&stone, &ahead(DVec3::X), DT_S),
            None,
            "it is not told again at once"
        );
    }
    assert!(!body.set_mode(Mode::Fly, &stone), "there is no room to fly");
    let (low, _) = body.shape().voxels();
    for up in 0..3 {
        stone.set(IVec3::new(low.x + 2, low.y + up, low.z), false);
    }
    let freed = (0..120).find_map(|_| body.step(&stone, &Intent::default(), DT_S));
    assert_eq!(freed, Some(Event::Freed));
    assert!(!body.shape().overlaps(&stone));
}

#[test]
fn a_start_in_the_air_flies_on_the_ground_walks_and_in_stone_passes_through() {
    let grid = floor();
    let mode = |y: f64| body_at(DVec3::new(8.0, y, 8.0), &grid).mode;
    assert_eq!(mode(12.0), Mode::Fly);
    assert_eq!(mode(5.625), Mode::Walk);
    assert_eq!(mode(5.8), Mode::Walk, "almost on the ground");
    assert_eq!(mode(5.0), Mode::NoClip);
    let mut body = body_at(DVec3::new(8.0, 5.0, 8.0), &grid);
    for _ in 0..240 {
        body.step(&grid, &ahead(DVec3::NEG_Y), DT_S);
    }
    assert!(body.feet.y < 0, "through the floor");
    body.feet.y = 3 * ONE;
    assert!(body.set_mode(Mode::Walk, &grid));
    assert_eq!(body.feet.y, 4 * ONE, "out of the floor");
}

#[test]
fn the_eye_stays_below_a_ceiling_that_comes_with_a_step_down() {
    // The floor and the ceiling both drop by one voxel at x = 8.
    let grid = Grid::new(|at| {
        let lower = i32::from(at.x >= 8);
        at.y < 5 - lower || at.y >= 7 - lower
    });
    let mut body = body_at(DVec3::new(4.0, 6.625, 8.0), &grid);
    for _ in 0..300 {
        body.step(&grid, &ahead(DVec3::X), DT_S);
        let eye = body.eye(&grid).floor().as_ivec3();
        assert!(!grid.is_solid(eye), "the eye is in stone at {eye}");
    }
    assert_eq!(body.feet.y, 5 * ONE, "the lower part is too low to enter");
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
