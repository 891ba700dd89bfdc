//! `grotto play --replay FILE --out FOLDER`: a record as pictures and figures, without a window.

use std::{
    path::{Path, PathBuf},
    sync::atomic::Ordering,
    time::Instant,
};

use serde::Serialize;

use super::super::{
    Failure,
    options::RunOptions,
    output, stop,
    stress::storms::{Footprint, Process, steady_growth},
};
use crate::{
    app::{
        record::Record,
        replay::{LatencyFigures, Replay, ReplayOptions},
        sound::wav::WavFile,
    },
    gpu::{Gpu, GpuError},
    measure::{frame_times::FrameStatistics, picture_file, whole_file},
    world::{PlacedLamp, bodies::ChangedBodies},
};

/// Measurements of memory over a replay.
const SAMPLES: u64 = 240;

/// Frames before times count.
const WARM_UP: u64 = 60;

/// What a replay draws.
pub struct Film {
    /// Folder of the pictures.
    pub folder: PathBuf,
    /// Draw every N-th frame into a file; 0 for none.
    pub every: u64,
    /// File for what is heard.
    pub sound: Option<PathBuf>,
}

/// The `--json` of a replay.
#[derive(Serialize)]
struct Figures {
    world: String,
    frames: u64,
    pictures: u64,
    steps: u64,
    time_s: f64,
    eye: [f32; 3],
    yaw_deg: f32,
    pitch_deg: f32,
    /// CRC-32 of all voxels, in hexadecimal digits.
    voxels_crc32: String,
    /// In the order of placing.
    lamps: Vec<PlacedLamp>,
    /// Those that were placed or pushed.
    bodies: Vec<BodyFigures>,
    latency: LatencyFigures,
    /// Wall time from frame to frame (ms), and how much of it the CPU took to make each; without the first frames, which
    /// compile and warm up, and without those that became pictures. `null` for a short replay.
    frame_ms: Option<FrameStatistics>,
    cpu_ms: Option<FrameStatistics>,
    process_bytes: Growth,
    adapter_bytes: Growth,
}

#[derive(Serialize)]
struct BodyFigures {
    name: String,
    /// Its lowest corner if a player placed it, its pivot if it is of the world file (world space, voxels).
    position: [f32; 3],
    /// Extent of a placed one (voxels).
    size: Option<[u32; 3]>,
}

fn bodies_of(changes: &ChangedBodies) -> Vec<BodyFigures> {
    let placed = changes.placed.iter().map(|body| BodyFigures {
        name: body.name.clone(),
        position: body.corner.to_array(),
        size: Some(body.model.size.to_array()),
    });
    let moved = changes.moved.iter().map(|body| BodyFigures {
        name: body.name.clone(),
        position: body.position.to_array(),
        size: None,
    });
    placed.chain(moved).collect()
}

/// Memory after the first tenth of the frames and at the end.
#[derive(Serialize)]
struct Growth {
    start: u64,
    end: u64,
    /// Rise over the replay of a line through all samples between; 0 unless memory rises steadily.
    steady: u64,
}

impl Growth {
    /// Of samples: frames, bytes.
    fn of(samples: &[(f64, f64)]) -> Self {
        let bytes = |sample: Option<&(f64, f64)>| sample.map_or(0, |(_, bytes)| *bytes as u64);
        let settled = &samples[samples.len() / 10..];
        Self {
            start: bytes(settled.first()),
            end: bytes(settled.last()),
            steady: steady_growth(settled) as u64,
        }
    }
}

