//! Arguments → a command → an exit code, nothing else.

use std::{panic, process::ExitCode};

use clap::Parser as _;
use grotto::commands::{self, Cli};
use tracing_subscriber::EnvFilter;

fn main() -> ExitCode {
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
        // The hook has said what happened.
        Err(_) => ExitCode::from(commands::EXIT_FAULT),
    }
}
