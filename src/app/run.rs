//! A run of a world: applies inputs to the player, the clock, the brush and the voxels. The window and a replay
//! both play through it.

use super::{
    AppError,
    body::{Body, Ground, Mode},
    clock::WorldClock,
    hands::{
        Changes, Hands, Item, Side,
        aim::{Reach, Target},
        bits::Dug,
        brush::{Brush, Stroke, Stroked},
        lamps::{self, LampChange},
    },
    input::Input,
    messages::Messages,
    panel::Settings,
    player::Player,
    viewport::{Choice, Viewport},
};
use crate::{
    frame::FrameError,
    parameters::KEYS,
    world::{Camera, World, voxels::Voxels},
};

/// What a run changes.
pub struct Run<'a> {
    pub viewport: &'a mut Viewport,
    pub settings: &'a mut Settings,
    pub player: &'a mut Player,
    pub hands: &'a mut Hands,
    pub messages: &'a mut Messages,
}

/// Whether a stroke is the first of its button, or one of those while it is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turn {
    First,
    Repeated,
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
        self.settings.clock.advance(elapsed_ns as f64 * 1e-9);
        let ground = self.viewport.ground()?;
        self.player.advance(to_ns, &ground);
        let measures = self.player.body().measures;
        self.hands.bits.advance(to_ns, &ground, &measures);
        for notice in self.player.take_notices() {
            self.messages.toast(notice.text());
        }
        Ok(())
    }

    /// Makes a stroke where the player looks. Returns whether voxels changed.
    fn stroke(&mut self, stroke: Stroke, turn: Turn) -> Result<bool, AppError> {
        let camera = self.view()?;
        let reach = Reach::of(self.player.body());
        self.follow_build();
        let Some(target) = self.viewport.aim(&reach, &camera)? else {
            return Ok(false);
        };
        let world = self.viewport.world();
        let lamp = lamps::met(world, &target).copied();
        match (stroke, lamp) {
            (Stroke::Pick, Some(lamp)) => self.hands.hotbar.pick(Item::Lamp(lamp.block)),
            (Stroke::Pick, None) => self.hands.hotbar.pick(Item::Material(target.material)),
            (Stroke::Dig, Some(lamp)) => self.change_lamp(lamps::dug(&lamp)),
            (Stroke::Dig, None) => {
                let brush = self.settings.brush;
                let is_dug = self.edit(|voxels, _| brush.dig(voxels, target.voxel));
                if is_dug {
                    self.burst(&camera);
                }
                return Ok(is_dug);
            }
            (Stroke::Replace, Some(_)) => {}
            (Stroke::Replace, None) => return Ok(self.replace(&target)),
            // One press hangs or switches one lamp.
            (Stroke::Place, Some(lamp)) if turn == Turn::First => {
                self.change_lamp(lamps::switched(&lamp));
            }
            (Stroke::Place, Some(_)) => {}
            (Stroke::Place, None) => return self.place(&target, &camera, &reach, turn),
        }
        Ok(false)
    }

    /// Places what is in the hand. Returns whether voxels changed.
    fn place(
        &mut self,
        target: &Target,
        camera: &Camera,
        reach: &Reach,
        turn: Turn,
    ) -> Result<bool, AppError> {
        match self.hands.hotbar.item() {
            Some(Item::Material(material)) => {
                let Some(at) = target.before() else {
                    return Ok(false);
                };
                let brush = self.settings.brush;
                Ok(self.edit(|voxels, world| {
                    let (low, high) = reach.kept(world.origin, camera);
                    let hung = lamps::occupied(world);
                    brush.place(voxels, at, material, |voxel| {
                        let is_of_body = voxel.cmpge(low).all() && voxel.cmple(high).all();
                        is_of_body || hung.contains(&voxel)
                    })
                }))
            }
            Some(Item::Lamp(block)) if turn == Turn::First => {
                let eye = camera.position.floor().as_ivec3();
                let (voxels, world) = self.viewport.voxels_and_world()?;
                match lamps::hung(block, voxels, world, target, eye) {
                    Ok(change) => self.change_lamp(change),
                    Err(reason) => self.messages.toast(reason),
                }
                Ok(false)
            }
            Some(Item::Lamp(_)) => Ok(false),
            None => {
                self.messages
                    .toast("This slot is empty: E has everything that can be placed");
                Ok(false)
            }
        }
    }

    /// Gives voxels the material in the hand. Returns whether voxels changed.
    fn replace(&mut self, target: &Target) -> bool {
        let Some(Item::Material(material)) = self.hands.hotbar.item() else {
            self.messages
                .toast("Replacing needs a material in the hand");
            return false;
        };
        let brush = self.settings.brush;
        self.edit(|voxels, _| brush.replace(voxels, target.voxel, material))
    }

    fn change_lamp(&mut self, change: LampChange) {
        self.viewport.put_lamp(change.voxel, change.after);
        self.hands.history.push(Changes::of_lamp(change));
    }

    /// Changes voxels by a stroke. Returns whether there were any to change.
    pub(super) fn edit(&mut self, stroke: impl FnOnce(&mut Voxels, &World) -> Stroked) -> bool {
        let mut changes = Changes::default();
        let edited = self.viewport.edit(|voxels, world| {
            let stroked = stroke(voxels, world);
            changes = stroked.changes;
            stroked.edit
        });
        if let Err(error) = edited {
            self.messages.toast_error(error.to_string());
            return false;
        }
        let edited = !changes.is_empty();
        self.hands.history.push(changes);
        edited
    }

    /// Bits fly off the voxels that the last stroke removed.
    fn burst(&mut self, camera: &Camera) {
        let world = self.viewport.world();
        let Some(changes) = self.hands.history.last() else {
            return;
        };
        let dug = changes.removed(world.size.as_ivec3());
        let dug: Vec<Dug> = dug
            .map(|(voxel, material)| Dug {
                voxel: voxel + world.origin,
                material,
            })
            .collect();
        let measures = self.player.body().measures;
        let eye = camera.position.as_dvec3();
        self.hands
            .bits
            .burst(&dug, &world.materials, eye, &measures);
    }

    /// Lets the next pictures show the bits that fly now, and the bulbs of placed lamps.
    ///
    /// # Errors
    /// [`AppError`] when the device fails.
    pub fn show_bits(&mut self) -> Result<(), AppError> {
        self.follow_build();
        let measures = self.player.body().measures;
        let time_s = self.settings.clock.time_s;
        let ground = self.viewport.ground()?;
        let mut bits = self
            .hands
            .bits
            .seen(self.player.now_ns(), &ground, &measures);
        bits.extend(self.viewport.bulbs(time_s));
        Ok(self.viewport.show_bits(&bits)?)
    }

    /// Returns whether anything changed.
    fn undo(&mut self) -> bool {
        self.follow_build();
        let viewport = &mut *self.viewport;
        let undone = self
            .hands
            .history
            .undo(|changes| viewport.put(changes, Side::Before));
        self.went(undone, "There is nothing to undo")
    }

    /// Returns whether anything changed.
    fn redo(&mut self) -> bool {
        self.follow_build();
        let viewport = &mut *self.viewport;
        let redone = self
            .hands
            .history
            .redo(|changes| viewport.put(changes, Side::After));
        self.went(redone, "There is nothing to redo")
    }

    pub(super) fn follow_build(&mut self) {
        let build = self.viewport.build();
        self.hands.follow(self.viewport.world(), build);
    }

    fn went(&mut self, done: Result<bool, FrameError>, nothing: &str) -> bool {
        match done {
            Ok(true) => return true,
            Ok(false) => self.messages.toast(nothing),
            Err(error) => self.messages.toast_error(error.to_string()),
        }
        false
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
        let origin = self.world().origin;
        let voxels = self.voxels()?;
        Ok(Ground { voxels, origin })
    }

    /// What a stroke where `camera` looks would meet.
    ///
    /// # Errors
    /// [`AppError`] when the voxels must be read back and the device is lost.
    pub fn aim(&mut self, reach: &Reach, camera: &Camera) -> Result<Option<Target>, AppError> {
        let (voxels, world) = self.voxels_and_world()?;
        Ok(reach.aim(voxels, &world.restored.lamps, world.origin, camera))
    }

    /// Gives everything that a stroke changed what it was before, or after.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold it; then nothing changes.
    pub fn put(&mut self, changes: &Changes, side: Side) -> Result<(), FrameError> {
        self.edit(|voxels, _| changes.put(voxels, side))?;
        if let Some((voxel, lamp)) = changes.lamp(side) {
            self.put_lamp(voxel, lamp);
        }
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
