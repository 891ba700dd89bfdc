//! The player: a body that looks around and obeys keys, in fixed steps of simulated time.
//!
//! State changes only in steps of 1/120 s, so the same inputs at the same times give the same state whatever the
//! frame rate. What a frame shows in between is that state after one shorter step on a copy: the remainder of the
//! time since the last whole step. Compared with the usual interpolation between the last two steps (Fiedler 2004,
//! "Fix Your Timestep!"), no input waits a step until it is seen.

mod gait;
#[cfg(test)]
mod tests;

use std::collections::{HashMap, HashSet};

use glam::DVec3;

use gait::Gait;
pub use gait::{Contact, Footfall};

use super::{
    body::{Body, Event, Intent, Measures, Mode, Terrain, free::Pusher, to_units},
    input::{Input, Key},
    settings::FIELDS_OF_VIEW_DEG,
    texts::body as texts,
};
use crate::world::{Camera, World};

/// Steps per second of simulated time.
pub const STEPS_PER_S: u64 = 120;
pub const STEP_S: f64 = 1.0 / STEPS_PER_S as f64;
pub const NS_PER_S: u64 = 1_000_000_000;
/// Footfalls that are kept until they are taken.
const MOST_FOOTFALLS: usize = 16;
/// Two presses of a key within this time (nanoseconds) are a double press.
const DOUBLE_NS: u64 = 300_000_000;

/// Flight with the run key is this much faster: 4 m/s become 20.
const FAST: f64 = 5.0;
/// Speeds of flight that can be chosen (voxels a second).
const FLY_SPEEDS: std::ops::RangeInclusive<f64> = 0.5..=500.0;
const SPEED_PER_NOTCH: f64 = 1.2;

/// A run begins on foot no higher above the ground than this (metres, for a player of 1.77): a fall of a second.
const LANDING_M: f64 = 12.0;

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
    /// Names of actions in braces stand for their keys.
    pub fn text(self) -> &'static str {
        match self {
            Self::Body(Event::Returned) => texts::RETURNED,
            Self::Body(Event::Freed) => texts::FREED,
            Self::Body(Event::Stuck) => texts::STUCK,
            Self::Moves(Mode::Walk) => texts::WALKS,
            Self::Moves(Mode::Fly) => texts::FLIES,
            Self::Moves(Mode::NoClip) => texts::PASSES,
            Self::NoRoom => texts::NO_ROOM,
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Player {
    body: Body,
    camera: Camera,
    /// The user's own, in place of the camera's.
    field_of_view_deg: Option<f32>,
    keys: Keys,
    /// Voxels per second.
    fly_speed: f64,
    /// Simulated time in nanoseconds, and the whole steps in it.
    now_ns: u64,
    steps: u64,
    notices: Vec<Notice>,
    gait: Gait,
    footfalls: Vec<Footfall>,
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
            field_of_view_deg: None,
            keys: Keys::default(),
            now_ns: 0,
            steps: 0,
            gait: Gait::default(),
            footfalls: Vec::new(),
        }
    }

    /// Ends the flight that a run begins with where the ground is close below: who enters a cave walks.
    pub fn land(&mut self, terrain: &impl Terrain) {
        let near = to_units(LANDING_M * self.body.measures.scale);
        let falls_on_ground = self.body.shape().sweep(terrain, 1, -near) != -near;
        if self.body.mode == Mode::Fly && falls_on_ground {
            self.notices.clear();
            self.toggle(Mode::Fly, terrain);
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

    /// The footfalls since the last call.
    pub fn take_footfalls(&mut self) -> Vec<Footfall> {
        std::mem::take(&mut self.footfalls)
    }

    /// Moves to a camera, with the keys as they are.
    pub fn place(&mut self, camera: &Camera, world: &World, terrain: &impl Terrain) {
        let placed = Self::new(camera, world, terrain);
        self.body = placed.body;
        self.camera = placed.camera;
        self.gait = placed.gait;
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
            Input::FieldOfView(own_deg) => {
                // A record can hold any number.
                let own_deg = own_deg.filter(|deg| deg.is_finite());
                self.field_of_view_deg = own_deg
                    .map(|deg| deg.clamp(*FIELDS_OF_VIEW_DEG.start(), *FIELDS_OF_VIEW_DEG.end()));
            }
            Input::FlySpeed(notches) => {
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
        let changed = self.body.set_mode(next, &terrain.at(self.now_ns));
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
            self.steps += 1;
            let at_ns = step_start_ns(self.steps);
            let terrain = terrain.at(at_ns);
            let event = self.body.step(&terrain, &intent, STEP_S);
            self.notices.extend(event.map(Notice::Body));
            self.keys.pressed.clear();
            let footfall = self.gait.follow(&self.body, &terrain, STEP_S, at_ns);
            // A player whom nobody hears, such as a twin of the latency, keeps only a few.
            let room = MOST_FOOTFALLS.saturating_sub(self.footfalls.len());
            self.footfalls.extend(footfall.into_iter().take(room));
        }
    }

    /// The player for bodies that he may push in the next step; `None` for one who passes through them.
    pub fn pusher(&self) -> Option<Pusher> {
        let intent = self.intent();
        let level = |v: DVec3| match self.body.mode {
            Mode::Walk => DVec3::new(v.x, 0.0, v.z).normalize_or_zero(),
            Mode::Fly | Mode::NoClip => v,
        };
        let course = level(intent.heading) * f64::from(intent.forward)
            + level(intent.rightwards) * f64::from(intent.right);
        (self.body.mode != Mode::NoClip).then(|| Pusher {
            shape: self.body.shape(),
            course: course.normalize_or_zero(),
            velocity: self.body.velocity(),
        })
    }

    /// What the player pushes goes so fast along each axis in the next step (voxels per second).
    pub fn push(&mut self, speeds: DVec3) {
        self.body.push(speeds);
    }

    /// When the next step ends (nanoseconds).
    pub fn next_step_ns(&self) -> u64 {
        step_start_ns(self.steps + 1)
    }

    /// What the player sees now.
    pub fn view(&self, terrain: &impl Terrain) -> Camera {
        let rest_ns = self.now_ns - step_start_ns(self.steps);
        let mut body = self.body.clone();
        let terrain = terrain.at(self.now_ns);
        if rest_ns > 0 {
            // It may not be told: the whole step will tell it again.
            let _ = body.step(&terrain, &self.intent(), rest_ns as f64 / NS_PER_S as f64);
        }
        Camera {
            position: body.eye(&terrain).as_vec3(),
            fov_deg: self.field_of_view_deg.unwrap_or(self.camera.fov_deg),
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

/// Whole steps within this time.
pub fn whole_steps(ns: u64) -> u64 {
    (u128::from(ns) * u128::from(STEPS_PER_S) / u128::from(NS_PER_S)) as u64
}

/// The first nanosecond that belongs to this step.
pub fn step_start_ns(step: u64) -> u64 {
    (u128::from(step) * u128::from(NS_PER_S)).div_ceil(u128::from(STEPS_PER_S)) as u64
}
