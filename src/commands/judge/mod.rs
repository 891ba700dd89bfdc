//! `grotto judge`: DDGI against path-traced references, as one table.

pub(super) mod cache;
mod motion;
mod page;
mod part;
mod report;
pub(super) mod row;
mod runner;
mod summary;
mod table;
pub(super) mod truth;

use std::{collections::BTreeMap, path::PathBuf};

use clap::Args;

pub(super) use self::part::merge;
use self::{
    cache::Cache,
    motion::MotionOptions,
    page::Page,
    report::Files,
    runner::{Judge, Missed, Progress},
    truth::Against,
};
use super::{
    EXIT_FAULT, Failure,
    dynamics::{TURN_DEG, WATCHED_FRAMES},
    memory,
    options::RunOptions,
    output,
    settings::Varied,
    shard::Shard,
    stop,
    test_case::TestCaseOptions,
};
use crate::{
    measure::{picture_file, selection::Selection},
    parameters::{Antialias, Parameters},
};

/// Judge DDGI against path-traced references: error, energy, leaks, stability, response
///
/// Writes judge.json, judge.csv, judge.md (only the table) and judge.html (one page with small pictures) into
/// --out, and rewrites them after each row. There is a row for each world, camera, layout, and setting of
/// --rays and --vary. With several settings a second table lists the means of each. FLIP and absolute error
/// compare the tone-mapped pictures, energy ratios (DDGI over reference) compare linear light; "indirect" is
/// bounced light alone. The leak ratio is the light that DDGI adds where the reference has none, over the mean
/// light of the world's brightest camera. These places are the surfaces that no path found light for, if they
/// fill 1 % of the picture, or a --mask. Stability is the change of a pixel between consecutive frames, sum
/// over RGB, over 50 frames of the tone-mapped scene at rest. Response counts frames until the indirect light
/// has made 90 % and 99 % of its change, after a lamp is switched on, off, or moved, and after a wall is opened
/// and closed. The world names the lamp and the wall; the defaults are the first lamp and a hole in front of
/// the camera. With --motion, rows are also judged while lamps and camera move; with --displayed, edges count
/// too. Without WORLD all worlds of the folder worlds/ are judged.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    subjects: TestCaseOptions,
    /// The folder for the tables, created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Paths per pixel of the references: the noise of the references counts as error of DDGI
    #[arg(long, value_name = "N", default_value_t = 256, allow_negative_numbers = true,
          value_parser = clap::value_parser!(u32).range(1..=65536))]
    spp: u32,
    /// The tracer of the references
    #[arg(long, value_name = "TRACER", value_enum, default_value_t = Against::Reference)]
    against: Against,
    /// A picture that is white where a camera must see no light, for the leak ratio (repeatable)
    #[arg(long = "mask", value_name = "CAMERA=FILE", value_parser = camera_mask)]
    masks: Vec<(String, PathBuf)>,
    /// Also add a row for each camera with direct light without any probes: the worst acceptable result of DDGI
    #[arg(long)]
    direct: bool,
    /// Width in pixels of the pictures in the page; 0 leaves them out
    #[arg(long, value_name = "W", default_value_t = 256, allow_negative_numbers = true,
          value_parser = clap::value_parser!(u32).range(0..=4096))]
    page_pictures: u32,
    /// Also write every picture in full size, as PNG, into a folder `pictures` beside the page
    #[arg(long)]
    pictures: bool,
    /// Leave out the stability
    #[arg(long)]
    skip_stability: bool,
    /// Leave out the response, which takes most of the time
    #[arg(long)]
    skip_response: bool,
    /// Frames to watch after each change
    #[arg(long, value_name = "N", default_value_t = WATCHED_FRAMES, value_parser = clap::value_parser!(u32).range(16..=100_000))]
    response_frames: u32,
    #[command(flatten)]
    motion: MotionOptions,
    /// Judge what players see: frames are anti-aliased, and so are the references
    ///
    /// Without it all pictures are taken at the centres of pixels, and edges are the same on both sides. With
    /// --motion the camera turns at 120 degrees per second in place of 90.
    #[arg(long)]
    displayed: bool,
    /// Where references are stored [default: the user's cache folder]
    #[arg(long, value_name = "DIR", conflicts_with = "no_cache")]
    cache: Option<PathBuf>,
    /// Trace every reference again, and store none
    #[arg(long)]
    no_cache: bool,
    /// Only part I of N of the rows, in a file of its own; `grotto merge` joins the parts
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    shard: Option<Shard>,
    #[command(flatten)]
    run: RunOptions,
}

fn camera_mask(text: &str) -> Result<(String, PathBuf), String> {
    let (camera, path) = text
        .split_once('=')
        .ok_or("write CAMERA=FILE, as in dark=mask.png")?;
    Ok((camera.to_owned(), path.into()))
}

pub(super) const COMMAND: &str = "judge";

