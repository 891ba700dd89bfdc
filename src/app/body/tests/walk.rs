//! Worlds made for one question each, and the walk through the cave.

use std::path::Path;

use glam::{DVec3, IVec3};

use super::{
    super::{
        Body, Event, Ground, Intent, Measures, Mode, Terrain,
        sweep::{ONE, point_to_units, to_voxels},
    },
    DT_S, Grid, HEIGHT, ahead, body_at,
};
use crate::world::{file, generate};

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

/// Straight on in all directions from below each camera, without a jump, no less than half of the way is made:
/// walls and the stems of mushrooms stop who never turns.
#[test]
fn the_cave_is_walked_without_jumps() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/cave.ron");
    let world = file::load(&path, &file::Overrides::default()).expect("it loads");
    let voxels = generate::generate(&world);
    let ground = Ground::new(&voxels, world.origin);
    let measures = Measures::of_height(world.player_height);
    let bottom = f64::from(world.origin.y);
    for camera in &world.cameras {
        let mut landed = Body::with_eye_at(camera.position.as_dvec3(), measures, bottom, &ground);
        assert!(landed.set_mode(Mode::Walk, &ground));
        for _ in 0..1200 {
            assert_eq!(landed.step(&ground, &Intent::default(), DT_S), None);
        }
        assert!(landed.shape().is_supported(&ground), "{}", camera.name);
        let directions = 32;
        let steps = 600;
        let mut way = 0.0;
        for direction in 0..directions {
            let angle = f64::from(direction) / f64::from(directions) * std::f64::consts::TAU;
            let intent = ahead(DVec3::new(angle.cos(), 0.0, angle.sin()));
            let mut body = landed.clone();
            let mut last = body.feet;
            for _ in 0..steps {
                assert_eq!(body.step(&ground, &intent, DT_S), None);
                way += (body.feet - last).with_y(0).as_dvec3().length() / ONE as f64;
                last = body.feet;
            }
        }
        let share = way / (f64::from(directions * steps) * DT_S * measures.walk);
        assert!(share > 0.5, "{}: {share}", camera.name);
    }
}
