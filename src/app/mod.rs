//! The window: a player who walks and flies through a world, a panel, and files that are read again when
//! they are edited.
//!
//! `session` is an open window: it takes input and draws the frames. `viewport` is the world that it shows. `run`
//! applies each `input` to the `player`, its `body`, and the voxels; `record` keeps inputs, and `replay` plays them
//! without a window, and `saving` writes saves. The other modules are their parts: `controls` holds the keys, `settings`
//! what stays from run to run, `gamepad` hears what is no key, `texts` the words of the `menu`, `hands` dig and build,
//! `inventory` shows what can be placed, `panel` and `widgets` choose, `readout` shows where the player is, `quality` says
//! how much work a picture gets, `sound` lets the run be heard, `screen` is the surface, `reload` watches files,
//! `benchmark` flies by itself, and
//! `time_graph` draws frame times.

mod benchmark;
mod body;
mod clock;
mod controls;
// Without the feature only its tests run.
#[cfg(any(feature = "gamepad", test))]
mod gamepad;
mod hands;
mod icon;
mod input;
mod inventory;
mod menu;
mod messages;
mod named_lines;
mod pace;
mod panel;
mod player;
pub mod quality;
mod readout;
pub mod record;
mod reference_view;
mod reload;
pub mod replay;
mod run;
pub mod saving;
mod screen;
mod screenshot;
mod session;
mod settings;
pub mod sound;
mod texts;
mod time_graph;
mod viewport;
mod views;
mod widgets;

