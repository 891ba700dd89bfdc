//! Plays a record without a window, at a frame rate of its own: for tests, bug reports and films.

mod latency;

use std::{
    collections::VecDeque,
    path::Path,
    time::{Duration, Instant},
};

pub use latency::LatencyFigures;

use latency::Latency;

use super::{
    AppError,
    hands::Hands,
    messages::Messages,
    panel::Settings,
    player::Player,
    record::{Playback, Record},
    run::Run,
    sound::{Noises, Soundtrack},
    viewport::{Choice, Viewport},
};
use crate::{
    gpu::{DeviceErrors, Gpu, GpuError, Recorder},
    measure::picture::Picture,
    parameters::Parameters,
    passes::view::Inspection,
    world::{Camera, PlacedLamp, World, bodies::ChangedBodies},
};

/// Frames that the adapter may have at a time, so that it draws one while the next is made, as in the window.
const IN_FLIGHT: usize = 2;

/// A record while it is played.
pub struct Replay {
    viewport: Viewport,
    device_errors: DeviceErrors,
    settings: Settings,
    player: Player,
    hands: Hands,
    messages: Messages,
    playback: Playback,
    latency: Latency,
    noises: Noises,
    /// What is heard, if that was asked for, and the samples of the last frame.
    soundtrack: Option<Soundtrack>,
    heard: Vec<[f32; 2]>,
    camera: Camera,
    seed: u32,
    frames_per_s: u32,
    end_ns: u64,
    frames: u64,
    /// Frames that the adapter may still draw, oldest first.
    in_flight: VecDeque<wgpu::SubmissionIndex>,
    /// Time that it took to make the last frame, without waiting for the adapter.
    making: Duration,
    /// The size of all pictures, where it is not the record's.
    size: Option<[u32; 2]>,
}

/// How a replay begins.
pub struct ReplayOptions<'a> {
    /// The world of the record, with its parameters, and the file that it was read from.
    pub world: World,
    pub world_path: &'a Path,
    pub parameters: Parameters,
    pub inspection: Inspection,
    pub frames_per_s: u32,
    /// Width and height of all pictures in pixels; `None` for those of the record.
    pub size: Option<[u32; 2]>,
    /// Whether [`Replay::heard`] is wanted.
    pub sound: bool,
}

/// Where a run has come to.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    pub frames: u64,
    /// Steps of the simulation.
    pub steps: u64,
    /// Simulated seconds.
    pub time_s: f64,
    pub camera: Camera,
    /// CRC-32 of all voxels.
    pub voxels_crc32: u32,
    /// In the order of placing.
    pub lamps: Vec<PlacedLamp>,
    /// Those that were placed or pushed.
    pub bodies: ChangedBodies,
    pub latency: LatencyFigures,
}

impl Replay {
    /// Builds the world of a record.
    ///
    /// # Errors
    /// [`AppError`] when the adapter cannot hold it.
    pub fn new(gpu: Gpu, record: Record, options: ReplayOptions<'_>) -> Result<Self, AppError> {
        let device_errors = DeviceErrors::watch(&gpu);
        let header = record.header.clone();
        let choice = Choice {
            parameters: options.parameters,
            layout: header.layout.clone(),
            size: options.size.unwrap_or(header.size),
            traced: false,
        };
        let mut viewport = Viewport::new(gpu, options.world_path, options.world, choice)?;
        let mut inspection = options.inspection;
        viewport.inspect(&mut inspection)?;
        let settings = Settings::of_replay(viewport.choice().clone(), inspection);
        let camera = header.camera();
        let world = viewport.world().clone();
        let player = Player::new(&camera, &world, &viewport.ground()?);
        let hands = Hands::new(&world, viewport.build());
        Ok(Self {
            viewport,
            device_errors,
            settings,
            player,
            hands,
            messages: Messages::default(),
            end_ns: record.end_ns(),
            playback: Playback::new(record),
            latency: Latency::default(),
            noises: Noises::default(),
            soundtrack: options.sound.then(Soundtrack::new),
            heard: Vec::new(),
            camera,
            seed: header.seed,
            frames_per_s: options.frames_per_s,
            frames: 0,
            in_flight: VecDeque::new(),
            making: Duration::ZERO,
            size: options.size,
        })
    }

    /// Number of frames of the whole replay.
    pub fn length(&self) -> u64 {
        let frames = u128::from(self.end_ns) * u128::from(self.frames_per_s);
        (frames.div_ceil(1_000_000_000) as u64).max(1)
    }

