//! The body of the player: a box that walks, jumps, sneaks and flies through voxels. No GPU and no window.
//!
//! [`Body::step`] moves it by a short time. The box never enters a solid voxel (see `sweep`), and gives way to bodies of
//! voxels that move into it (see `obstacles`).

mod escape;
pub mod free;
mod measures;
mod obstacles;
mod steps;
mod sweep;
mod terrain;
#[cfg(test)]
mod tests;

use glam::{DVec3, I64Vec3};
use serde::{Deserialize, Serialize};

pub use measures::Measures;
pub use obstacles::Obstacles;
pub use sweep::{Aabb, point_to_units, to_units, to_voxels};
use sweep::{FARTHEST, ONE};
pub use terrain::{Ground, Terrain, Walled};

/// Seconds in which the speed closes 63 % of its distance to the wanted one.
const ON_GROUND_S: f64 = 0.05;
const IN_AIR_S: f64 = 0.3;
const IN_FLIGHT_S: f64 = 0.08;
/// The same for the eye after a step up or down.
const EYE_S: f64 = 0.06;
/// Slower than this (voxels per second), what should stand still does.
const STILL: f64 = 1e-3;
/// A fall ends this far below the world (metres of the player).
const BELOW_WORLD_M: f64 = 16.0;
/// Seconds between two searches for room while there is none.
const SEARCH_S: f64 = 0.5;

/// How the body moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// On the ground, with gravity.
    #[default]
    Walk,
    /// Without gravity; voxels stop it.
    Fly,
    /// Without gravity, through everything.
    NoClip,
}

/// What the player wants to do, for one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Intent {
    /// −1, 0 or 1: backwards or forwards, left or right.
    pub forward: i8,
    pub right: i8,
    /// Jump, or rise.
    pub up: bool,
    /// Sneak, or sink.
    pub down: bool,
    pub run: bool,
    /// Where the player looks and what is right of it: unit vectors.
    pub heading: DVec3,
    pub rightwards: DVec3,
    /// Speed of flight (voxels per second).
    pub fly_speed: f64,
}

/// What happened to the body that its player should know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// It fell out of the world and is back where it last stood.
    Returned,
    /// Stone closed around it; it was moved out.
    Freed,
    /// Stone closed around it, and there is no room nearby.
    Stuck,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    pub measures: Measures,
    pub mode: Mode,
    /// Middle of the base of the box, in units of a voxel, world space.
    feet: I64Vec3,
    /// Voxels per second.
    velocity: DVec3,
    /// How far the eye is above its place in the body: after a step it follows smoothly. Voxels.
    eye_lift: f64,
    /// Where the body last stood.
    safe: Option<I64Vec3>,
    /// Where it began.
    start: I64Vec3,
    /// Seconds until room is searched again.
    search_in_s: f64,
    /// Lowest coordinate of the world (voxels).
    bottom: f64,
    /// Whether it stands on a body of voxels, which may sink.
    rides: bool,
    /// How fast what it pushes along each axis goes (voxels per second); 0 where it pushes nothing.
    pushed: DVec3,
}

impl Body {
    /// A body with its eye at a place (world space, voxels). It walks if it stands on the ground, flies if there
    /// is none, and passes through voxels if it is in one. `bottom`: lowest coordinate of the world.
    pub fn with_eye_at(
        eye: DVec3,
        measures: Measures,
        bottom: f64,
        terrain: &impl Terrain,
    ) -> Self {
        let feet = point_to_units(eye) - I64Vec3::Y * measures.eye;
        let mut body = Self {
            measures,
            mode: Mode::Fly,
            feet,
            velocity: DVec3::ZERO,
            eye_lift: 0.0,
            safe: None,
            start: feet,
            search_in_s: 0.0,
            bottom,
            rides: false,
            pushed: DVec3::ZERO,
        };
        // Ground that is nearly reached counts, and so do bodies: a run may go on where the player stands on one.
        let near = to_units(0.3 * measures.scale);
        if body.shape().overlaps(terrain) {
            body.mode = Mode::NoClip;
        } else if body.shape().sweep(&terrain.at(0), 1, -near) != -near {
            body.mode = Mode::Walk;
        }
        body
    }

