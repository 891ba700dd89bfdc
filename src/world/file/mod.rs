//! World files: RON text in, a checked [`World`] out, or one message with a place and a remedy.
//!
//! `schema` declares what may be written, `values` reads single numbers and names, `resolve` and its
//! neighbours build the world from them. `worlds/README.md` documents every key.

mod bodies;
mod diagnostics;
mod explain;
mod features;
mod fingerprint;
mod lamps;
mod leaf;
mod matter;
mod place;
mod printable;
mod resolve;
mod response;
mod scenery;
pub mod schema;
mod shape;
mod source_file;
mod summary;
mod travel;
mod values;
mod variant;
mod vox;
mod vox_alone;
pub mod vox_write;

use std::path::{Path, PathBuf};

use glam::{UVec3, Vec3};
use miette::Report;
use ron::extensions::Extensions;

pub use self::diagnostics::Problem;
use self::diagnostics::{MAX_NESTING, Source};
pub use self::fingerprint::fingerprint;
pub(super) use self::leaf::{Leaf, Located};
pub(super) use self::resolve::Reader;
pub(super) use self::schema::Vector;
pub(super) use self::source_file::read_bytes;
pub use self::summary::Summary;
pub(super) use self::values::{GREATEST_SCALE, Read, or};
pub(super) use self::variant::VariantKeys;
use self::vox::MAX_BYTES as MAX_MODEL_BYTES;
use super::{World, save};
use crate::parameters::Parameters;

/// Values that override those of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    /// Voxels; the origin stays.
    pub size: Option<UVec3>,
    /// Seed of the world; seeds that the file names itself stay.
    pub seed: Option<u32>,
    /// Albedo of every material, in both colours of its pattern.
    pub albedo: Option<Vec3>,
    /// Emitted radiance of every material.
    pub emission: Option<Vec3>,
    /// The file's bodies are left out.
    pub without_bodies: bool,
}

impl From<&Parameters> for Overrides {
    fn from(parameters: &Parameters) -> Self {
        Self {
            size: parameters.world.size,
            seed: parameters.world.seed,
            albedo: parameters.materials.albedo,
            emission: parameters.materials.emission,
            without_bodies: !parameters.world.bodies,
        }
    }
}

/// Reads a world file, or a save with its world file.
///
/// # Errors
/// A [`Problem`]: what is wrong with the file, where, and what to do about it.
pub fn load(path: &Path, overrides: &Overrides) -> Result<World, Report> {
    if save::is_save(path) {
        return save::load(path, overrides);
    }
    Ok(load_plain(path, overrides).map_err(|problem| *problem)?)
}

/// Reads a world from text. `name` is the name of the world, also in messages, and `folder` contains
/// its models (without a folder it can have none).
///
/// # Errors
/// Those of [`load`].
pub fn parse(
    text: &str,
    name: &str,
    folder: Option<&Path>,
    overrides: &Overrides,
) -> Result<World, Report> {
    let source = Source {
        name: name.to_owned(),
        text: text.into(),
    };
    Ok(read(&source, folder, overrides).map_err(|problem| *problem)?)
}

/// The text of a world file, valid or not.
///
/// # Errors
/// Those of [`load`], for files that are not text.
pub fn text(path: &Path) -> Result<String, Report> {
    let source = source_file::read(path).map_err(|problem| *problem)?;
    Ok(source.text.to_string())
}

/// The title of a world file, if its text can be parsed; the world need not be buildable.
pub fn title(text: &str) -> Option<String> {
    let source = Source {
        name: String::new(),
        text: text.into(),
    };
    source.text(&parsed(&source).ok()?.title, "title").ok()
}

/// The files that a world file includes, whether or not they exist; `None` if the file cannot be parsed
/// far enough to find their names.
pub fn included(path: &Path) -> Option<Vec<PathBuf>> {
    let source = source_file::read(path).ok()?;
    let file = parsed(&source).ok()?;
    let bodies = file.bodies.iter().filter_map(|body| match &body.model {
        schema::BodyModel::Vox { file } => Some(file),
        schema::BodyModel::Shape { .. } | schema::BodyModel::Like { .. } => None,
    });
    let files = file.models.iter().map(|model| &model.file).chain(bodies);
    let names = files.filter_map(|file| {
        let name = source.text(file, "file").ok()?;
        vox::is_inside(Path::new(&name)).then_some(name)
    });
    Some(names.map(|name| folder_of(path).join(name)).collect())
}

/// Reads a world file and summarises its content.
///
/// # Errors
/// Those of [`load`].
pub fn check(path: &Path) -> Result<Summary, Report> {
    let world = load(path, &Overrides::default())?;
    Ok(Summary::of(&world))
}

fn load_plain(path: &Path, overrides: &Overrides) -> Read<World> {
    let source = source_file::read(path)?;
    read(&source, Some(folder_of(path)), overrides)
}

fn folder_of(path: &Path) -> &Path {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

fn read(source: &Source, folder: Option<&Path>, overrides: &Overrides) -> Read<World> {
    resolve::resolve(source, folder, &parsed(source)?, overrides)
}

fn parsed(source: &Source) -> Read<schema::World> {
    source.check_nesting()?;
    let options = ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        // Brackets have already been counted; the parser counts several levels per bracket.
        .with_recursion_limit(8 * MAX_NESTING);
    options
        .from_str(&source.text)
        .map_err(|error| source.of_parser(error))
}
