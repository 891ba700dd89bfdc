//! The commands, as a user types them. Each checks all of its input before it starts to work.

pub mod bench;
mod check;
mod compare;
mod dynamics;
mod export;
mod failure;
mod frame_loop;
mod info;
mod judge;
mod memory;
mod merge;
mod options;
mod out_file;
mod output;
mod part;
mod play;
mod record;
pub mod reference;
mod render;
mod saves;
mod settings;
mod shard;
mod stop;
pub mod stress;
mod test_case;

use std::panic::PanicHookInfo;

use clap::{Parser, Subcommand};

pub use failure::{EXIT_BAD_INPUT, EXIT_FAULT, EXIT_GATE, EXIT_INTERRUPTED, EXIT_NO_GPU, Failure};

/// Printed when `grotto` is called without arguments where no window can be opened.
const GREETING: &str = "\
grotto renders procedural voxel worlds with real-time global illumination (DDGI).

  grotto play   worlds/cave.ron               walk through the cave in a window
  grotto render worlds/cave.ron -o cave.png   a picture of it; with --cpu on any machine

The worlds lie in the folder worlds/ (copy worlds/minimal.ron to begin your own).
`grotto info` says what this machine would run on, `grotto --help` lists every command.
";

const EXIT_CODES: &str = "\
Exit codes: 0 done; 1 a fault of grotto's or of the machine; 2 a bad file or flag; 3 no usable GPU; \
4 a comparison failed; 130 stopped before it was done.";

/// Procedural voxel worlds with real-time global illumination.
#[derive(Parser)]
#[command(name = "grotto", version, max_term_width = 100, after_help = EXIT_CODES)]
pub struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    Play(play::Arguments),
    Render(render::Arguments),
    Reference(reference::Arguments),
    Compare(compare::Arguments),
    Judge(judge::Arguments),
    Export(export::Arguments),
    Saves(saves::Arguments),
    Check(check::Arguments),
    Bench(bench::Arguments),
    Stress(stress::Arguments),
    Merge(merge::Arguments),
    Info(info::Arguments),
}

/// Runs the command of the user.
///
/// # Errors
/// Why the command failed, with the exit code that says where the fault lies.
pub fn run(cli: Cli) -> Result<(), Failure> {
    stop::listen();
    match cli.command {
        None => match play::open()? {
            true => Ok(()),
            false => output::print(GREETING),
        },
        Some(Command::Play(arguments)) => play::run(arguments),
        Some(Command::Render(arguments)) => render::run(&arguments),
        Some(Command::Reference(arguments)) => reference::run(&arguments),
        Some(Command::Compare(arguments)) => compare::run(&arguments),
        Some(Command::Judge(arguments)) => judge::run(&arguments),
        Some(Command::Export(arguments)) => export::run(&arguments),
        Some(Command::Saves(arguments)) => saves::run(arguments),
        Some(Command::Check(arguments)) => check::run(&arguments),
        Some(Command::Bench(arguments)) => bench::run(&arguments),
        Some(Command::Stress(arguments)) => stress::run(&arguments),
        Some(Command::Merge(arguments)) => merge::run(&arguments),
        Some(Command::Info(arguments)) => info::run(&arguments),
    }
}

/// The message of a panic to a user: a broken invariant is a fault of grotto.
pub fn bug_report(info: &PanicHookInfo<'_>) -> String {
    let place = info
        .location()
        .map(|place| format!(" at {}:{}", place.file(), place.line()))
        .unwrap_or_default();
    let message = info.payload_as_str().unwrap_or("no message");
    format!(
        "error: this is a bug in grotto, not a fault of yours: {message}{place}\n\
         Please report it with the command line and the world file."
    )
}
