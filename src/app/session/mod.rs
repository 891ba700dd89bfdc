//! An open window: what it shows, and its loop of frames.

mod actions;
mod benchmark;
mod files;
#[cfg(feature = "gamepad")]
mod gamepads;
mod input;
mod inventory;
mod lost;
mod menu;
mod panels;
mod play;
mod preferences;
mod quality;
mod saves;
mod screenshots;
mod start;
mod times;
mod views;

use std::{collections::HashMap, path::PathBuf, sync::Arc, time::Instant};

use winit::{event_loop::ActiveEventLoop, window::Window};

use benchmark::Benchmarks;
use play::Play;

use super::{
    AppError, Options,
    clock::FrameRate,
    controls::{Action, Trigger},
    hands::brush::Brush,
    inventory::Items,
    menu::{Folders, Menu, Occasion},
    messages::Messages,
    pace::Pace,
    panel::{PassMeans, Settings},
    quality::Auto,
    reload::Watch,
    saving::Saving,
    screen::{Acquired, Screen},
    settings::{Preferences, Store},
    texts::toasts,
    viewport::{Choice, Viewport},
    without_place,
};
use crate::{
    gpu::{DeviceErrors, Recorder, Timing},
    parameters::Parameters,
    passes::view::overlay::Overlay,
    world::Camera,
};

/// Frames between two counts of the probes: reading the counts back stalls.
const FRAMES_TO_COUNT: u32 = 64;
/// Frames between two timings of single passes: in all other frames passes may run concurrently.
const FRAMES_TO_TIME: u32 = 8;

pub struct Session {
    window: Arc<Window>,
    screen: Screen,
    device_errors: DeviceErrors,
    timing: Timing,
    overlay: Overlay,
    viewport: Viewport,
    egui: egui_winit::State,
    settings: Settings,
    auto: Auto,
    panel_open: bool,
    readout_open: bool,
    /// What the user searches for in the panel.
    search: String,
    /// While it is open, it takes all input.
    menu: Option<Menu>,
    /// While the inventory is open, it takes keys and clicks.
    items: Items,
    folders: Folders,
    /// With which every world is entered.
    parameters_at_start: Parameters,
    /// Those of them that the command line set.
    set_at_start: Vec<String>,
    messages: Messages,
    camera: Camera,
    play: Play,
    preferences: Preferences,
    store: Store,
    /// Whether the window has the size of the settings, which then follow it.
    keeps_size: bool,
    /// The actions of the keys and buttons that are down.
    down: HashMap<Trigger, Action>,
    #[cfg(feature = "gamepad")]
    gamepads: Option<super::gamepad::Gamepads>,
    captured: bool,
    modifiers: winit::keyboard::ModifiersState,
    rate: FrameRate,
    passes: PassMeans,
    probes: Option<crate::passes::probes::StateCounts>,
    /// When the last frame began, and when it was drawn.
    last_frame: Instant,
    drawn: Instant,
    pace: Pace,
    presented: u32,
    hidden: bool,
    /// Whether other windows cover the whole window, where the system reports it.
    occluded: bool,
    focused: bool,
    /// The window closes after a given number of frames.
    counted: bool,
    world_watch: Watch,
    shaders: Option<(PathBuf, Watch)>,
    screenshot_wanted: bool,
    benchmarks: Benchmarks,
    seed: u32,
    /// When a lost device was last replaced.
    replaced: Option<Instant>,
    saving: Saving,
    lose_device_at: Option<u32>,
    lifts_after_frame: bool,
}

