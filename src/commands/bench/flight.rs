//! `grotto bench flight`: the cost and the visible changes of a moving camera, and what remains after a jump.

use std::path::PathBuf;

use clap::Args;
use indicatif::ProgressBar;
use serde::Serialize;

use super::{
    super::{
        Failure,
        options::RunOptions,
        output,
        settings::Setting,
        test_case::{TestCase, TestCaseOptions},
    },
    flight_look::{Look, Meters},
    light_suite::LightSuite,
};
use crate::{
    frame::{Frame, Stage},
    gpu::{Gpu, Recorder, Timing},
    measure::{
        changes::{ChangeMeter, Changes, mean_lit},
        picture::Picture,
        statistics,
        tonemap::tone_mapped,
    },
    parameters::ProbeParameters,
    passes::view::Shot,
    reference::flight_path::Path,
    world::{Camera, LayoutSpec, View},
};

/// Light while the camera flies and after it has jumped, and the cost of new probes
///
/// Flies along the first camera's view, back and forth before the wall ahead, or through several cameras
/// (`--camera A --camera B`). After each frame the surfaces of the previous frame are lit again: the change of
/// their indirect irradiance, relative to the brighter of the two, is the popping. Pixels below 5 % of the mean
/// are left out. The change of the displayed picture of the same surfaces, as a share of white, tells how much
/// of it is visible. Then the camera jumps to the world's camera that is farthest away, and its picture after
/// the settling frames is compared with that of probes that started there. Without WORLD the flight is through
/// the cavern.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    subjects: TestCaseOptions,
    /// How far to fly
    #[arg(long, value_name = "M", default_value_t = 200.0, value_parser = positive, allow_negative_numbers = true)]
    metres: f32,
    /// Metres per second
    #[arg(long, value_name = "V", default_value_t = 20.0, value_parser = positive, allow_negative_numbers = true)]
    speed: f32,
    /// Frames per second of flight
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=1000))]
    rate: u32,
    /// Also write flight.json into this folder, created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    run: RunOptions,
}

fn positive(text: &str) -> Result<f32, String> {
    let value = text.parse().ok();
    let value = value.filter(|value: &f32| *value > 0.0 && *value <= 1e6);
    value.ok_or_else(|| "write a number above 0, at most 1e6".to_owned())
}

#[derive(Serialize)]
struct Row {
    world: String,
    cameras: Vec<String>,
    layout: String,
    settings: Setting,
    probes: u32,
    rays: u32,
    metres: f32,
    /// Metres per second.
    speed: f32,
    /// Frames before the flight, and again after the jump.
    settling: u32,
    /// Frames of the flight.
    frames: u32,
    /// Changes from frame to frame in flight.
    change: Changes,
    /// Changes in equally many frames before the flight, with the camera at rest.
    change_at_rest: Changes,
    /// Changes of the displayed picture in flight, as shares of white.
    displayed: Changes,
    displayed_at_rest: Changes,
    scroll: Scroll,
    teleport: Teleport,
}

/// Frames of a flight that add probes, compared with frames of the same flight that add none.
#[derive(Serialize)]
struct Scroll {
    frames: u32,
    /// Most probes added in one frame.
    most_fresh: u32,
    /// Median milliseconds; `null` where there are no such frames, or no timestamps.
    scrolling_ms: Option<f64>,
    still_ms: Option<f64>,
    /// `scrolling_ms` over `still_ms`.
    ratio: Option<f64>,
}

#[derive(Serialize)]
struct Teleport {
    /// The camera that it jumped to.
    camera: String,
    /// Probes that are new after the jump.
    fresh: u32,
    /// Difference from a run that started there.
    difference: Changes,
}

/// Pixels below this share of the mean are ignored: their relative changes say nothing about popping.
const FLOOR: f64 = 0.05;

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let options = &arguments.subjects;
    let suite = LightSuite {
        name: "flight",
        subjects: options,
        run: &arguments.run,
        out: arguments.out.as_deref(),
        otherwise: "worlds/cavern.ron",
        size: Some(options.size),
    };
    suite.run(
        |gpu, case| measure(gpu, case, arguments),
        |adapter, rows| {
            let rows: String = rows.iter().map(lines).collect();
            format!("{adapter}\n{rows}")
        },
    )
}

