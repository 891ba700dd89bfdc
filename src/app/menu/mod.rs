//! The menu over the picture: the title screen, and the pause.
//!
//! `worlds` lists what can be entered, `pictures` shows it, and `pages` draws. The menu only says what was chosen
//! ([`Action`]); the session carries it out.

mod folders;
mod pages;
mod pictures;
mod worlds;

use std::path::PathBuf;

pub use folders::Folders;
pub use pages::Shown;
use pages::{KeyPage, SavesPage};
use pictures::Pictures;
pub use worlds::{Entry, built_in, create};

use crate::{
    gpu::Gpu,
    world::{new_cave::NewCave, save::Folder},
};

/// What the menu shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Page {
    Saves,
    Worlds,
    NewCave,
    HowToPlay,
    Settings,
    Keys,
}

/// What the menu stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occasion {
    /// The start, or the return to it: a world to look at turns behind the menu.
    Title,
    /// A pause of the world that is played: time stands still.
    Pause,
}

/// What a user chose.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Play a world of the list.
    EnterWorld(Entry),
    /// Go on from this save.
    Continue(PathBuf),
    /// Show this cave behind the menu.
    Preview(NewCave),
    /// Keep this cave under a name, and play it.
    Create(NewCave, String),
    /// Go on with the world that is paused.
    Resume,
    /// Leave the world that is paused.
    ToTitle,
    CopySave(PathBuf, String),
    RenameSave(PathBuf, String),
    DeleteSave(PathBuf),
    Quit,
}

/// An open menu.
pub struct Menu {
    pub occasion: Occasion,
    page: Page,
    entries: Vec<Entry>,
    saves: SavesPage,
    /// What the page of keys waits for.
    pub keys: KeyPage,
    pictures: Pictures,
    cave: NewCave,
    /// Whether the sliders have been moved since the last preview.
    is_stale: bool,
    name: String,
}

impl Menu {
    /// Opens the menu; the worlds' pictures are made with `gpu`.
    pub fn open(gpu: &Gpu, occasion: Occasion, folders: &Folders) -> Self {
        let entries = worlds::entries(folders);
        let cache = folders.pictures.clone();
        // A pause is short: what the title screen has not made yet is made there later.
        let maker = (occasion == Occasion::Title).then_some(gpu);
        Self {
            occasion,
            page: match occasion {
                Occasion::Title => Page::Worlds,
                Occasion::Pause => Page::HowToPlay,
            },
            pictures: Pictures::begin(maker, entries.clone(), cache),
            entries,
            saves: SavesPage::of(Folder::of_user().as_ref()),
            keys: KeyPage::default(),
            cave: NewCave::default(),
            is_stale: false,
            name: String::new(),
        }
    }

    /// Reads the folder of saves again.
    pub fn list_saves(&mut self) {
        self.saves = SavesPage::of(Folder::of_user().as_ref());
    }

    /// Forgets textures of a device that is gone.
    pub fn forget_textures(&mut self) {
        self.pictures.forget_textures();
    }
}
