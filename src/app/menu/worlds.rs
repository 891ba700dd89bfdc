//! The worlds that the menu offers: those that come with grotto, and the user's own caves.

use std::{
    fs,
    io::Write as _,
    path::{Path, PathBuf},
};

use super::folders::Folders;
use crate::{
    measure::whole_file::{self, FileError},
    world::{file, new_cave::NewCave},
};

macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        /// The worlds of the binary: their names and files, in the order of the menu.
        const BUILT_IN: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../../worlds/", $name, ".ron")))),*];
    };
}

// The showpieces come first, then the rooms that prove something.
built_in![
    "cave",
    "cavern",
    "house",
    "glow",
    "cornell",
    "cornell_turning",
    "bleed",
    "door",
    "swinging_door",
    "split",
    "beam",
    "soft_shadows",
    "corner",
    "sealed",
    "furnace",
    "small_emitter",
    "minimal",
];

/// A world that can be entered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    pub name: String,
    /// One sentence; an error, if the file is wrong.
    pub title: String,
    pub origin: Origin,
}

/// Where the world file is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    BuiltIn(&'static str),
    File(PathBuf),
}

impl Entry {
    /// The world file. A world of the binary is written into the user's folder first, unless the current folder is
    /// a checkout of grotto: then its own file is used, and edits of it are seen.
    ///
    /// # Errors
    /// [`FileError`] when it cannot be written.
    pub fn path(&self, folders: &Folders) -> Result<PathBuf, FileError> {
        let text = match &self.origin {
            Origin::File(path) => return Ok(path.clone()),
            Origin::BuiltIn(text) => text,
        };
        let near = Path::new("worlds").join(format!("{}.ron", self.name));
        if near.is_file() {
            return Ok(near);
        }
        let path = folders.worlds.join(format!("{}.ron", self.name));
        if fs::read_to_string(&path).ok().as_deref() != Some(text) {
            write(&path, text)?;
        }
        Ok(path)
    }

    /// The text of the world file, if it can be read.
    pub fn text(&self) -> Option<String> {
        match &self.origin {
            Origin::BuiltIn(text) => Some((*text).to_owned()),
            Origin::File(path) => fs::read_to_string(path).ok(),
        }
    }
}

/// The file of a world of the binary, for a name such as `cave`, `cave.ron` or `worlds/cave.ron`.
pub fn bundled(name: &Path, folders: &Folders) -> Option<PathBuf> {
    let is_here = name
        .parent()
        .is_none_or(|folder| folder == Path::new("") || folder == Path::new("worlds"));
    let is_world = name.extension().is_none_or(|extension| extension == "ron");
    let stem = name.file_stem()?.to_str()?;
    let (name, text) = BUILT_IN.iter().find(|(name, _)| *name == stem)?;
    let entry = Entry {
        name: (*name).to_owned(),
        title: String::new(),
        origin: Origin::BuiltIn(text),
    };
    // Where it cannot be written, the name is told as missing.
    let path = (is_here && is_world).then(|| entry.path(folders).ok());
    path.flatten()
}

/// The worlds of the binary.
pub fn built_in() -> Vec<Entry> {
    let entries = BUILT_IN.iter().map(|(name, text)| Entry {
        name: (*name).to_owned(),
        title: title(text, name),
        origin: Origin::BuiltIn(text),
    });
    entries.collect()
}

/// The user's caves, newest first, and then the worlds of the binary.
pub fn entries(folders: &Folders) -> Vec<Entry> {
    let mut caves: Vec<_> = fs::read_dir(&folders.caves)
        .into_iter()
        .flatten()
        .filter_map(|file| {
            let path = file.ok()?.path();
            let named = path.extension()? == "ron";
            let changed = fs::metadata(&path).and_then(|data| data.modified()).ok()?;
            named.then_some((changed, path))
        })
        .collect();
    caves.sort_by(|a, b| b.cmp(a));
    let caves = caves.into_iter().map(|(_, path)| {
        let name = path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let text = fs::read_to_string(&path).unwrap_or_default();
        Entry {
            title: title(&text, &name),
            name,
            origin: Origin::File(path),
        }
    });
    caves.chain(built_in()).collect()
}

/// The title alone, without building the world: files of the menu are read whenever it opens.
fn title(text: &str, name: &str) -> String {
    file::title(text).unwrap_or_else(|| format!("{name}.ron has an error: enter it to see where"))
}

/// Writes a new cave under a free name that resembles the player's, and returns its file.
///
/// # Errors
/// [`FileError`] when it cannot be written.
pub fn create(cave: &NewCave, name: &str, folders: &Folders) -> Result<PathBuf, FileError> {
    let stem = stem_of(name);
    let mut path = folders.caves.join(format!("{stem}.ron"));
    for number in 2.. {
        if !path.exists() {
            break;
        }
        path = folders.caves.join(format!("{stem} {number}.ron"));
    }
    let title = if name.trim().is_empty() {
        &stem
    } else {
        name.trim()
    };
    write(&path, &cave.text(title))?;
    Ok(path)
}

