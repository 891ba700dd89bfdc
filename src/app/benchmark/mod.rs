//! The benchmark of the window (F4): flies the same course in the same steps of world time, and measures its
//! frame times.

mod course;
mod summary;

use std::time::{Duration, Instant};

pub use course::Course;
pub use summary::{Summary, Surroundings};

use super::clock::WorldClock;
use crate::world::Camera;

/// Seconds of world time that are measured.
const MEASURED_S: u32 = 20;
/// The same on a software adapter, which draws only a few frames a second.
const SOFTWARE_MEASURED_S: u32 = 4;
/// Frames per second of world time, however long each frame takes to draw.
const FRAMES_PER_SECOND: u32 = 60;
/// Frames before measuring starts: the probes settle, and the GPU raises its clock.
const WARM_UP_FRAMES: u32 = 30;
const WARM_UP: Duration = Duration::from_millis(500);

/// Settings that the benchmark changes and restores at its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Before {
    pub camera: Camera,
    pub clock: WorldClock,
}

/// What the next frame is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    WarmUp,
    /// This frame is the first that is measured: see [`Benchmark::start_counting`].
    WarmedUp,
    Counting,
    /// All frames are drawn.
    Over,
}

/// A running benchmark.
pub struct Benchmark {
    course: Course,
    before: Before,
    /// Seconds of world time that are measured.
    seconds: u32,
    voxel_m: f32,
    begun: Instant,
    warm_frames: u32,
    counting: bool,
    /// Frames presented since measuring began.
    counted: u32,
    /// When the last measured frame began; `None` if the time since then belongs to no frame.
    last: Option<Instant>,
    wall_ms: Vec<f64>,
    gpu_ms: Vec<f64>,
}

impl Benchmark {
    pub fn new(course: Course, before: Before, voxel_m: f32, software: bool, now: Instant) -> Self {
        Self {
            course,
            before,
            seconds: if software {
                SOFTWARE_MEASURED_S
            } else {
                MEASURED_S
            },
            voxel_m,
            begun: now,
            warm_frames: 0,
            counting: false,
            counted: 0,
            last: None,
            wall_ms: Vec::new(),
            gpu_ms: Vec::new(),
        }
    }

    fn frames(&self) -> u32 {
        self.seconds * FRAMES_PER_SECOND
    }

    /// A frame begins: the time since the last frame began is the duration of that frame.
    pub fn begin_frame(&mut self, now: Instant) -> Phase {
        if let Some(last) = self.last.take() {
            let elapsed = now.saturating_duration_since(last);
            self.wall_ms.push(elapsed.as_secs_f64() * 1e3);
        }
        if !self.counting {
            let is_warm = self.warm_frames >= WARM_UP_FRAMES
                && now.saturating_duration_since(self.begun) >= WARM_UP;
            return if is_warm {
                Phase::WarmedUp
            } else {
                Phase::WarmUp
            };
        }
        if self.counted >= self.frames() {
            return Phase::Over;
        }
        self.last = Some(now);
        Phase::Counting
    }

    /// Frames are measured from now on. The GPU must be idle.
    pub fn start_counting(&mut self, now: Instant) {
        self.counting = true;
        self.last = Some(now);
    }

    pub fn is_counting(&self) -> bool {
        self.counting
    }

    /// The frame that began was presented.
    pub fn presented(&mut self) {
        if self.counting {
            self.counted += 1;
        } else {
            self.warm_frames += 1;
        }
    }

    /// The frame that began was not presented, and the time since then belongs to no frame.
    pub fn interrupt(&mut self) {
        self.last = None;
    }

    /// The next measured frame took the GPU this many milliseconds.
    pub fn gpu_took(&mut self, ms: f64) {
        if self.counting {
            self.gpu_ms.push(ms);
        }
    }

    /// World time of the frame (seconds). It starts at 0, so that lamps move alike in every run.
    pub fn time_s(&self) -> f64 {
        f64::from(self.counted) / f64::from(FRAMES_PER_SECOND)
    }

    pub fn camera(&self) -> Camera {
        let total_s = f64::from(self.seconds);
        self.course.at(self.time_s(), total_s, self.voxel_m)
    }

    /// For a person, while it runs.
    pub fn status(&self) -> String {
        if self.counting {
            format!(
                "Benchmark: {:.0} of {} s, Esc stops",
                self.time_s().floor(),
                self.seconds
            )
        } else {
            "Benchmark: warming up, Esc stops".to_owned()
        }
    }

