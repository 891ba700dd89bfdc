//! The folder of saves: where the player's saves lie, by name.

use std::{
    env, fs,
    path::{Component, Path, PathBuf},
    time::{SystemTime, UNIX_EPOCH},
};

use atomic_write_file::AtomicWriteFile;
use directories::ProjectDirs;

use super::{EXTENSION, Head, SaveError, backup_of, disk, read_head};

/// Names another folder for saves than the one in the user's data folder.
pub const VARIABLE: &str = "GROTTO_SAVES";

/// A folder of saves. It need not exist yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folder(PathBuf);

/// A save in the folder.
#[derive(Debug)]
pub struct Listed {
    pub name: String,
    pub path: PathBuf,
    pub bytes: u64,
    /// Its head, or why it cannot be read.
    pub head: Result<Head, SaveError>,
}

impl Folder {
    /// That of this user: `GROTTO_SAVES`, or `saves` in the folder for data of programs. `None` for a user without a
    /// home.
    pub fn of_user() -> Option<Self> {
        let named = env::var_os(VARIABLE).filter(|path| !path.is_empty());
        let own = || {
            Some(
                ProjectDirs::from("", "", "grotto")?
                    .data_dir()
                    .join("saves"),
            )
        };
        named.map(PathBuf::from).or_else(own).map(Self)
    }

    pub fn at(path: &Path) -> Self {
        Self(path.to_owned())
    }

    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Creates it if need be, and tries whether a save could be written.
    ///
    /// # Errors
    /// [`SaveError::Unwritable`].
    pub fn check_writable(&self) -> Result<(), SaveError> {
        let tried = fs::create_dir_all(&self.0)
            .and_then(|()| AtomicWriteFile::open(self.0.join("trial")))
            .and_then(AtomicWriteFile::discard);
        tried.map_err(|error| disk::unwritable(&self.0, &error))
    }

    /// Its saves, the latest first; without a folder there are none.
    ///
    /// # Errors
    /// [`SaveError::Unreadable`] when the folder cannot be read.
    pub fn list(&self) -> Result<Vec<Listed>, SaveError> {
        if !self.0.exists() {
            return Ok(Vec::new());
        }
        let unreadable = |error: std::io::Error| SaveError::Unreadable {
            path: self.0.clone(),
            reason: format!("the folder cannot be read: {error}"),
        };
        let mut found = Vec::new();
        for entry in fs::read_dir(&self.0).map_err(unreadable)? {
            let path = entry.map_err(unreadable)?.path();
            let is_one = path.extension().is_some_and(|known| known == EXTENSION);
            let name = path
                .file_stem()
                .map(|name| name.to_string_lossy().into_owned());
            if let Some(name) = name.filter(|name| is_one && !name.starts_with('.')) {
                let bytes = fs::metadata(&path).map_or(0, |known| known.len());
                let head = read_head(&path);
                found.push(Listed {
                    name,
                    path,
                    bytes,
                    head,
                });
            }
        }
        let saved_s = |one: &Listed| one.head.as_ref().map_or(0, |head| head.saved_s);
        found.sort_by(|a, b| saved_s(b).cmp(&saved_s(a)).then(a.name.cmp(&b.name)));
        Ok(found)
    }

    /// The file of a save of this name, or `None` for a name that is none.
    pub fn file(&self, name: &str) -> Option<PathBuf> {
        let mut parts = Path::new(name).components();
        let is_plain = matches!(
            (parts.next(), parts.next()),
            (Some(Component::Normal(_)), None)
        );
        let fits = is_plain && !name.starts_with('.') && !name.contains(['/', '\\', '\0']);
        fits.then(|| self.0.join(format!("{name}.{EXTENSION}")))
    }

    /// A file for a new save of this world: its name, or with a number where that is taken.
    pub fn free_file(&self, world: &str) -> PathBuf {
        let name = if self.file(world).is_some() {
            world
        } else {
            "world"
        };
        let numbered = (2..).map(|number| format!("{name} {number}"));
        std::iter::once(name.to_owned())
            .chain(numbered)
            .map(|name| self.0.join(format!("{name}.{EXTENSION}")))
            .find(|path| !path.exists() && !backup_of(path).exists())
            .unwrap_or_else(|| self.0.join(format!("{name}.{EXTENSION}")))
    }
}

/// Seconds since 1970, UTC.
pub fn now_s() -> u64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_secs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{
        Overlay,
        save::{sample::save_of, write},
    };

    #[test]
    fn saves_are_listed_the_latest_first() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let folder = Folder::at(&place.path().join("saves"));
        assert!(folder.list().expect("none yet").is_empty());
        folder.check_writable().expect("writable");
        for (name, saved_s) in [("old", 5), ("new", 9), ("older", 1)] {
            let mut save = save_of(Overlay::default());
            save.head.saved_s = saved_s;
            let path = folder.file(name).expect("a name");
            write(&path, &save).expect("writable");
            write(&path, &save).expect("writable");
        }
        fs::write(folder.path().join("bad.grotto"), "nonsense").expect("writable");
        fs::write(folder.path().join("note.txt"), "nonsense").expect("writable");
        let list = folder.list().expect("readable");
        let names: Vec<_> = list.iter().map(|one| one.name.as_str()).collect();
        assert_eq!(names, ["new", "old", "older", "bad"]);
        assert!(list[3].head.is_err() && list[0].bytes > 100);
        assert_eq!(folder.free_file("new"), folder.path().join("new 2.grotto"));
        assert_eq!(folder.free_file("cave"), folder.path().join("cave.grotto"));
    }

    #[test]
    fn names_stay_in_the_folder() {
        let folder = Folder::at(Path::new("saves"));
        for bad in ["", ".", "..", "a/b", "/a", "../a", ".a"] {
            assert_eq!(folder.file(bad), None, "{bad}");
        }
        assert_eq!(folder.file("my cave"), Some("saves/my cave.grotto".into()));
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_found_out() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let file = place.path().join("file");
        fs::write(&file, "x").expect("writable");
        let error = Folder::at(&file.join("saves")).check_writable();
        let message = error.expect_err("a file is no folder").to_string();
        assert!(
            message.contains("a file is where its folder should be"),
            "{message}"
        );
    }
}
