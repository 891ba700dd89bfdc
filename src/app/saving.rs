//! Saves of a run: when they are made, and the thread that writes them.
//!
//! What is saved is copied between two frames, and written beside them: no frame waits for a disk.

use std::{
    path::{Path, PathBuf},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use super::{
    clock::WorldClock,
    messages::Messages,
    quality::Preset,
    texts::{saving as texts, toasts},
};
use crate::parameters::Parameters;
use crate::world::{
    Overlay, PlacedLamp,
    bodies::ChangedBodies,
    file,
    save::{self, Folder, Head, Save, SaveError, State, VARIABLE, now_s},
};

/// Time between two automatic saves.
const INTERVAL: Duration = Duration::from_secs(60);

/// Where a run is saved.
#[derive(Clone, Debug, Default)]
pub struct SaveOptions {
    /// Where new saves go; `None` for a user without a home.
    pub folder: Option<Folder>,
    /// The save with which the run began: it is continued.
    pub continued: Option<(PathBuf, Save)>,
    /// Save every minute and at the end.
    pub automatic: bool,
}

/// What a save keeps of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    pub state: State,
    pub overlay: Overlay,
    pub lamps: Vec<PlacedLamp>,
    pub bodies: ChangedBodies,
}

impl Kept {
    /// Whether the world is the same, wherever the player is.
    fn has_same_world(&self, other: &Self) -> bool {
        self.overlay == other.overlay && self.lamps == other.lamps && self.bodies == other.bodies
    }
}

/// The parameters that a save kept, over those of a preset. Those that are no longer known are left out: notes of the
/// world say so.
pub fn parameters_of(save: &Save, preset: Preset) -> Parameters {
    let mut parameters = Parameters::default();
    preset.apply(&mut parameters);
    for assignment in &save.state.set {
        let _ = parameters.set(assignment);
    }
    parameters
}

/// The clock with which a run goes on.
pub fn clock_of(save: &Save) -> WorldClock {
    WorldClock {
        time_s: save.state.time_s,
        paused: save.state.paused,
        rate: save.state.rate,
    }
}

/// The saves of a run.
pub struct Saving {
    folder: Option<Folder>,
    world_file: PathBuf,
    /// Name and place are chosen when something is saved first.
    file: Option<PathBuf>,
    automatic: bool,
    /// What was saved last, or what the run began with.
    known: Option<Kept>,
    next: Instant,
    writer: Option<Writer>,
}

struct Writer {
    thread: JoinHandle<Result<(), SaveError>>,
    path: PathBuf,
    /// The user waits for a word.
    is_asked: bool,
}

impl Saving {
    /// Finds out whether saves can be written, and says at once if they cannot. `start` is what the run begins with.
    pub fn begin(
        options: &SaveOptions,
        world_file: &Path,
        start: Kept,
        messages: &mut Messages,
    ) -> Self {
        let file = options.continued.as_ref().map(|(path, _)| path.clone());
        let folder = match &file {
            Some(file) => Some(Folder::at(file.parent().unwrap_or(Path::new(".")))),
            None => options.folder.clone(),
        };
        let trouble = match &folder {
            Some(folder) => folder.check_writable().err().map(|error| error.to_string()),
            None => Some(texts::no_home(VARIABLE)),
        };
        if let Some(trouble) = trouble.filter(|_| options.automatic) {
            let text = texts::impossible(&trouble);
            tracing::error!("{text}");
            messages.toast_error(text);
        }
        Self {
            folder,
            world_file: world_file.to_owned(),
            file,
            automatic: options.automatic,
            known: Some(start),
            next: Instant::now() + INTERVAL,
            writer: None,
        }
    }

