//! Passes are compiled side by side, each in a thread of its own.

use std::thread::ScopedJoinHandle;

/// What a thread has made; a panic there is one here.
pub(super) fn made<T>(thread: ScopedJoinHandle<'_, T>) -> T {
    thread
        .join()
        .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}