/// A file name for what a player typed: letters, digits, spaces and dashes of it.
fn stem_of(name: &str) -> String {
    const MOST: usize = 60;
    let kept = |letter: &char| letter.is_alphanumeric() || [' ', '-', '_'].contains(letter);
    let stem: String = name.chars().filter(kept).take(MOST).collect();
    match stem.trim() {
        "" => "new cave".to_owned(),
        stem => stem.to_owned(),
    }
}

/// Writes a world file as a whole, with its folder.
fn write(path: &Path, text: &str) -> Result<(), FileError> {
    if let Some(folder) = path.parent() {
        whole_file::create_folder(folder)?;
    }
    let mut file = whole_file::open(path)?;
    file.write_all(text.as_bytes())
        .and_then(|()| file.commit())
        .map_err(|reason| FileError::writing(path, reason))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::file::Overrides;

    fn folders(root: &Path) -> Folders {
        Folders {
            caves: root.join("caves"),
            worlds: root.join("worlds"),
            pictures: root.join("pictures"),
        }
    }

    #[test]
    fn every_world_of_the_repository_is_built_in_and_has_a_title() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds");
        let files = fs::read_dir(folder)
            .expect("the folder")
            .filter_map(|file| {
                let path = file.expect("a file").path();
                (path.extension()? == "ron").then_some(path)
            });
        let mut there: Vec<String> = files
            .map(|path| {
                path.file_stem()
                    .expect("a name")
                    .to_string_lossy()
                    .into_owned()
            })
            .collect();
        let mut known: Vec<String> = BUILT_IN
            .iter()
            .map(|(name, _)| (*name).to_owned())
            .collect();
        there.sort();
        known.sort();
        assert_eq!(known, there);
        for entry in built_in() {
            assert!(!entry.title.contains("error"), "{}", entry.title);
        }
    }

    #[test]
    fn worlds_of_the_binary_are_found_by_their_names() {
        let root = tempfile::tempdir().expect("a folder");
        let folders = folders(root.path());
        for name in ["sealed", "sealed.ron", "worlds/sealed.ron"] {
            let path = bundled(Path::new(name), &folders).expect("it is one");
            assert!(fs::read_to_string(path).is_ok_and(|text| text.contains("title:")));
        }
        for name in [
            "other.ron",
            "sealed.vox",
            "elsewhere/sealed.ron",
            "/sealed.ron",
            "",
        ] {
            assert_eq!(bundled(Path::new(name), &folders), None, "{name}");
        }
    }

    #[test]
    fn caves_get_free_names_and_are_listed_with_the_name_that_was_typed() {
        let root = tempfile::tempdir().expect("a folder");
        let folders = folders(root.path());
        let cave = NewCave::default();
        let first = create(&cave, " Deep/Hall ", &folders).expect("it is written");
        let second = create(&cave, " Deep/Hall ", &folders).expect("it is written");
        assert_eq!(first, folders.caves.join("DeepHall.ron"));
        assert_eq!(second, folders.caves.join("DeepHall 2.ron"));
        assert!(
            create(&cave, "../..", &folders)
                .expect("it is written")
                .starts_with(&folders.caves)
        );
        fs::write(folders.caves.join("broken.ron"), "(").expect("it is written");
        let listed = entries(&folders);
        assert_eq!(listed.len(), BUILT_IN.len() + 4);
        let of = |name: &str| {
            listed
                .iter()
                .find(|entry| entry.name == name)
                .expect("listed")
        };
        assert_eq!(of("DeepHall").title, "Deep/Hall");
        assert!(of("broken").title.contains("error"));
        file::load(&first, &Overrides::default()).expect("it can be entered");
    }

    #[test]
    fn worlds_of_the_binary_become_files_that_can_be_entered() {
        let root = tempfile::tempdir().expect("a folder");
        let folders = folders(root.path());
        let entry = Entry {
            // A name that the checkout lacks.
            name: "elsewhere".to_owned(),
            ..built_in().remove(0)
        };
        let path = entry.path(&folders).expect("it is written");
        assert!(path.starts_with(root.path()));
        assert_eq!(fs::read_to_string(&path).ok(), entry.text());
        fs::write(&path, "spoilt").expect("it is written");
        entry.path(&folders).expect("it is written again");
        assert_eq!(fs::read_to_string(&path).ok(), entry.text());
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_named() {
        let root = tempfile::tempdir().expect("a folder");
        fs::write(root.path().join("caves"), "a file").expect("it is written");
        let error = create(&NewCave::default(), "x", &folders(root.path())).expect_err("no folder");
        assert!(error.to_string().contains("caves"), "{error}");
    }
}
