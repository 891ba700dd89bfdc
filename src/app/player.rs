//! The player: a body that looks around and obeys keys, in fixed steps of simulated time.
//!
//! State changes only in steps of 1/120 s, so the same inputs at the same times give the same state whatever the
//! frame rate. What a frame shows in between is that state after one shorter step on a copy: the remainder of the
//! time since the last whole step. Compared with the usual interpolation between the last two steps (Fiedler 2004,
//! "Fix Your Timestep!"), no input waits a step until it is seen.

use std::collections::{HashMap, HashSet};

use glam::DVec3;

use super::{
    body::{Body, Event, Intent, Measures, Mode, Terrain},
    input::{Input, Key},
};
use crate::world::{Camera, World};

/// Steps per second of simulated time.
pub const STEPS_PER_S: u64 = 120;
const STEP_S: f64 = 1.0 / STEPS_PER_S as f64;
const NS_PER_S: u64 = 1_000_000_000;
/// Two presses of a key within this time (nanoseconds) are a double press.
const DOUBLE_NS: u64 = 300_000_000;

/// Flight with the run key is this much faster: 4 m/s become 20.
const FAST: f64 = 5.0;
/// Speeds of flight that can be chosen (voxels a second).
const FLY_SPEEDS: std::ops::RangeInclusive<f64> = 0.5..=500.0;
const SPEED_PER_NOTCH: f64 = 1.2;

const DEGREES_PER_PIXEL: f32 = 0.1;
/// One degree short of straight up and down, where left and right would trade places.
const STEEPEST_DEG: f32 = 89.0;

/// What the player should be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notice {
    Body(Event),
    Moves(Mode),
    /// A mode in which voxels stop the body was wanted, but there is no room for it.
    NoRoom,
}

