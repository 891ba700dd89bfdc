//! Shaders that are composed before there is a device: composition keeps a CPU busy, and opening a device mostly
//! waits for the driver.

use std::{
    collections::HashMap,
    hash::{DefaultHasher, Hash as _, Hasher as _},
    panic,
    sync::{Arc, Mutex},
    thread::{self, JoinHandle},
};

use super::{Composed, GpuError, ShaderLibrary};

/// Compositions in progress, each on a thread of its own, by [`key`].
type Begun = HashMap<u64, JoinHandle<Result<Composed, GpuError>>>;

/// The shaders of the binary, and the compositions of them that have begun. Each is for the first kernel that asks
/// for it; what nobody asks for costs only its time on the CPU. Cheap to clone.
#[derive(Clone)]
pub struct EarlyShaders {
    library: Arc<ShaderLibrary>,
    begun: Arc<Mutex<Begun>>,
}

impl EarlyShaders {
    /// Begins to compose these shaders of the binary.
    pub fn begin(names: &[&str]) -> Self {
        let early = Self::none(Arc::new(ShaderLibrary::embedded()));
        for name in names {
            early.compose(name, &[]);
        }
        early
    }

    /// No composition of this library has begun.
    pub(super) fn none(library: Arc<ShaderLibrary>) -> Self {
        Self {
            library,
            begun: Arc::default(),
        }
    }

    /// Begins to compose one more shader, with modules that are generated for it.
    pub fn compose(&self, name: &str, generated: &[(&str, &str)]) {
        let own = |text: &str| text.to_owned();
        let (library, shader) = (self.library.clone(), own(name));
        let modules: Vec<_> = generated
            .iter()
            .map(|(name, text)| (own(name), own(text)))
            .collect();
        let composing = thread::spawn(move || {
            let modules = modules.iter().map(|(name, text)| (&**name, &**text));
            library.compose(&shader, &modules.collect::<Vec<_>>())
        });
        let mut begun = self.begun.lock().expect("nobody panics holding it");
        begun.insert(key(name, generated), composing);
    }

    /// The composition that has begun, once it is complete; otherwise a new one.
    pub(super) fn composed(
        &self,
        name: &str,
        generated: &[(&str, &str)],
    ) -> Result<Composed, GpuError> {
        let mut begun = self.begun.lock().expect("nobody panics holding it");
        let early = begun.remove(&key(name, generated));
        drop(begun);
        match early {
            Some(composing) => composing
                .join()
                .unwrap_or_else(|panic| panic::resume_unwind(panic)),
            None => self.library.compose(name, generated),
        }
    }

    /// Whether a kernel has asked for everything that has begun.
    #[cfg(test)]
    pub fn is_used_up(&self) -> bool {
        self.begun
            .lock()
            .expect("nobody panics holding it")
            .is_empty()
    }

    pub(super) fn library(&self) -> &Arc<ShaderLibrary> {
        &self.library
    }
}

/// Distinguishes the compositions of a library.
fn key(name: &str, generated: &[(&str, &str)]) -> u64 {
    let mut hasher = DefaultHasher::new();
    (name, generated).hash(&mut hasher);
    hasher.finish()
}
