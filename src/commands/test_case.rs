//! The rows of a table: worlds, and for each world the cameras and layouts.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{
    Failure,
    options::{
        RunOptions, choose, load_world, note_restored, picture_size, world_file, world_time,
    },
    settings::{Setting, Varied},
};
use crate::{
    lights::Lights,
    parameters::Parameters,
    passes::view::Shot,
    world::{Camera, LampPreset, LayoutSpec, View, World},
};

/// Options of tables.
#[derive(Args, Clone)]
pub struct TestCaseOptions {
    /// World files
    #[arg(value_name = "WORLD", value_parser = world_file())]
    pub worlds: Vec<PathBuf>,
    /// Only this camera (repeatable); worlds without it are left out
    #[arg(long = "camera", value_name = "NAME")]
    pub cameras: Vec<String>,
    /// Only this probe layout (repeatable); worlds without it are left out
    #[arg(long = "layout", value_name = "NAME")]
    pub layouts: Vec<String>,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "480x270", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: [u32; 2],
    /// Frames for the probes to settle before anything is measured
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(0..=1_000_000), allow_negative_numbers = true)]
    pub frames: u32,
    /// World time of all rows, in seconds; the time does not advance, except in `grotto judge --motion`
    #[arg(long, value_name = "S", default_value_t = 0.0, value_parser = world_time, allow_negative_numbers = true)]
    pub time: f64,
    /// Seed of the random rays
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        allow_negative_numbers = true
    )]
    pub seed: u32,
    /// Rays per probe and frame, one row each [default: the value of probes.rays]
    #[arg(long, value_name = "N,N…", value_delimiter = ',', value_parser = rays)]
    pub rays: Vec<u32>,
    /// Values of a probes.* parameter, one row each (repeatable: all combinations), as in
    /// probes.relocation=off,exact
    #[arg(long, value_name = "KEY=VALUE,VALUE…", value_parser = Varied::parse)]
    pub vary: Vec<Varied>,
}

impl TestCaseOptions {
    /// The keys that vary, in the order of their columns; `--rays` is the last of them.
    ///
    /// # Errors
    /// For a number of rays that is given twice.
    pub fn varied(&self) -> Result<Vec<Varied>, Failure> {
        let mut varied = self.vary.clone();
        if !self.rays.is_empty() {
            varied.push(Varied::rays(&self.rays).map_err(Failure::bad_input)?);
        }
        Ok(varied)
    }

    /// The settings for the rows of each camera and layout: never empty.
    ///
    /// # Errors
    /// See [`varied`](Self::varied) and [`Setting::product`].
    pub fn settings(&self, run: &RunOptions) -> Result<Vec<Setting>, Failure> {
        Setting::product(&self.varied()?, &run.set)
    }
}

/// Accepts what `probes.rays` accepts.
fn rays(text: &str) -> Result<u32, String> {
    let mut parameters = Parameters::default();
    let set = parameters.set(&format!("probes.rays={text}"));
    set.map(|()| parameters.probes.rays)
        .map_err(|error| error.to_string())
}

/// Which cameras or layouts rows are for when none are named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unnamed {
    /// The world's first, as in `grotto render`.
    First,
    All,
}

/// One world with everything that its rows need, and its constant lights.
pub struct TestCase {
    pub world: World,
    pub parameters: Parameters,
    pub cameras: Vec<Camera>,
    pub layouts: Vec<LayoutSpec>,
    /// Never empty.
    pub settings: Vec<Setting>,
    pub lights: Lights,
    /// Index of the lamp that the world names for changes of light; `None` where it names none, or one that is
    /// not lit.
    pub named_lamp: Option<usize>,
    lamps: LampPreset,
    options: ViewOptions,
}

struct ViewOptions {
    size: [u32; 2],
    seed: u32,
    time_s: f64,
}

impl TestCase {
    /// Reads a world and selects in it what the options name. `None` for a world without such a camera or
    /// layout, if it is one of several.
    ///
    /// # Errors
    /// For a world that cannot be read, and for names that the only world does not have.
    pub fn load(
        path: &Path,
        run: &RunOptions,
        options: &TestCaseOptions,
        unnamed: Unnamed,
    ) -> Result<Option<Self>, Failure> {
        let parameters = run.parameters()?;
        let settings = options.settings(run)?;
        let world = load_world(path, &parameters)?;
        note_restored(run, &world);
        let alone = options.worlds.len() <= 1;
        let chosen = Choice {
            path,
            unnamed,
            alone,
        };
        let cameras = chosen.of("camera", &world.cameras, |c| &c.name, &options.cameras)?;
        let layouts = chosen.of("layout", &world.layouts, |l| &l.name, &options.layouts)?;
        let preset = Some(&parameters.lights.preset).filter(|name| !name.is_empty());
        let presets = &world.lamp_presets;
        let mut lamps: LampPreset =
            choose(path, "lamp preset", presets, |p| &p.name, &preset.cloned())?;
        lamps.lamps.truncate(parameters.lights.max_lamps as usize);
        if cameras.is_empty() || layouts.is_empty() {
            return Ok(None);
        }
        let named = world.response.lamp.as_ref();
        let named_lamp = named.and_then(|name| lamps.lamps.iter().position(|l| l.name == *name));
        let lights = lights_at(&world, &lamps, &parameters, options.time);
        Ok(Some(Self {
            world,
            parameters,
            cameras,
            layouts,
            settings,
            lights,
            named_lamp,
            lamps,
            options: ViewOptions {
                size: options.size,
                seed: options.seed,
                time_s: options.time,
            },
        }))
    }

    /// The lights at another world time (seconds); `lights.animate=off` stops the lamps.
    pub fn lights_at(&self, time_s: f64) -> Lights {
        lights_at(&self.world, &self.lamps, &self.parameters, time_s)
    }

    /// World time of the rows, in seconds.
    pub fn time_s(&self) -> f64 {
        self.options.time_s
    }

    /// The view that a frame loop of this world starts with.
    pub fn shot(&self, camera: &Camera) -> Shot {
        Shot {
            camera: camera.clone(),
            size: self.options.size,
            frame: 0,
            seed: self.options.seed,
            exposure_ev: self.parameters.picture.exposure_ev,
            view: View::Full,
            time_s: self.options.time_s,
            textures: self.parameters.textures.enabled,
            soft_rays: self.parameters.lights.soft_rays,
            shadows: self.parameters.lights.shadows,
        }
    }
}

fn lights_at(world: &World, lamps: &LampPreset, parameters: &Parameters, time_s: f64) -> Lights {
    let moving = parameters.lights.animate;
    Lights::at(world, lamps, if moving { time_s } else { 0.0 })
}

struct Choice<'a> {
    path: &'a Path,
    unnamed: Unnamed,
    /// Whether a name that does not exist is a mistake.
    alone: bool,
}

impl Choice<'_> {
    fn of<T: Clone>(
        &self,
        what: &str,
        all: &[T],
        name: impl Fn(&T) -> &str,
        wanted: &[String],
    ) -> Result<Vec<T>, Failure> {
        if wanted.is_empty() {
            let count = match self.unnamed {
                Unnamed::First => 1,
                Unnamed::All => all.len(),
            };
            return Ok(all.iter().take(count).cloned().collect());
        }
        let mut found = Vec::new();
        for wanted in wanted {
            match all.iter().find(|one| name(one) == wanted) {
                Some(one) => found.push(one.clone()),
                None if self.alone => {
                    // The error lists the names that exist.
                    choose(self.path, what, all, &name, &Some(wanted.clone()))?;
                }
                None => {}
            }
        }
        Ok(found)
    }
}
