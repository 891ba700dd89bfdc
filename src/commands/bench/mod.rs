//! `grotto bench SUITE`: one file a suite.

mod diff;
mod flight;
mod flight_look;
mod history;
#[cfg(test)]
mod made_up;
pub mod merge;
pub mod model;
mod page;
mod response;
pub mod results;
mod stability;
mod suite;
pub mod traversal;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde::Serialize;

use super::{
    Failure,
    options::{RunOptions, load_world, picture_size},
    out_file::OutFile,
    output,
};
use crate::{frame::Stage, gpu::AdapterSummary, world::World};

/// Measure this machine
#[derive(Args)]
pub struct Arguments {
    #[command(subcommand)]
    suite: Suite,
}

#[derive(Subcommand)]
enum Suite {
    Traversal(Traversal),
    Stability(stability::Arguments),
    Response(response::Arguments),
    Flight(flight::Arguments),
    Diff(diff::Arguments),
    History(history::Arguments),
    Merge(merge::Arguments),
}

/// March camera, shadow and probe rays, against plain DDA in the same run
#[derive(Args)]
struct Traversal {
    /// World files [default: worlds/cavern.ron]
    #[arg(value_name = "WORLD")]
    worlds: Vec<PathBuf>,
    /// Also write traversal.json into this folder, made if need be
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Width and height in pixels of the camera rays
    #[arg(long, value_name = "WxH", default_value = "1920x1080", value_parser = picture_size, allow_hyphen_values = true)]
    size: [u32; 2],
    /// Runs that each median is taken of
    #[arg(long, value_name = "N", default_value_t = 15,
          value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeats: u32,
    #[command(flatten)]
    run: RunOptions,
}

/// What was measured, on what.
#[derive(Serialize)]
struct TraversalRecord<'a> {
    suite: &'static str,
    adapter: &'a AdapterSummary,
    size: [u32; 2],
    repeats: u32,
    rows: Vec<traversal::Row>,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.suite {
        Suite::Traversal(arguments) => run_traversal(arguments),
        Suite::Stability(arguments) => stability::run(arguments),
        Suite::Response(arguments) => response::run(arguments),
        Suite::Flight(arguments) => flight::run(arguments),
        Suite::Diff(arguments) => diff::run(arguments),
        Suite::History(arguments) => history::run(arguments),
        Suite::Merge(arguments) => merge::run(arguments),
    }
}

fn run_traversal(arguments: &Traversal) -> Result<(), Failure> {
    let run = &arguments.run;
    let parameters = run.parameters()?;
    let showpiece = [PathBuf::from("worlds/cavern.ron")];
    let paths = match &arguments.worlds[..] {
        [] => &showpiece[..],
        given => given,
    };
    let worlds: Vec<World> = paths
        .iter()
        .map(|path| load_world(path, &parameters))
        .collect::<Result<_, _>>()?;
    let file = arguments
        .out
        .as_deref()
        .map(|folder| OutFile::new(folder, "traversal.json"));
    let file = file.transpose()?;
    let gpu = output::open_gpu(run)?;

    let spinner = output::spinner(run, "marching");
    let mut rows = Vec::new();
    for world in &worlds {
        let stage = Stage::build(&gpu, world)?;
        let voxels = stage.read_back(&gpu)?;
        rows.extend(traversal::measure(
            &gpu,
            world,
            &voxels,
            &stage.voxels,
            arguments.size,
            arguments.repeats,
        )?);
    }
    spinner.finish_and_clear();

    let record = TraversalRecord {
        suite: "traversal",
        adapter: &gpu.summary,
        size: arguments.size,
        repeats: arguments.repeats,
        rows,
    };
    if let Some(file) = file {
        file.write_json(&record)?;
    }
    if run.json {
        output::print_json(&record)?;
    } else {
        let AdapterSummary {
            name,
            kind,
            driver,
            backend,
        } = record.adapter;
        output::print(&format!(
            "{name} ({kind}, {backend}, {driver}), {} × {}, median of {}\n{}",
            record.size[0],
            record.size[1],
            record.repeats,
            traversal::table(&record.rows)
        ))?;
    }
    match record.rows.iter().map(|row| row.mismatches).sum() {
        0 => Ok(()),
        mismatches => Err(Failure::gate(format!(
            "{mismatches} rays hit something else than plain DDA does"
        ))),
    }
}
