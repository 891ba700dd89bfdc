//! Judges world by world, camera by camera, row by row.

use std::{
    collections::BTreeMap,
    ops::Range,
    path::{Path, PathBuf},
    sync::{Arc, atomic::AtomicBool},
};

use super::{
    super::{
        EXIT_INTERRUPTED, Failure,
        frame_loop::FrameLoop,
        output,
        settings::Setting,
        shard::Shard,
        test_case::{TestCase, Unnamed},
    },
    Arguments,
    cache::Cache,
    motion::{self, Judging, Targets},
    page::Page,
    report::{Files, Missing, Report},
    row::{self, Dark, Names, Pictures, Plan, Row, Target},
    summary, table,
    truth::{Film, Tracer},
};
use crate::{
    frame::Stage,
    gpu::Gpu,
    measure::{picture::Picture, selection::Selection},
    world::{Camera, View},
};

/// The judge's options and its results so far.
pub struct Judge<'a> {
    pub arguments: &'a Arguments,
    pub gpu: &'a Gpu,
    pub cache: &'a Cache,
    pub masks: &'a BTreeMap<String, Selection>,
    pub stop: &'a Arc<AtomicBool>,
    /// `None` if this run is only a part.
    pub files: Option<&'a Files>,
    pub shard: Shard,
    /// Keys with a column of their own.
    pub varied: &'a [&'static str],
    pub rows: Vec<Row>,
    /// Position of each row among all worlds, cameras and rows.
    pub places: Vec<u32>,
    pub page: Page,
    /// Worlds that are missing from the table, and why.
    pub failures: Vec<Missed>,
    /// The position in the whole work.
    pub progress: Progress,
}

/// Counts worlds, cameras and rows in their order, so that all parts of a run number them alike.
#[derive(Default)]
pub struct Progress {
    /// Rows of the worlds that are finished, including the rows of other parts.
    pub rows: usize,
    /// First and end position of the current world.
    world: Range<u32>,
    /// The current position.
    at: u32,
}

/// A world that is missing from the table, or of which the table has only the first rows.
pub struct Missed {
    pub path: PathBuf,
    pub failure: Failure,
    /// The positions of the world, and the one that failed.
    pub world: Range<u32>,
    pub at: u32,
}

