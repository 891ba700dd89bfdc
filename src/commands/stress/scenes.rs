//! The run: workers, each with a GPU device of its own, examine the scenes, and the report covers all finished
//! scenes.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use clap::Args;

use super::{
    super::{Failure, options::RunOptions, out_file::OutFile, output, shard::Shard},
    checks::Check,
    examine::{Examination, examine, listen_for_panics},
    fault::Fault,
    known::Known,
    report::{FAILURES, FILE, KIND, Report, Row, SCHEMA, TIMES},
    scene::Scene,
    shrink::{MOST_TRIES, shrink},
    watched::Watched,
};

/// The scenes of a run, and how they are examined.
#[derive(Args)]
pub struct SceneOptions {
    /// Random scenes, made from seeds S, S+1, …
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true,
          value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub scenes: u32,
    /// One world file, examined like a random scene, in place of random scenes
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scenes", "shard"])]
    pub world: Option<PathBuf>,
    /// Only part I of N of the scenes; `grotto merge` joins the parts
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    pub shard: Option<Shard>,
    /// Scenes examined concurrently, each on a device of its own [default: 1]
    #[arg(long, value_name = "J", allow_negative_numbers = true,
          value_parser = clap::value_parser!(u32).range(1..=64))]
    pub jobs: Option<u32>,
    /// Plant a fault into every scene: proves that checks can fail
    #[arg(long, value_name = "FAULT", value_enum, hide = true)]
    pub plant: Option<Fault>,
    /// Most scenes that are played to shrink a failing one
    #[arg(long, value_name = "N", default_value_t = MOST_TRIES, hide = true)]
    pub tries: u32,
}