impl Session {
    /// Opens the window and builds the world.
    ///
    /// # Errors
    /// [`AppError`] without a usable adapter, and when it cannot hold the world.
    pub fn open(event_loop: &ActiveEventLoop, options: &Options) -> Result<Self, AppError> {
        let (store, notes) = Store::of_user();
        let preferences = store.kept().clone();
        let [width, height] = options.size.unwrap_or(preferences.window_size);
        let attributes = super::icon::identified(Window::default_attributes())
            .with_title(format!("grotto: {}", options.world.name))
            .with_inner_size(winit::dpi::PhysicalSize::new(width, height));
        let window = event_loop
            .create_window(attributes)
            .map_err(|error| AppError::NoWindow(without_place(&error.to_string())))?;
        let window = Arc::new(window);
        let (gpu, surface) = start::open_gpu(&window, options)?;
        let device_errors = DeviceErrors::watch(&gpu);
        let screen = Screen::new(&gpu, window.clone(), surface)?;
        let is_software = gpu.summary.is_software();
        let quality = options.quality.unwrap_or(preferences.quality);
        let preset = quality.preset_on(is_software);
        let mut parameters = quality::parameters_at_start(options, preset);
        // A replay has the parameters of its record.
        if options.replay.is_none() {
            let of_picture = Preferences {
                // A quality that the command line names has a scale of its own.
                picture_scale: preferences
                    .picture_scale
                    .filter(|_| options.quality.is_none()),
                ..preferences.clone()
            };
            of_picture.apply_to(&mut parameters, &options.set);
        }
        let choice = Choice {
            parameters: parameters.clone(),
            layout: options.layout.clone(),
            size: screen.size().map(|edge| edge.max(1)),
            traced: options.traced,
        };
        let mut messages = Messages::default();
        for note in notes {
            tracing::warn!("{note}");
            messages.toast_error(note);
        }
        let mut viewport = start::build(&gpu, options, choice, &mut messages)?;
        if !options.title {
            messages.hint(toasts::FIRST);
        }
        for note in viewport.take_notes() {
            messages.toast_error(note);
        }
        let settings = Settings {
            choice: viewport.choice().clone(),
            inspection: options.inspection,
            preset,
            auto: quality.auto,
            target_ms: options
                .target_ms
                .unwrap_or(Auto::default_target_ms(is_software)),
            vsync: preferences.vsync,
            clock: saves::first_clock(options),
            brush: Brush::default(),
        };
        let play = Play::begin(options, &mut viewport)?;
        let start = saves::kept(&mut viewport, &play, &settings)?;
        let saving = Saving::begin(&options.saves, &options.world_path, start, &mut messages);
        let mut session = Self {
            overlay: Overlay::new(&viewport.gpu, screen.format())?,
            timing: Timing::new(&gpu)?,
            play,
            saving,
            auto: Auto::new(settings.target_ms),
            settings,
            egui: lost::panel_state(event_loop, &window, &viewport.gpu),
            window,
            screen,
            device_errors,
            viewport,
            replaced: None,
            lose_device_at: options.lose_device_at,
            lifts_after_frame: false,
            panel_open: false,
            readout_open: false,
            search: String::new(),
            menu: None,
            items: Items::default(),
            folders: Folders::of_user(),
            parameters_at_start: parameters,
            set_at_start: options.set.clone(),
            messages,
            camera: options.camera.clone(),
            preferences,
            store,
            keeps_size: options.size.is_none(),
            down: HashMap::new(),
            #[cfg(feature = "gamepad")]
            gamepads: super::gamepad::Gamepads::open(),
            captured: false,
            modifiers: Default::default(),
            rate: FrameRate::default(),
            passes: PassMeans::default(),
            probes: None,
            last_frame: Instant::now(),
            drawn: Instant::now(),
            pace: Pace::new(Instant::now()),
            presented: 0,
            hidden: false,
            occluded: false,
            // Systems report changes of focus; some never report any.
            focused: true,
            counted: options.frames.is_some(),
            world_watch: Watch::world(&options.world_path),
            shaders: options
                .shaders
                .clone()
                .map(|folder| (folder.clone(), Watch::folder(&folder, "wesl"))),
            screenshot_wanted: false,
            benchmarks: Benchmarks::default(),
            seed: options.seed,
        };
        session.begin_with_preferences(options.size.is_none());
        if options.title {
            session.open_menu(Occasion::Title);
        }
        if options.benchmark {
            session.begin_benchmark();
        }
        Ok(session)
    }

    /// Requests the next frame.
    pub fn request_frame(&self) {
        self.window.request_redraw();
    }

    /// When to request the next frame, if the last was requested at `requested`; `None` where it is urgent.
    pub fn next_frame(&self, requested: Instant) -> Option<Instant> {
        self.pace.next(self.interval(), requested)
    }

    /// Frames shown so far.
    pub fn presented(&self) -> u32 {
        self.presented
    }