    /// Takes other measures, with the feet where they are.
    pub fn resize(&mut self, measures: Measures, bottom: f64) {
        self.measures = measures;
        self.bottom = bottom;
    }

    /// The box, for collision.
    pub fn shape(&self) -> Aabb {
        self.at(self.feet)
    }

    /// Middle of the base of the box (world space, voxels).
    pub fn feet(&self) -> DVec3 {
        DVec3::from(self.feet.to_array().map(to_voxels))
    }

    /// Voxels per second.
    pub fn velocity(&self) -> DVec3 {
        self.velocity
    }

    /// Pushes bodies that go so fast along each axis (voxels per second) in the next step. It keeps pace with them, and
    /// does not climb them.
    pub fn push(&mut self, speeds: DVec3) {
        self.pushed = speeds;
    }

    fn at(&self, feet: I64Vec3) -> Aabb {
        let Measures {
            half_width, height, ..
        } = self.measures;
        Aabb {
            min: feet - I64Vec3::new(half_width, 0, half_width),
            max: feet + I64Vec3::new(half_width, height, half_width),
        }
    }

    /// Where the eye is (world space, voxels). It never leaves the box through a ceiling.
    pub fn eye(&self, terrain: &impl Terrain) -> DVec3 {
        let mut lift = to_units(self.eye_lift);
        if lift > 0 && self.mode != Mode::NoClip {
            lift = self.shape().sweep(terrain, 1, lift);
        }
        self.feet() + DVec3::Y * to_voxels(self.measures.eye + lift)
    }

    /// Changes how the body moves. Returns false, and changes nothing, where a body in stone finds no room.
    pub fn set_mode(&mut self, mode: Mode, terrain: &impl Terrain) -> bool {
        if mode != Mode::NoClip && self.shape().overlaps(terrain) {
            match self.nearest_room(terrain) {
                Some(feet) => self.feet = feet,
                None => return false,
            }
        }
        if mode == Mode::Walk && self.mode != Mode::Walk {
            self.velocity.y = self.velocity.y.min(0.0);
        }
        self.mode = mode;
        true
    }

    /// Moves by `dt_s` seconds.
    pub fn step(&mut self, terrain: &impl Terrain, intent: &Intent, dt_s: f64) -> Option<Event> {
        self.eye_lift *= (-dt_s / EYE_S).exp();
        if self.eye_lift.abs() < STILL {
            self.eye_lift = 0.0;
        }
        let mut event = None;
        self.follow_obstacles(terrain);
        if self.mode != Mode::NoClip && self.shape().overlaps(terrain) {
            event = self.free(terrain, dt_s);
            if self.shape().overlaps(terrain) {
                return event;
            }
        }
        match self.mode {
            Mode::Walk => self.walk(terrain, intent, dt_s),
            Mode::Fly | Mode::NoClip => self.fly(terrain, intent, dt_s),
        }
        let farthest = I64Vec3::splat(FARTHEST * ONE);
        self.feet = self.feet.clamp(-farthest, farthest);
        self.rides = self.mode == Mode::Walk && terrain.in_the_way().supports(&self.shape());
        if self.mode == Mode::Walk {
            if self.shape().is_supported(terrain) {
                self.safe = Some(self.feet);
            } else if to_voxels(self.feet.y) < self.bottom - BELOW_WORLD_M * self.measures.scale {
                self.return_to_safety(terrain);
                event = Some(Event::Returned);
            }
        }
        event
    }

    /// Whether a body that may be in stone or in other bodies gets out of them.
    pub fn finds_room(&self, terrain: &impl Terrain) -> bool {
        let has_room = |feet: I64Vec3| !self.at(feet).overlaps(terrain);
        self.mode == Mode::NoClip
            || has_room(self.feet)
            || self.nearest_room(terrain).is_some()
            || self.safe.is_some_and(has_room)
    }

    /// Out of the stone that closed around the body: to room nearby, or to where it last stood.
    fn free(&mut self, terrain: &impl Terrain, dt_s: f64) -> Option<Event> {
        self.velocity = DVec3::ZERO;
        self.search_in_s -= dt_s;
        if self.search_in_s > 0.0 {
            return None;
        }
        let last = self.safe.filter(|feet| !self.at(*feet).overlaps(terrain));
        match self.nearest_room(terrain).or(last) {
            Some(feet) => {
                self.search_in_s = 0.0;
                self.feet = feet;
                Some(Event::Freed)
            }
            None => {
                self.search_in_s = SEARCH_S;
                Some(Event::Stuck)
            }
        }
    }

