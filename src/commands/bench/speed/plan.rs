//! The rows of a suite, before anything is opened or measured.

use std::path::{Path, PathBuf};

use super::{
    super::{super::Failure, model::Missing},
    Arguments, occlusion, probe_tables,
    rig::Length,
    spec::{BenchScene, RowSpec, Work},
    suites::{self, Wanted},
    tables,
};
use crate::{
    parameters::{Antialias, Parameters},
    world::World,
};

/// A suite that times frames, or several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpeedSuite {
    Layouts,
    Rays,
    Maps,
    Lights,
    Edits,
    Textures,
    Resolution,
    States,
    Cascades,
    Occlusion,
    World,
    Start,
    Probes,
    Hits,
    Tables,
    All,
}

/// Worlds of the suites, relative to the working directory.
const CAVE: &str = "worlds/cave.ron";
const CORNELL: &str = "worlds/cornell.ron";
const CAVERN: &str = "worlds/cavern.ron";
const BEAM: &str = "worlds/beam.ron";
const DOOR: &str = "worlds/door.ron";
const SPLIT: &str = "worlds/split.ron";
const BLEED: &str = "worlds/bleed.ron";
const HOUSE: &str = "worlds/house.ron";

/// Number of voxels from which a world counts as large: its frames take long, and fewer of them are measured.
const LARGE: u64 = 10_000_000;
/// Lamps of a large world whose cascades are compared: with all lamps of the cavern, their cost would hide that
/// of the cascades.
const LAMPS_OF_CASCADES: u32 = 4;

impl SpeedSuite {
    pub fn name(self) -> &'static str {
        match self {
            Self::Layouts => "layouts",
            Self::Rays => "rays",
            Self::Maps => "maps",
            Self::Lights => "lights",
            Self::Edits => "edits",
            Self::Textures => "textures",
            Self::Resolution => "resolution",
            Self::States => "states",
            Self::Cascades => "cascades",
            Self::Occlusion => "occlusion",
            Self::World => "world",
            Self::Start => "start",
            Self::Probes => "probes",
            Self::Hits => "hits",
            Self::Tables => "tables",
            Self::All => "all",
        }
    }

    /// The parts that the suite is made of.
    fn parts(self) -> &'static [Part] {
        use Part as P;
        match self {
            Self::Layouts => &[P::Layouts],
            Self::Rays => &[P::Rays],
            Self::Maps => &[P::Maps],
            Self::Lights => &[P::Lights, P::Spheres],
            Self::Edits => &[P::Edits],
            Self::Textures => &[P::Textures],
            Self::Resolution => &[P::Resolution],
            Self::States => &[P::States],
            Self::Cascades => &[P::Cascades],
            Self::Occlusion => &[P::Occlusion],
            Self::World => &[P::World],
            Self::Start => &[P::Start],
            Self::Probes => &[P::Probes],
            Self::Hits => &[P::Hits],
            Self::Tables => &[P::Tables],
            Self::All => &[
                P::Layouts,
                P::Rays,
                P::Maps,
                P::LightsOfAll,
                P::SpheresOfAll,
                P::Edits,
                P::Textures,
                P::Resolution,
                P::States,
                P::Cascades,
                P::Occlusion,
                P::World,
                P::Start,
                P::Traversal,
                P::Tables,
            ],
        }
    }
}

/// A list of rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Layouts,
    Rays,
    Maps,
    Lights,
    /// Without the cavern, whose dozens of lamps take minutes.
    LightsOfAll,
    /// The same lamps with a radius.
    Spheres,
    SpheresOfAll,
    Edits,
    Textures,
    Resolution,
    States,
    Cascades,
    Occlusion,
    World,
    Start,
    Probes,
    Hits,
    Traversal,
    Tables,
}

