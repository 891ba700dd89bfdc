//! A run of a world: applies inputs to the player, the clock, the brush and the voxels. The window and a replay
//! both play through it.

mod bits;
mod bodies;
mod clip;
mod noises;
mod strokes;
mod undo;

use strokes::Turn;

use super::{
    AppError,
    body::{Body, Ground, Mode},
    clock::{ClockReading, WorldClock},
    hands::{Hands, aim::Reach, brush::Brush},
    input::Input,
    messages::Messages,
    panel::Settings,
    player::Player,
    sound::{Noises, Place},
    viewport::{Choice, Viewport},
};
use crate::{parameters::KEYS, world::Camera};

/// What a run changes.
pub struct Run<'a> {
    pub viewport: &'a mut Viewport,
    pub settings: &'a mut Settings,
    pub player: &'a mut Player,
    pub hands: &'a mut Hands,
    pub messages: &'a mut Messages,
    pub noises: &'a mut Noises,
}

/// What an input did that costs time, so that frame times from before say nothing any more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Done {
    /// The world or its probes were built again.
    pub remade: bool,
    /// Voxels changed.
    pub edited: bool,
}

impl Run<'_> {
    /// Applies an input at the current simulated time.
    ///
    /// # Errors
    /// [`AppError`] when the device fails. Inputs that the world does not know change nothing but the messages.
    pub fn take(&mut self, input: &Input) -> Result<Done, AppError> {
        let mut done = Done::default();
        match input {
            Input::Stroke(stroke) => done.edited = self.stroke(*stroke, Turn::First)?,
            Input::Hold(stroke) => {
                done.edited = self.stroke(*stroke, Turn::First)?;
                self.hands.held.begin(*stroke, self.player.now_ns());
            }
            Input::LetGo(stroke) => self.hands.held.end(*stroke),
            Input::Undo => done.edited = self.undo(),
            Input::Redo => done.edited = self.redo(),
            Input::Brush(brush) => self.settings.brush = *brush,
            Input::Clip(clip) => done.edited = self.clip(*clip)?,
            Input::Slot(slot) => self.hands.hotbar.select(*slot),
            Input::Scroll(slots) => self.hands.hotbar.scroll(*slots),
            Input::Item { slot, item } => {
                if item.name(self.viewport.world()).is_some() {
                    self.hands.hotbar.put(*slot, *item);
                }
            }
            Input::Camera(index) => self.jump_to(*index)?,
            Input::Clock {
                paused,
                rate,
                time_s,
            } => {
                self.settings.clock = WorldClock {
                    paused: *paused,
                    rate: *rate,
                    time_s: *time_s,
                };
                self.tell_time();
            }
            Input::Set(assignment) => {
                let mut next = self.viewport.choice().clone();
                match next.parameters.set(assignment) {
                    Ok(()) => done.remade = self.choose(next),
                    Err(error) => self.messages.toast_error(error.to_string()),
                }
            }
            Input::Layout(name) => {
                let mut next = self.viewport.choice().clone();
                next.layout.clone_from(name);
                done.remade = self.choose(next);
            }
            Input::Resize(size) => {
                let mut next = self.viewport.choice().clone();
                next.size = *size;
                done.remade = self.choose(next);
            }
            Input::Reload => {
                self.reload_world();
                done.remade = true;
            }
            input => {
                if *input == Input::Focus(false) {
                    self.hands.held.end_all();
                }
                self.player.take(input, &self.viewport.ground()?);
            }
        }
        Ok(done)
    }

    /// Simulates until this time (nanoseconds of the run), advances world time by as much, and repeats the
    /// strokes of a held button whenever they are due.
    ///
    /// # Errors
    /// [`AppError`] when the device fails.
    pub fn advance(&mut self, to_ns: u64) -> Result<Done, AppError> {
        let mut done = Done::default();
        while let Some(due_ns) = self.hands.held.due_ns(to_ns) {
            self.simulate(due_ns)?;
            if let Some(stroke) = self.hands.held.take_due(due_ns) {
                done.edited |= self.stroke(stroke, Turn::Repeated)?;
            }
        }
        self.simulate(to_ns)?;
        Ok(done)
    }

    fn simulate(&mut self, to_ns: u64) -> Result<(), AppError> {
        let elapsed_ns = to_ns.saturating_sub(self.player.now_ns());
        self.tell_time();
        self.settings.clock.advance(elapsed_ns as f64 * 1e-9);
        self.advance_player(to_ns)?;
        let ground = self.viewport.ground()?;
        let measures = self.player.body().measures;
        self.hands.bits.advance(to_ns, &ground, &measures);
        for notice in self.player.take_notices() {
            self.messages.hint(notice.text());
        }
        for footfall in self.player.take_footfalls() {
            self.footfall(&footfall)?;
        }
        self.tell_time();
        Ok(())
    }

    /// Bodies are where the clock says: it is read where simulated time has come to.
    fn tell_time(&mut self) {
        self.viewport.clock = ClockReading {
            at_ns: self.player.now_ns(),
            clock: self.settings.clock,
        };
    }

    /// What the player sees now.
    ///
    /// # Errors
    /// [`AppError`] when the device fails.
    pub fn view(&mut self) -> Result<Camera, AppError> {
        Ok(self.player.view(&self.viewport.ground()?))
    }

    /// Returns whether anything was rebuilt.
    fn choose(&mut self, next: Choice) -> bool {
        if next == *self.viewport.choice() {
            return false;
        }
        let remade = self.viewport.apply(next).unwrap_or_else(|error| {
            self.messages.toast_error(error.to_string());
            false
        });
        // What cannot be shown is reverted.
        self.settings.choice = self.viewport.choice().clone();
        self.player.resize(self.viewport.world());
        self.follow_build();
        self.tell_notes();
        remade
    }

    /// Says what no longer fits a world that was built again.
    fn tell_notes(&mut self) {
        for note in self.viewport.take_notes() {
            self.messages.toast_error(note);
        }
    }

    fn reload_world(&mut self) {
        self.messages.world = match self.viewport.reload_world() {
            Ok(()) => {
                self.messages.toast("world read again");
                None
            }
            Err(error) => Some(error.to_string()),
        };
        self.settings.choice = self.viewport.choice().clone();
        self.player.resize(self.viewport.world());
        self.follow_build();
        self.tell_notes();
    }

    fn jump_to(&mut self, index: usize) -> Result<(), AppError> {
        let Some(camera) = self.viewport.world().cameras.get(index).cloned() else {
            return Ok(());
        };
        let world = self.viewport.world().clone();
        self.player.place(&camera, &world, &self.viewport.ground()?);
        self.messages.toast(format!("camera {}", camera.name));
        Ok(())
    }
}

