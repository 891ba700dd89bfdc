//! `grotto check`: reads world files and says what is in them, or what is wrong.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{Failure, output};
use crate::world::{self, World, file::Overrides};

/// Validate world files
#[derive(Args)]
pub struct Arguments {
    /// World files (worlds/*.ron)
    #[arg(required = true, value_name = "WORLD")]
    worlds: Vec<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut failures = Vec::new();
    for path in &arguments.worlds {
        match world::file::load(path, &Overrides::default()) {
            Ok(world) => output::print(&summary(path, &world))?,
            Err(error) => failures.push(Failure::from(error)),
        }
    }
    let (bad, all) = (failures.len(), arguments.worlds.len());
    match failures.pop() {
        None => Ok(()),
        Some(failure) if all == 1 => Err(failure),
        Some(last) => {
            for failure in failures.iter().chain([&last]) {
                eprintln!("{failure}");
            }
            Err(Failure::bad_input(format!(
                "{bad} of {all} files cannot be used as they are"
            )))
        }
    }
}

fn summary(path: &Path, world: &World) -> String {
    fn names<'a>(all: impl Iterator<Item = &'a String>) -> String {
        all.map(String::as_str).collect::<Vec<_>>().join(", ")
    }
    let presets = world.lamp_presets.iter();
    let presets = presets.map(|preset| format!("{} ({})", preset.name, preset.lamps.len()));
    format!(
        "{}: ok. {}\n\
         \x20 size       {} × {} × {} voxels of {} m, seed {}\n\
         \x20 materials  {}\n\
         \x20 features   {} parts\n\
         \x20 lamps      {}{}\n\
         \x20 cameras    {}\n\
         \x20 layouts    {}\n",
        path.display(),
        world.title,
        world.size.x,
        world.size.y,
        world.size.z,
        world.voxel_m,
        world.seed,
        names(world.materials.iter().map(|material| &material.name)),
        world.features.len(),
        presets.collect::<Vec<_>>().join(", "),
        if world.sun.is_some() {
            ", and a sun"
        } else {
            ""
        },
        names(world.cameras.iter().map(|camera| &camera.name)),
        names(world.layouts.iter().map(|layout| &layout.name)),
    )
}