impl Part {
    fn worlds(self) -> &'static [&'static str] {
        match self {
            Self::Layouts | Self::Textures => &[CAVE, CORNELL],
            Self::Lights | Self::Spheres | Self::Edits | Self::Start => &[CAVE, CAVERN],
            Self::Cascades | Self::World | Self::Traversal => &[CAVERN],
            Self::Tables => &[CAVE, CORNELL, BEAM, DOOR, SPLIT, BLEED, HOUSE],
            Self::Probes | Self::Hits => &[CORNELL],
            _ => &[CAVE],
        }
    }

    fn rows(self, wanted: &Wanted<'_>) -> Result<Vec<RowSpec>, Failure> {
        match self {
            Self::Layouts => suites::layouts(wanted),
            Self::Rays => suites::rays(wanted),
            Self::Maps => suites::maps(wanted),
            Self::Lights | Self::LightsOfAll => suites::lights(wanted),
            Self::Spheres | Self::SpheresOfAll => suites::spheres(wanted),
            Self::Edits => suites::edits(wanted),
            Self::Textures => suites::textures(wanted),
            Self::Resolution => suites::resolution(wanted),
            Self::States => suites::states(wanted),
            Self::Cascades => suites::cascades(wanted),
            Self::Occlusion => occlusion::rows(wanted),
            Self::World => suites::world(wanted),
            Self::Start => suites::start(wanted),
            Self::Probes => probe_tables::probes(wanted),
            Self::Hits => probe_tables::hits(wanted),
            Self::Traversal => suites::traversal(wanted),
            Self::Tables => tables::tables(wanted),
        }
    }
}

/// Rows of one suite, whose runs are interleaved.
pub struct Group {
    pub rows: Vec<RowSpec>,
}

/// All rows, and the worlds that they use.
pub struct Plan {
    pub scenes: Vec<BenchScene>,
    /// In the order of measurement.
    pub groups: Vec<Group>,
    /// Rows that could not be planned, and why.
    pub missing: Vec<Missing>,
}

impl Plan {
    /// # Errors
    /// For worlds that cannot be read, and for cameras and layouts that no world has.
    pub fn new(suite: SpeedSuite, arguments: &Arguments) -> Result<Self, Failure> {
        let parameters = arguments.run.parameters()?;
        if arguments.displayed && parameters.picture.antialias == Antialias::Off {
            return Err(Failure::bad_input(
                "--displayed times anti-aliased pictures, and picture.antialias=off asks for none; leave one of them out",
            ));
        }
        let mut plan = Self {
            scenes: Vec::new(),
            groups: Vec::new(),
            missing: Vec::new(),
        };
        for part in suite.parts() {
            let paths: Vec<PathBuf> = match &arguments.worlds[..] {
                [] => part.worlds().iter().map(PathBuf::from).collect(),
                named => named.to_vec(),
            };
            let mut only = Vec::new();
            for path in &paths {
                match part {
                    Part::World => {
                        only.extend(plan.variants(path, &parameters, arguments.quick)?)
                    }
                    Part::Occlusion | Part::Spheres | Part::SpheresOfAll => {
                        only.push(plan.scene_of_spheres(path, &parameters)?)
                    }
                    _ => only.push(plan.scene(path, &parameters)?),
                }
            }
            let wanted = Wanted {
                scenes: &plan.scenes,
                only,
                cameras: &arguments.cameras,
                layouts: &arguments.layouts,
                size: arguments.size,
                quick: arguments.quick,
            };
            let mut rows = part.rows(&wanted)?;
            if *part == Part::Cascades {
                let large = |row: &&mut RowSpec| is_large(&plan.scenes[row.scene].world);
                for row in rows.iter_mut().filter(large) {
                    row.parameters.lights.max_lamps =
                        row.parameters.lights.max_lamps.min(LAMPS_OF_CASCADES);
                    row.lamps.lamps.truncate(LAMPS_OF_CASCADES as usize);
                }
            }
            plan.groups.push(Group { rows });
            if *part == Part::Tables {
                plan.missing.extend(tables::missing());
            }
        }
        if plan.groups.iter().all(|group| group.rows.is_empty()) {
            return Err(Failure::bad_input(format!(
                "there is no row to measure: suite `{}` has no world with the named --camera and --layout",
                suite.name()
            )));
        }
        let rows = plan.groups.iter_mut().flat_map(|group| &mut group.rows);
        for (place, row) in rows.enumerate() {
            row.place = place as u32;
            if arguments.displayed && matches!(row.work, Work::Frames(_)) {
                row.display();
            }
        }
        if let Some(shard) = arguments.shard {
            for group in &mut plan.groups {
                group.rows.retain(|row| shard.has(row.place as usize));
            }
        }
        Ok(plan)
    }

