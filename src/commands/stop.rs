//! Ctrl-C, and SIGTERM where there is such a thing: long work ends early and keeps what it has; the rest ends at
//! once. Both with [`EXIT_INTERRUPTED`].

use std::sync::{
    Arc, OnceLock,
    atomic::{AtomicBool, Ordering},
};

use super::{EXIT_INTERRUPTED, options::RunOptions, output};

/// The flag of the work that ends by itself, once there is such work.
static LISTENER: OnceLock<Arc<AtomicBool>> = OnceLock::new();
/// Why signals cannot be heard.
static DEAF: OnceLock<String> = OnceLock::new();

/// Hears the signals from now on: whatever does not ask for [`at_ctrl_c`] ends at once.
pub fn listen() {
    let handler = || match LISTENER.get() {
        Some(flag) if !flag.swap(true, Ordering::Relaxed) => {}
        _ => std::process::exit(i32::from(EXIT_INTERRUPTED)),
    };
    if let Err(error) = ctrlc::set_handler(handler) {
        // It is listened for only once in a process.
        let _ = DEAF.set(error.to_string());
    }
}

/// A flag that the first Ctrl-C sets; the second ends the program at once.
pub fn at_ctrl_c(run: &RunOptions) -> Arc<AtomicBool> {
    if let Some(error) = DEAF.get() {
        output::note(
            run,
            &format!("note: Ctrl-C ends this at once: it cannot be listened for ({error})"),
        );
    }
    LISTENER.get_or_init(Arc::default).clone()
}
