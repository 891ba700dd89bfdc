//! Work that is done side by side, because opening devices and compiling pipelines takes long.

use std::{panic, thread::ScopedJoinHandle};

/// What a thread has made; a panic there is one here.
pub fn made<T>(thread: ScopedJoinHandle<'_, T>) -> T {
    thread
        .join()
        .unwrap_or_else(|panic| panic::resume_unwind(panic))
}
