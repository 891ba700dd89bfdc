//! Refuses work that does not fit into this machine's memory, before any of it is allocated.

use super::{Failure, info::bytes};
use crate::gpu::available_memory;

/// # Errors
/// When `what` needs more bytes than the system reports as available. Systems that report nothing (all but
/// Linux) are assumed to have enough.
pub fn check(what: &str, needed: u64) -> Result<(), Failure> {
    match available_memory() {
        Some(available) if needed > available => Err(Failure::bad_input(format!(
            "{what} needs {} of memory, and {} are available; choose a smaller one",
            bytes(needed),
            bytes(available)
        ))),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_always_fits_and_everything_never_does() {
        assert!(check("nothing", 0).is_ok());
        if cfg!(target_os = "linux") {
            let refused = check("a picture", u64::MAX).expect_err("16 EiB");
            assert!(refused.to_string().contains("a picture needs"));
        }
    }
}
