//! A world as a save left it: its world file, changed.

use std::path::{Component, Path, PathBuf};

use miette::Report;

use super::{Head, SaveError, disk};
use crate::{
    parameters::Parameters,
    world::{
        World,
        file::{self, Overrides},
    },
};

/// Name of the camera at which the player stood.
pub const VIEW: &str = "save";

/// Reads a save with its world file. The player's view is the first camera, and the chosen layout is the first one.
///
/// # Errors
/// A report when the save or its world file cannot be used.
pub fn load(path: &Path, overrides: &Overrides) -> Result<World, Report> {
    let report = |error: SaveError| Report::msg(error.to_string());
    let opened = disk::open(path).map_err(report)?;
    let save = opened.save;
    let mut notes: Vec<String> = opened.note.into_iter().collect();
    let world_file = world_file(path, &save.head).map_err(report)?;

    let mut parameters = Parameters::default();
    for assignment in &save.state.set {
        if let Err(error) = parameters.set(assignment) {
            notes.push(format!(
                "{}: a setting is left out: {error}",
                path.display()
            ));
        }
    }
    let own = Overrides::from(&parameters);
    let overrides = Overrides {
        size: overrides.size.or(own.size),
        seed: overrides.seed.or(own.seed),
        albedo: overrides.albedo.or(own.albedo),
        emission: overrides.emission.or(own.emission),
        without_bodies: overrides.without_bodies || own.without_bodies,
    };
    let mut world = file::load(&world_file, &overrides)?;
    let is_changed = file::fingerprint(&world_file)? != save.head.world_crc32;

    let numbers: Vec<Option<u8>> = save
        .state
        .materials
        .iter()
        .map(|name| {
            let place = world.materials.iter().position(|known| known.name == *name);
            place.and_then(|place| u8::try_from(place + 1).ok())
        })
        .collect();
    let renumbered = |material: u8| *numbers.get(usize::from(material) - 1)?;
    let shift = glam::IVec3::from(save.state.origin) - world.origin;
    let (overlay, lost) = save.overlay.fitted(world.size, shift, renumbered);
    let lost_bodies = world.bodies.take_changes(&save.bodies, renumbered);
    let place = path.display();
    let world_place = world_file.display();
    let fits = match lost {
        0 => "all changes of its voxels still fit".to_owned(),
        lost => format!(
            "{lost} of {} changed voxels are left out, for they have no place or no material in it",
            save.overlay.count()
        ),
    };
    if is_changed {
        notes.push(format!(
            "{place}: {world_place} has been changed since this was saved; {fits}"
        ));
    } else if lost > 0 {
        notes.push(format!("{place}: {fits}"));
    }

    if lost_bodies != [0, 0] {
        let [bodies, voxels] = lost_bodies;
        notes.push(format!(
            "{place}: {bodies} bodies are left out, for they have no place or no material in {world_place}, and {voxels} \
             voxels of others"
        ));
    }

    let layouts = &mut world.layouts;
    match layouts
        .iter()
        .position(|known| known.name == save.state.layout)
    {
        Some(chosen) => layouts[..=chosen].rotate_right(1),
        None => notes.push(format!(
            "{place}: {world_place} has no layout `{}` any more; its first one is used",
            save.state.layout
        )),
    }
    world.cameras.insert(0, save.view());
    if let Some(name) = path.file_stem() {
        world.name = name.to_string_lossy().into_owned();
    }
    world.restored.overlay = overlay;
    world.restored.notes = notes;
    world.restored.hotbar = save.state.hotbar;
    let (origin, size) = (world.origin, world.size);
    world.restored.take_lamps(&save.lamps, origin, size);
    Ok(world)
}

/// The world file that a save belongs to: where it was, or beside the save.
///
/// # Errors
/// [`SaveError::NoWorld`] when it is gone.
pub fn world_file(save: &Path, head: &Head) -> Result<PathBuf, SaveError> {
    let folder = save.parent().unwrap_or(Path::new(""));
    let absolute = Path::new(&head.world_file);
    let beside = head.world_beside.as_ref().map(|path| folder.join(path));
    let in_folder = absolute.file_name().map(|name| folder.join(name));
    let mut places = [beside, Some(absolute.to_owned()), in_folder]
        .into_iter()
        .flatten();
    places
        .find(|path| path.is_file())
        .map(|path| shortest(&path))
        .ok_or_else(|| SaveError::NoWorld {
            path: save.to_owned(),
            world: head.world_file.clone(),
        })
}

/// Without `..`, for messages; relative to the current folder if it lies there.
fn shortest(path: &Path) -> PathBuf {
    let Ok(real) = path.canonicalize() else {
        return path.to_owned();
    };
    let here = std::env::current_dir().and_then(|here| here.canonicalize());
    let within = here
        .ok()
        .and_then(|here| Some(real.strip_prefix(here).ok()?.to_owned()));
    within.unwrap_or(real)
}