/// Plays a record, writes its pictures, and prints its figures.
pub fn run(
    record: Record,
    options: ReplayOptions<'_>,
    film: &Film,
    run: &RunOptions,
    gpu: Result<Gpu, GpuError>,
) -> Result<(), Failure> {
    whole_file::create_folder(&film.folder)?;
    let mut wav = film.sound.as_deref().map(WavFile::create).transpose()?;
    let stop = stop::at_ctrl_c(run);
    let gpu = output::usable(run, gpu)?;
    let world = options.world.name.clone();
    let mut replay = Replay::new(gpu, record, options)?;
    let length = replay.length();
    let bar = output::progress(run, "frames", length);
    let mut process = Process::this();
    let (mut process_bytes, mut adapter_bytes) = (Vec::new(), Vec::new());
    let mut pictures = 0;
    let (mut frames_ms, mut making_ms) = (Vec::new(), Vec::new());
    let mut last_end = Instant::now();
    for frame in 1..=length {
        if stop.load(Ordering::Relaxed) {
            bar.finish_and_clear();
            return Err(Failure::interrupted(format!(
                "stopped after {} of {length} frames; the pictures so far are in {}",
                frame - 1,
                film.folder.display()
            )));
        }
        replay.next_frame()?;
        for error in replay.take_errors() {
            bar.suspend(|| output::note(run, &format!("frame {frame}: {error}")));
        }
        if let Some(wav) = &mut wav {
            wav.add(replay.heard())?;
        }
        let is_drawn = film.every > 0 && frame.is_multiple_of(film.every);
        if frame > WARM_UP && !is_drawn {
            frames_ms.push(last_end.elapsed().as_secs_f64() * 1e3);
            making_ms.push(replay.making().as_secs_f64() * 1e3);
        }
        if is_drawn {
            picture_file::write_png(&picture_path(&film.folder, frame), &replay.picture()?)?;
            pictures += 1;
        }
        if frame.is_multiple_of(length.div_ceil(SAMPLES)) {
            let at = frame as f64;
            process_bytes.push((at, process.bytes() as f64));
            adapter_bytes.push((at, Footprint::of(replay.gpu()).bytes as f64));
        }
        bar.inc(1);
        last_end = Instant::now();
    }
    replay.finish()?;
    bar.finish_and_clear();
    if let Some(wav) = wav {
        wav.finish()?;
    }
    let state = replay.state()?;
    let figures = Figures {
        world,
        frames: state.frames,
        pictures,
        steps: state.steps,
        time_s: state.time_s,
        eye: state.camera.position.to_array(),
        yaw_deg: state.camera.yaw_deg,
        pitch_deg: state.camera.pitch_deg,
        voxels_crc32: format!("{:08x}", state.voxels_crc32),
        lamps: state.lamps,
        bodies: bodies_of(&state.bodies),
        latency: state.latency,
        frame_ms: FrameStatistics::of(&frames_ms),
        cpu_ms: FrameStatistics::of(&making_ms),
        process_bytes: Growth::of(&process_bytes),
        adapter_bytes: Growth::of(&adapter_bytes),
    };
    if run.json {
        return output::print_json(&figures);
    }
    let [x, y, z] = figures.eye;
    output::print(&format!(
        "{} frames, {} steps, {:.2} s; {} pictures\n\
         eye {x} {y} {z}, yaw {}°, pitch {}°, voxels {}, {} placed lamps, {} bodies placed or pushed\n\
         {} inputs seen {:.2} frames late on average, at most {}; {} lost; {} without effect at once\n\
         {}\
         memory {:.1} MB at first, {:.1} MB at the end, {:.1} MB of steady growth\n",
        figures.frames,
        figures.steps,
        figures.time_s,
        figures.pictures,
        figures.yaw_deg,
        figures.pitch_deg,
        figures.voxels_crc32,
        figures.lamps.len(),
        figures.bodies.len(),
        figures.latency.inputs,
        figures.latency.mean_frames,
        figures.latency.most_frames,
        figures.latency.lost,
        figures.latency.without_effect,
        times(figures.frame_ms.as_ref(), figures.cpu_ms.as_ref()),
        megabytes(figures.process_bytes.start),
        megabytes(figures.process_bytes.end),
        megabytes(figures.process_bytes.steady),
    ))
}

/// A line about how long frames took.
fn times(frame_ms: Option<&FrameStatistics>, cpu_ms: Option<&FrameStatistics>) -> String {
    let Some((frame, cpu)) = frame_ms.zip(cpu_ms) else {
        return String::new();
    };
    format!(
        "{:.2} ms a frame, 99th percentile {:.2}; making one takes the CPU {:.2} ms, 99th percentile {:.2}\n",
        frame.median, frame.p99, cpu.median, cpu.p99
    )
}

fn megabytes(bytes: u64) -> f64 {
    bytes as f64 / 1e6
}

/// Numbered so that every program sorts the pictures by time.
fn picture_path(folder: &Path, frame: u64) -> PathBuf {
    folder.join(format!("frame-{frame:06}.png"))
}
