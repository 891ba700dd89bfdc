//! The menu over the picture: opens it, and carries out what is chosen in it.

use std::{path::Path, time::Duration};

use winit::event_loop::ActiveEventLoop;

use super::{Session, quality::over_preset};
use crate::{
    app::{
        AppError,
        clock::WorldClock,
        input::Input,
        menu::{self, Action, Menu, Occasion},
        player::Player,
        reload::Watch,
        saving::{self, SaveOptions, Saving},
        texts::{saves as texts, toasts},
        viewport::{Choice, Viewport, ViewportError},
    },
    measure::whole_file::FileError,
    parameters::Parameters,
    passes::view::Inspection,
    world::{
        self, Camera, World,
        file::Overrides,
        new_cave::NewCave,
        save::{self, Folder, Save, SaveError},
    },
};

/// How far the camera behind the title swings to either side (degrees), and how long it takes to and fro (seconds).
const SWING_DEG: f64 = 28.0;
const SWING_S: f64 = 40.0;

/// Why a world cannot be entered.
#[derive(Debug, thiserror::Error)]
enum EnterError {
    #[error(transparent)]
    World(#[from] ViewportError),
    /// The diagnostic of a save that cannot be read.
    #[error("{0}")]
    Restored(String),
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    App(#[from] AppError),
    #[error(transparent)]
    Save(#[from] SaveError),
    #[error("{}", toasts::unknown_file(.0))]
    Unknown(String),
}

/// How a world is entered.
struct Start<'a> {
    /// The world file; empty for a world that is not kept.
    path: &'a Path,
    /// `None`: the world's first camera.
    camera: Option<Camera>,
    layout: String,
    clock: WorldClock,
    parameters: Parameters,
    saves: SaveOptions,
}

impl Session {
    /// Opens the menu. Keys that are down are released: the menu takes all input.
    pub(super) fn open_menu(&mut self, occasion: Occasion) {
        self.release_mouse();
        self.down.clear();
        self.give(Input::Focus(false));
        self.menu = Some(Menu::open(&self.viewport.gpu, occasion, &self.folders));
    }

    fn close_menu(&mut self) {
        self.menu = None;
        self.capture_mouse();
        self.remade();
    }

    /// Esc or F1 while the menu is open: a pause ends, the title stays.
    pub(super) fn leave_menu(&mut self) {
        if self
            .menu
            .as_ref()
            .is_some_and(|menu| menu.occasion == Occasion::Pause)
        {
            self.close_menu();
        }
    }

    /// Lets the world behind the title live, and swings its camera. A pause stands still.
    pub(super) fn linger(&mut self, occasion: Occasion, elapsed: Duration) {
        if occasion == Occasion::Pause {
            return;
        }
        let clock = &mut self.settings.clock;
        clock.advance(elapsed.as_secs_f64());
        let first = self.viewport.world().cameras.first();
        let mut camera = first.unwrap_or(&self.camera).clone();
        let turn = SWING_DEG * (std::f64::consts::TAU * clock.time_s / SWING_S).sin();
        camera.yaw_deg += turn as f32;
        self.camera = camera;
    }

    /// Carries out what was chosen in the menu. What fails is told, and the menu stays.
    pub(super) fn carry_out(&mut self, event_loop: &ActiveEventLoop, action: Action) {
        let done = match action {
            Action::EnterWorld(entry) => {
                let path = entry.path(&self.folders).map_err(EnterError::from);
                path.and_then(|path| self.enter(&path))
            }
            Action::Continue(path) => {
                let entered = self.enter(&path);
                // A damaged save was set aside.
                if let (Err(_), Some(menu)) = (&entered, &mut self.menu) {
                    menu.list_saves();
                }
                entered
            }
            Action::Preview(cave) => self.preview(&cave),
            Action::Create(cave, name) => {
                let path = menu::create(&cave, &name, &self.folders).map_err(EnterError::from);
                path.and_then(|path| self.enter(&path))
            }
            Action::Resume => {
                self.close_menu();
                Ok(())
            }
            Action::ToTitle => {
                let ended = self.end_run();
                self.open_menu(Occasion::Title);
                ended.map_err(EnterError::from)
            }
            Action::CopySave(from, name) => {
                self.arrange(|folder| save::copy(&from, &folder.free(&name)?))
            }
            Action::RenameSave(from, name) => {
                self.arrange(|folder| save::rename(&from, &folder.free(&name)?))
            }
            Action::DeleteSave(path) => {
                let name = path.file_stem().unwrap_or_default().to_string_lossy();
                let told = texts::deleted(&name);
                let deleted = self.arrange(|_| save::delete(&path));
                if deleted.is_ok() {
                    self.messages.toast(told);
                }
                deleted
            }
            Action::Quit => {
                event_loop.exit();
                Ok(())
            }
        };
        self.tell(done);
    }

    /// Changes the folder of saves, and lists it again.
    fn arrange(
        &mut self,
        change: impl FnOnce(&Folder) -> Result<(), SaveError>,
    ) -> Result<(), EnterError> {
        let changed = Folder::of_user().map_or(Ok(()), |folder| change(&folder));
        if let Some(menu) = &mut self.menu {
            menu.list_saves();
        }
        Ok(changed?)
    }

    /// A file was dropped on the window.
    pub(super) fn dropped(&mut self, path: &Path) {
        let extension = path
            .extension()
            .map(|extension| extension.to_ascii_lowercase());
        let is_known = extension
            .is_some_and(|known| known == "ron" || known == "vox" || known == save::EXTENSION);
        let done = if is_known {
            self.enter(path)
        } else {
            Err(EnterError::Unknown(path.display().to_string()))
        };
        self.tell(done);
    }

    fn tell(&mut self, done: Result<(), EnterError>) {
        match done {
            Ok(()) => {}
            // The diagnostic of a file stays until it is read.
            Err(EnterError::World(error @ ViewportError::World(_))) => {
                self.messages.world = Some(error.to_string());
            }
            Err(EnterError::Restored(text)) => self.messages.save = Some(text),
            Err(error) => self.messages.toast_error(error.to_string()),
        }
    }

    /// Plays the world of a file from its first camera, or goes on from a save. The run before ends, with its save.
    fn enter(&mut self, path: &Path) -> Result<(), EnterError> {
        let is_save = save::is_save(path);
        let overrides = match is_save {
            // It has its own.
            true => Overrides::default(),
            false => Overrides::from(&self.parameters_at_start),
        };
        // Watched from before it is read, so that no edit is missed.
        let mut watch = Watch::world(path);
        // The first to open a damaged save says so.
        let mut world = world::file::load(path, &overrides)
            .map_err(ViewportError::from)
            .map_err(|error| match is_save {
                true => EnterError::Restored(error.to_string()),
                false => EnterError::World(error),
            })?;
        let save = match is_save {
            true => Some(save::open(path)?.save),
            false => None,
        };
        let (world_file, mut parameters) = match &save {
            Some(save) => {
                let world_file = save::world_file(path, &save.head)?;
                watch = Watch::world(&world_file);
                (
                    world_file,
                    saving::parameters_of(save, self.settings.preset),
                )
            }
            None => (path.to_owned(), self.parameters_of_new()),
        };
        self.preferences
            .apply_to(&mut parameters, &self.set_at_start);
        // It belongs to the machine, not to a world.
        parameters.picture.scale = self.settings.choice.parameters.picture.scale;
        // Alt and the digits jump to the world's own cameras.
        world
            .cameras
            .retain(|camera| save.is_none() || camera.name != save::VIEW);
        let start = Start {
            path: &world_file,
            camera: save.as_ref().map(Save::view),
            layout: save
                .as_ref()
                .map_or_else(String::new, |save| save.state.layout.clone()),
            clock: save.as_ref().map(saving::clock_of).unwrap_or_default(),
            parameters,
            saves: SaveOptions {
                folder: Folder::of_user(),
                continued: save.map(|save| (path.to_owned(), save)),
                automatic: true,
            },
        };
        self.show(world, start)?;
        if !is_save {
            self.play.player.land(&self.viewport.ground()?);
        }
        self.world_watch = watch;
        self.close_menu();
        self.messages.hint(toasts::ENTERED);
        Ok(())
    }

    /// The parameters of a world that is entered from the menu: those of the start, with what the menu's settings change.
    fn parameters_of_new(&self) -> Parameters {
        let now = &self.settings.choice.parameters;
        let start = Parameters {
            picture: now.picture.clone(),
            textures: now.textures.clone(),
            ..self.parameters_at_start.clone()
        };
        over_preset(start, self.settings.preset, &self.set_at_start)
    }

    /// Ends the run, with its record and its save.
    fn end_run(&mut self) -> Result<(), AppError> {
        self.finish()?;
        self.save_at_end()?;
        // What is shown from now on is only to look at, until a world is entered.
        let kept = self.kept()?;
        let nowhere = SaveOptions::default();
        self.saving = Saving::begin(&nowhere, Path::new(""), kept, &mut self.messages);
        Ok(())
    }

    /// Shows a cave that is not kept yet, behind the menu.
    fn preview(&mut self, cave: &NewCave) -> Result<(), EnterError> {
        let overrides = Overrides::from(&self.parameters_at_start);
        let world = world::file::parse(&cave.text("new cave"), "new cave", None, &overrides)
            .map_err(ViewportError::from)?;
        let start = Start {
            path: Path::new(""),
            camera: None,
            layout: String::new(),
            clock: WorldClock::default(),
            parameters: self.parameters_of_new(),
            saves: SaveOptions::default(),
        };
        self.show(world, start)
    }

    /// Replaces the world that is shown.
    fn show(&mut self, world: World, start: Start<'_>) -> Result<(), EnterError> {
        let choice = Choice {
            parameters: start.parameters,
            layout: start.layout,
            size: self.viewport.choice().size,
            traced: false,
        };
        let gpu = self.viewport.gpu.clone();
        let mut viewport =
            Viewport::new(gpu, start.path, world, choice).map_err(ViewportError::from)?;
        let first = viewport.world().cameras.first();
        let camera = start.camera.or(first.cloned());
        let camera = camera.unwrap_or_else(|| self.camera.clone());
        let player = Player::new(&camera, &viewport.world().clone(), &viewport.ground()?);
        self.end_run()?;
        for note in viewport.take_notes() {
            self.messages.toast_error(note);
        }
        self.window
            .set_title(&format!("grotto: {}", viewport.world().name));
        self.settings.choice = viewport.choice().clone();
        self.settings.inspection = Inspection::default();
        self.settings.clock = start.clock;
        self.viewport = viewport;
        self.play.begin_again(player, &self.viewport);
        self.begin_with_field_of_view();
        let kept = self.kept()?;
        self.saving = Saving::begin(&start.saves, start.path, kept, &mut self.messages);
        self.camera = camera;
        self.benchmarks = Default::default();
        self.messages.world = None;
        self.messages.save = None;
        self.remade();
        Ok(())
    }
}