/// The way from a folder to a file, both absolute; `None` where they have nothing in common.
pub(super) fn path_from(folder: &Path, file: &Path) -> Option<PathBuf> {
    let (from, to): (Vec<_>, Vec<_>) = (folder.components().collect(), file.components().collect());
    let same = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let is_named = |part: &&Component<'_>| matches!(part, Component::Normal(_));
    if !from[..same].iter().any(|part| is_named(&part))
        || !from[same..].iter().all(|part| is_named(&part))
    {
        return None;
    }
    let up = from[same..].iter().map(|_| Component::ParentDir);
    Some(up.chain(to[same..].iter().copied()).collect())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use glam::{IVec3, UVec3};

    use super::*;
    use crate::world::{
        Overlay,
        generate::generate,
        save::{Save, sample::save_of, write},
    };

    /// A folder with a copy of the smallest world and a save of it.
    fn saved() -> (tempfile::TempDir, PathBuf, PathBuf) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let world_file = folder.path().join("worlds/minimal.ron");
        let original = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/minimal.ron");
        fs::create_dir(folder.path().join("worlds")).expect("writable");
        fs::copy(original, &world_file).expect("writable");
        let path = folder.path().join("saves/mine.grotto");
        write(&path, &save(&world_file, &path)).expect("writable");
        (folder, world_file, path)
    }

    fn save(world_file: &Path, path: &Path) -> Save {
        let world = file::load(world_file, &Overrides::default()).expect("it loads");
        let mut overlay = Overlay::default();
        overlay.set(UVec3::new(2, 30, 3), 1);
        overlay.set(world.size - 1, 1);
        let mut save = save_of(overlay);
        save.state.set.clear();
        save.state.materials = world.materials.iter().map(|m| m.name.clone()).collect();
        save.state.origin = world.origin.to_array();
        save.state.layout = world.layouts.last().expect("a layout").name.clone();
        save.head.world_crc32 = file::fingerprint(world_file).expect("it loads");
        save.belongs_to(world_file, path);
        save
    }

    fn loaded(path: &Path) -> World {
        file::load(path, &Overrides::default()).expect("it loads")
    }

    #[test]
    fn a_save_is_its_world_with_the_changes() {
        let (_folder, world_file, path) = saved();
        let (plain, world) = (loaded(&world_file), loaded(&path));
        assert_eq!(world.name, "mine");
        assert_eq!(world.cameras[0].name, VIEW);
        assert_eq!(world.cameras.len(), plain.cameras.len() + 1);
        assert_eq!(
            world.layouts[0].name,
            plain.layouts.last().expect("one").name
        );
        assert_eq!(world.restored.notes, [""; 0]);
        let voxels = generate(&world);
        assert_eq!(voxels.material(IVec3::new(2, 30, 3)), 1);
        assert_eq!(generate(&plain).material(IVec3::new(2, 30, 3)), 0);
        assert_eq!(voxels.validate(), Ok(()));
    }

    #[test]
    fn a_changed_world_is_said_and_what_fits_is_kept() {
        let (_folder, world_file, path) = saved();
        let text = fs::read_to_string(&world_file).expect("readable");
        fs::write(&world_file, format!("// a word\n{text}\n")).expect("writable");
        assert_eq!(
            loaded(&path).restored.notes,
            [""; 0],
            "a comment changes nothing"
        );
        let changed = text.replacen("(64, 32, 64)", "(64, 34, 64)", 1);
        assert_ne!(changed, text);
        fs::write(&world_file, changed).expect("writable");
        let notes = loaded(&path).restored.notes;
        assert!(notes[0].contains("has been changed"), "{notes:?}");
        assert!(notes[0].contains("all changes"), "{notes:?}");
        let smaller = Overrides {
            size: Some(UVec3::splat(32)),
            ..Overrides::default()
        };
        let world = file::load(&path, &smaller).expect("it loads");
        let notes = &world.restored.notes;
        assert!(notes[0].contains("1 of 2 changed voxels"), "{notes:?}");
        assert_eq!(world.restored.overlay.count(), 1);
    }

    #[test]
    fn save_and_world_may_move_together_or_into_one_folder() {
        let (folder, world_file, path) = saved();
        let moved = folder.path().join("elsewhere");
        fs::create_dir(&moved).expect("writable");
        for part in ["worlds", "saves"] {
            fs::rename(folder.path().join(part), moved.join(part)).expect("movable");
        }
        let save = moved.join("saves/mine.grotto");
        assert_eq!(loaded(&save).restored.overlay.count(), 2);
        fs::rename(
            moved.join("worlds/minimal.ron"),
            moved.join("saves/minimal.ron"),
        )
        .expect("movable");
        assert_eq!(loaded(&save).restored.overlay.count(), 2);
        fs::remove_file(moved.join("saves/minimal.ron")).expect("there");
        let report = file::load(&save, &Overrides::default()).expect_err("no world");
        let message = report.to_string();
        assert!(message.contains("is gone"), "{message}");
        assert!(!world_file.exists() && !path.exists());
    }

    #[test]
    fn ways_between_paths() {
        let way = |from: &str, to: &str| path_from(Path::new(from), Path::new(to));
        assert_eq!(way("/a/b", "/a/c/d.ron"), Some("../c/d.ron".into()));
        assert_eq!(way("/a/b", "/a/b/d.ron"), Some("d.ron".into()));
        assert_eq!(way("/a/b", "/c/d.ron"), None);
    }
}
