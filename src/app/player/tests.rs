//! Inputs at their times, at any frame rate.

use std::path::Path;

use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;

use super::*;
use crate::{
    app::body::Ground,
    world::{file, voxels::Voxels},
};

/// A bumpy floor with pillars, and a camera above it.
fn scene() -> (World, Voxels) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/minimal.ron");
    let mut world = file::load(&path, &file::Overrides::default()).expect("it loads");
    world.size = UVec3::splat(32);
    world.origin = IVec3::splat(-16);
    let mut voxels = Voxels::empty(world.size);
    voxels.edit(IVec3::ZERO, IVec3::splat(31), |at, _| {
        let bump = i32::from((at.x * 7 + at.z * 13) % 5 == 0);
        let is_pillar = at.x % 8 == 3 && at.z % 6 == 1;
        u8::from(at.y < 8 + bump || is_pillar)
    });
    (world, voxels)
}

fn camera(y: f32) -> Camera {
    Camera {
        name: "test".into(),
        position: Vec3::new(0.5, y, 0.5),
        yaw_deg: 30.0,
        pitch_deg: -20.0,
        fov_deg: 70.0,
    }
}

/// The eye of who stands on the bump in the middle.
const ON_GROUND_Y: f32 = -7.0 + 1.625;
const MS: u64 = 1_000_000;

/// Plays inputs at their times, with frames at these times in between; returns the end and its view.
fn played(inputs: &[(u64, Input)], frames: impl Iterator<Item = u64>) -> (Player, Camera) {
    let (world, voxels) = scene();
    let ground = Ground::new(&voxels, world.origin);
    let mut player = Player::new(&camera(ON_GROUND_Y), &world, &ground);
    let mut inputs = inputs.iter().peekable();
    for frame in frames {
        while let Some((at, input)) = inputs.next_if(|(at, _)| *at < frame) {
            player.advance(*at, &ground);
            player.take(input, &ground);
        }
        player.advance(frame, &ground);
        player.view(&ground);
    }
    let view = player.view(&ground);
    (player, view)
}

fn frames(per_s: u64, end: u64) -> impl Iterator<Item = u64> {
    (1..)
        .map(move |frame| frame * NS_PER_S / per_s)
        .take_while(move |at| *at < end)
        .chain([end])
}

