//! Copies, renames and deletes saves, each together with its backup.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::{Folder, SaveError, backup_of, disk, read, world_file, write};

impl Folder {
    /// The file of a new name.
    ///
    /// # Errors
    /// [`SaveError::BadName`] and [`SaveError::Taken`].
    pub fn free(&self, name: &str) -> Result<PathBuf, SaveError> {
        let bad = || SaveError::BadName(name.to_owned());
        let path = self.file(name).ok_or_else(bad)?;
        match path.exists() || backup_of(&path).exists() {
            true => Err(SaveError::Taken(name.to_owned())),
            false => Ok(path),
        }
    }
}

/// Copies a save to a file that does not exist yet. A damaged one is not copied.
///
/// # Errors
/// [`SaveError`] when it cannot be read, or the copy cannot be written.
pub fn copy(from: &Path, to: &Path) -> Result<(), SaveError> {
    let mut content = read(from)?;
    if let Ok(world) = world_file(from, &content.head) {
        content.belongs_to(&world, to);
    }
    write(to, &content)
}

/// Gives a save the name of a file that does not exist yet.
///
/// # Errors
/// [`SaveError::Unwritable`].
pub fn rename(from: &Path, to: &Path) -> Result<(), SaveError> {
    let pairs = [
        (from.to_owned(), to.to_owned()),
        (backup_of(from), backup_of(to)),
    ];
    for (from, to) in pairs {
        if from.exists() {
            fs::rename(&from, &to).map_err(|error| disk::unwritable(&to, &error))?;
        }
    }
    Ok(())
}

/// Deletes a save and its backup.
///
/// # Errors
/// [`SaveError::Unwritable`].
pub fn delete(path: &Path) -> Result<(), SaveError> {
    // The backup first: alone it would count as a save that lost its file.
    for path in [&backup_of(path), path] {
        if path.exists() {
            fs::remove_file(path).map_err(|error| disk::unwritable(path, &error))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Overlay, save::sample::save_of};

    #[test]
    fn saves_go_with_their_backups_and_never_over_another() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let folder = Folder::at(place.path());
        let first = folder.free("first").expect("free");
        for _ in 0..2 {
            write(&first, &save_of(Overlay::default())).expect("writable");
        }
        assert!(backup_of(&first).exists());
        assert!(matches!(folder.free("first"), Err(SaveError::Taken(_))));
        assert!(matches!(folder.free("a/b"), Err(SaveError::BadName(_))));
        let [copied, renamed] = ["copy", "renamed"].map(|name| folder.free(name).expect("free"));
        copy(&first, &copied).expect("copied");
        rename(&first, &renamed).expect("renamed");
        assert!(!first.exists() && !backup_of(&first).exists());
        assert!(backup_of(&renamed).exists());
        assert_eq!(
            read(&copied).expect("whole").overlay,
            read(&renamed).expect("whole").overlay
        );
        delete(&renamed).expect("deleted");
        let left: Vec<_> = folder.list().expect("readable");
        assert_eq!(left.len(), 1);
        assert_eq!(left[0].path, copied);
        assert!(!backup_of(&renamed).exists());
    }
}