fn measure(gpu: &Gpu, case: &TestCase, arguments: &Arguments) -> Result<Vec<Row>, Failure> {
    let options = &arguments.subjects;
    let mut rows = Vec::new();
    for layout in &case.layouts {
        for setting in &case.settings {
            let probes = setting.of(&case.parameters).probes;
            let frames = (arguments.metres / arguments.speed * arguments.rate as f32).ceil() as u32;
            let rest = u64::from(frames.min(options.frames));
            let length = 3 * u64::from(options.frames) + u64::from(frames) + rest + 2;
            let bar = output::progress(&arguments.run, "frames", length);
            let mut flyer = Flyer::new(gpu, case, layout, &probes, &bar)?;
            let mut row = flyer.fly(case, arguments, frames)?;
            row.settings = setting.clone();
            bar.finish_and_clear();
            rows.push(row);
        }
    }
    Ok(rows)
}

/// A frame with everything needed to record the next one and to look at the previous one again.
struct Flyer<'a> {
    gpu: &'a Gpu,
    frame: Frame,
    timing: Timing,
    shot: Shot,
    case: &'a TestCase,
    layout: &'a LayoutSpec,
    probes: &'a ProbeParameters,
    bar: &'a ProgressBar,
}

impl<'a> Flyer<'a> {
    fn new(
        gpu: &'a Gpu,
        case: &'a TestCase,
        layout: &'a LayoutSpec,
        probes: &'a ProbeParameters,
        bar: &'a ProgressBar,
    ) -> Result<Self, Failure> {
        let mut shot = case.shot(&case.cameras[0]);
        shot.view = View::Irradiance;
        let stage = Stage::build(gpu, &case.world)?;
        Ok(Self {
            gpu,
            frame: Frame::new(gpu, stage, layout, probes, shot.size)?,
            timing: Timing::new(gpu)?,
            shot,
            case,
            layout,
            probes,
            bar,
        })
    }

    /// Draws the next frame. Returns its milliseconds, where they are known.
    fn step(&mut self, camera: &Camera) -> Result<Option<f64>, Failure> {
        self.shot.camera = camera.clone();
        self.shot.frame = self.frame.frames();
        let mut recorder = Recorder::new(self.gpu, Some(&mut self.timing));
        let lights = &self.case.lights;
        self.frame
            .record(self.gpu, &mut recorder, &self.shot, lights, self.probes);
        recorder.submit(self.gpu)?;
        self.gpu.wait()?;
        self.bar.inc(1);
        let times = self.timing.next_frame();
        let known = times.filter(|_| self.timing.supported());
        Ok(known.map(|times| times.frame_ms))
    }

    fn settle(&mut self, camera: &Camera, frames: u32) -> Result<Picture, Failure> {
        for _ in 0..frames.max(1) {
            self.step(camera)?;
        }
        Ok(self.frame.read_radiance(self.gpu)?)
    }

    /// The view of the camera of the last step.
    fn seen(&mut self) -> Result<Look, Failure> {
        let irradiance = self.frame.read_radiance(self.gpu)?;
        self.with_display(irradiance, &self.shot.camera.clone())
    }

    /// The view of another camera, with the light unchanged.
    fn look(&mut self, camera: &Camera) -> Result<Look, Failure> {
        let irradiance = self.look_at(camera, View::Irradiance)?;
        self.with_display(irradiance, camera)
    }

    fn with_display(&mut self, irradiance: Picture, camera: &Camera) -> Result<Look, Failure> {
        let radiance = self.look_at(camera, View::Full)?;
        Ok(Look {
            irradiance,
            displayed: tone_mapped(&radiance, self.shot.exposure_ev),
        })
    }

    fn look_at(&mut self, camera: &Camera, view: View) -> Result<Picture, Failure> {
        let mut shot = self.shot.clone();
        shot.camera = camera.clone();
        shot.view = view;
        let mut recorder = Recorder::new(self.gpu, None);
        self.frame.show(self.gpu, &mut recorder, &shot);
        recorder.submit(self.gpu)?;
        Ok(self.frame.read_radiance(self.gpu)?)
    }

