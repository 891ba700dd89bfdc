//! `grotto export`: what was built, as a MagicaVoxel model.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::{
    Failure, memory,
    options::{RunOptions, load_world, note_restored, world_file},
    output,
};
use crate::{
    measure::whole_file,
    world::{
        file::vox_write::{self, Chosen},
        generate,
        voxels::grid_cells,
    },
};

/// Write the voxels of a save or a world as a MagicaVoxel model, for others
///
/// Materials become the palette without their patterns; those that glow keep their light. Worlds larger than 256
/// voxels become several models in one scene. It needs no GPU.
#[derive(Args)]
pub struct Arguments {
    /// Save or world file
    #[arg(value_name = "SAVE", value_parser = world_file())]
    world: PathBuf,
    /// The model
    #[arg(short, long, value_name = "FILE.vox")]
    output: PathBuf,
    /// Leave out voxels that no air touches: the model looks the same and is smaller
    #[arg(long)]
    surface: bool,
    #[command(flatten)]
    run: RunOptions,
}

/// The `--json` of a model.
#[derive(Serialize)]
struct Record {
    world: String,
    file: String,
    models: usize,
    voxels: usize,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let run = &arguments.run;
    if arguments.output.extension().is_none_or(|ext| ext != "vox") {
        return Err(Failure::bad_input(format!(
            "{}: a model is a .vox file: name one",
            arguments.output.display()
        )));
    }
    let mut file = whole_file::open(&arguments.output)?;
    let world = load_world(&arguments.world, &run.parameters()?)?;
    note_restored(run, &world);
    let grid_bytes = grid_cells(world.size).as_u64vec3().element_product() * 4;
    memory::check("a world of this size", grid_bytes)?;
    let spinner = output::spinner(run, super::render::VOXELISING);
    let voxels = generate::generate(&world);
    let chosen = match arguments.surface {
        true => Chosen::Surface,
        false => Chosen::All,
    };
    let made = vox_write::model(&world, &voxels, chosen);
    spinner.finish_and_clear();
    let (data, count) = made
        .map_err(|error| Failure::bad_input(format!("{}: {error}", arguments.world.display())))?;
    let unwritten = |reason| Failure::unwritten(&arguments.output, reason);
    vox_write::write(&data, &mut file).map_err(unwritten)?;
    file.commit().map_err(unwritten)?;
    let record = Record {
        world: world.name,
        file: arguments.output.display().to_string(),
        models: data.models.len(),
        voxels: count,
    };
    if run.json {
        return output::print_json(&record);
    }
    let Record {
        file,
        models,
        voxels,
        ..
    } = record;
    output::note(run, &format!("{file}: {voxels} voxels in {models} models"));
    Ok(())
}
