//! The run that the window shows: inputs from the user, or from a record.

use std::time::Duration;

use super::{super::run::Run, Session};
use crate::app::{
    AppError, Options,
    body::Ground,
    hands::{
        Hands,
        aim::{Reach, Target},
        brush::Shape,
        extent::Eye,
        outline::{self, Segment},
    },
    input::Input,
    player::Player,
    record::{Header, Moment, Playback, RecordError, Recorder, crc32_of},
    run::Chosen,
    sound::{Noises, Sound},
    texts::toasts,
    viewport::Viewport,
};

/// Longest simulated time of a frame, so that a stall does not become a leap.
const LONGEST_FRAME: Duration = Duration::from_millis(250);

/// The player, and where inputs come from and go to.
pub(super) struct Play {
    pub player: Player,
    pub hands: Hands,
    pub sound: Sound,
    noises: Noises,
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
            player,
            hands: Hands::new(viewport.world(), viewport.build()),
            sound: Sound::open(),
            noises: Noises::default(),
            pending: Vec::new(),
            chosen: Chosen::at_start(viewport),
            recorder: recorder.transpose()?,
            playback: options.replay.clone().map(Playback::new),
            unrecorded: None,
        })
    }

    /// Begins a run of its own, in a world that is entered from the menu. It is heard as the one before, and the copied
    /// box is kept.
    pub fn begin_again(&mut self, player: Player, viewport: &Viewport) {
        self.player = player;
        self.hands = Hands::new(viewport.world(), viewport.build()).with_copy_of(&self.hands);
        self.noises = Noises::default();
        self.pending.clear();
        self.chosen = Chosen::at_start(viewport);
        self.recorder = None;
        self.playback = None;
        self.unrecorded = None;
    }

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
            noises: &mut self.play.noises,
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
        run.show_bits()?;
        if let Err(error) = self.viewport.show_waiting_bodies() {
            self.messages.toast_error(error.to_string());
        }
        self.hear(to_ns)?;
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
            self.messages.toast(toasts::REPLAY_OVER);
        }
        Ok(())
    }

    /// Lets the frame that ends at a simulated time be heard.
    fn hear(&mut self, now_ns: u64) -> Result<(), AppError> {
        let voxels_per_m = self.play.player.body().measures.scale;
        self.viewport
            .with_place(&self.camera, voxels_per_m, |place| {
                self.play.sound.hear(place, &mut self.play.noises, now_ns);
            })
    }

    /// The voxel that a click would meet, and what is outlined on the screen: that voxel, what the brush covers, and the
    /// box that is copied or pasted; or a body.
    pub(super) fn aim(&mut self) -> Option<(Option<Target>, Vec<Segment>)> {
        let reach = Reach::of(self.play.player.body());
        if let Some(edges) = self.outline_of_body(&reach) {
            return Some((None, edges));
        }
        let [width, height] = self.viewport.frame().size().map(f64::from);
        let target = self.viewport.aim(&reach, &self.camera).ok()??;
        let ground = self.viewport.ground().ok()?;
        let basis = self.camera.basis(width / height);
        let mut edges = outline::of_target(ground.voxels, ground.origin, &basis, &target);
        let eye = Eye {
            voxels: ground.voxels,
            origin: ground.origin,
            camera: &basis,
        };
        let clipboard = &self.play.hands.clipboard;
        edges.extend(match clipboard.extent(ground.origin, &target) {
            Some((low, high)) => eye.of_box(low, high),
            None => eye.of_brush(&self.settings.brush, target.voxel),
        });
        Some((Some(target), edges))
    }

    /// The box around the free body that is aimed at.
    fn outline_of_body(&mut self, reach: &Reach) -> Option<Vec<Segment>> {
        let [width, height] = self.viewport.frame().size().map(f64::from);
        let ahead = self.viewport.aim_at_body(reach, &self.camera).ok()??;
        let index = ahead.free?;
        let bodies = &self.viewport.world().bodies;
        let bounds = self.viewport.free_bodies().bounds(bodies, index)?;
        let Ground { voxels, origin, .. } = self.viewport.ground().ok()?;
        let eye = Eye {
            voxels,
            origin,
            camera: &self.camera.basis(width / height),
        };
        Some(eye.of_bounds(bounds.map(|at| at - origin.as_dvec3())))
    }

    /// What the hands hold besides a brush of one voxel, in words.
    pub(super) fn in_hands(&self, target: Option<&Target>) -> Option<String> {
        let origin = self.viewport.world().origin;
        let brush = &self.settings.brush;
        let copy = self.play.hands.clipboard.text(origin, target);
        copy.or_else(|| (brush.shape != Shape::Voxel).then(|| brush.text()))
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
