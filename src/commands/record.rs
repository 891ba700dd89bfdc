//! The `--json` of `render`, and of a row of a benchmark: what ran, and how fast.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::{
    frame::BuildReport,
    gpu::{AdapterSummary, Gpu, GpuError, PassTimes},
    measure::statistics,
    passes::{probes::ProbeField, scene::MemoryUse},
};

/// Fields in the order in which they are printed.
#[derive(Clone, Debug, Serialize)]
pub struct Record {
    pub world: String,
    pub camera: String,
    /// `null` where no probes were used.
    pub layout: Option<String>,
    /// As `--view` spells it.
    pub view: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Settling frames before the picture.
    pub frames: u32,
    pub adapter: AdapterSummary,
    pub fps: f64,
    pub frame_ms: FrameTimes,
    /// Median milliseconds of each pass.
    pub passes: BTreeMap<String, f64>,
    /// Rays in one frame.
    pub rays: Rays<u64>,
    pub mrays_per_s: Rays<f64>,
    pub probes: ProbeCounts,
    pub memory_bytes: MemoryUse,
    /// The cost of voxelising the world; `null` where the GPU did not voxelise it.
    pub build: Option<Build>,
}

/// How the world's voxels were built.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Build {
    /// GPU milliseconds; `null` where the adapter cannot time them.
    pub voxelise_ms: Option<f64>,
    pub distances_ms: Option<f64>,
    /// From start to end, without compiling but including the readback of counts.
    pub wall_ms: f64,
    pub bricks: u32,
    /// Peak GPU memory.
    pub peak_bytes: u64,
}

impl From<BuildReport> for Build {
    fn from(report: BuildReport) -> Self {
        Self {
            voxelise_ms: report.voxelise.gpu_ms,
            distances_ms: report.distances_ms,
            wall_ms: report.voxelise.wall_ms,
            bricks: report.voxelise.bricks,
            peak_bytes: report.voxelise.peak_bytes,
        }
    }
}

/// Milliseconds per frame, and the frames per second of the slowest 1 %.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct FrameTimes {
    pub median: f64,
    pub p99: f64,
    pub low1_fps: f64,
}

/// A figure for each kind of ray; `null` where there is none. Shadow rays are counted after the frames. They
/// share their passes with other work, so they have no rate of their own here: `grotto bench traversal`
/// measures it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Rays<T> {
    pub camera: Option<T>,
    pub shadow: Option<T>,
    pub probe: Option<T>,
    /// Rays of the final gather.
    pub face: Option<T>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ProbeCounts {
    /// All probes of the layout and their back-side probes: alive, sleeping and dead.
    pub total: u32,
    pub alive: u32,
    pub sleeping: u32,
    pub dead: u32,
    /// Probes updated in the last frame.
    pub updated: u32,
    /// How many of `total` are back-side probes, which the layout does not count.
    pub back_side: u32,
}

impl ProbeCounts {
    /// Counts the probes of a field that has been updated.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read(gpu: &Gpu, field: &ProbeField) -> Result<Self, GpuError> {
        let counts = field.state_counts(gpu)?;
        Ok(Self {
            total: counts.total(),
            alive: counts.alive,
            sleeping: counts.sleeping,
            dead: counts.dead,
            updated: counts.updated,
            back_side: counts.back_side,
        })
    }
}

impl FrameTimes {
    /// `None` if there is no frame.
    pub fn of(frames_ms: &[f64]) -> Option<Self> {
        Some(Self {
            median: statistics::median(frames_ms)?,
            p99: statistics::p99(frames_ms)?,
            low1_fps: statistics::low1_fps(frames_ms)?,
        })
    }

    /// Frames per second at the median.
    pub fn fps(&self) -> f64 {
        1e3 / self.median
    }
}

/// Milliseconds of the frames that were timed as a whole, or of all frames if none was.
pub fn frame_spans(frames: &[PassTimes]) -> Vec<f64> {
    let some_whole = frames.iter().any(|frame| frame.passes_ms.is_empty());
    frames
        .iter()
        .filter(|frame| !some_whole || frame.passes_ms.is_empty())
        .map(|frame| frame.frame_ms)
        .collect()
}

/// The median of each pass over the frames in which it ran.
pub fn median_passes(frames: &[PassTimes]) -> BTreeMap<String, f64> {
    let mut all: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for (label, &ms) in frames.iter().flat_map(|frame| &frame.passes_ms) {
        all.entry(label).or_default().push(ms);
    }
    all.into_iter()
        .filter_map(|(label, ms)| Some((label.to_owned(), statistics::median(&ms)?)))
        .collect()
}

/// Millions of rays a second, where both the count and a time above 0 are known.
pub fn mrays_per_s(rays: Option<u64>, ms: Option<f64>) -> Option<f64> {
    let ms = ms.filter(|&ms| ms > 0.0)?;
    Some(rays? as f64 / ms / 1e3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_known_frames() {
        let times = FrameTimes::of(&[2.0, 4.0, 6.0]).expect("three frames");
        assert_eq!(times.median, 4.0);
        assert_eq!(times.fps(), 250.0);
        assert!(FrameTimes::of(&[]).is_none());

        let frame = |ms: f64| PassTimes {
            passes_ms: [("view/shade".to_owned(), ms)].into(),
            frame_ms: ms,
        };
        let whole = PassTimes {
            frame_ms: 3.0,
            ..Default::default()
        };
        assert_eq!(frame_spans(&[frame(5.0), whole, frame(7.0)]), [3.0]);
        assert_eq!(frame_spans(&[frame(5.0), frame(7.0)]), [5.0, 7.0]);
        let passes = median_passes(&[frame(1.0), frame(9.0), frame(2.0)]);
        assert_eq!(passes["view/shade"], 2.0);

        assert_eq!(mrays_per_s(Some(2_000_000), Some(4.0)), Some(500.0));
        assert_eq!(mrays_per_s(Some(1), Some(0.0)), None);
        assert_eq!(mrays_per_s(None, Some(1.0)), None);
    }
}