    /// The save that this run writes, once it has one.
    pub fn written(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Whether it is time for an automatic save; the next one is due an interval later.
    pub fn is_due(&mut self, now: Instant) -> bool {
        let is_due = self.automatic && self.writer.is_none() && now >= self.next;
        if is_due {
            self.next = now + INTERVAL;
        }
        is_due
    }

    /// Saves because the user wants it.
    pub fn save(&mut self, kept: Kept, messages: &mut Messages) {
        if self.writer.is_some() {
            messages.toast(texts::BUSY);
            return;
        }
        match self.file() {
            Ok(path) => self.start(kept, path, true),
            Err(error) => messages.toast_error(error.to_string()),
        }
    }

    /// Saves if voxels, lamps or bodies were changed since the last save.
    pub fn save_changes(&mut self, kept: Kept, messages: &mut Messages) {
        let is_same = |known: &Kept| known.has_same_world(&kept);
        if self.known.as_ref().is_some_and(is_same) {
            return;
        }
        match self.file() {
            Ok(path) => self.start(kept, path, false),
            Err(error) => messages.toast_error(error.to_string()),
        }
    }

    /// Says what became of a save that was being written.
    pub fn hear(&mut self, messages: &mut Messages) {
        let Some(writer) = self.writer.take_if(|writer| writer.thread.is_finished()) else {
            return;
        };
        let (path, is_asked) = (writer.path.clone(), writer.is_asked);
        match self.ended(writer) {
            Ok(()) if is_asked => messages.toast(toasts::saved(&path)),
            Ok(()) => {}
            Err(error) => messages.toast_error(error.to_string()),
        }
    }

    /// The end of the run: saves what was changed since the last save. A run that was never saved and changed no voxel,
    /// no lamp and no body leaves none. Returns the file that was written.
    ///
    /// # Errors
    /// [`SaveError`] when it cannot be written.
    pub fn finish(&mut self, kept: Kept) -> Result<Option<PathBuf>, SaveError> {
        if let Some(writer) = self.writer.take() {
            // If it failed, all is written again now.
            let _ = self.ended(writer);
        }
        let is_same = match (&self.known, &self.file) {
            (Some(known), Some(_)) => *known == kept,
            (Some(known), None) => known.has_same_world(&kept),
            (None, _) => false,
        };
        if !self.automatic || is_same {
            return Ok(None);
        }
        let path = self.file()?;
        write(&path, &self.world_file, kept)?;
        Ok(Some(path))
    }

    /// The file of this run.
    fn file(&mut self) -> Result<PathBuf, SaveError> {
        if let Some(file) = &self.file {
            return Ok(file.clone());
        }
        let folder = self.folder.as_ref().ok_or_else(|| SaveError::Unwritable {
            path: VARIABLE.into(),
            reason: "this user has no home folder: name one by this variable".to_owned(),
        })?;
        let name = self.world_file.file_stem().unwrap_or_default();
        let file = folder.free_file(&name.to_string_lossy());
        Ok(self.file.insert(file).clone())
    }

    fn start(&mut self, kept: Kept, path: PathBuf, is_asked: bool) {
        self.known = Some(kept.clone());
        self.next = Instant::now() + INTERVAL;
        let (file, world_file) = (path.clone(), self.world_file.clone());
        self.writer = Some(Writer {
            thread: thread::spawn(move || write(&file, &world_file, kept)),
            path,
            is_asked,
        });
    }

    fn ended(&mut self, writer: Writer) -> Result<(), SaveError> {
        let path = writer.path;
        let written = writer.thread.join().unwrap_or_else(|_| {
            Err(SaveError::Unwritable {
                path,
                reason: "the thread that wrote it failed".to_owned(),
            })
        });
        if written.is_err() {
            // It counts as not saved.
            self.known = None;
        }
        written
    }
}

/// Writes a save of the world as its file is now.
fn write(path: &Path, world_file: &Path, kept: Kept) -> Result<(), SaveError> {
    let Kept {
        state,
        overlay,
        lamps,
        bodies,
    } = kept;
    let mut save = Save {
        head: Head {
            world: String::new(),
            world_file: String::new(),
            world_beside: None,
            // A world file that cannot be read now is a changed one.
            world_crc32: file::fingerprint(world_file).unwrap_or(0),
            saved_s: now_s(),
            voxels: overlay.count(),
            lamps: lamps.len(),
            bodies: bodies.placed.len() + bodies.moved.len() + bodies.gone.len(),
            grotto: env!("CARGO_PKG_VERSION").to_owned(),
        },
        state,
        overlay,
        lamps,
        bodies,
    };
    save.belongs_to(world_file, path);
    save::write(path, &save)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use glam::UVec3;

    use super::*;
    use crate::world::save::SavedHotbar;

    fn kept(voxels: u32, time_s: f64) -> Kept {
        let mut overlay = Overlay::default();
        for x in 0..voxels {
            overlay.set(UVec3::new(x, 0, 0), 1);
        }
        Kept {
            state: State {
                time_s,
                paused: false,
                rate: 1.0,
                eye: [0.0; 3],
                yaw_deg: 0.0,
                pitch_deg: 0.0,
                fov_deg: 70.0,
                layout: "probes".into(),
                set: Vec::new(),
                materials: vec!["stone".into()],
                origin: [0; 3],
                hotbar: SavedHotbar::default(),
            },
            overlay,
            lamps: Vec::new(),
            bodies: ChangedBodies::default(),
        }
    }

    fn begun(folder: &Path, messages: &mut Messages) -> Saving {
        let options = SaveOptions {
            folder: Some(Folder::at(folder)),
            continued: None,
            automatic: true,
        };
        let world = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/minimal.ron");
        Saving::begin(&options, &world, kept(0, 0.0), messages)
    }

    fn wait(saving: &mut Saving, messages: &mut Messages) {
        while saving.writer.is_some() {
            thread::sleep(Duration::from_millis(1));
            saving.hear(messages);
        }
    }

    #[test]
    fn a_run_is_saved_when_it_changed() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let folder = place.path().join("saves");
        let mut messages = Messages::default();
        let mut saving = begun(&folder, &mut messages);
        let now = Instant::now();
        assert!(!saving.is_due(now) && saving.is_due(now + INTERVAL));
        assert!(!saving.is_due(now + INTERVAL), "the next is later");
        let files = || fs::read_dir(&folder).expect("readable").count();
        saving.save_changes(kept(0, 9.0), &mut messages);
        assert_eq!(saving.finish(kept(0, 9.0)).expect("nothing to write"), None);
        assert_eq!(files(), 0, "looking around leaves no save");
        saving.save_changes(kept(3, 10.0), &mut messages);
        wait(&mut saving, &mut messages);
        let path = folder.join("minimal.grotto");
        assert_eq!(save::read(&path).expect("whole").overlay.count(), 3);
        assert_eq!(
            saving.finish(kept(3, 10.0)).expect("nothing to write"),
            None
        );
        let ended = saving.finish(kept(3, 11.0)).expect("writable");
        assert_eq!(ended.as_deref(), Some(&*path));
        let mut other = begun(&folder, &mut messages);
        other.save(kept(0, 1.0), &mut messages);
        wait(&mut other, &mut messages);
        assert!(
            folder.join("minimal 2.grotto").exists(),
            "nobody's save is overwritten"
        );
        assert_eq!(messages.take_errors(), [""; 0]);
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_said_at_the_start_and_at_each_try() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let file = place.path().join("file");
        fs::write(&file, "x").expect("writable");
        let mut messages = Messages::default();
        let mut saving = begun(&file.join("saves"), &mut messages);
        let errors = messages.take_errors();
        assert!(
            errors[0].contains("Nothing can be saved here"),
            "{errors:?}"
        );
        saving.save(kept(1, 0.0), &mut messages);
        wait(&mut saving, &mut messages);
        let errors = messages.take_errors();
        assert!(
            errors[0].contains("a file is where its folder"),
            "{errors:?}"
        );
        assert!(
            saving.finish(kept(1, 0.0)).is_err(),
            "it counts as not saved"
        );
    }
}