    /// Back to where the body last stood. Where that ground is gone, it flies, or it would fall for ever.
    fn return_to_safety(&mut self, terrain: &impl Terrain) {
        self.velocity = DVec3::ZERO;
        self.eye_lift = 0.0;
        self.feet = self.safe.unwrap_or(self.start);
        if !self.shape().is_supported(terrain) {
            self.mode = Mode::Fly;
        }
    }

    fn walk(&mut self, terrain: &impl Terrain, intent: &Intent, dt_s: f64) {
        let Measures {
            walk,
            sneak,
            run,
            jump,
            gravity,
            fastest_fall,
            ..
        } = self.measures;
        let is_grounded = self.shape().is_supported(terrain) && self.velocity.y <= 0.0;
        let jumps = is_grounded && intent.up;
        let speed = match intent {
            intent if intent.down => sneak,
            intent if intent.run => run,
            _ => walk,
        };
        let level = |v: DVec3| DVec3::new(v.x, 0.0, v.z).normalize_or_zero();
        let course = level(intent.heading) * f64::from(intent.forward)
            + level(intent.rightwards) * f64::from(intent.right);
        let wanted = course.normalize_or_zero() * speed;
        let lag_s = if is_grounded { ON_GROUND_S } else { IN_AIR_S };
        let fall = self.velocity.y;
        self.velocity.y = 0.0;
        self.approach(wanted, lag_s, dt_s);

        let mut way = point_to_units(self.velocity * dt_s);
        if is_grounded && !jumps {
            if intent.down {
                self.stay_on_edges(terrain, &mut way);
            }
            match self.pushed == DVec3::ZERO {
                true => self.slide_and_step_up(terrain, way),
                false => self.slide(terrain, way),
            }
            if self.shape().is_supported(terrain) || (!intent.down && self.step_down(terrain)) {
                return;
            }
        } else {
            self.slide(terrain, way);
        }
        self.velocity.y = if jumps { jump } else { fall };
        // Exact for a constant acceleration: a jump rises as high at any length of a step.
        let rise = self.velocity.y * dt_s - 0.5 * gravity * dt_s * dt_s;
        self.velocity.y = (self.velocity.y - gravity * dt_s).max(-fastest_fall);
        self.slide(terrain, I64Vec3::Y * to_units(rise));
    }

    fn fly(&mut self, terrain: &impl Terrain, intent: &Intent, dt_s: f64) {
        let rise = f64::from(i8::from(intent.up) - i8::from(intent.down));
        let course = intent.heading * f64::from(intent.forward)
            + intent.rightwards * f64::from(intent.right)
            + DVec3::Y * rise;
        let wanted = course.normalize_or_zero() * intent.fly_speed;
        self.approach(wanted, IN_FLIGHT_S, dt_s);
        let way = point_to_units(self.velocity * dt_s);
        match self.mode {
            Mode::NoClip => self.feet += way,
            Mode::Walk | Mode::Fly => self.slide(terrain, way),
        }
    }

    /// The velocity comes closer to the wanted one.
    fn approach(&mut self, wanted: DVec3, lag_s: f64, dt_s: f64) {
        self.velocity += (wanted - self.velocity) * (1.0 - (-dt_s / lag_s).exp());
        if wanted == DVec3::ZERO && self.velocity.length_squared() < STILL * STILL {
            self.velocity = DVec3::ZERO;
        }
    }

    /// Moves along one axis after the other; what stops the box also stops its velocity on that axis, or gives it its own
    /// if it is pushed.
    fn slide(&mut self, terrain: &impl Terrain, way: I64Vec3) {
        for axis in [1, 0, 2] {
            let free = self.shape().sweep(terrain, axis, way[axis]);
            self.feet[axis] += free;
            if free != way[axis] {
                let pushed = self.pushed[axis];
                self.velocity[axis] = if pushed * self.velocity[axis] > 0.0 {
                    pushed
                } else {
                    0.0
                };
            }
        }
    }
}
