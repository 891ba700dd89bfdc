//! Notices that files were edited, by looking at them a few times a second.

use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant, SystemTime},
};

/// Four looks a second.
const INTERVAL: Duration = Duration::from_millis(250);

/// When each file was written and how long it is, in the order of their names.
type Stamp = Vec<(PathBuf, SystemTime, u64)>;

/// Watches a file, or every file of a folder that a filter lets through.
pub struct Watch {
    path: PathBuf,
    extension: Option<&'static str>,
    /// What was last reported or there from the start.
    known: Stamp,
    /// What the last look saw.
    seen: Stamp,
    looked: Instant,
}

impl Watch {
    pub fn file(path: &Path) -> Self {
        Self::new(path, None)
    }

    /// The files under `folder` that end in this extension (without a dot).
    pub fn folder(folder: &Path, extension: &'static str) -> Self {
        Self::new(folder, Some(extension))
    }

    fn new(path: &Path, extension: Option<&'static str>) -> Self {
        let known = stamp(path, extension);
        Self {
            path: path.to_owned(),
            extension,
            seen: known.clone(),
            known,
            looked: Instant::now(),
        }
    }

    /// Whether an edit has been completed since the last time that this said so: two looks in a row
    /// saw the same, so that nothing is read half-written, and something is there, so that an editor
    /// that removes and renames is not heard twice.
    pub fn changed(&mut self, now: Instant) -> bool {
        if now.saturating_duration_since(self.looked) < INTERVAL {
            return false;
        }
        self.looked = now;
        let stamp = stamp(&self.path, self.extension);
        let settled = stamp == self.seen && !stamp.is_empty();
        self.seen = stamp;
        let changed = settled && self.seen != self.known;
        if changed {
            self.known.clone_from(&self.seen);
        }
        changed
    }
}

/// Of what can be read; the rest is not there.
fn stamp(path: &Path, extension: Option<&str>) -> Stamp {
    let mut stamp = Stamp::new();
    collect(path, extension, &mut stamp);
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

    /// Looks often enough that an edit must be seen, at times that never pass.
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
        let mut watch = Watch::file(&path);
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
        let mut watch = Watch::file(&path);
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
