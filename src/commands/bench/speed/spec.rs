//! The description of a row, before it is measured.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use super::super::{
    super::{
        Failure,
        dynamics::Edited,
        judge::cache::fnv1a,
        options::{choose, load_world},
    },
    model::{Varied, WorldRecord},
};
use crate::{
    frame::Smoothing,
    parameters::{KEYS, Parameters},
    world::{Camera, Lamp, LampPreset, LayoutSpec, World},
};

/// A world as a suite reads it, with the parameters that all of its rows start from.
#[derive(Clone)]
pub struct BenchScene {
    pub path: PathBuf,
    pub world: World,
    pub parameters: Parameters,
    /// 32 hexadecimal digits, the same on every machine.
    pub hash: String,
}

impl BenchScene {
    /// # Errors
    /// For a world that cannot be read.
    pub fn load(path: &Path, parameters: &Parameters) -> Result<Self, Failure> {
        let world = load_world(path, parameters)?;
        Ok(Self::of(path, world, parameters))
    }

    /// A world that was read from `path`, and perhaps changed since.
    pub fn of(path: &Path, world: World, parameters: &Parameters) -> Self {
        Self {
            hash: format!("{:032x}", fnv1a(format!("{world:?}").as_bytes())),
            path: path.to_owned(),
            world,
            parameters: parameters.clone(),
        }
    }

    pub fn record(&self) -> WorldRecord {
        WorldRecord {
            name: self.world.name.clone(),
            title: self.world.title.clone(),
            hash: self.hash.clone(),
            seed: self.world.seed,
            size: self.world.size.to_array(),
            picture: None,
        }
    }

    /// The preset that the parameters name, or the first, without the lamps that the parameters leave out.
    ///
    /// # Errors
    /// For a name that the world does not have.
    pub fn lamps(&self) -> Result<LampPreset, Failure> {
        let preset = Some(&self.parameters.lights.preset).filter(|name| !name.is_empty());
        let presets = &self.world.lamp_presets;
        let mut lamps = choose(
            &self.path,
            "lamp preset",
            presets,
            |preset| &preset.name,
            &preset.cloned(),
        )?;
        lamps
            .lamps
            .truncate(self.parameters.lights.max_lamps as usize);
        Ok(lamps)
    }

    /// The lamps of the largest preset.
    pub fn most_lamps(&self) -> Vec<Lamp> {
        let presets = self.world.lamp_presets.iter().map(|preset| &preset.lamps);
        presets
            .max_by_key(|lamps| lamps.len())
            .cloned()
            .unwrap_or_default()
    }
}

/// What happens while frames are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// World time is paused.
    Still,
    /// World time advances by 1/60 s per frame.
    Moving,
    /// Like `Moving`, and the camera flies its path.
    Flight,
    /// Like `Moving`, and every tenth frame voxels are edited.
    Edits(Edited),
}

impl Condition {
    pub const ALL: [Self; 4] = [
        Self::Still,
        Self::Moving,
        Self::Flight,
        Self::Edits(Edited::Ball),
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Still => "still",
            Self::Moving => "moving",
            Self::Flight => "flight",
            Self::Edits(_) => "edits",
        }
    }
}

/// How a row is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// Timed frames.
    Frames(Condition),
    /// A settled picture against the reference; no frames are timed.
    Error,
    /// Direct light alone against the reference.
    DirectError,
    /// The change of a pixel between frames of a scene at rest.
    Stability,
    /// Bytes of a probe.
    Bytes,
    /// Voxelising the world.
    Build,
    /// From the start of a process to its pictures.
    Start,
    /// Rays alone, compared with plain DDA: one row for each kind.
    Traversal,
    /// A row of the table of probes: frames in motion, and errors at rest.
    Probes,
    /// Probes and hits of the published octree, over time.
    HitsOverTime,
}

