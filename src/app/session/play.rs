//! The run that the window shows: inputs from the user, or from a record.

use std::time::Duration;

use super::{super::run::Run, Session};
use crate::app::{
    AppError, Options,
    hands::{
        Hands,
        aim::{Reach, Target},
        outline::{self, Segment},
    },
    input::Input,
    player::Player,
    record::{Header, Moment, Playback, RecordError, Recorder, crc32_of},
    run::Chosen,
    viewport::Viewport,
};
use crate::world::Camera;

/// Longest simulated time of a frame, so that a stall does not become a leap.
const LONGEST_FRAME: Duration = Duration::from_millis(250);

/// The player, and where inputs come from and go to.
pub(super) struct Play {
    pub player: Player,
    pub hands: Hands,
    /// Inputs since the last frame.
    pending: Vec<Input>,
    /// What was chosen in the panel at the last frame.
    chosen: Chosen,
    recorder: Option<Recorder>,
    playback: Option<Playback>,
    /// Why the record could not be written.
    unrecorded: Option<RecordError>,
}

impl Play {
    /// # Errors
    /// [`AppError`] when the voxels cannot be read back, or the record cannot be written.
    pub fn begin(options: &Options, viewport: &mut Viewport) -> Result<Self, AppError> {
        let world = viewport.world().clone();
        let player = Player::new(&options.camera, &world, &viewport.ground()?);
        let recorder = options.record.as_ref().map(|path| {
            let crc32 = crc32_of(&options.recorded_world).map_err(RecordError::File)?;
            let header = Header::new(
                &options.recorded_world,
                crc32,
                options.seed,
                viewport.choice(),
                &options.camera,
            );
            Recorder::create(path, &header)
        });
        Ok(Self {
            recorder: recorder.transpose()?,
            playback: options.replay.clone().map(Playback::new),
            ..Self::of(player, viewport)
        })
    }

    /// A run of its own, in a world that is entered from the menu.
    ///
    /// # Errors
    /// [`AppError`] when the voxels cannot be read back.
    pub fn afresh(camera: &Camera, viewport: &mut Viewport) -> Result<Self, AppError> {
        let world = viewport.world().clone();
        let player = Player::new(camera, &world, &viewport.ground()?);
        Ok(Self::of(player, viewport))
    }

    fn of(player: Player, viewport: &Viewport) -> Self {
        Self {
            player,
            hands: Hands::default(),
            pending: Vec::new(),
            chosen: Chosen::at_start(viewport),
            recorder: None,
            playback: None,
            unrecorded: None,
        }
    }
}

impl Play {
    /// Whether a record plays now.
    pub fn is_replay(&self) -> bool {
        self.playback.is_some()
    }
}

impl Session {
    /// The next frame takes this input. A replay takes no others than its own.
    pub(super) fn give(&mut self, input: Input) {
        if self.play.playback.is_none() {
            self.play.pending.push(input);
        }
    }

    /// Plays the time since the last frame, and looks through the player's eye.
    ///
    /// # Errors
    /// [`AppError`] when the device fails.
    pub(super) fn play_on(&mut self, elapsed: Duration) -> Result<(), AppError> {
        let from_ns = self.play.player.now_ns();
        let to_ns = from_ns + elapsed.min(LONGEST_FRAME).as_nanos() as u64;
        let moments = match &mut self.play.playback {
            Some(playback) => playback.before(to_ns),
            None => vec![self.live(from_ns)],
        };
        let mut run = Run {
            viewport: &mut self.viewport,
            settings: &mut self.settings,
            player: &mut self.play.player,
            hands: &mut self.play.hands,
            messages: &mut self.messages,
        };
        let (mut remade, mut edited) = (false, false);
        for moment in moments {
            edited |= run.advance(moment.at_ns)?.edited;
            for input in &moment.inputs {
                // The picture of a window has the window's size.
                if self.play.playback.is_some() && matches!(input, Input::Resize(_)) {
                    continue;
                }
                let done = run.take(input)?;
                remade |= done.remade;
                edited |= done.edited;
            }
        }
        edited |= run.advance(to_ns)?.edited;
        self.camera = run.view()?;
        self.play.chosen = Chosen::of(&self.viewport, &self.settings);
        if remade {
            self.remade();
        }
        if edited {
            // The edit may have freed probes from solid voxels, or buried them.
            self.probes = None;
        }
        if self.play.playback.as_mut().is_some_and(Playback::is_over) {
            self.play.playback = None;
            self.give(Input::FieldOfView(self.preferences.field_of_view_deg));
            self.messages.toast("The replay is over: go on from here");
        }
        Ok(())
    }

    /// The voxel that a click would meet, and its edges on the screen.
    pub(super) fn aim(&mut self) -> Option<(Target, Vec<Segment>)> {
        let reach = Reach::of(self.play.player.body());
        let [width, height] = self.viewport.frame().size().map(f64::from);
        let ground = self.viewport.ground().ok()?;
        let target = reach.aim(ground.voxels, ground.origin, &self.camera)?;
        let basis = self.camera.basis(width / height);
        let edges = outline::of_target(ground.voxels, ground.origin, &basis, &target);
        Some((target, edges))
    }

    /// What the user did since the last frame.
    fn live(&mut self, at_ns: u64) -> Moment {
        let chosen = Chosen::of(&self.viewport, &self.settings);
        let mut inputs = self.play.chosen.changes_to(&chosen);
        inputs.append(&mut self.play.pending);
        if let Some(recorder) = &mut self.play.recorder
            && let Err(error) = recorder.add(at_ns, &inputs)
        {
            self.messages.toast_error(error.to_string());
            self.play.unrecorded = Some(error);
            self.play.recorder = None;
        }
        Moment::new(at_ns, inputs)
    }

    /// Ends the run: its record gets its name.
    ///
    /// # Errors
    /// [`AppError::Record`] when the record is incomplete.
    pub fn finish(&mut self) -> Result<(), AppError> {
        if let Some(recorder) = self.play.recorder.take() {
            recorder.finish(self.play.player.now_ns())?;
        }
        self.play
            .unrecorded
            .take()
            .map_or(Ok(()), |error| Err(error.into()))
    }
}
