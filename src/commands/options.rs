//! Options that commands share, and the scene that they select, checked.

use std::path::{Path, PathBuf};

use clap::{
    Args,
    builder::{PathBufValueParser, TypedValueParser},
};

use super::{Failure, output};
use crate::{
    app::{self, quality::Preset, saving},
    parameters::{Parameters, nearest},
    passes::view::{AtlasLayer, Inspection, ProbeColour},
    world::{
        self, Camera, LampPreset, LayoutSpec, View, World,
        file::Overrides,
        save::{self, Save},
    },
};

/// Output options of every command.
#[derive(Args, Clone, Copy)]
pub struct OutputOptions {
    /// Print one JSON object on stdout
    #[arg(long)]
    pub json: bool,
    /// No progress, no notes
    #[arg(long)]
    pub quiet: bool,
}

/// Options of every command that runs on an adapter.
#[derive(Args)]
pub struct RunOptions {
    /// Use the adapter whose name contains this [default: the fastest]; NAME#2 is the second of several with
    /// the same name
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Set a parameter (repeatable); `grotto info --keys` lists them
    #[arg(long, value_name = "KEY=VALUE", value_parser = assignment)]
    pub set: Vec<String>,
    /// Print one JSON object on stdout
    #[arg(long)]
    pub json: bool,
    /// No progress, no notes
    #[arg(long)]
    pub quiet: bool,
}

/// Options of a picture.
#[derive(Args)]
pub struct PictureOptions {
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: [u32; 2],
    /// One of the world's cameras [default: its first]
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// One of the world's probe layouts [default: its first]
    #[arg(long, value_name = "NAME")]
    pub layout: Option<String>,
    /// Frames for the probes to settle before the picture [default: 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1_000_000), allow_negative_numbers = true)]
    pub frames: Option<u32>,
    /// World time of the picture, in seconds [default: 0, or that of the save]
    #[arg(long, value_name = "S", value_parser = world_time, allow_negative_numbers = true)]
    pub time: Option<f64>,
    /// Seed of the random rays; the world's own is `--set world.seed=N`
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        allow_negative_numbers = true
    )]
    pub seed: u32,
    /// What the picture shows
    #[arg(long, value_name = "VIEW", value_enum, default_value_t)]
    pub view: View,
}

/// Options that show the probes themselves.
#[derive(Args, Clone, Copy)]
pub struct InspectionOptions {
    /// Draw the probes as spheres over any view, coloured by this; dead ones are red rings
    #[arg(long, value_name = "COLOUR", value_enum)]
    pub probes: Option<ProbeColour>,
    /// Show a layer of the probes' maps in place of the picture: irradiance:LAYER or distance:LAYER,
    /// numbered from 0
    #[arg(long, value_name = "MAP:LAYER", value_parser = AtlasLayer::parse,
          conflicts_with_all = ["probes", "view"])]
    pub atlas: Option<AtlasLayer>,
}

impl InspectionOptions {
    /// These options for pictures of this view.
    pub fn with(self, view: View) -> Inspection {
        let Self { probes, atlas } = self;
        Inspection {
            view,
            probes,
            atlas,
        }
    }
}

/// Settling frames where the user names no number.
pub const DEFAULT_FRAMES: u32 = 64;
/// Longest edge of a picture.
const MAX_EDGE: u32 = 16384;

/// Reads `WIDTHxHEIGHT`.
pub fn picture_size(text: &str) -> Result<[u32; 2], String> {
    let edges = text
        .split_once(['x', 'X', '×'])
        .and_then(|(width, height)| {
            Some([width.trim().parse().ok()?, height.trim().parse().ok()?])
        });
    edges
        .filter(|edges| edges.iter().all(|edge| (1..=MAX_EDGE).contains(edge)))
        .ok_or_else(|| format!("write WIDTHxHEIGHT, as in 1280x720, each from 1 to {MAX_EDGE}"))
}

pub fn world_time(text: &str) -> Result<f64, String> {
    let time = text.parse().ok().filter(|time: &f64| time.abs() <= 1e9);
    time.ok_or_else(|| "write seconds as a number, at most 1e9".to_owned())
}

/// A world file; where there is none, the world of that name that comes with grotto.
pub fn world_file() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().map(|path| {
        if path.exists() {
            return path;
        }
        app::bundled_world(&path).unwrap_or(path)
    })
}

/// Accepts what [`Parameters::set`] accepts, so that mistakes are reported like those of any other flag.
pub fn assignment(text: &str) -> Result<String, String> {
    let tried = Parameters::default().set(text);
    tried
        .map(|()| text.to_owned())
        .map_err(|error| error.to_string())
}

