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
    /// By the label of a pass.
    learning: BTreeMap<String, PassLearning>,
    /// Frames that were begun.
    frames: u64,
}

/// The kernels of a pass, whose chunk times learn from its time.
#[derive(Default)]
struct PassLearning {
    /// The last frame that recorded the pass.
    frame: u64,
    /// With their numbers of workgroups.
    kernels: Vec<(Arc<ChunkTime>, u32)>,
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
            frames: 0,
        })
    }

    /// Counts the frame that begins to be recorded.
    pub(super) fn begun(&mut self) -> &mut Self {
        self.frames += 1;
        self
    }

    /// Notes that the frame runs `groups` workgroups of a kernel with this chunk time in the pass with this label.
    pub(super) fn teach(&mut self, label: &str, chunk_time: &Arc<ChunkTime>, groups: u32) {
        let pass = self.learning.entry(label.to_owned()).or_default();
        if pass.frame != self.frames {
            pass.frame = self.frames;
            pass.kernels.clear();
        }
        pass.kernels.push((chunk_time.clone(), groups));
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
                    if let Some(pass) = self.learning.get(label) {
                        pass.learn(*ms);
                    }
                }
                Some(times)
            }
            Clock::Wall { finished, .. } => finished.pop_front(),
            Clock::None => None,
        }
    }
}

impl PassLearning {
    /// How the kernels share the time of the pass is not known: a workgroup of each counts alike.
    fn learn(&self, ms: f64) {
        let groups = self.kernels.iter().map(|(_, groups)| groups).sum();
        for (chunk_time, _) in &self.kernels {
            chunk_time.learn(groups, ms);
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

#[cfg(test)]
mod tests {
    use super::{super::dispatch_chunks::DispatchChunks, *};

    #[test]
    fn all_kernels_of_a_pass_learn_from_its_time_and_none_of_earlier_frames() {
        let mut timing = Timing {
            clock: Clock::None,
            learning: BTreeMap::new(),
            frames: 0,
        };
        let [before, large, small]: [Arc<ChunkTime>; 3] = Default::default();
        timing.begun();
        timing.teach("pass", &before, 1000);
        timing.begun();
        timing.teach("pass", &large, 30);
        timing.teach("pass", &small, 10);
        // The first measurement is ignored. A workgroup takes 2 ms, and a dispatch may take 20.
        for _ in 0..2 {
            timing.learning["pass"].learn(80.0);
        }
        assert!(before.is_due());
        for kernel in [&large, &small] {
            assert_eq!(
                DispatchChunks::new(kernel, [1, 100], 512).next(),
                Some(0..10)
            );
        }
    }
}