    fn fly(&mut self, case: &TestCase, arguments: &Arguments, frames: u32) -> Result<Row, Failure> {
        let settling = arguments.subjects.frames;
        let voxels = self.frame.stage.read_back(self.gpu)?;
        let per_metre = 1.0 / case.world.voxel_m;
        let length = arguments.metres * per_metre;
        let path =
            Path::new(&case.world, &voxels, &case.cameras, length).map_err(Failure::bad_input)?;
        let start = path.at(0.0);
        let floor = FLOOR * mean_lit(&self.settle(&start, settling)?);
        let mut last = self.seen()?;

        let mut at_rest = Meters::new(floor);
        for _ in 0..frames.min(settling) {
            self.step(&start)?;
            let now = self.seen()?;
            at_rest.add(&last, &now)?;
            last = now;
        }

        let mut change = Meters::new(floor);
        let (mut scrolling, mut still) = (Vec::new(), Vec::new());
        let (mut scrolls, mut most_fresh) = (0, 0);
        let mut before = start;
        for index in 1..=frames {
            let flown = arguments.speed * per_metre * index as f32 / arguments.rate as f32;
            let camera = path.at(flown.min(length));
            let ms = self.step(&camera)?;
            let now = self.seen()?;
            let again = self.look(&before)?;
            change.add(&last, &again)?;
            let fresh = self.frame.field().fresh();
            if fresh > 0 {
                (scrolls, most_fresh) = (scrolls + 1, most_fresh.max(fresh));
                scrolling.extend(ms);
            } else {
                still.extend(ms);
            }
            (last, before) = (now, camera);
        }

        let teleport = self.teleport(&before, settling, floor)?;
        let scrolling_ms = statistics::median(&scrolling);
        let still_ms = statistics::median(&still);
        Ok(Row {
            world: case.world.name.clone(),
            cameras: case.cameras.iter().map(|c| c.name.clone()).collect(),
            layout: self.layout.name.clone(),
            settings: Setting::default(),
            probes: self.frame.field().volume().probes(),
            rays: self.probes.rays,
            metres: arguments.metres,
            speed: arguments.speed,
            settling,
            frames,
            change: change.irradiance.result(),
            change_at_rest: at_rest.irradiance.result(),
            displayed: change.displayed.result(),
            displayed_at_rest: at_rest.displayed.result(),
            scroll: Scroll {
                frames: scrolls,
                most_fresh,
                scrolling_ms,
                still_ms,
                ratio: scrolling_ms.zip(still_ms).map(|(a, b)| a / b),
            },
            teleport,
        })
    }

    /// Jumps to the camera that is farthest from `here`.
    fn teleport(&mut self, here: &Camera, settling: u32, floor: f64) -> Result<Teleport, Failure> {
        let distance = |camera: &&Camera| camera.position.distance_squared(here.position);
        let cameras = self.case.world.cameras.iter();
        let there = cameras.max_by(|a, b| distance(a).total_cmp(&distance(b)));
        let there = there.expect("a world has a camera").clone();
        self.step(&there)?;
        let fresh = self.frame.field().fresh();
        let jumped = self.settle(&there, settling)?;
        self.frame
            .replace_probes(self.gpu, self.layout, self.probes)?;
        self.step(&there)?;
        let started = self.settle(&there, settling)?;
        let mut difference = ChangeMeter::new(floor);
        difference.add(&started, &jumped).map_err(Failure::fault)?;
        Ok(Teleport {
            camera: there.name,
            fresh,
            difference: difference.result(),
        })
    }
}

fn lines(row: &Row) -> String {
    let cameras = row.cameras.join(" – ");
    let percent = |changes: &Changes| {
        let [median, p99, p999, max] =
            [changes.median, changes.p99, changes.p999, changes.max].map(|share| 100.0 * share);
        format!("median {median:.2} %  p99 {p99:.2} %  p99.9 {p999:.2} %  max {max:.1} %")
    };
    let ms = |ms: Option<f64>| ms.map_or("?".to_owned(), |ms| format!("{ms:.3} ms"));
    let scroll = &row.scroll;
    let ratio = scroll.ratio.map_or(String::new(), |ratio| {
        format!(", {:+.1} %", 100.0 * (ratio - 1.0))
    });
    format!(
        "{} · {cameras} · {} ({} probes, {} rays{}), {} m at {} m/s in {} frames\n\
         \x20 change in flight   {}\n\
         \x20 change at rest     {}\n\
         \x20 displayed, in flight   {}\n\
         \x20 displayed, at rest     {}\n\
         \x20 frames with new probes: {} (at most {} probes), {}; others {}{ratio}\n\
         \x20 after a jump to `{}` ({} of {} probes new), against a start there: {}\n",
        row.world,
        row.layout,
        row.probes,
        row.rays,
        row.settings.note(),
        row.metres,
        row.speed,
        row.frames,
        percent(&row.change),
        percent(&row.change_at_rest),
        percent(&row.displayed),
        percent(&row.displayed_at_rest),
        scroll.frames,
        scroll.most_fresh,
        ms(scroll.scrolling_ms),
        ms(scroll.still_ms),
        row.teleport.camera,
        row.teleport.fresh,
        row.probes,
        percent(&row.teleport.difference),
    )
}