use std::{
    cell::Cell,
    env,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

use winit::{
    application::ApplicationHandler,
    error::EventLoopError,
    event::{DeviceEvent, DeviceId, StartCause, WindowEvent},
    event_loop::{ActiveEventLoop, ControlFlow, EventLoop},
    window::WindowId,
};

use crate::{
    frame::FrameError,
    gpu::{Gpu, GpuError},
    measure::whole_file::FileError,
    parameters::Parameters,
    passes::view::Inspection,
    world::{Camera, World, save::SaveError},
};
use quality::Quality;
use record::{Record, RecordError};
use saving::SaveOptions;
use session::Session;

/// What a window starts with.
pub struct Options {
    /// The file that `world` was read from, with the overrides of `parameters`.
    pub world_path: PathBuf,
    pub world: World,
    pub parameters: Parameters,
    /// `None`: what the settings say.
    pub quality: Option<Quality>,
    /// The frame time to hold (milliseconds); `None`: by the adapter.
    pub target_ms: Option<f64>,
    pub camera: Camera,
    /// Name of a probe layout of the world.
    pub layout: String,
    pub inspection: Inspection,
    /// Show the path-traced picture in place of the one lit by probes.
    pub traced: bool,
    /// Width and height of the window in pixels; `None`: those of the settings.
    pub size: Option<[u32; 2]>,
    /// What of `parameters` was set on the command line, as `KEY=VALUE`: it comes before the settings.
    pub set: Vec<String>,
    /// Part of the name of the adapter to run on; `None` for the fastest.
    pub adapter: Option<String>,
    /// Seed of the random rays.
    pub seed: u32,
    /// Reads the shaders from this folder, and again whenever they are edited.
    pub shaders: Option<PathBuf>,
    /// Starts with the title screen: the world is only to look at.
    pub title: bool,
    /// Starts with the benchmark.
    pub benchmark: bool,
    /// Closes the window after this many frames.
    pub frames: Option<u32>,
    /// Records the run into this file.
    pub record: Option<PathBuf>,
    /// The world or save that a record names: a replay begins with it.
    pub recorded_world: PathBuf,
    /// Where the run is saved.
    pub saves: SaveOptions,
    /// Plays this record before the user takes over.
    pub replay: Option<Record>,
    /// Ends the window as its close button does, once it is set.
    pub stop: Arc<AtomicBool>,
    /// Destroys the device after this many frames, as a failing driver does: for tests.
    pub lose_device_at: Option<u32>,
    /// The adapter, opened while the world was read. The window takes it if it can present there.
    pub opened: Cell<Option<Gpu>>,
}

/// Why the window did not open, or closed.
#[derive(Debug, thiserror::Error)]
pub enum AppError {
    #[error(
        "no window can be opened: {0}\n\
         Without a display, `grotto render WORLD -o FILE.png` draws a picture of a world."
    )]
    NoWindow(String),
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error(transparent)]
    Frame(#[from] FrameError),
    #[error(transparent)]
    Record(#[from] RecordError),
    #[error(transparent)]
    Save(#[from] SaveError),
}

/// Whether the system says that there is a display. An event loop would tell for certain, but a process can make only
/// one.
pub fn has_display() -> bool {
    let is_named = |name| env::var_os(name).is_some_and(|value| !value.is_empty());
    let is_x11_or_wayland = cfg!(all(unix, not(target_os = "macos")));
    !is_x11_or_wayland
        || ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"]
            .into_iter()
            .any(is_named)
}

/// The world behind the title screen, as a file.
///
/// # Errors
/// [`FileError`] when it cannot be written.
pub fn title_world() -> Result<PathBuf, FileError> {
    let first = menu::built_in().swap_remove(0);
    first.path(&menu::Folders::of_user())
}

/// The file of a world that comes with grotto, for its name: `cave`, `cave.ron` or `worlds/cave.ron`.
pub fn bundled_world(name: &Path) -> Option<PathBuf> {
    menu::bundled(name, &menu::Folders::of_user())
}

/// Opens the window. Returns, when it is closed, the number of frames that it has shown.
///
/// # Errors
/// [`AppError`] without a display or a usable adapter, when the adapter cannot hold the world, and when the
/// adapter fails later.
pub fn run(options: Options) -> Result<u32, AppError> {
    let no_window = |error: EventLoopError| AppError::NoWindow(without_place(&error.to_string()));
    let event_loop = EventLoop::new().map_err(no_window)?;
    let mut app = App {
        options,
        session: None,
        error: None,
        requested: Instant::now(),
    };
    event_loop.run_app(&mut app).map_err(no_window)?;
    let (mut presented, mut error) = (0, app.error);
    if let Some(session) = &mut app.session {
        presented = session.presented();
        session.keep_settings_at_end();
        let finished = session.finish();
        error = error.or(finished.err());
        match session.save_at_end() {
            Ok(Some(path)) => tracing::info!("saved {}", path.display()),
            Ok(None) => {}
            Err(failed) => error = error.or(Some(failed)),
        }
    }
    error.map_or(Ok(presented), Err)
}

/// An error of winit without the source position that it begins with.
fn without_place(message: &str) -> String {
    let told = message
        .strip_prefix("os error at ")
        .and_then(|rest| rest.split_once(".rs:"))
        .and_then(|(_, rest)| rest.split_once(": "));
    told.map_or(message, |(_line, told)| told).to_owned()
}

struct App {
    options: Options,
    session: Option<Session>,
    error: Option<AppError>,
    /// When a window that waits between frames last requested a frame.
    requested: Instant,
}

impl App {
    fn end(&mut self, event_loop: &ActiveEventLoop, result: Result<(), AppError>) {
        if let Err(error) = result {
            self.error = Some(error);
        }
        event_loop.exit();
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.session.is_none() {
            match Session::open(event_loop, &self.options) {
                Ok(session) => self.session = Some(session),
                Err(error) => self.end(event_loop, Err(error)),
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(session) = &mut self.session else {
            return;
        };
        match event {
            WindowEvent::CloseRequested | WindowEvent::Destroyed => self.end(event_loop, Ok(())),
            WindowEvent::RedrawRequested => {
                let drawn = session.draw(event_loop);
                let enough = self
                    .options
                    .frames
                    .is_some_and(|frames| session.presented() >= frames);
                if drawn.is_err() || enough {
                    self.end(event_loop, drawn);
                }
            }
            event => session.event(&event),
        }
    }

    fn device_event(&mut self, _: &ActiveEventLoop, _: DeviceId, event: DeviceEvent) {
        if let (Some(session), DeviceEvent::MouseMotion { delta }) = (&mut self.session, event) {
            session.mouse_moved(delta);
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        if self.options.stop.load(Ordering::Relaxed) {
            return event_loop.exit();
        }
        let Some(session) = &self.session else {
            return;
        };
        event_loop.set_control_flow(match session.next_frame(self.requested) {
            Some(next) => ControlFlow::WaitUntil(next),
            None => {
                session.request_frame();
                ControlFlow::Poll
            }
        });
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let (Some(session), StartCause::ResumeTimeReached { .. }) = (&self.session, cause) {
            self.requested = Instant::now();
            session.request_frame();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_winit_lose_their_place_alone() {
        let place = "os error at /src/winit/linux/mod.rs:765: no display: none is set";
        assert_eq!(without_place(place), "no display: none is set");
        assert_eq!(without_place("not supported"), "not supported");
    }
}