/// One row to be measured.
#[derive(Clone)]
pub struct RowSpec {
    pub id: String,
    /// Its position in the plan of the whole run, counted from 0, whichever part of the plan is measured.
    pub place: u32,
    pub suite: &'static str,
    /// Index of its world.
    pub scene: usize,
    /// Its world's name.
    pub world: String,
    pub camera: Camera,
    pub layout: LayoutSpec,
    pub parameters: Parameters,
    pub lamps: LampPreset,
    pub work: Work,
    /// The name of the condition in the report.
    pub condition: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Whether its pictures are anti-aliased, as players see them.
    pub displayed: bool,
    pub varied: BTreeMap<String, Varied>,
}

impl RowSpec {
    /// A row of the scene with the parameters of its file, seen from one of its cameras in one of its layouts.
    ///
    /// # Errors
    /// For a lamp preset that the world does not have.
    pub fn new(
        suite: &'static str,
        (index, scene): (usize, &BenchScene),
        camera: &Camera,
        layout: &LayoutSpec,
        size: [u32; 2],
        work: Work,
    ) -> Result<Self, Failure> {
        let condition = match work {
            Work::Frames(condition) => condition.name(),
            Work::Probes | Work::HitsOverTime => Condition::Moving.name(),
            _ => Condition::Still.name(),
        };
        Ok(Self {
            id: format!("{suite}/{}/{}/{condition}", scene.world.name, layout.name),
            place: 0,
            suite,
            scene: index,
            world: scene.world.name.clone(),
            camera: camera.clone(),
            layout: layout.clone(),
            parameters: scene.parameters.clone(),
            lamps: scene.lamps()?,
            work,
            condition: condition.to_owned(),
            size,
            displayed: false,
            varied: BTreeMap::new(),
        })
    }

    /// How its pictures are smoothed: not at all, unless they are displayed or have fewer pixels than are shown.
    pub fn smoothing(&self) -> Smoothing {
        match Smoothing::from(&self.parameters.picture) {
            as_played if self.displayed || as_played.scale < 1.0 => as_played,
            _ => Smoothing::default(),
        }
    }

    /// Anti-aliases its pictures, and says so in its name.
    pub fn display(&mut self) {
        self.displayed = true;
        self.id.push_str("/displayed");
    }

    /// Gives the row another name: the part after the suite and the world.
    #[must_use]
    pub fn called(mut self, world: &str, name: &str) -> Self {
        self.id = format!("{}/{world}/{name}", self.suite);
        self
    }

    /// Sets a parameter that the suite varies.
    ///
    /// # Errors
    /// For a value that the key does not accept.
    pub fn with(mut self, key: &str, value: &str) -> Result<Self, Failure> {
        self.parameters.set(&format!("{key}={value}"))?;
        Ok(self.varying(key, value))
    }

    /// Records a value that the suite varies and that is not a parameter.
    #[must_use]
    pub fn varying(mut self, name: &str, value: &str) -> Self {
        let varied = match value.parse::<f64>() {
            Ok(number) => Varied::Number(number),
            Err(_) => Varied::Text(value.to_owned()),
        };
        self.varied.insert(name.to_owned(), varied);
        self
    }
}

/// Parameters that differ from their defaults, as `--set` takes them.
pub fn changed(parameters: &Parameters) -> Vec<String> {
    let differing = KEYS
        .iter()
        .filter(|key| key.get(parameters) != key.default());
    differing
        .map(|key| format!("{}={}", key.name, key.get(parameters)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_changed_can_be_set_again() {
        let mut parameters = Parameters::default();
        assert!(changed(&parameters).is_empty());
        for set in [
            "probes.rays=400",
            "world.size=64x32x64",
            "textures.enabled=off",
            "lights.preset=four",
        ] {
            parameters.set(set).expect("a key and a value");
        }
        let mut again = Parameters::default();
        for set in changed(&parameters) {
            again.set(&set).expect("what was printed is read");
        }
        assert_eq!(again, parameters);
    }
}