fn any_input() -> impl Strategy<Value = Input> {
    let key = prop::sample::select(vec![
        Key::Forward,
        Key::Back,
        Key::Left,
        Key::Right,
        Key::Up,
        Key::Down,
        Key::Run,
        Key::Fly,
        Key::NoClip,
    ]);
    prop_oneof![
        4 => key.clone().prop_map(Input::Press),
        3 => key.prop_map(Input::Release),
        3 => (-300.0f32..300.0, -100.0f32..100.0).prop_map(|(x, y)| Input::Look(x, y)),
        1 => (-3.0f32..3.0).prop_map(Input::FlySpeed),
        1 => Just(Input::Focus(false)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The same inputs at the same times give the same player, to the bit, at 20 and at 500 frames a second
    /// and at any times of frames in between.
    #[test]
    fn a_run_is_the_same_at_any_frame_rate(
        gaps in prop::collection::vec((0u64..200 * MS, any_input()), 1..24),
        odd in prop::collection::vec(1u64..3_000 * MS, 0..40),
    ) {
        let mut at = 0;
        let inputs: Vec<_> = gaps.into_iter().map(|(gap, input)| { at += gap; (at, input) }).collect();
        let end = at + 300 * MS;
        let slow = played(&inputs, frames(20, end));
        let fast = played(&inputs, frames(500, end));
        let mut odd: Vec<u64> = odd.into_iter().filter(|at| *at < end).chain([end]).collect();
        odd.sort_unstable();
        prop_assert_eq!(&slow, &fast);
        prop_assert_eq!(&slow, &played(&inputs, odd.into_iter()));
    }
}

#[test]
fn the_comparison_of_frame_rates_finds_an_input_that_comes_late() {
    let at = |ms: u64| [(ms * MS, Input::Press(Key::Forward))];
    let on_time = played(&at(100), frames(60, 500 * MS));
    let late = played(&at(109), frames(60, 500 * MS));
    assert_ne!(on_time, late);
}

#[test]
fn an_input_is_seen_in_the_next_frame_however_short_frames_are() {
    for per_s in [20, 60, 500, 2000] {
        let frame = NS_PER_S / per_s;
        for inputs in [
            Input::Press(Key::Forward),
            Input::Look(10.0, 0.0),
            Input::Press(Key::Up),
        ] {
            let at = 20 * frame;
            let with = played(&[(at, inputs.clone())], (1..=21).map(|n| n * frame));
            let without = played(&[], (1..=21).map(|n| n * frame));
            assert_ne!(with.1, without.1, "{inputs:?} at {per_s} frames a second");
        }
    }
}

#[test]
fn a_tap_within_one_frame_counts_for_one_step() {
    let tap = |key| [(10 * MS, Input::Press(key)), (10 * MS, Input::Release(key))];
    let (jumped, view) = played(&tap(Key::Up), frames(20, 200 * MS));
    assert!(view.position.y > ON_GROUND_Y + 0.3, "{}", view.position.y);
    assert!(jumped.keys.down.is_empty());
    let (_, view) = played(&tap(Key::Forward), frames(20, 200 * MS));
    assert!(view.position.distance(camera(view.position.y).position) > 0.005);
}

#[test]
fn keys_change_the_mode_and_two_quick_presses_do_too() {
    let mode = |inputs: &[(u64, Input)]| played(inputs, frames(60, 3_000 * MS)).0.body.mode;
    let press = |ms: u64, key| (ms * MS, Input::Press(key));
    assert_eq!(mode(&[]), Mode::Walk);
    assert_eq!(mode(&[press(9, Key::Fly)]), Mode::Fly);
    assert_eq!(mode(&[press(9, Key::Fly), press(99, Key::Fly)]), Mode::Walk);
    assert_eq!(mode(&[press(9, Key::NoClip)]), Mode::NoClip);
    assert_eq!(
        mode(&[press(9, Key::NoClip), press(99, Key::NoClip)]),
        Mode::Fly
    );
    let up = |ms: u64| {
        [
            press(ms, Key::Up),
            ((ms + 20) * MS, Input::Release(Key::Up)),
        ]
    };
    assert_eq!(mode(&[up(9), up(200)].concat()), Mode::Fly);
    assert_eq!(mode(&[up(9), up(500)].concat()), Mode::Walk, "too slow");
    assert_eq!(
        mode(&[up(9), up(200), up(400)].concat()),
        Mode::Fly,
        "a third is a first"
    );
}

#[test]
fn a_second_press_runs_until_the_key_is_released_and_lost_focus_stops() {
    let w = Key::Forward;
    let twice = [
        (0, Input::Press(w)),
        (50 * MS, Input::Release(w)),
        (100 * MS, Input::Press(w)),
    ];
    let running = played(&twice, frames(60, 150 * MS)).0;
    assert!(running.intent().run);
    let released = [&twice[..], &[(120 * MS, Input::Release(w))]].concat();
    assert!(!played(&released, frames(60, 150 * MS)).0.intent().run);
    let unfocused = [&twice[..], &[(120 * MS, Input::Focus(false))]].concat();
    let intent = played(&unfocused, frames(60, 150 * MS)).0.intent();
    assert_eq!((intent.run, intent.forward), (false, 0));
}

#[test]
fn looking_turns_right_and_down_and_stops_at_the_poles() {
    let look = |right, down| played(&[(0, Input::Look(right, down))], frames(60, 20 * MS)).1;
    assert!((look(100.0, 0.0).yaw_deg - 20.0).abs() < 1e-3);
    assert!((look(-1600.0, 0.0).yaw_deg + 170.0).abs() < 1e-3, "wraps");
    assert!((look(0.0, 50.0).pitch_deg + 25.0).abs() < 1e-3);
    assert_eq!(look(0.0, 1e6).pitch_deg, -STEEPEST_DEG);
    assert_eq!(look(0.0, -1e6).pitch_deg, STEEPEST_DEG);
    assert_eq!(look(f32::NAN, f32::INFINITY).yaw_deg, 30.0);
}

#[test]
fn speeds_of_flight_stay_in_range() {
    let speed = |notches: &[f32]| {
        let inputs: Vec<_> = notches.iter().map(|n| (0, Input::FlySpeed(*n))).collect();
        played(&inputs, frames(60, 20 * MS)).0.fly_speed
    };
    assert!((speed(&[3.0, -3.0]) - 4.0).abs() < 1e-9);
    assert_eq!(speed(&[1e6]), *FLY_SPEEDS.end());
    assert_eq!(speed(&[-1e6]), *FLY_SPEEDS.start());
}

#[test]
fn the_users_field_of_view_takes_the_place_of_every_cameras() {
    let (world, voxels) = scene();
    let ground = Ground::new(&voxels, world.origin);
    let mut player = Player::new(&camera(ON_GROUND_Y), &world, &ground);
    let mut seen_with = |own_deg| {
        player.take(&Input::FieldOfView(own_deg), &ground);
        let at_once = player.view(&ground).fov_deg;
        player.place(&camera(ON_GROUND_Y), &world, &ground);
        assert_eq!(player.view(&ground).fov_deg, at_once, "after a jump");
        at_once
    };
    assert_eq!(seen_with(Some(100.0)), 100.0);
    assert_eq!(seen_with(Some(1e9)), 120.0);
    assert_eq!(seen_with(Some(f32::NAN)), 70.0);
    assert_eq!(seen_with(None), 70.0);
}

#[test]
fn who_enters_a_world_walks_where_the_ground_is_close() {
    let (world, voxels) = scene();
    let ground = Ground::new(&voxels, world.origin);
    for (above, mode) in [(0.0, Mode::Walk), (9.0, Mode::Walk), (14.0, Mode::Fly)] {
        let mut player = Player::new(&camera(ON_GROUND_Y + above), &world, &ground);
        player.land(&ground);
        assert_eq!(player.take_notices(), [Notice::Moves(mode)], "{above}");
        player.advance(3 * NS_PER_S, &ground);
        let fell = player.view(&ground).position.y < ON_GROUND_Y + 0.1;
        assert_eq!(fell, mode == Mode::Walk, "{above}");
    }
}