    /// Plays and draws the next frame. Returns false when the record is over.
    ///
    /// # Errors
    /// [`AppError`] when the adapter fails.
    pub fn next_frame(&mut self) -> Result<bool, AppError> {
        if self.frames == self.length() {
            self.finish()?;
            return Ok(false);
        }
        let begun = Instant::now();
        self.frames += 1;
        let frame_end = u128::from(self.frames) * 1_000_000_000 / u128::from(self.frames_per_s);
        let to_ns = (frame_end as u64).min(self.end_ns);
        self.play_to(to_ns)?;
        let gpu = self.viewport.gpu.clone();
        let mut recorder = Recorder::new(&gpu, None);
        let time_s = self.settings.clock.time_s;
        self.viewport
            .record(&mut recorder, &self.camera, time_s, self.seed)?;
        self.in_flight.push_back(recorder.submit(&gpu)?);
        self.making = begun.elapsed();
        if self.in_flight.len() >= IN_FLIGHT
            && let Some(oldest) = self.in_flight.pop_front()
        {
            gpu.wait_for(oldest)?;
        }
        self.check()?;
        Ok(true)
    }

    /// Waits until the adapter has drawn every frame.
    ///
    /// # Errors
    /// [`AppError`] when the adapter fails.
    pub fn finish(&mut self) -> Result<(), AppError> {
        self.in_flight.clear();
        self.viewport.gpu.wait()?;
        self.check()
    }

    fn check(&self) -> Result<(), AppError> {
        self.device_errors
            .first()
            .map_or(Ok(()), |error| Err(error.into()))
    }

    /// Time that it took to make the last frame: simulation, recording and submission.
    pub fn making(&self) -> Duration {
        self.making
    }

    fn play_to(&mut self, to_ns: u64) -> Result<(), AppError> {
        for moment in self.playback.before(to_ns) {
            self.advance(moment.at_ns)?;
            for input in &moment.inputs {
                if self.size.is_some() && matches!(input, super::input::Input::Resize(_)) {
                    continue;
                }
                self.latency
                    .input(&self.player, input, &self.viewport.ground()?);
                self.run().take(input)?;
            }
        }
        self.advance(to_ns)?;
        self.run().show_bits()?;
        let ground = self.viewport.ground()?;
        self.latency.shown(&self.player, &ground);
        self.camera = self.player.view(&ground);
        self.hear(to_ns)
    }

    fn hear(&mut self, now_ns: u64) -> Result<(), AppError> {
        let Some(soundtrack) = &mut self.soundtrack else {
            self.noises = Noises::default();
            return Ok(());
        };
        let voxels_per_m = self.player.body().measures.scale;
        self.viewport
            .with_place(&self.camera, voxels_per_m, |place| {
                self.heard = soundtrack.frame(place, &mut self.noises, now_ns);
            })
    }

    /// The samples of the left and the right ear of the last frame, [`super::sound::wav::RATE_HZ`] in a second;
    /// none unless the replay was made with sound.
    pub fn heard(&self) -> &[[f32; 2]] {
        &self.heard
    }

    fn advance(&mut self, to_ns: u64) -> Result<(), AppError> {
        // A stroke of a held button changes the ground of all that the latency compares.
        while let Some(due_ns) = self.hands.held.due_ns(to_ns) {
            self.latency.advance(due_ns, &self.viewport.ground()?);
            self.run().advance(due_ns)?;
        }
        self.latency.advance(to_ns, &self.viewport.ground()?);
        self.run().advance(to_ns)?;
        Ok(())
    }

    fn run(&mut self) -> Run<'_> {
        Run {
            viewport: &mut self.viewport,
            settings: &mut self.settings,
            player: &mut self.player,
            hands: &mut self.hands,
            messages: &mut self.messages,
            noises: &mut self.noises,
        }
    }

    /// The last frame as a display shows it.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn picture(&self) -> Result<Picture, GpuError> {
        self.viewport.read_display()
    }

    /// Errors of inputs since the last call: the run went on without them.
    pub fn take_errors(&mut self) -> Vec<String> {
        self.messages.take_errors()
    }

    pub fn gpu(&self) -> &Gpu {
        &self.viewport.gpu
    }

    /// Where the run has come to.
    ///
    /// # Errors
    /// [`AppError`] when the voxels must be read back and the device is lost.
    pub fn state(&mut self) -> Result<State, AppError> {
        Ok(State {
            frames: self.frames,
            steps: self.player.steps(),
            time_s: self.player.now_ns() as f64 * 1e-9,
            camera: self.camera.clone(),
            voxels_crc32: self.viewport.voxels()?.crc32(),
            lamps: self.viewport.placed_lamps().to_vec(),
            bodies: self.viewport.world().bodies.changes(),
            latency: self.latency.figures(),
        })
    }
}
