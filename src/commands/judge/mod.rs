//! `grotto judge`: DDGI against path-traced references, as one table.

mod cache;
mod page;
mod row;
mod table;
mod truth;

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use clap::Args;
use serde::Serialize;

use self::{
    cache::Cache,
    page::Page,
    row::{Dark, Plan, Row, Target},
    truth::{Against, Film, Tracer},
};
use super::{
    EXIT_FAULT, Failure,
    driver::Driver,
    dynamics::WATCHED_FRAMES,
    memory,
    options::RunOptions,
    out_file::OutFile,
    output,
    subject::{Subject, SubjectOptions, Unnamed},
};
use crate::{
    frame::Stage,
    gpu::{AdapterSummary, Gpu},
    measure::{picture::Picture, picture_file, selection::Selection},
    passes::ViewMode,
    world::Camera,
};

/// Judge DDGI by path-traced references: error, energy, leaks, stability, response
///
/// Writes judge.json, judge.csv and judge.html (one page with all pictures) into --out: a row for each
/// world, camera, layout and number of rays. FLIP and absolute error are of the tone-mapped pictures,
/// energy ratios (DDGI over reference) of linear light; "indirect" is bounced light alone. The leak
/// ratio is the light that DDGI adds where the reference has none (surfaces that no path found light
/// for, if they fill 1 % of the picture; or a --mask), over the mean light of the world's brightest
/// camera. Stability is the change of a pixel between consecutive frames, sum over RGB, over 50 frames
/// of the still, tone-mapped scene. Response counts frames until 90 % and 99 % of a change of the
/// indirect light are there, after the first lamp is switched on, off, or moved, and after a wall before
/// the camera is opened and closed by a sphere of radius 3. Without WORLD all worlds of the folder
/// worlds/ are judged.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    subjects: SubjectOptions,
    /// The folder for judge.json, judge.csv and judge.html, made if need be
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Paths per pixel of the references: their noise counts as error of DDGI
    #[arg(long, value_name = "N", default_value_t = 256, allow_negative_numbers = true,
          value_parser = clap::value_parser!(u32).range(1..=65536))]
    spp: u32,
    /// Who traces the references
    #[arg(long, value_name = "TRACER", value_enum, default_value_t = Against::Reference)]
    against: Against,
    /// A picture that is white where a camera must see no light, for the leak ratio (repeatable)
    #[arg(long = "mask", value_name = "CAMERA=FILE", value_parser = camera_mask)]
    masks: Vec<(String, PathBuf)>,
    /// Leave the stability out
    #[arg(long)]
    skip_stability: bool,
    /// Leave the response out: most of the time goes there
    #[arg(long)]
    skip_response: bool,
    /// Frames to watch after each change
    #[arg(long, value_name = "N", default_value_t = WATCHED_FRAMES, value_parser = clap::value_parser!(u32).range(16..=100_000))]
    response_frames: u32,
    /// Where references are kept [default: the user's cache folder]
    #[arg(long, value_name = "DIR", conflicts_with = "no_cache")]
    cache: Option<PathBuf>,
    /// Trace every reference anew, and keep none
    #[arg(long)]
    no_cache: bool,
    #[command(flatten)]
    run: RunOptions,
}

fn camera_mask(text: &str) -> Result<(String, PathBuf), String> {
    let (camera, path) = text
        .split_once('=')
        .ok_or("write CAMERA=FILE, as in dark=mask.png")?;
    Ok((camera.to_owned(), path.into()))
}

/// What is written.
#[derive(Serialize)]
struct Report<'a> {
    version: &'static str,
    adapter: &'a AdapterSummary,
    /// Width and height in pixels.
    size: [u32; 2],
    /// Paths per pixel of the references.
    spp: u32,
    rows: &'a [Row],
    /// What is missing, and why.
    failures: Vec<Missing>,
}

#[derive(Serialize)]
struct Missing {
    world: String,
    message: String,
}