    /// What it changed, and the summary of its frames: `None` if none was measured.
    pub fn end(self, surroundings: Surroundings) -> (Before, Option<Summary>) {
        let flight = if self.counted >= self.frames() {
            format!("{} s {}", self.seconds, self.course.describe())
        } else {
            format!(
                "stopped after {:.1} of {} s {}",
                self.time_s(),
                self.seconds,
                self.course.describe()
            )
        };
        let summary = Summary::new(flight, self.wall_ms, self.gpu_ms, surroundings);
        (self.before, summary)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn before() -> Before {
        Before {
            camera: Camera {
                name: "here".into(),
                position: Vec3::new(1.0, 2.0, 3.0),
                yaw_deg: 10.0,
                pitch_deg: 20.0,
                fov_deg: 70.0,
            },
            clock: WorldClock {
                time_s: 42.0,
                paused: true,
                rate: 0.5,
            },
        }
    }

    fn benchmark(now: Instant) -> Benchmark {
        let course = Course::Turn(before().camera);
        Benchmark::new(course, before(), 1.0, true, now)
    }

    /// Draws frames of 20 ms until it is over or `most` were presented. Returns the cameras and times of the
    /// measured frames.
    fn run(most: u32) -> (Benchmark, Vec<(Camera, f64)>) {
        let mut now = Instant::now();
        let mut benchmark = benchmark(now);
        let mut seen = Vec::new();
        for _ in 0..most {
            now += Duration::from_millis(20);
            match benchmark.begin_frame(now) {
                Phase::Over => break,
                Phase::WarmedUp => benchmark.start_counting(now),
                Phase::WarmUp | Phase::Counting => {}
            }
            if benchmark.counting {
                seen.push((benchmark.camera(), benchmark.time_s()));
            }
            benchmark.presented();
            benchmark.gpu_took(5.0);
        }
        (benchmark, seen)
    }

    #[test]
    fn all_frames_count_once_and_everything_is_given_back() {
        let (benchmark, seen) = run(10_000);
        assert_eq!(seen.len(), 240);
        assert_eq!(benchmark.warm_frames, 30);
        assert_eq!(
            (benchmark.wall_ms.len(), benchmark.gpu_ms.len()),
            (240, 240)
        );
        assert!(benchmark.wall_ms.iter().all(|ms| (ms - 20.0).abs() < 1e-9));
        assert_eq!(seen[0], (before().camera, 0.0));
        assert!((seen[120].0.yaw_deg + 170.0).abs() < 1e-3, "half a turn");
        let (after, summary) = benchmark.end(Surroundings::default());
        assert_eq!(after, before());
        let summary = summary.expect("frames").text();
        assert!(summary.contains("4 s around on the spot"), "{summary}");
        assert!(summary.contains("240 frames"), "{summary}");
    }

    #[test]
    fn every_run_flies_the_same() {
        assert_eq!(run(10_000).1, run(10_000).1);
    }

    #[test]
    fn stopped_early_it_says_so_and_in_the_warm_up_nothing() {
        let (benchmark, _) = run(30 + 60);
        assert_eq!(benchmark.status(), "Benchmark: 1 of 4 s, Esc stops");
        let (after, summary) = benchmark.end(Surroundings::default());
        assert_eq!(after, before());
        let summary = summary.expect("59 whole frames").text();
        assert!(summary.contains("stopped after 1.0 of 4 s"), "{summary}");
        let (benchmark, _) = run(9);
        assert!(benchmark.status().contains("warming up"));
        let (after, summary) = benchmark.end(Surroundings::default());
        assert_eq!(after, before());
        assert!(summary.is_none());
    }

    #[test]
    fn what_was_not_presented_is_no_frame() {
        let start = Instant::now();
        let after = |ms| start + Duration::from_millis(ms);
        let mut benchmark = benchmark(start);
        benchmark.start_counting(after(0));
        benchmark.presented();
        assert_eq!(benchmark.begin_frame(after(10)), Phase::Counting);
        benchmark.interrupt();
        assert_eq!(benchmark.begin_frame(after(5000)), Phase::Counting);
        benchmark.presented();
        assert_eq!(benchmark.begin_frame(after(5030)), Phase::Counting);
        assert_eq!(benchmark.counted, 2);
        assert_eq!(benchmark.wall_ms, [10.0, 30.0]);
    }
}
