//! Ctrl-C, and SIGTERM where there is such a thing: long work ends early and keeps what it has.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use super::{EXIT_INTERRUPTED, options::RunOptions, output};

/// A flag that the first Ctrl-C sets; the second ends the program at once.
pub fn at_ctrl_c(run: &RunOptions) -> Arc<AtomicBool> {
    let stopped = Arc::new(AtomicBool::new(false));
    let flag = stopped.clone();
    let handler = move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(EXIT_INTERRUPTED));
        }
    };
    if let Err(error) = ctrlc::set_handler(handler) {
        output::note(
            run,
            &format!("note: Ctrl-C ends this at once: it cannot be listened for ({error})"),
        );
    }
    stopped
}