    /// One frame, on a new device if the last one was lost.
    ///
    /// # Errors
    /// [`AppError`] when the GPU failed: there will be no further frame.
    pub fn draw(&mut self, event_loop: &ActiveEventLoop) -> Result<(), AppError> {
        if self.device_errors.is_lost() {
            self.replace_device(event_loop)?;
        }
        let drawn = self.draw_frame(event_loop);
        self.drawn = Instant::now();
        match drawn {
            // The next frame has another device.
            Err(_) if self.device_errors.is_lost() => Ok(()),
            drawn => drawn,
        }
    }

    /// Draws one frame: handles input and edits, records the passes, and presents the picture.
    fn draw_frame(&mut self, event_loop: &ActiveEventLoop) -> Result<(), AppError> {
        let now = Instant::now();
        let elapsed = now.saturating_duration_since(self.last_frame);
        self.pace.begin(now, self.interval());
        self.last_frame = now;
        #[cfg(feature = "gamepad")]
        self.hear_gamepads(elapsed);
        self.steer(now, elapsed)?;
        let is_benchmark = self.benchmarks.running.is_some();
        if !self.hidden {
            self.rate.tick(now);
        }
        if !is_benchmark {
            self.save_now_and_then(now);
            self.follow_files(now);
        }
        self.keep_settings();
        self.screen.set_vsync(self.settings.vsync && !is_benchmark);
        self.apply_settings();
        self.hold_frame_time();
        self.inspect_probes();

        // X11 hands out textures even for a minimised window.
        let acquired = if self.occluded || self.window.is_minimized() == Some(true) {
            Acquired::Hidden
        } else {
            self.screen.acquire(&self.viewport.gpu)?
        };
        self.hidden = matches!(acquired, Acquired::Hidden);
        let Acquired::Texture(texture) = acquired else {
            self.rate.clear();
            self.auto.interrupt();
            if let Some(run) = &mut self.benchmarks.running {
                run.interrupt();
            }
            return self.check();
        };
        let shapes = self.run_panel(event_loop);
        let target = texture.texture.create_view(&Default::default());
        let gpu = self.viewport.gpu.clone();
        // The path tracer chooses its work per frame from its own measured time.
        let is_timed = self.viewport.reference_view().is_some()
            || (self.presented.is_multiple_of(FRAMES_TO_TIME) && !is_benchmark);
        let mut recorder = if is_timed {
            Recorder::new(&gpu, Some(&mut self.timing))
        } else {
            Recorder::new_whole(&gpu, &mut self.timing)
        };
        let time_s = self.settings.clock.time_s;
        self.viewport
            .record(&mut recorder, &self.camera, time_s, self.seed)?;
        if self.device_errors.is_lost() {
            // The panel cannot be drawn with a lost device.
            return self.check();
        }
        let size = [texture.texture.width(), texture.texture.height()];
        let picture = self.viewport.display();
        self.overlay
            .record(&gpu, &mut recorder, picture, &target, size, shapes);
        recorder.submit(&gpu)?;
        self.window.pre_present_notify();
        gpu.queue.present(texture);
        self.presented += 1;
        self.lift_after_frame();
        if let Some(run) = &mut self.benchmarks.running {
            run.presented();
        }
        if self.lose_device_at == Some(self.presented) {
            gpu.device.destroy();
        }

        self.hear_times(elapsed.as_secs_f64() * 1e3);
        // The first frames belong to whoever waits for the window. A software adapter compiles a kernel when it first runs,
        // which no thread can do ahead.
        let is_idle = self.presented.is_multiple_of(FRAMES_TO_COUNT) && !is_benchmark;
        if is_idle && !gpu.summary.is_software() {
            self.viewport.prepare_bodies();
        }
        if std::mem::take(&mut self.screenshot_wanted) {
            self.save_screenshot();
        }
        if !is_benchmark
            && self
                .viewport
                .frame()
                .frames()
                .is_multiple_of(FRAMES_TO_COUNT)
        {
            self.probes = Some(self.viewport.frame().field().state_counts(&gpu)?);
        }
        self.check()
    }

    fn check(&self) -> Result<(), AppError> {
        self.device_errors
            .first()
            .map_or(Ok(()), |fault| Err(fault.into()))
    }

    /// Resets counts and times after work that must not count towards any frame.
    fn remade(&mut self) {
        self.probes = None;
        self.rate.clear();
        self.auto.interrupt();
        self.last_frame = Instant::now();
    }
}