/// The world that every device plays before it examines scenes. wgpu creates some objects at their first use
/// and keeps them, and no scene must be blamed for that. Few probes and rays make those objects as well as many: on a
/// software adapter the default numbers take longer than several scenes.
const FIRST: &str = "(
    title: \"A sphere on a plane, and few probes.\",
    size: (64, 32, 64),
    origin: (-32, -8, -32),
    shape: Union([Plane(normal: (0, 1, 0), offset: 0), Translate(by: (0, 6, 0), of: Sphere(radius: 7))]),
    materials: {\"stone\": (a: Flat(0.5, 0.3, 0.2), b: Flat(0.3, 0.3, 0.2), pattern: Bricks(rows: 2, joint: 0.05))},
    sun: (towards: (2, 3, 1), irradiance: (3, 3, 2)),
    sky: (zenith: (0.3, 0.5, 1)),
    cameras: [(name: \"front\", position: (18, 12, 22), look_at: (0, 4, 0))],
    layouts: [(name: \"few\", counts: (3, 2, 3), spacing: 16)],
)";
const FIRST_SET: &str = "probes.rays=8";

/// Shortest time between two reports of unfinished work.
const REPORT_EVERY: Duration = Duration::from_secs(1);

/// What the workers share.
struct Run<'a> {
    options: &'a SceneOptions,
    seed: u32,
    run: &'a RunOptions,
    out: &'a Path,
    stop: &'a AtomicBool,
    known: Known,
    worlds: Vec<Scene>,
    /// Indices of the scenes of this part.
    pieces: Vec<usize>,
    next: AtomicUsize,
    state: Mutex<State>,
    bar: indicatif::ProgressBar,
}

struct State {
    report: Report,
    /// Seconds taken by each scene.
    times: BTreeMap<String, f64>,
    written: Option<Instant>,
}

/// # Errors
/// For a folder that holds results, without an adapter; and [`Failure::gate`] when a failure is not known.
pub fn run(
    options: &SceneOptions,
    seed: u32,
    out: &Path,
    run: &RunOptions,
    known: Known,
    stop: &AtomicBool,
) -> Result<Report, Failure> {
    run.parameters()?;
    refuse_results(out)?;
    if seed.checked_add(options.scenes).is_none() {
        return Err(Failure::bad_input(format!(
            "--seed {seed} leaves no {} seeds up to {}; take a smaller one",
            options.scenes,
            u32::MAX
        )));
    }
    let (worlds, all) = match &options.world {
        Some(path) => (vec![Scene::of_file(path, seed, &run.set)?], 1),
        None => (Vec::new(), options.scenes as usize),
    };
    let shard = options.shard.unwrap_or(Shard::WHOLE);
    let first = Watched::open(run)?;
    let pieces: Vec<usize> = (0..all).filter(|piece| shard.has(*piece)).collect();
    let shared = Run {
        options,
        seed,
        run,
        out,
        stop,
        known,
        worlds,
        next: AtomicUsize::new(0),
        state: Mutex::new(State {
            report: Report {
                kind: KIND.to_owned(),
                schema: SCHEMA,
                version: env!("CARGO_PKG_VERSION").to_owned(),
                adapter: (&first.gpu.summary).into(),
                seed,
                scenes: options.scenes,
                world: options
                    .world
                    .as_ref()
                    .map(|path| path.display().to_string()),
                set: run.set.clone(),
                shard: options.shard.filter(|shard| !shard.is_whole()),
                complete: false,
                examined: 0,
                checks: BTreeMap::new(),
                failures: Vec::new(),
                known: Vec::new(),
                cured: Vec::new(),
            },
            times: BTreeMap::new(),
            written: None,
        }),
        bar: output::progress(run, "scenes", pieces.len() as u64),
        pieces,
    };
    shared.lock().report.write(out)?;
    let hook = std::panic::take_hook();
    listen_for_panics();
    let worked = shared.work(first);
    std::panic::set_hook(hook);
    worked?;
    shared.bar.finish_and_clear();
    let mut state = shared.lock();
    state.report.complete = state.report.examined as usize == shared.pieces.len();
    state.report.write(out)?;
    OutFile::new(out, TIMES)?.write_json(&state.times)?;
    Ok(state.report.clone())
}

/// # Errors
/// For a folder that holds the results of another run.
pub fn refuse_results(out: &Path) -> Result<(), Failure> {
    let holds = |name: &str| out.join(name).exists();
    if holds(FILE) || holds(FAILURES) {
        return Err(Failure::bad_input(format!(
            "{} holds results of another run; choose another folder, or remove them",
            out.display()
        )));
    }
    Ok(())
}

/// The scene that shows [`FIRST`].
fn first_scene() -> Scene {
    Scene {
        name: "first".to_owned(),
        seed: 0,
        text: FIRST.to_owned(),
        set: vec![FIRST_SET.to_owned()],
        folder: None,
        tree: None,
    }
}

fn warm_up(watched: &mut Watched) {
    let all = Examination {
        fault: None,
        only: None,
    };
    examine(watched, &first_scene(), all);
}

impl Run<'_> {
    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn work(&self, first: Watched) -> Result<(), Failure> {
        let others = self
            .options
            .jobs
            .unwrap_or(1)
            .min(self.pieces.len() as u32)
            .max(1)
            - 1;
        std::thread::scope(|scope| {
            let one = |watched: Option<Watched>| {
                let mut watched = match watched {
                    Some(watched) => watched,
                    None => Watched::open(self.run)?,
                };
                warm_up(&mut watched);
                self.worker(&mut watched)
            };
            let handles: Vec<_> = (0..others)
                .map(|_| scope.spawn(move || one(None)))
                .collect();
            let mine = one(Some(first));
            let all = handles.into_iter().map(|handle| match handle.join() {
                Ok(ended) => ended,
                Err(_) => Err(Failure::fault("a worker of grotto stress panicked")),
            });
            all.fold(mine, Result::and)
        })
    }

    fn worker(&self, watched: &mut Watched) -> Result<(), Failure> {
        while !self.stop.load(Ordering::Relaxed) {
            let Some(&piece) = self.pieces.get(self.next.fetch_add(1, Ordering::Relaxed)) else {
                break;
            };
            self.scene(watched, piece)?;
            self.bar.inc(1);
        }
        Ok(())
    }

    fn scene_of(&self, piece: usize) -> Scene {
        let generated = if self.options.world.is_some() {
            0
        } else {
            self.options.scenes as usize
        };
        if piece < generated {
            return Scene::generated(self.seed + piece as u32, &self.run.set);
        }
        self.worlds[piece - generated].clone()
    }

    fn scene(&self, watched: &mut Watched, piece: usize) -> Result<(), Failure> {
        let start = Instant::now();
        let scene = self.scene_of(piece);
        let fault = self.options.plant;
        let findings = examine(watched, &scene, Examination { fault, only: None });
        let failed = {
            let mut state = self.lock();
            let name = (scene.name.as_str(), scene.seed);
            state
                .report
                .count(piece as u32, name, &findings, &self.known)
        };
        for check in failed {
            let message = findings.failure(check).unwrap_or_default();
            let row = self.row(watched, &scene, piece, check, message)?;
            let mut state = self.lock();
            state.report.failures.push(row);
            state.report.sort();
        }
        // A lost device cannot examine further scenes.
        if watched.gpu.wait().is_err() {
            *watched = Watched::open(self.run)?;
            warm_up(watched);
        }
        let mut state = self.lock();
        state
            .times
            .insert(scene.name, start.elapsed().as_secs_f64());
        if state
            .written
            .is_none_or(|written| written.elapsed() >= REPORT_EVERY)
        {
            state.report.write(self.out)?;
            state.written = Some(Instant::now());
        }
        Ok(())
    }

    /// Shrinks a scene that fails, and writes the smaller one as a world file.
    fn row(
        &self,
        watched: &mut Watched,
        scene: &Scene,
        piece: usize,
        check: Check,
        message: &str,
    ) -> Result<Row, Failure> {
        let fault = self.options.plant;
        let shrunk = shrink(
            watched,
            scene,
            check,
            message,
            fault,
            self.options.tries,
            self.stop,
        );
        let name = format!("{}-{}.ron", scene.name, check.name());
        let file = format!("{FAILURES}/{name}");
        let mut command = shrunk.scene.command(&file);
        if let Some(fault) = fault.and_then(|fault| clap::ValueEnum::to_possible_value(&fault)) {
            command += &format!(" --plant {}", fault.get_name());
        }
        let text = format!(
            "// {command}\n// {}\n{}",
            shrunk.message.replace('\n', "\n// "),
            shrunk.scene.text
        );
        OutFile::new(&self.out.join(FAILURES), &name)?.write(&text)?;
        Ok(Row {
            index: piece as u32,
            scene: scene.name.clone(),
            seed: scene.seed,
            check,
            message: shrunk.message,
            file: Some(file),
            command: Some(command),
            reason: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nobody reads the findings of the first scene.
    #[test]
    fn the_first_scene_is_a_valid_world() {
        let world = first_scene()
            .load()
            .unwrap_or_else(|failure| panic!("{failure}"));
        assert_eq!(world.layouts.len(), 1);
    }
}
