//! Saves: what a player changed about a world, as an overlay over the world file that it belongs to.
//!
//! `format` turns a [`Save`] into bytes and back, `disk` replaces files without a moment of danger and sets
//! damaged ones aside, `arrange` copies, renames and deletes them, `restore` makes a [`super::World`] of a save. The note `docs/notes/saves.md` describes the
//! format.

mod arrange;
mod bodies;
mod disk;
mod folder;
mod format;
mod restore;
#[cfg(test)]
pub mod sample;

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

pub use arrange::{copy, delete, rename};
pub use disk::{Opened, backup_of, is_save, open, read, read_head, write};
pub use folder::{Folder, Listed, VARIABLE, now_s};
pub(super) use restore::load;
pub use restore::{VIEW, world_file};

use super::{Overlay, PlacedLamp, bodies::ChangedBodies, placed::LampBlock};

/// Extension of the files.
pub const EXTENSION: &str = "grotto";

/// Larger files are neither written nor read (bytes).
pub const LARGEST: u64 = 512 << 20;

/// Everything that a save keeps.
#[derive(Clone, Debug, PartialEq)]
pub struct Save {
    pub head: Head,
    pub state: State,
    /// Voxels that differ from those of the world file, in the grid space of [`State::origin`].
    pub overlay: Overlay,
    /// In the order of placing.
    pub lamps: Vec<PlacedLamp>,
    pub bodies: ChangedBodies,
}

/// What lists of saves show: it is read without the rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// Name of the world.
    pub world: String,
    /// The world file, as an absolute path.
    pub world_file: String,
    /// The same from the folder of the save, so that both can be moved together.
    #[serde(default)]
    pub world_beside: Option<String>,
    /// [`super::file::fingerprint`] of the world file.
    pub world_crc32: u32,
    /// When it was saved: seconds since 1970, UTC.
    pub saved_s: u64,
    /// Number of changed voxels.
    pub voxels: u64,
    /// Number of placed lamps.
    #[serde(default)]
    pub lamps: usize,
    /// Number of bodies that were placed, pushed, or set into the world.
    #[serde(default)]
    pub bodies: usize,
    /// The version of grotto that wrote it.
    pub grotto: String,
}

/// Where the player was, and what was chosen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// World time in seconds.
    pub time_s: f64,
    pub paused: bool,
    /// Seconds of world time per second.
    pub rate: f32,
    /// The player's eye in world space (voxels).
    pub eye: [f32; 3],
    pub yaw_deg: f32,
    pub pitch_deg: f32,
    pub fov_deg: f32,
    /// Name of the probe layout.
    pub layout: String,
    /// `KEY=VALUE` for every parameter that is not at its default.
    pub set: Vec<String>,
    /// Names of the world's materials: number m of the overlay is `materials[m - 1]`.
    pub materials: Vec<String>,
    /// World space of the voxel (0, 0, 0) of the overlay.
    pub origin: [i32; 3],
    /// Saves of older versions have none.
    #[serde(default)]
    pub hotbar: SavedHotbar,
}

/// The items that were at hand. Whoever uses them leaves out what they do not know.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SavedHotbar {
    /// Empty: the hotbar of a new run.
    pub slots: Vec<Option<SavedItem>>,
    /// Index of the slot that was in the hand.
    pub selected: usize,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SavedItem {
    /// Name of a material of the world.
    Material(String),
    Lamp(LampBlock),
}

/// Why a save cannot be written or read. Every message names the file and a remedy.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    #[error("{}: no such save; `grotto saves list` lists those that there are", .0.display())]
    Missing(PathBuf),
    #[error("{}: {reason}", path.display())]
    Unreadable { path: PathBuf, reason: String },
    #[error("{}: {reason}; what was saved there before is unchanged", path.display())]
    Unwritable { path: PathBuf, reason: String },
    #[error(
        "{}: the save is of version {version} of the format, and this grotto reads version {}: open it with the grotto \
         that wrote it ({grotto}), or a newer one",
        path.display(),
        format::VERSION
    )]
    Newer {
        path: PathBuf,
        version: u32,
        grotto: String,
    },
    #[error("{}: the save is damaged: {reason}", path.display())]
    Damaged { path: PathBuf, reason: String },
    #[error(
        "{}: the save is damaged ({reason}){aside}, and there is no good backup of it ({backup})",
        path.display()
    )]
    Lost {
        path: PathBuf,
        reason: String,
        aside: String,
        backup: String,
    },
    #[error(
        "{}: the changes take {} MB, more than the {} MB of a save; undo some of them",
        path.display(),
        bytes / 1_000_000,
        LARGEST / 1_000_000
    )]
    TooLarge { path: PathBuf, bytes: u64 },
    #[error(
        "{}: the world file of this save, {world}, is gone: put it there again, or beside the save",
        path.display()
    )]
    NoWorld { path: PathBuf, world: String },
    #[error(
        "`{0}` cannot be the name of a save: a name has no slashes and does not begin with a dot"
    )]
    BadName(String),
    #[error("there is a save `{0}` already; choose another name, or delete it first")]
    Taken(String),
}

impl Head {
    /// For a person: how much was changed.
    pub fn changes(&self) -> String {
        let counted = |count: usize, one: &str, many: &str| match count {
            0 => String::new(),
            1 => format!(", 1 {one}"),
            count => format!(", {count} {many}"),
        };
        let lamps = counted(self.lamps, "lamp", "lamps");
        let bodies = counted(self.bodies, "body", "bodies");
        format!("{} voxels changed{lamps}{bodies}", self.voxels)
    }
}

impl Save {
    /// The view of the player.
    pub fn view(&self) -> super::Camera {
        super::Camera {
            name: VIEW.to_owned(),
            position: self.state.eye.into(),
            yaw_deg: self.state.yaw_deg,
            pitch_deg: self.state.pitch_deg,
            fov_deg: self.state.fov_deg,
        }
    }

    /// Names the world file, as seen from where the save will lie.
    pub fn belongs_to(&mut self, world_file: &Path, save: &Path) {
        let world = std::path::absolute(world_file).unwrap_or_else(|_| world_file.to_owned());
        let save = std::path::absolute(save).unwrap_or_else(|_| save.to_owned());
        let name = world.file_stem().unwrap_or(world.as_os_str());
        self.head.world = name.to_string_lossy().into_owned();
        self.head.world_beside = save
            .parent()
            .and_then(|folder| restore::path_from(folder, &world))
            .map(|path| path.to_string_lossy().into_owned());
        self.head.world_file = world.to_string_lossy().into_owned();
    }
}