/// Speed of a camera that turns while edges are judged: a player who looks around (degrees per second).
const DISPLAYED_TURN_DEG: f32 = 120.0;

impl Arguments {
    /// Speed of a camera that turns (degrees per second).
    fn turn_deg(&self) -> f32 {
        match self.displayed {
            true => DISPLAYED_TURN_DEG,
            false => TURN_DEG,
        }
    }

    /// # Errors
    /// Where the parameters contradict `--displayed`, or need it.
    fn check_displayed(&self, parameters: &Parameters) -> Result<(), Failure> {
        if self.displayed && parameters.picture.antialias == Antialias::Off {
            return Err(Failure::bad_input(
                "--displayed judges anti-aliased pictures, and picture.antialias=off asks for none; leave one of \
                 them out",
            ));
        }
        let scale = parameters.picture.scale;
        if !self.displayed && scale < 1.0 {
            return Err(Failure::bad_input(format!(
                "picture.scale={scale} is part of what players see: add --displayed, or leave it out",
            )));
        }
        Ok(())
    }
}

/// Folder of the worlds that are judged if none is named.
const WORLDS: &str = "worlds";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let run = &arguments.run;
    let paths = worlds(&arguments.subjects.worlds)?;
    let varied: Vec<&'static str> = arguments.subjects.vary.iter().map(Varied::name).collect();
    arguments.subjects.settings(run)?;
    arguments.motion.check_worlds(&paths)?;
    let parameters = run.parameters()?;
    arguments.motion.plan(&parameters)?;
    arguments.check_displayed(&parameters)?;
    // Memory for light, display and figures of DDGI and reference, and for FLIP, per pixel.
    let [width, height] = arguments.subjects.size.map(u64::from);
    let per_pixel = 400 + arguments.motion.bytes_per_pixel();
    memory::check("judging pictures of this size", width * height * per_pixel)?;
    let masks = read_masks(arguments)?;
    let files = match arguments.shard {
        None => Some(Files::new(&arguments.out)?),
        Some(_) => None,
    };
    let page = Page::new(&arguments.out, arguments.page_pictures, arguments.pictures)?;
    let stop = stop::at_ctrl_c(run);
    let gpu = output::open_gpu(run)?;
    let part = arguments
        .shard
        .map(|shard| part::file(arguments, &paths, &gpu, shard));
    let part = part.transpose()?;
    let cache = match arguments.no_cache {
        true => Cache::none(),
        false => Cache::new(arguments.cache.as_deref()),
    };
    let mut judge = Judge {
        arguments,
        gpu: &gpu,
        cache: &cache,
        masks: &masks,
        stop: &stop,
        files: files.as_ref(),
        shard: arguments.shard.unwrap_or(Shard::WHOLE),
        varied: &varied,
        rows: Vec::new(),
        places: Vec::new(),
        page,
        failures: Vec::new(),
        progress: Progress::default(),
    };
    for path in &paths {
        if judge.world(path).is_err() {
            return judge.stopped();
        }
    }
    if judge.progress.rows == 0 || part.is_none() && judge.rows.is_empty() {
        verdict(judge.failures, paths.len())?;
        return Err(Failure::bad_input(
            "no world has the cameras and layouts that --camera and --layout name",
        ));
    }
    match part {
        None => {
            judge.write(true)?;
            judge.print(true)?;
        }
        Some(file) => {
            part::write(&judge, file, paths.len())?;
            judge.print(false)?;
        }
    }
    verdict(judge.failures, paths.len())
}

/// # Errors
/// When a world is missing from the table: a fault if one of the failures is a fault of grotto, else bad input.
fn verdict(mut failures: Vec<Missed>, worlds: usize) -> Result<(), Failure> {
    match failures.pop() {
        None => Ok(()),
        Some(missed) if worlds == 1 => Err(missed.failure),
        Some(last) => {
            failures.push(last);
            let reasons = failures.iter().map(|missed| missed.failure.reason());
            let text = format!(
                "{} of {worlds} worlds are not in the table:\n{}",
                failures.len(),
                reasons.collect::<Vec<_>>().join("\n")
            );
            let mut codes = failures.iter().map(|missed| missed.failure.exit_code());
            Err(match codes.any(|code| code == EXIT_FAULT) {
                true => Failure::fault(text),
                false => Failure::bad_input(text),
            })
        }
    }
}

/// The named files, or all files of the folder `worlds`.
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

/// The masks, by the names of their cameras.
fn read_masks(arguments: &Arguments) -> Result<BTreeMap<String, Selection>, Failure> {
    let read = |(camera, path): &(String, PathBuf)| {
        let (mask, _) = picture_file::read(path)?;
        let selection = Selection::mask(arguments.subjects.size, &mask)
            .map_err(|error| Failure::bad_input(format!("{}: {error}", path.display())))?;
        Ok((camera.clone(), selection))
    };
    arguments.masks.iter().map(read).collect()
}
