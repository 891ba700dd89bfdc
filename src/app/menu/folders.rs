//! Where grotto keeps what belongs to the user: caves, and pictures of worlds.

use std::{
    env,
    path::{Path, PathBuf},
};

use directories::ProjectDirs;

/// The user's folders.
#[derive(Clone, Debug)]
pub struct Folders {
    /// New caves.
    pub caves: PathBuf,
    /// The worlds of the binary, as files.
    pub worlds: PathBuf,
    /// Pictures of worlds, which can be made again.
    pub pictures: PathBuf,
}

impl Folders {
    /// Those of the system; without any, folders in the one for temporary files.
    pub fn of_user() -> Self {
        let own = ProjectDirs::from("", "", "grotto");
        let or_temporary = |folder: Option<&Path>| {
            folder.map_or_else(|| env::temp_dir().join("grotto"), Path::to_owned)
        };
        let data = or_temporary(own.as_ref().map(ProjectDirs::data_dir));
        let cache = or_temporary(own.as_ref().map(ProjectDirs::cache_dir));
        Self {
            caves: data.join("caves"),
            // A newer binary brings newer worlds.
            worlds: cache.join(concat!("worlds-", env!("CARGO_PKG_VERSION"))),
            pictures: cache.join("pictures"),
        }
    }
}
