//! `grotto bench SUITE`: one file for each suite.

mod diff;
mod flight;
mod flight_look;
mod history;
mod light_suite;
#[cfg(test)]
mod made_up;
pub mod merge;
pub mod model;
mod page;
mod response;
pub mod results;
mod speed;
mod stability;
pub mod traversal;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde::Serialize;

use self::speed::SpeedSuite;
use super::{
    Failure,
    options::{RunOptions, load_world, note_restored, picture_size},
    out_file::OutFile,
    output,
};
use crate::{frame::Stage, gpu::AdapterSummary, parameters::nearest, world::World};

/// Measure this machine
#[derive(Args)]
pub struct Arguments {
    #[command(subcommand)]
    suite: Suite,
}

#[derive(Subcommand)]
enum Suite {
    /// Every probe layout: still, moving, in flight, with edits
    Layouts(speed::Arguments),
    /// By rays per probe
    Rays(speed::Arguments),
    /// By the sizes of the probes' maps
    Maps(speed::Arguments),
    /// By lamps: still, flickering, moving, still with a radius
    Lights(speed::Arguments),
    /// By what is edited at once: nothing, a ball, a box of 32³ voxels, a thousand single voxels
    Edits(speed::Arguments),
    /// With block textures and without
    Textures(speed::Arguments),
    /// By the picture's size
    Resolution(speed::Arguments),
    /// With probes that sleep and without
    States(speed::Arguments),
    /// By the levels of nested volumes
    Cascades(speed::Arguments),
    /// The occlusion field in place of shadow rays, by lamps and rays
    Occlusion(speed::Arguments),
    /// Voxelising, by the world's size and seed
    World(speed::Arguments),
    /// From the start of a process to its first frame, its first picture, settled light
    Start(speed::Arguments),
    /// Ways to place probes and to find their light, in one table: uniform, cascades, octrees, kept hits
    Probes(speed::Arguments),
    /// Probes and hits of the published octree over 600 frames
    Hits(speed::Arguments),
    /// The tables and charts of the documents that grotto started from, on our own worlds
    Tables(speed::Arguments),
    /// All of these and the rays of `traversal`, in one report
    All(speed::Arguments),
    #[command(hide = true)]
    OneStart(speed::start::Arguments),
    Traversal(Traversal),
    Stability(stability::Arguments),
    Response(response::Arguments),
    Flight(flight::Arguments),
    Diff(diff::Arguments),
    History(history::Arguments),
    Merge(merge::Arguments),
    #[command(external_subcommand)]
    Unknown(Vec<String>),
}

/// March camera, shadow and probe rays, compared with plain DDA in the same run
#[derive(Args)]
struct Traversal {
    /// World files [default: worlds/cavern.ron]
    #[arg(value_name = "WORLD")]
    worlds: Vec<PathBuf>,
    /// Also write traversal.json into this folder, created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Width and height in pixels of the camera rays
    #[arg(long, value_name = "WxH", default_value = "1920x1080", value_parser = picture_size, allow_hyphen_values = true)]
    size: [u32; 2],
    /// Runs that each median is taken over
    #[arg(long, value_name = "N", default_value_t = 15,
          value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeats: u32,
    #[command(flatten)]
    run: RunOptions,
}

/// What was measured, and on which adapter.
#[derive(Serialize)]
struct TraversalRecord<'a> {
    suite: &'static str,
    adapter: &'a AdapterSummary,
    size: [u32; 2],
    repeats: u32,
    rows: Vec<traversal::Row>,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    use SpeedSuite as Speed;
    match &arguments.suite {
        Suite::Layouts(arguments) => speed::run(Speed::Layouts, arguments),
        Suite::Rays(arguments) => speed::run(Speed::Rays, arguments),
        Suite::Maps(arguments) => speed::run(Speed::Maps, arguments),
        Suite::Lights(arguments) => speed::run(Speed::Lights, arguments),
        Suite::Edits(arguments) => speed::run(Speed::Edits, arguments),
        Suite::Textures(arguments) => speed::run(Speed::Textures, arguments),
        Suite::Resolution(arguments) => speed::run(Speed::Resolution, arguments),
        Suite::States(arguments) => speed::run(Speed::States, arguments),
        Suite::Cascades(arguments) => speed::run(Speed::Cascades, arguments),
        Suite::Occlusion(arguments) => speed::run(Speed::Occlusion, arguments),
        Suite::World(arguments) => speed::run(Speed::World, arguments),
        Suite::Start(arguments) => speed::run(Speed::Start, arguments),
        Suite::Probes(arguments) => speed::run(Speed::Probes, arguments),
        Suite::Hits(arguments) => speed::run(Speed::Hits, arguments),
        Suite::Tables(arguments) => speed::run(Speed::Tables, arguments),
        Suite::All(arguments) => speed::run(Speed::All, arguments),
        Suite::OneStart(arguments) => speed::start::run(arguments),
        Suite::Unknown(words) => Err(unknown(words)),
        Suite::Traversal(arguments) => run_traversal(arguments),
        Suite::Stability(arguments) => stability::run(arguments),
        Suite::Response(arguments) => response::run(arguments),
        Suite::Flight(arguments) => flight::run(arguments),
        Suite::Diff(arguments) => diff::run(arguments),
        Suite::History(arguments) => history::run(arguments),
        Suite::Merge(arguments) => merge::run(arguments),
    }
}

/// The error that lists the suites.
fn unknown(words: &[String]) -> Failure {
    let wanted = words.first().map_or("", String::as_str);
    let command = Suite::augment_subcommands(clap::Command::new("bench"));
    let visible = command
        .get_subcommands()
        .filter(|suite| !suite.is_hide_set());
    let suites: Vec<&str> = visible.map(clap::Command::get_name).collect();
    let near = nearest(wanted, suites.iter().copied());
    let hint = near
        .first()
        .map_or(String::new(), |near| format!(" Did you mean `{near}`?"));
    Failure::bad_input(format!(
        "there is no suite `{wanted}`; there are {}.{hint}",
        suites.join(", ")
    ))
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
    for world in &worlds {
        note_restored(run, world);
    }
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
            "{mismatches} rays hit something other than plain DDA does"
        ))),
    }
}