/// Worlds of those who name none.
const WORLDS: &str = "worlds";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let paths = worlds(&arguments.subjects.worlds)?;
    let file = |name| OutFile::new(&arguments.out, name);
    let (json, csv, html) = (file("judge.json")?, file("judge.csv")?, file("judge.html")?);
    // Light, display and figures of DDGI and reference, and what FLIP takes for each pixel.
    let [width, height] = arguments.subjects.size.map(u64::from);
    memory::check("judging pictures of this size", width * height * 400)?;
    let masks = read_masks(arguments)?;
    let gpu = output::open_gpu(&arguments.run)?;
    let cache = match arguments.no_cache {
        true => Cache::none(),
        false => Cache::new(arguments.cache.as_deref()),
    };
    let mut judge = Judge {
        arguments,
        gpu: &gpu,
        cache: &cache,
        masks: &masks,
        rows: Vec::new(),
        page: Page::default(),
    };
    let mut failures = Vec::new();
    for path in &paths {
        if let Err(failure) = judge.world(path) {
            let text = format!("{} fails; the reason follows", path.display());
            output::note(&arguments.run, &text);
            failures.push((path, failure));
        }
    }
    let Judge { rows, page, .. } = judge;
    if rows.is_empty() {
        verdict(failures, paths.len())?;
        return Err(Failure::bad_input(
            "no world has the cameras and layouts that --camera and --layout name",
        ));
    }

    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        adapter: &gpu.summary,
        size: arguments.subjects.size,
        spp: arguments.spp,
        rows: &rows,
        failures: failures
            .iter()
            .map(|(path, failure)| Missing {
                world: path.display().to_string(),
                message: failure.reason().to_owned(),
            })
            .collect(),
    };
    json.write_json(&report)?;
    csv.write(&table::csv(&rows))?;
    html.write(&page.finish(&report))?;
    if arguments.run.json {
        output::print_json(&report)?;
    } else {
        output::print(&table::text(&rows))?;
    }
    verdict(failures, paths.len())
}

/// # Errors
/// When a world is missing from the table: a fault if one of them is ours, else bad input.
fn verdict(mut failures: Vec<(&PathBuf, Failure)>, worlds: usize) -> Result<(), Failure> {
    match failures.pop() {
        None => Ok(()),
        Some((_, failure)) if worlds == 1 => Err(failure),
        Some(last) => {
            failures.push(last);
            let reasons = failures.iter().map(|(_, failure)| failure.reason());
            let text = format!(
                "{} of {worlds} worlds are not in the table:\n{}",
                failures.len(),
                reasons.collect::<Vec<_>>().join("\n")
            );
            let mut codes = failures.iter().map(|(_, failure)| failure.exit_code());
            Err(match codes.any(|code| code == EXIT_FAULT) {
                true => Failure::fault(text),
                false => Failure::bad_input(text),
            })
        }
    }
}

/// The files that were named, or all of the folder `worlds`.
fn worlds(named: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    if !named.is_empty() {
        return Ok(named.to_vec());
    }
    let entries = std::fs::read_dir(WORLDS).map_err(|error| {
        Failure::bad_input(format!(
            "the folder {WORLDS}: {error}; name the world files"
        ))
    })?;
    let is_world = |path: &PathBuf| path.extension().is_some_and(|e| e == "ron");
    let found = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut found: Vec<PathBuf> = found.filter(is_world).collect();
    found.sort();
    if found.is_empty() {
        return Err(Failure::bad_input(format!(
            "the folder {WORLDS} holds no world; name the world files"
        )));
    }
    Ok(found)
}

/// The masks by the names of their cameras.
fn read_masks(arguments: &Arguments) -> Result<BTreeMap<String, Selection>, Failure> {
    let read = |(camera, path): &(String, PathBuf)| {
        let (mask, _) = picture_file::read(path)?;
        let selection = Selection::mask(arguments.subjects.size, &mask)
            .map_err(|error| Failure::bad_input(format!("{}: {error}", path.display())))?;
        Ok((camera.clone(), selection))
    };
    arguments.masks.iter().map(read).collect()
}

/// The work, and what has come of it.
struct Judge<'a> {
    arguments: &'a Arguments,
    gpu: &'a Gpu,
    cache: &'a Cache,
    masks: &'a BTreeMap<String, Selection>,
    rows: Vec<Row>,
    page: Page,
}