impl Notice {
    pub fn text(self) -> &'static str {
        match self {
            Self::Body(Event::Returned) => {
                "You fell out of the world, and are back where you last stood"
            }
            Self::Body(Event::Freed) => "Voxels closed around you: you were moved out of them",
            Self::Body(Event::Stuck) => {
                "Voxels closed around you and there is no room nearby: dig, or press H to pass through"
            }
            Self::Moves(Mode::Walk) => "Walking: Space jumps, Shift sneaks, K flies",
            Self::Moves(Mode::Fly) => "Flying: Space rises, Shift sinks, K walks",
            Self::Moves(Mode::NoClip) => "Passing through voxels: H ends it",
            Self::NoRoom => "There is no room here: fly out of the voxels first",
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Player {
    body: Body,
    camera: Camera,
    keys: Keys,
    /// Voxels per second.
    fly_speed: f64,
    /// Simulated time in nanoseconds, and the whole steps in it.
    now_ns: u64,
    steps: u64,
    notices: Vec<Notice>,
}

/// Keys that are down, and those that went down since the last step: even the shortest press counts for one.
#[derive(Clone, Debug, Default, PartialEq)]
struct Keys {
    down: HashSet<Key>,
    pressed: Vec<Key>,
    /// When each key last went down, for double presses.
    last: HashMap<Key, u64>,
    /// Forward was pressed twice: run until it is released.
    running: bool,
}

impl Keys {
    fn is_down(&self, key: Key) -> bool {
        self.down.contains(&key) || self.pressed.contains(&key)
    }

    fn axis(&self, plus: Key, minus: Key) -> i8 {
        i8::from(self.is_down(plus)) - i8::from(self.is_down(minus))
    }

    /// Returns whether this is the second of two quick presses.
    fn press(&mut self, key: Key, now_ns: u64) -> bool {
        self.down.insert(key);
        self.pressed.push(key);
        let last = self.last.insert(key, now_ns);
        let is_double = last.is_some_and(|last| now_ns - last <= DOUBLE_NS);
        if is_double {
            // A third press begins a new pair.
            self.last.remove(&key);
        }
        self.running |= is_double && key == Key::Forward;
        is_double
    }

    fn release(&mut self, key: Key) {
        self.down.remove(&key);
        self.running &= key != Key::Forward;
    }
}

impl Player {
    /// A player who looks through a camera of the world.
    pub fn new(camera: &Camera, world: &World, terrain: &impl Terrain) -> Self {
        let measures = Measures::of_height(world.player_height);
        let bottom = f64::from(world.origin.y);
        let eye = camera.position.as_dvec3();
        let body = Body::with_eye_at(eye, measures, bottom, terrain);
        Self {
            notices: vec![Notice::Moves(body.mode)],
            fly_speed: measures.walk,
            body,
            camera: camera.clone(),
            keys: Keys::default(),
            now_ns: 0,
            steps: 0,
        }
    }

    pub fn body(&self) -> &Body {
        &self.body
    }

    /// Simulated time in nanoseconds.
    pub fn now_ns(&self) -> u64 {
        self.now_ns
    }

    /// Whole steps of the simulation so far.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Speed of flight (voxels per second).
    pub fn fly_speed(&self) -> f64 {
        self.fly_speed
    }

    /// What happened since the last call that the player should be told.
    pub fn take_notices(&mut self) -> Vec<Notice> {
        std::mem::take(&mut self.notices)
    }

    /// Moves to a camera, with the keys as they are.
    pub fn place(&mut self, camera: &Camera, world: &World, terrain: &impl Terrain) {
        let placed = Self::new(camera, world, terrain);
        self.body = placed.body;
        self.camera = placed.camera;
        self.notices.extend(placed.notices);
    }

    /// Takes the measures of a world that was read again.
    pub fn resize(&mut self, world: &World) {
        let measures = Measures::of_height(world.player_height);
        self.body.resize(measures, f64::from(world.origin.y));
    }

    /// Applies an input, if it is one for the player.
    pub fn take(&mut self, input: &Input, terrain: &impl Terrain) {
        match *input {
            Input::Press(key) => {
                let is_double = self.keys.press(key, self.now_ns);
                match key {
                    Key::Fly => self.toggle(Mode::Fly, terrain),
                    Key::Up if is_double => self.toggle(Mode::Fly, terrain),
                    Key::NoClip => self.toggle(Mode::NoClip, terrain),
                    _ => {}
                }
            }
            Input::Release(key) => self.keys.release(key),
            Input::Focus(false) => self.keys = Keys::default(),
            Input::Look(right, down) => self.look(right, down),
            Input::Wheel(notches) => {
                let speed = self.fly_speed * SPEED_PER_NOTCH.powf(f64::from(notches));
                self.fly_speed = speed.clamp(*FLY_SPEEDS.start(), *FLY_SPEEDS.end());
            }
            _ => {}
        }
    }

    /// Into a mode, or out of it to walk. Whoever passes through voxels begins to fly.
    fn toggle(&mut self, mode: Mode, terrain: &impl Terrain) {
        let next = match self.body.mode {
            Mode::NoClip => Mode::Fly,
            now if now == mode => Mode::Walk,
            _ => mode,
        };
        let changed = self.body.set_mode(next, terrain);
        self.notices.push(match changed {
            true => Notice::Moves(next),
            false => Notice::NoRoom,
        });
    }

    fn look(&mut self, right_px: f32, down_px: f32) {
        let camera = &mut self.camera;
        let yaw_deg = camera.yaw_deg - right_px * DEGREES_PER_PIXEL;
        let pitch_deg = camera.pitch_deg - down_px * DEGREES_PER_PIXEL;
        // A record can hold any number.
        if yaw_deg.is_finite() && pitch_deg.is_finite() {
            camera.yaw_deg = (yaw_deg + 180.0).rem_euclid(360.0) - 180.0;
            camera.pitch_deg = pitch_deg.clamp(-STEEPEST_DEG, STEEPEST_DEG);
        }
    }

    /// Simulates until this time (nanoseconds).
    pub fn advance(&mut self, to_ns: u64, terrain: &impl Terrain) {
        self.now_ns = self.now_ns.max(to_ns);
        let steps = whole_steps(self.now_ns);
        while self.steps < steps {
            let intent = self.intent();
            let event = self.body.step(terrain, &intent, STEP_S);
            self.notices.extend(event.map(Notice::Body));
            self.keys.pressed.clear();
            self.steps += 1;
        }
    }

    /// What the player sees now.
    pub fn view(&self, terrain: &impl Terrain) -> Camera {
        let rest_ns = self.now_ns - step_start_ns(self.steps);
        let mut body = self.body.clone();
        if rest_ns > 0 {
            // It may not be told: the whole step will tell it again.
            let _ = body.step(terrain, &self.intent(), rest_ns as f64 / NS_PER_S as f64);
        }
        Camera {
            position: body.eye(terrain).as_vec3(),
            ..self.camera.clone()
        }
    }

    fn intent(&self) -> Intent {
        let basis = self.camera.basis(1.0);
        let keys = &self.keys;
        let runs = keys.is_down(Key::Run) || keys.running;
        let fast = if runs { FAST } else { 1.0 };
        Intent {
            forward: keys.axis(Key::Forward, Key::Back),
            right: keys.axis(Key::Right, Key::Left),
            up: keys.is_down(Key::Up),
            down: keys.is_down(Key::Down),
            run: runs,
            heading: basis.forward.normalize_or(DVec3::NEG_Z),
            rightwards: basis.right.normalize_or(DVec3::X),
            fly_speed: self.fly_speed * fast,
        }
    }
}

fn whole_steps(ns: u64) -> u64 {
    (u128::from(ns) * u128::from(STEPS_PER_S) / u128::from(NS_PER_S)) as u64
}

/// The first nanosecond that belongs to this step.
fn step_start_ns(step: u64) -> u64 {
    (u128::from(step) * u128::from(NS_PER_S)).div_ceil(u128::from(STEPS_PER_S)) as u64
}

#[cfg(test)]
mod tests {
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
        let ground = Ground {
            voxels: &voxels,
            origin: world.origin,
        };
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
            1 => (-3.0f32..3.0).prop_map(Input::Wheel),
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
            let inputs: Vec<_> = notches.iter().map(|n| (0, Input::Wheel(*n))).collect();
            played(&inputs, frames(60, 20 * MS)).0.fly_speed
        };
        assert!((speed(&[3.0, -3.0]) - 4.0).abs() < 1e-9);
        assert_eq!(speed(&[1e6]), *FLY_SPEEDS.end());
        assert_eq!(speed(&[-1e6]), *FLY_SPEEDS.start());
    }
}
