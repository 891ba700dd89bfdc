//! Distributes the frame times: to the panel, to the benchmark, and to the path tracer, which chooses its work
//! by them.

use super::{super::benchmark::Benchmark, Session};

impl Session {
    /// Takes the times of passes that have arrived. `frame_ms`: milliseconds since the last frame.
    pub(super) fn hear_times(&mut self, frame_ms: f64) {
        // Pass times of a software adapter are not GPU times: there only the wall clock counts.
        let is_gpu_time = !self.viewport.gpu.summary.is_software();
        while let Some(times) = self.timing.next_frame() {
            if !times.passes_ms.is_empty() {
                self.passes.push(&times);
            }
            if is_gpu_time {
                self.frame_took(times.frame_ms);
            }
            if is_gpu_time && let Some(run) = &mut self.benchmarks.running {
                run.gpu_took(times.frame_ms);
            }
            if let Some(reference_view) = self.viewport.reference_view() {
                reference_view.took(Some(&times), frame_ms);
            }
        }
        if !is_gpu_time || !self.timing.supported() {
            self.frame_came_after(frame_ms);
        }
        let benchmark = self.benchmarks.running.as_ref().map(Benchmark::status);
        let traced = self.viewport.reference_view().map(|reference_view| {
            if !self.timing.supported() {
                reference_view.took(None, frame_ms);
            }
            format!("path-traced: {} samples a pixel", reference_view.samples())
        });
        self.messages.status = benchmark.or(traced);
    }
}