impl Judge<'_> {
    /// Adds the rows of a world; those that are done stay when it fails.
    fn world(&mut self, path: &Path) -> Result<(), Failure> {
        let (arguments, run) = (self.arguments, &self.arguments.run);
        let loaded = Subject::load(path, run, &arguments.subjects, Unnamed::All)?;
        let Some(subject) = loaded else {
            let text = format!("{}: no such camera or layout; left out", path.display());
            output::note(run, &text);
            return Ok(());
        };
        let stage = Stage::build(self.gpu, &subject.world)?;
        let mut driver = Driver::new(
            self.gpu,
            stage,
            &subject.layouts[0],
            &subject.parameters,
            subject.view(&subject.cameras[0]),
        )?;
        let mut tracer = Tracer {
            world: &subject.world,
            lights: &subject.lights,
            run,
            cache: self.cache,
            gpu: self.gpu,
            against: arguments.against,
            voxels: None,
        };
        self.page.world(&subject.world);
        for camera in &subject.cameras {
            let target = self.target(&subject, camera, &mut tracer, &mut driver)?;
            self.page.camera(camera, &target);
            for layout in &subject.layouts {
                for &rays in &subject.rays {
                    driver.replace_probes(layout, &subject.with_rays(rays).probes)?;
                    self.row(&subject, camera, &layout.name, &target, &mut driver)?;
                }
            }
        }
        Ok(())
    }

    fn film<'c>(&self, subject: &Subject, camera: &'c Camera) -> Film<'c> {
        Film {
            camera,
            size: self.arguments.subjects.size,
            spp: self.arguments.spp,
            seed: self.arguments.subjects.seed,
            textures: subject.parameters.textures.enabled,
        }
    }

    fn target(
        &self,
        subject: &Subject,
        camera: &Camera,
        tracer: &mut Tracer<'_>,
        driver: &mut Driver<'_>,
    ) -> Result<Target, Failure> {
        let truth = tracer.truth(&self.film(subject, camera), driver.stage())?;
        let mut target = Target::new(truth, subject.parameters.picture.exposure_ev);
        let dark = match self.masks.get(&camera.name) {
            Some(mask) => Some(mask.clone()),
            None => {
                driver.look(camera, ViewMode::Normal);
                driver.advance(&subject.lights, 1, &|| {})?;
                let mask = target.unlit(&driver.radiance()?);
                let selected = |mask: Picture| Selection::mask([mask.width, mask.height], &mask);
                mask.map(selected).transpose().map_err(Failure::fault)?
            }
        };
        if let Some(pixels) = dark {
            let bright = self.brightest(subject, tracer, driver.stage())?;
            target.dark = (bright > 0.0).then_some(Dark { pixels, bright });
        }
        Ok(target)
    }

    /// The mean luminance that the brightest of a world's cameras sees.
    fn brightest(
        &self,
        subject: &Subject,
        tracer: &mut Tracer<'_>,
        stage: &Stage,
    ) -> Result<f64, Failure> {
        let mut brightest: f64 = 0.0;
        for camera in &subject.world.cameras {
            let truth = tracer.truth(&self.film(subject, camera), stage)?;
            let light = row::luminance(&row::full(&truth), &Selection::ALL);
            brightest = brightest.max(light);
        }
        Ok(brightest)
    }

    fn row(
        &mut self,
        subject: &Subject,
        camera: &Camera,
        layout: &str,
        target: &Target,
        driver: &mut Driver<'_>,
    ) -> Result<(), Failure> {
        let arguments = self.arguments;
        let plan = Plan {
            frames: arguments.subjects.frames,
            stability: !arguments.skip_stability,
            watched: (!arguments.skip_response).then_some(arguments.response_frames),
        };
        let bar = output::progress(&arguments.run, "frames", plan.length());
        let names = (&subject.world, camera, layout);
        let judged = row::judge(driver, names, &subject.lights, target, &plan, &|| {
            bar.inc(1)
        });
        bar.finish_and_clear();
        let (row, pictures) = judged?;
        output::note(&arguments.run, &table::line(&row));
        self.page.row(&row, &pictures);
        self.rows.push(row);
        Ok(())
    }
}