/// What a user last chose in the panel, to find out what was changed there.
#[derive(Clone, Debug)]
pub struct Chosen {
    choice: Choice,
    clock: WorldClock,
    brush: Brush,
}

impl Chosen {
    /// What a run begins with.
    pub fn at_start(viewport: &Viewport) -> Self {
        Self {
            choice: viewport.choice().clone(),
            clock: WorldClock::default(),
            brush: Brush::default(),
        }
    }

    pub fn of(viewport: &Viewport, settings: &Settings) -> Self {
        Self {
            choice: viewport.choice().clone(),
            clock: settings.clock,
            brush: settings.brush,
        }
    }

    /// The inputs that lead from here to `next`.
    pub fn changes_to(&self, next: &Self) -> Vec<Input> {
        let mut inputs = Vec::new();
        if self.clock != next.clock {
            let WorldClock {
                paused,
                rate,
                time_s,
            } = next.clock;
            inputs.push(Input::Clock {
                paused,
                rate,
                time_s,
            });
        }
        if self.brush != next.brush {
            inputs.push(Input::Brush(next.brush));
        }
        let (old, new) = (&self.choice, &next.choice);
        let changed = KEYS
            .iter()
            .filter(|key| key.get(&old.parameters) != key.get(&new.parameters));
        inputs.extend(
            changed.map(|key| Input::Set(format!("{}={}", key.name, key.get(&new.parameters)))),
        );
        if old.layout != new.layout {
            inputs.push(Input::Layout(new.layout.clone()));
        }
        if old.size != new.size {
            inputs.push(Input::Resize(new.size));
        }
        inputs
    }
}

/// The world of a viewport for the player who is in it.
impl Viewport {
    /// # Errors
    /// [`AppError`] when the voxels must be read back and the device is lost.
    pub fn ground(&mut self) -> Result<Ground<'_>, AppError> {
        let clock = self.clock;
        let (voxels, world) = self.voxels_and_world()?;
        Ok(Ground::new(voxels, world.origin).with_bodies(&world.bodies, clock))
    }

    /// Lets `hear` know what surrounds a camera.
    ///
    /// # Errors
    /// [`AppError`] when the voxels must be read back and the device is lost.
    pub fn with_place(
        &mut self,
        camera: &Camera,
        voxels_per_m: f64,
        hear: impl FnOnce(&Place<'_>),
    ) -> Result<(), AppError> {
        let materials = self.world().materials.iter();
        let sounds: Vec<_> = materials.map(|material| material.sound).collect();
        let Ground { voxels, origin, .. } = self.ground()?;
        hear(&Place {
            voxels,
            sounds: &sounds,
            ear: camera.position.as_dvec3() - origin.as_dvec3(),
            voxels_per_m,
        });
        Ok(())
    }
}

impl Reach {
    /// How far a player reaches: like an arm, or everywhere for one who passes through voxels.
    pub fn of(body: &Body) -> Self {
        match body.mode {
            Mode::NoClip => Self::default(),
            Mode::Walk | Mode::Fly => Self {
                distance: body.measures.reach,
                body: Some(body.shape().voxels()),
            },
        }
    }
}
