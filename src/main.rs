//! Arguments → a command → an exit code, nothing else.

use std::{env, panic, process::ExitCode};

use clap::Parser as _;
use grotto::commands::{self, Cli};
use tracing_subscriber::EnvFilter;

fn main() -> ExitCode {
    #[cfg(target_os = "linux")]
    silence_device_select();
    panic::set_hook(Box::new(|info| eprintln!("{}", commands::bug_report(info))));
    tracing_subscriber::fmt()
        .with_env_filter(EnvFilter::try_from_default_env().unwrap_or_else(|_| "error".into()))
        .with_writer(std::io::stderr)
        .init();
    let cli = Cli::parse();
    match panic::catch_unwind(|| commands::run(cli)) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(failure)) => {
            eprintln!("{failure}");
            ExitCode::from(failure.exit_code())
        }
        // The panic hook has printed the message.
        Err(_) => ExitCode::from(commands::EXIT_FAULT),
    }
}

/// Starts this program again with `NODEVICE_SELECT`, where that is needed. Mesa's device-select layer, which ranks the
/// desktop's GPU first, asks a Wayland compositor for that GPU. Without a session there is no compositor, and its
/// library prints errors to stderr. grotto ranks the adapters itself. (A process that changes its own environment
/// needs `unsafe`.)
#[cfg(target_os = "linux")]
fn silence_device_select() {
    use std::{os::unix::process::CommandExt as _, process::Command};

    let is_set = |name| env::var_os(name).is_some();
    let is_wanted =
        is_set("XDG_RUNTIME_DIR") || is_set("MESA_VK_DEVICE_SELECT") || is_set("DRI_PRIME");
    if is_wanted || is_set(NO_DEVICE_SELECT) {
        return;
    }
    if let Ok(program) = env::current_exe() {
        // Returns only if it fails: then the errors are printed.
        let _ = Command::new(program)
            .args(env::args_os().skip(1))
            .env(NO_DEVICE_SELECT, "1")
            .exec();
    }
}

#[cfg(target_os = "linux")]
const NO_DEVICE_SELECT: &str = "NODEVICE_SELECT";