impl Judge<'_> {
    pub fn report(&self, complete: bool) -> Report<'_> {
        let missing = |missed: &Missed| Missing {
            world: missed.path.display().to_string(),
            message: missed.failure.reason().to_owned(),
        };
        Report {
            version: env!("CARGO_PKG_VERSION"),
            adapter: &self.gpu.summary,
            size: self.arguments.subjects.size,
            spp: self.arguments.spp,
            displayed: self.arguments.displayed,
            complete,
            rows: &self.rows,
            by_setting: summary::by_setting(&self.rows),
            failures: self.failures.iter().map(missing).collect(),
            varied: self.varied,
        }
    }

    /// Writes all files, unless this run is a part: then `grotto merge` makes them from all parts.
    pub fn write(&self, complete: bool) -> Result<(), Failure> {
        match self.files {
            Some(files) => files.write(&self.report(complete), &self.page),
            None => Ok(()),
        }
    }

    pub fn print(&self, complete: bool) -> Result<(), Failure> {
        let report = self.report(complete);
        match self.arguments.run.json {
            true => output::print_json(&report),
            false => output::print(&report.text()),
        }
    }

    /// Keeps the files of the last row, which are marked as incomplete.
    pub fn stopped(&self) -> Result<(), Failure> {
        let out = self.arguments.out.display();
        if self.rows.is_empty() {
            return Err(Failure::interrupted(format!(
                "stopped before the first row: nothing is written to {out}"
            )));
        }
        self.print(false)?;
        if self.files.is_none() {
            return Err(Failure::interrupted(format!(
                "stopped: part {} is not written",
                self.shard
            )));
        }
        Err(Failure::interrupted(format!(
            "stopped: {out} holds the first {} rows and is marked incomplete",
            self.rows.len()
        )))
    }

    /// Adds the rows of a world. Rows that are finished are kept when the world fails.
    ///
    /// # Errors
    /// When the user stops the run. All other failures are listed in the table.
    pub fn world(&mut self, path: &Path) -> Result<(), Failure> {
        let start = self.progress.world.end;
        self.progress.world = start..start;
        self.progress.at = start;
        match self.rows_of(path) {
            Err(failure) if failure.exit_code() == EXIT_INTERRUPTED => return Err(failure),
            Err(failure) => {
                let text = format!("{} fails; the reason follows", path.display());
                output::note(&self.arguments.run, &text);
                self.failures.push(Missed {
                    path: path.to_owned(),
                    failure,
                    world: self.progress.world.clone(),
                    at: self.progress.at,
                });
            }
            Ok(()) => {}
        }
        Ok(())
    }

    fn rows_of(&mut self, path: &Path) -> Result<(), Failure> {
        let (arguments, run) = (self.arguments, &self.arguments.run);
        let loaded = TestCase::load(path, run, &arguments.subjects, Unnamed::All)?;
        let Some(case) = loaded else {
            let text = format!("{}: no such camera or layout; left out", path.display());
            output::note(run, &text);
            return Ok(());
        };
        let settings = case.settings.len();
        let per_camera = usize::from(arguments.direct) + case.layouts.len() * settings;
        let first_row = self.progress.rows;
        self.progress.rows += case.cameras.len() * per_camera;
        let start = self.progress.world.start;
        // Positions of the world itself, and of each camera with its rows.
        self.progress.world.end += (1 + case.cameras.len() * (1 + per_camera)) as u32;
        let shard = self.shard;
        let has_any = move |mut rows: Range<usize>| rows.any(|row| shard.has(row));
        if !has_any(first_row..self.progress.rows) {
            return Ok(());
        }
        let plan = arguments.motion.plan(&case.parameters)?;
        let stage = Stage::build(self.gpu, &case.world)?;
        let mut frame_loop = FrameLoop::new(
            self.gpu,
            stage,
            &case.layouts[0],
            &case.parameters,
            case.shot(&case.cameras[0]),
        )?;
        frame_loop.stop_at(self.stop);
        if arguments.displayed {
            frame_loop.antialias(&case.parameters.picture)?;
        }
        let mut tracer = Tracer {
            world: &case.world,
            run,
            cache: self.cache,
            gpu: self.gpu,
            against: arguments.against,
            stop: self.stop,
            voxels: None,
        };
        self.page.world(start, &case.world);
        for (index, camera) in case.cameras.iter().enumerate() {
            let mut row = first_row + index * per_camera;
            if !has_any(row..row + per_camera) {
                continue;
            }
            self.progress.at = start + (1 + index * (1 + per_camera)) as u32;
            let target = self.target(&case, camera, &mut tracer, &mut frame_loop)?;
            self.page.camera(self.progress.at, camera, &target)?;
            let mut targets = Targets::default();
            // Whether the next row belongs to this part.
            let mut is_mine = |progress: &mut Progress| {
                progress.at += 1;
                row += 1;
                shard.has(row - 1)
            };
            if arguments.direct && is_mine(&mut self.progress) {
                let names = Names {
                    case: &case,
                    camera,
                    layout: "",
                    settings: &Setting::default(),
                };
                let judged = row::direct_alone(&mut frame_loop, &names, &target)?;
                self.add(judged)?;
            }
            for layout in &case.layouts {
                for settings in &case.settings {
                    if !is_mine(&mut self.progress) {
                        continue;
                    }
                    let probes = settings.of(&case.parameters).probes;
                    frame_loop.replace_probes(layout, &probes)?;
                    let names = Names {
                        case: &case,
                        camera,
                        layout: &layout.name,
                        settings,
                    };
                    let mut judged = self.row(&names, &target, &mut frame_loop)?;
                    if let Some(plan) = &plan {
                        let mut motion = Judging {
                            names: &names,
                            plan,
                            settling: arguments.subjects.frames,
                            turn_deg: arguments.turn_deg(),
                            film: self.film(&case, camera),
                            tracer: &mut tracer,
                            targets: &mut targets,
                            run,
                        };
                        judged.0.motion = motion.rows(&mut frame_loop)?;
                    }
                    self.add(judged)?;
                }
            }
        }
        Ok(())
    }

    /// The camera's picture, before anything has moved.
    fn film<'c>(&self, case: &'c TestCase, camera: &'c Camera) -> Film<'c> {
        Film {
            camera,
            lights: &case.lights,
            time_s: case.time_s(),
            edits: &[],
            size: self.arguments.subjects.size,
            spp: self.arguments.spp,
            seed: self.arguments.subjects.seed,
            textures: case.parameters.textures.enabled,
            antialias: self.arguments.displayed,
        }
    }

    fn target(
        &self,
        case: &TestCase,
        camera: &Camera,
        tracer: &mut Tracer<'_>,
        frame_loop: &mut FrameLoop<'_>,
    ) -> Result<Target, Failure> {
        let truth = tracer.truth(&self.film(case, camera), frame_loop.stage())?;
        let mut target = Target::new(truth, case.parameters.picture.exposure_ev)?;
        let dark = match self.masks.get(&camera.name) {
            Some(mask) => Some(mask.clone()),
            None => {
                frame_loop.look(camera, View::Normal);
                frame_loop.advance(&case.lights, 1, &|| {})?;
                let mask = target.unlit(&frame_loop.radiance()?);
                let selected = |mask: Picture| Selection::mask([mask.width, mask.height], &mask);
                mask.map(selected).transpose().map_err(Failure::fault)?
            }
        };
        if let Some(pixels) = dark {
            let bright = self.brightest(case, tracer, frame_loop.stage())?;
            target.dark = (bright > 0.0).then_some(Dark { pixels, bright });
        }
        Ok(target)
    }

    /// The mean luminance in the view of the brightest of a world's cameras.
    fn brightest(
        &self,
        case: &TestCase,
        tracer: &mut Tracer<'_>,
        stage: &Stage,
    ) -> Result<f64, Failure> {
        let mut brightest: f64 = 0.0;
        for camera in &case.world.cameras {
            let truth = tracer.truth(&self.film(case, camera), stage)?;
            let light = row::luminance(&row::full(&truth.whole), &Selection::ALL);
            brightest = brightest.max(light);
        }
        Ok(brightest)
    }

    fn row(
        &self,
        names: &Names<'_>,
        target: &Target,
        frame_loop: &mut FrameLoop<'_>,
    ) -> Result<(Row, Pictures), Failure> {
        let arguments = self.arguments;
        let plan = Plan {
            frames: arguments.subjects.frames,
            stability: !arguments.skip_stability,
            watched: (!arguments.skip_response).then_some(arguments.response_frames),
        };
        let bar = output::progress(&arguments.run, "frames", plan.length());
        let after = || bar.inc(1);
        let judged = row::judge(frame_loop, names, target, &plan, &after);
        bar.finish_and_clear();
        judged
    }

    /// Adds a row, and rewrites the files.
    fn add(&mut self, (row, pictures): (Row, Pictures)) -> Result<(), Failure> {
        output::note(&self.arguments.run, &table::line(&row));
        for moved in &row.motion {
            output::note(&self.arguments.run, &motion::line(moved));
        }
        self.page.row(self.progress.at, &row, &pictures)?;
        self.rows.push(row);
        self.places.push(self.progress.at);
        self.write(false)
    }
}
