//! Times of passes by label: from the GPU's own clock, or from the wall clock on software adapters.

use std::{
    collections::{BTreeMap, VecDeque},
    sync::Arc,
};

use wgpu_profiler::{GpuProfiler, GpuProfilerSettings, GpuTimerQueryResult};

use super::{Gpu, GpuError, dispatch_chunks::ChunkTime};

/// Milliseconds of each pass in one frame by label, in alphabetical order (empty if the frame was timed
/// as a whole), and the time from the first pass's start to the last pass's end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PassTimes {
    pub passes_ms: BTreeMap<String, f64>,
    pub frame_ms: f64,
}

/// No pass has this label.
pub(super) const WHOLE: &str = "";

/// Collects the times of passes over frames.
pub struct Timing {
    pub(super) clock: Clock,
    /// By the label of a pass: the chunk time that learns from its time, and its number of workgroups.
    pub(super) learning: BTreeMap<String, (Arc<ChunkTime>, u32)>,
}

pub(super) enum Clock {
    /// Timestamps, which never stall a frame.
    Gpu { profiler: GpuProfiler, period: f32 },
    /// A software adapter writes its timestamps late, not when the pass ran. It loses nothing by
    /// running one pass after the other, so each is submitted and waited for.
    Wall {
        current: PassTimes,
        finished: VecDeque<PassTimes>,
    },
    /// The adapter has no timestamps, and waiting for every pass would slow it down.
    None,
}

impl Timing {
    /// # Errors
    /// [`GpuError::Device`] if the profiler refuses its settings.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let clock = if gpu.summary.is_software() {
            Clock::Wall {
                current: PassTimes::default(),
                finished: VecDeque::new(),
            }
        } else if gpu.features.contains(wgpu::Features::TIMESTAMP_QUERY) {
            let settings = GpuProfilerSettings {
                max_num_pending_frames: 64,
                enable_debug_groups: false,
                ..Default::default()
            };
            Clock::Gpu {
                profiler: GpuProfiler::new(&gpu.device, settings)
                    .map_err(|error| GpuError::Device(error.to_string()))?,
                period: gpu.queue.get_timestamp_period(),
            }
        } else {
            Clock::None
        };
        Ok(Self {
            clock,
            learning: BTreeMap::new(),
        })
    }

    /// Whether passes of this adapter are timed at all.
    pub fn supported(&self) -> bool {
        !matches!(self.clock, Clock::None)
    }

    /// The oldest frame whose times have arrived.
    pub fn next_frame(&mut self) -> Option<PassTimes> {
        match &mut self.clock {
            Clock::Gpu { profiler, period } => {
                let results = profiler.process_finished_frame(*period)?;
                let times = PassTimes::of(&results);
                for (label, ms) in &times.passes_ms {
                    if let Some((chunk_time, groups)) = self.learning.get(label) {
                        chunk_time.learn(*groups, *ms);
                    }
                }
                Some(times)
            }
            Clock::Wall { finished, .. } => finished.pop_front(),
            Clock::None => None,
        }
    }
}

impl PassTimes {
    fn of(results: &[GpuTimerQueryResult]) -> Self {
        let mut times = Self::default();
        let (mut start, mut end) = (f64::MAX, f64::MIN);
        for result in results {
            if let Some(range) = &result.time {
                if result.label != WHOLE {
                    *times.passes_ms.entry(result.label.clone()).or_default() +=
                        (range.end - range.start) * 1e3;
                }
                start = start.min(range.start);
                end = end.max(range.end);
            }
        }
        if end > start {
            times.frame_ms = (end - start) * 1e3;
        }
        times
    }
}
