//! Notices that files were edited, by checking them a few times a second.

use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant, SystemTime},
};

use crate::world::file;

/// Four checks a second.
const INTERVAL: Duration = Duration::from_millis(250);

/// Time of modification and length of each file, in the order of their names.
type Stamp = Vec<(PathBuf, SystemTime, u64)>;

/// Watches some files, or every file of a folder that passes a filter.
pub struct Watch {
    paths: Vec<PathBuf>,
    extension: Option<&'static str>,
    /// The state that was last reported, or the initial one.
    known: Stamp,
    /// The state at the last check.
    seen: Stamp,
    looked: Instant,
}

impl Watch {
    /// Watches a world file with all files that it includes.
    pub fn world(path: &Path) -> Self {
        let mut watch = Self::new(vec![path.to_owned()], None);
        watch.follow_world();
        watch
    }

    /// Watches the files under `folder` with this extension (without a dot).
    pub fn folder(folder: &Path, extension: &'static str) -> Self {
        Self::new(vec![folder.to_owned()], Some(extension))
    }

    fn new(paths: Vec<PathBuf>, extension: Option<&'static str>) -> Self {
        let known = stamp(&paths, extension);
        Self {
            paths,
            extension,
            seen: known.clone(),
            known,
            looked: Instant::now(),
        }
    }

    /// Watches the files that the world file includes now. Call this before reading them: an edit from then on
    /// is reported. While the world file cannot be read, the files that it included before are watched.
    pub fn follow_world(&mut self) {
        let Some(included) = self.paths.first().and_then(|world| file::included(world)) else {
            return;
        };
        let new: Vec<PathBuf> = included
            .iter()
            .filter(|path| !self.paths.contains(path))
            .cloned()
            .collect();
        self.paths.truncate(1);
        self.paths.extend(included);
        self.paths[1..].sort();
        self.paths.dedup();
        // For files that were watched before, the known state stays.
        let (known, paths) = (&mut self.known, &self.paths);
        known.retain(|(path, ..)| paths.contains(path));
        known.extend(stamp(&new, None));
        known.sort();
        known.dedup();
        self.seen.clone_from(known);
    }

    /// Whether an edit has been completed since the last time that this returned true. Two checks in a row must
    /// see the same state, so that nothing is read half-written, and at least one file must exist, so that an
    /// editor that removes and renames is not reported twice.
    pub fn changed(&mut self, now: Instant) -> bool {
        if now.saturating_duration_since(self.looked) < INTERVAL {
            return false;
        }
        self.looked = now;
        let stamp = stamp(&self.paths, self.extension);
        let settled = stamp == self.seen && !stamp.is_empty();
        self.seen = stamp;
        let changed = settled && self.seen != self.known;
        if changed {
            self.known.clone_from(&self.seen);
        }
        changed
    }
}

/// The state of the files that can be read; the others count as missing.
fn stamp(paths: &[PathBuf], extension: Option<&str>) -> Stamp {
    let mut stamp = Stamp::new();
    for path in paths {
        collect(path, extension, &mut stamp);
    }
    stamp.sort();
    stamp
}

