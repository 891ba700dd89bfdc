//! Arguments → a command → an exit code, nothing else.

use std::{env, panic, process::ExitCode};

use clap::Parser as _;
use grotto::commands::{self, Cli};
use tracing_subscriber::EnvFilter;

fn main() -> ExitCode {
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

/// Mesa's device-select layer, which ranks the desktop's GPU first, asks a Wayland compositor for that
/// GPU. Without a session there is no compositor, and its library prints errors to stderr. grotto ranks
/// the adapters itself.
fn silence_device_select() {
    let is_set = |name| env::var_os(name).is_some();
    let is_wanted =
        is_set("XDG_RUNTIME_DIR") || is_set("MESA_VK_DEVICE_SELECT") || is_set("DRI_PRIME");
    if cfg!(target_os = "linux") && !is_wanted && !is_set("NODEVICE_SELECT") {
        // SAFETY: no other thread runs yet that could read the environment.
        unsafe { env::set_var("NODEVICE_SELECT", "1") };
    }
}