    /// The index of a world. Each world is read once.
    fn scene(&mut self, path: &Path, parameters: &Parameters) -> Result<usize, Failure> {
        let same = |scene: &BenchScene| scene.path == path && scene.parameters == *parameters;
        if let Some(known) = self.scenes.iter().position(same) {
            return Ok(known);
        }
        self.scenes.push(BenchScene::load(path, parameters)?);
        Ok(self.scenes.len() - 1)
    }

    /// The index of a world whose lamps are spheres: shadow rays to them are what the occlusion field replaces.
    fn scene_of_spheres(&mut self, path: &Path, parameters: &Parameters) -> Result<usize, Failure> {
        let own = self.scene(path, parameters)?;
        let scene = occlusion::with_spheres(&self.scenes[own]);
        let same = |known: &BenchScene| known.hash == scene.hash && known.path == scene.path;
        if let Some(known) = self.scenes.iter().position(same) {
            return Ok(known);
        }
        self.scenes.push(scene);
        Ok(self.scenes.len() - 1)
    }

    /// A world at several sizes, and with several seeds.
    fn variants(
        &mut self,
        path: &Path,
        parameters: &Parameters,
        quick: bool,
    ) -> Result<Vec<usize>, Failure> {
        let own = self.scene(path, parameters)?;
        let size = self.scenes[own].world.size;
        let mut found = vec![own];
        // In quarters of the world's own size; the last ones grow sideways, as caves do.
        let factors = [[1, 1, 1], [2, 2, 2], [8, 4, 8], [8, 8, 8], [16, 8, 16]];
        for factor in factors.iter().take(if quick { 3 } else { factors.len() }) {
            let scaled = (size * glam::UVec3::from_array(*factor) / 4)
                .clamp(glam::UVec3::ONE, glam::UVec3::splat(4096));
            let mut parameters = parameters.clone();
            parameters.world.size = Some(scaled);
            found.push(self.scene(path, &parameters)?);
        }
        let seed = self.scenes[own].world.seed;
        for more in 1..=if quick { 1 } else { 4 } {
            let mut parameters = parameters.clone();
            parameters.world.seed = Some(seed.wrapping_add(more));
            found.push(self.scene(path, &parameters)?);
        }
        Ok(found)
    }

    /// The length of the runs of a row.
    pub fn length(&self, spec: &RowSpec, arguments: &Arguments) -> Length {
        let large = self.is_large(spec);
        let (settling, measured) = match (spec.suite, arguments.quick, large) {
            (_, false, true) => (80, 40),
            (_, true, true) => (30, 20),
            ("layouts", false, false) => (400, 240),
            ("tables" | "probes", false, false) => (80, 60),
            (_, false, false) => (160, 120),
            (_, true, false) => (60, 60),
        };
        Length {
            settling: arguments.frames.unwrap_or(settling),
            measured: arguments.measured.unwrap_or(measured),
        }
    }

    /// Whether the frames of a spec's world take long.
    pub fn is_large(&self, spec: &RowSpec) -> bool {
        is_large(&self.scenes[spec.scene].world)
    }

    /// Fewest and most runs of a row.
    pub fn runs(arguments: &Arguments) -> (usize, usize) {
        match (arguments.runs, arguments.quick) {
            (Some(runs), _) => (runs as usize, runs as usize),
            (None, true) => (3, 3),
            (None, false) => (5, 20),
        }
    }

    /// Fewest runs of all rows together, for the progress bar.
    pub fn least_runs(&self, arguments: &Arguments) -> u64 {
        let (least, _) = Self::runs(arguments);
        let rows = self.groups.iter().flat_map(|group| &group.rows);
        let runs = rows.map(|row| match row.work {
            Work::Frames(_) => least as u64,
            _ => 1,
        });
        runs.sum()
    }
}

fn is_large(world: &World) -> bool {
    let size = world.size;
    u64::from(size.x) * u64::from(size.y) * u64::from(size.z) >= LARGE
}