fn collect(path: &Path, extension: Option<&str>, stamp: &mut Stamp) {
    let Ok(metadata) = fs::metadata(path) else {
        return;
    };
    if metadata.is_dir() {
        for entry in fs::read_dir(path).into_iter().flatten().flatten() {
            collect(&entry.path(), extension, stamp);
        }
    } else if extension.is_none_or(|wanted| path.extension().is_some_and(|found| found == wanted)) {
        let modified = metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH);
        stamp.push((path.to_owned(), modified, metadata.len()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A world file that includes these models.
    fn with_models(names: &[&str]) -> String {
        let models: String = names
            .iter()
            .map(|name| format!("(file: \"{name}\", at: (0, 0, 0)),"))
            .collect();
        format!("(title: \"\", size: (8, 8, 8), shape: Empty, models: [{models}])")
    }

    #[test]
    fn a_world_is_watched_with_all_that_it_includes() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = |name: &str| folder.path().join(name);
        fs::create_dir(file("models")).expect("writable");
        fs::write(file("a.vox"), "one").expect("writable");
        fs::write(file("b.vox"), "one").expect("writable");
        fs::write(
            file("world.ron"),
            with_models(&["a.vox", "models/c.vox", "a.vox", "../a.vox"]),
        )
        .expect("writable");
        let mut watch = Watch::world(&file("world.ron"));
        let mut now = Instant::now();
        assert_eq!(seen(&mut watch, &mut now), 0);
        fs::write(file("a.vox"), "edited").expect("writable");
        assert_eq!(seen(&mut watch, &mut now), 1);
        fs::write(file("models/c.vox"), "it was missing").expect("writable");
        assert_eq!(seen(&mut watch, &mut now), 1);
        fs::write(file("b.vox"), "of no world").expect("writable");
        assert_eq!(seen(&mut watch, &mut now), 0);

        // Another world includes other files.
        fs::write(file("world.ron"), with_models(&["b.vox"])).expect("writable");
        assert_eq!(seen(&mut watch, &mut now), 1);
        watch.follow_world();
        assert_eq!(seen(&mut watch, &mut now), 0);
        fs::write(file("a.vox"), "no longer of any").expect("writable");
        assert_eq!(seen(&mut watch, &mut now), 0);
        fs::write(file("b.vox"), "of this one").expect("writable");
        assert_eq!(seen(&mut watch, &mut now), 1);

        // While the world is broken, a model may be mended.
        fs::write(file("world.ron"), "(title").expect("writable");
        assert_eq!(seen(&mut watch, &mut now), 1);
        watch.follow_world();
        fs::write(file("b.vox"), "mended").expect("writable");
        assert_eq!(seen(&mut watch, &mut now), 1);
    }

    /// Checks often enough that an edit must be seen. The times are simulated.
    fn seen(watch: &mut Watch, now: &mut Instant) -> usize {
        let mut look = || {
            *now += INTERVAL;
            watch.changed(*now)
        };
        (0..4).filter(|_| look()).count()
    }

    #[test]
    fn an_edit_is_reported_once_and_a_missing_file_never() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("world.ron");
        fs::write(&path, "one").expect("writable");
        let mut watch = Watch::world(&path);
        let mut now = Instant::now();
        assert_eq!(seen(&mut watch, &mut now), 0);
        fs::write(&path, "three").expect("writable");
        assert_eq!(seen(&mut watch, &mut now), 1);
        fs::remove_file(&path).expect("it is there");
        assert_eq!(seen(&mut watch, &mut now), 0);
        fs::write(&path, "back again").expect("writable");
        assert_eq!(seen(&mut watch, &mut now), 1);
    }

    #[test]
    fn nothing_is_reported_before_it_settles_or_too_soon() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("world.ron");
        fs::write(&path, "one").expect("writable");
        let mut watch = Watch::world(&path);
        let start = Instant::now();
        fs::write(&path, "half of what is t").expect("writable");
        assert!(!watch.changed(start + INTERVAL), "seen for the first time");
        fs::write(&path, "half of what is to come").expect("writable");
        assert!(!watch.changed(start + 2 * INTERVAL), "still growing");
        assert!(
            !watch.changed(start + 2 * INTERVAL + INTERVAL / 2),
            "too soon"
        );
        assert!(watch.changed(start + 3 * INTERVAL));
    }

    #[test]
    fn folders_are_watched_to_their_depths_but_for_other_files() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let deep = folder.path().join("passes");
        fs::create_dir(&deep).expect("writable");
        fs::write(deep.join("shade.wesl"), "one").expect("writable");
        let mut watch = Watch::folder(folder.path(), "wesl");
        let mut now = Instant::now();
        fs::write(deep.join("shade.wesl~"), "a copy").expect("writable");
        assert_eq!(seen(&mut watch, &mut now), 0);
        fs::write(deep.join("shade.wesl"), "two lines").expect("writable");
        assert_eq!(seen(&mut watch, &mut now), 1);
        fs::write(deep.join("new.wesl"), "a new file").expect("writable");
        assert_eq!(seen(&mut watch, &mut now), 1);
    }
}