impl RunOptions {
    /// The parameters after all `--set` options.
    pub fn parameters(&self) -> Result<Parameters, Failure> {
        let mut parameters = Parameters::default();
        for assignment in &self.set {
            parameters.set(assignment)?;
        }
        parameters.check()?;
        Ok(parameters)
    }
}

/// Whether the probes keep what a view shows.
///
/// # Errors
/// For the view of occlusion, where they keep nothing of it.
pub fn check_view(view: View, parameters: &Parameters) -> Result<(), Failure> {
    if view == View::Occlusion {
        parameters.check_occlusion_shown().map_err(|error| {
            Failure::bad_input(format!("--view occlusion: {error}, as in --set KEY=VALUE"))
        })?;
    }
    Ok(())
}

/// A world and everything selected in it for a picture.
pub struct Setup {
    pub world: World,
    pub parameters: Parameters,
    pub camera: Camera,
    pub layout: LayoutSpec,
    /// The lamps of the preset, up to the number that the parameters allow.
    pub lamps: LampPreset,
    /// World time of the picture.
    pub time_s: f64,
    /// World time of the lamps' positions.
    pub lamp_time_s: f64,
    /// What the world was read from, if that was a save.
    pub save: Option<Save>,
}

impl Setup {
    /// Reads a world or a save and selects in it what the options name; of a save, otherwise what it kept.
    pub fn load(path: &Path, run: &RunOptions, picture: &PictureOptions) -> Result<Self, Failure> {
        let mut parameters = run.parameters()?;
        let world = load_world(path, &parameters)?;
        note_restored(run, &world);
        let save = match save::is_save(path) {
            true => Some(save::open(path)?.save),
            false => None,
        };
        if let Some(save) = &save {
            parameters = saving::parameters_of(save, Preset::High);
            for assignment in &run.set {
                parameters.set(assignment)?;
            }
            let preset = &mut parameters.lights.preset;
            if !run.set.iter().any(|set| set.starts_with(PRESET))
                && world.lamp_presets.iter().all(|known| known.name != *preset)
            {
                preset.clear();
            }
        }
        let time_s = picture.time.or(save.as_ref().map(|save| save.state.time_s));
        let time_s = time_s.unwrap_or(0.0);
        let camera = choose(
            path,
            "camera",
            &world.cameras,
            |camera| &camera.name,
            &picture.camera,
        )?;
        let layout = choose(
            path,
            "layout",
            &world.layouts,
            |layout| &layout.name,
            &picture.layout,
        )?;
        let preset = Some(&parameters.lights.preset).filter(|name| !name.is_empty());
        let mut lamps = choose(
            path,
            "lamp preset",
            &world.lamp_presets,
            |preset| &preset.name,
            &preset.cloned(),
        )?;
        lamps.lamps.truncate(parameters.lights.max_lamps as usize);
        Ok(Self {
            time_s,
            lamp_time_s: if parameters.lights.animate {
                time_s
            } else {
                0.0
            },
            save,
            world,
            parameters,
            camera,
            layout,
            lamps,
        })
    }
}

/// The start of an assignment that names a lamp preset.
const PRESET: &str = "lights.preset=";

/// Prints what a person should know about a world that was read from a save.
pub fn note_restored(run: &RunOptions, world: &World) {
    for note in &world.restored.notes {
        output::note(run, &format!("note: {note}"));
    }
}

/// Reads a world or a save, with the parameters replacing values of its file.
pub fn load_world(path: &Path, parameters: &Parameters) -> Result<World, Failure> {
    Ok(world::file::load(path, &Overrides::from(parameters))?)
}

/// The item of that name, or the first when none is named.
pub fn choose<T: Clone>(
    path: &Path,
    what: &str,
    all: &[T],
    name: impl Fn(&T) -> &str,
    wanted: &Option<String>,
) -> Result<T, Failure> {
    let found = match wanted {
        None => all.first(),
        Some(wanted) => all.iter().find(|candidate| name(candidate) == wanted),
    };
    found.cloned().ok_or_else(|| {
        let wanted = wanted.as_deref().unwrap_or_default();
        let near = nearest(wanted, all.iter().map(&name));
        let hint = match near.first() {
            Some(near) => format!(" Did you mean `{near}`?"),
            None => String::new(),
        };
        let names: Vec<String> = all.iter().map(|one| format!("`{}`", name(one))).collect();
        Failure::bad_input(format!(
            "{} has no {what} called `{wanted}`; it has {}.{hint}",
            path.display(),
            names.join(", ")
        ))
    })
}
