//! Kernels that are compiled ahead, on a thread of their own, so that no frame waits for them.

use std::{
    panic,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
};

use super::{Gpu, GpuError, Kernel, KernelSpec};

/// A [`KernelSpec`] that owns its texts.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnedSpec {
    shader: String,
    entry: String,
    overrides: Vec<(String, f64)>,
    offered: Vec<(String, f64)>,
    generated: Vec<(String, String)>,
}

impl From<&KernelSpec<'_>> for OwnedSpec {
    fn from(spec: &KernelSpec<'_>) -> Self {
        let numbers = |all: &[(&str, f64)]| {
            let own = all.iter().map(|(name, value)| ((*name).to_owned(), *value));
            own.collect()
        };
        let texts = spec.generated.iter();
        let texts = texts.map(|(name, text)| ((*name).to_owned(), (*text).to_owned()));
        Self {
            shader: spec.shader.to_owned(),
            entry: spec.entry.to_owned(),
            overrides: numbers(spec.overrides),
            offered: numbers(spec.offered),
            generated: texts.collect(),
        }
    }
}

impl OwnedSpec {
    /// The same with another value of an offered constant; `None` if the kernel is offered none of this name.
    fn with(&self, name: &str, value: f64) -> Option<Self> {
        let mut spec = self.clone();
        let mut offered = spec.offered.iter_mut();
        offered.find(|(known, _)| known == name)?.1 = value;
        Some(spec)
    }

    fn with_spec<T>(&self, then: impl FnOnce(&KernelSpec<'_>) -> T) -> T {
        fn numbers(all: &[(String, f64)]) -> Vec<(&str, f64)> {
            all.iter().map(|(name, value)| (&**name, *value)).collect()
        }
        let texts = self.generated.iter();
        let texts: Vec<_> = texts.map(|(name, text)| (&**name, &**text)).collect();
        then(&KernelSpec {
            shader: &self.shader,
            entry: &self.entry,
            overrides: &numbers(&self.overrides),
            offered: &numbers(&self.offered),
            generated: &texts,
        })
    }
}

/// Kernels that are being compiled ahead. Dropping it ends that after the kernel in progress: a driver must not compile
/// while the program ends.
pub struct Compiling {
    thread: Option<JoinHandle<Result<(), GpuError>>>,
    ends: Arc<AtomicBool>,
}

impl Compiling {
    pub fn is_over(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Waits until all are compiled.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn finish(mut self) -> Result<(), GpuError> {
        let thread = self.thread.take();
        let compiled = thread.map(|thread| thread.join());
        compiled.map_or(Ok(()), |compiled| {
            compiled.unwrap_or_else(|panic| panic::resume_unwind(panic))
        })
    }
}

impl Drop for Compiling {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // Whoever needs the kernel that failed compiles it again, and hears why.
            let _ = thread.join();
        }
    }
}

impl Gpu {
    /// The kernels compiled so far that are offered a constant of this name, with this value of it.
    pub fn variants(&self, name: &str, value: f64) -> Vec<OwnedSpec> {
        let kernels = self.kernels.lock().expect("nobody panics holding it");
        let all = kernels.values();
        all.filter_map(|kernel| kernel.spec.with(name, value))
            .collect()
    }

    /// Number of kernels compiled so far.
    #[cfg(test)]
    pub fn compiled(&self) -> usize {
        self.kernels.lock().expect("nobody panics holding it").len()
    }

    /// Those of the specs whose kernels are not compiled yet, each once.
    pub fn unknown(&self, specs: impl IntoIterator<Item = OwnedSpec>) -> Vec<OwnedSpec> {
        let mut unknown = Vec::new();
        for spec in specs {
            let is_known = spec.with_spec(|spec| self.knows(spec));
            if !is_known && !unknown.contains(&spec) {
                unknown.push(spec);
            }
        }
        unknown
    }

    /// Compiles these kernels one after the other, beside all other work.
    pub fn compile_ahead(&self, specs: Vec<OwnedSpec>) -> Compiling {
        let ends = Arc::new(AtomicBool::new(false));
        let (gpu, is_over) = (self.clone(), ends.clone());
        let thread = thread::spawn(move || {
            for spec in specs {
                if is_over.load(Ordering::Relaxed) {
                    break;
                }
                spec.with_spec(|spec| Kernel::new(&gpu, spec))?;
            }
            Ok(())
        });
        Compiling {
            thread: Some(thread),
            ends,
        }
    }
}
