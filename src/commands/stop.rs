//! Ctrl-C, and SIGTERM on systems that have it: long work ends early and keeps its results; other commands end
//! at once. Both exit with [`EXIT_INTERRUPTED`].

use std::sync::{
    Arc, OnceLock,
    atomic::{AtomicBool, Ordering},
};

use super::{EXIT_INTERRUPTED, options::RunOptions, output};

/// The flag of work that ends early by itself, once such work has started.
static LISTENER: OnceLock<Arc<AtomicBool>> = OnceLock::new();
/// Why the signal handler could not be installed.
static DEAF: OnceLock<String> = OnceLock::new();

/// Installs the signal handler. From now on, a signal ends the program at once unless [`at_ctrl_c`] was called.
pub fn listen() {
    let handler = || match LISTENER.get() {
        Some(flag) if !flag.swap(true, Ordering::Relaxed) => {}
        _ => std::process::exit(i32::from(EXIT_INTERRUPTED)),
    };
    if let Err(error) = ctrlc::set_handler(handler) {
        // The handler is installed only once in a process.
        let _ = DEAF.set(error.to_string());
    }
}

/// Returns a flag that the first Ctrl-C sets; the second ends the program at once.
pub fn at_ctrl_c(run: &RunOptions) -> Arc<AtomicBool> {
    if let Some(error) = DEAF.get() {
        output::note(
            run,
            &format!("note: Ctrl-C ends this at once: the signal cannot be handled ({error})"),
        );
    }
    LISTENER.get_or_init(Arc::default).clone()
}
