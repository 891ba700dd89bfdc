//! What the times of frames are good for: the panel's figures, and how much the path tracer may do.

use super::Session;

impl Session {
    /// Hears the times of passes that have arrived. `frame_ms`: milliseconds since the last frame.
    pub(super) fn hear_times(&mut self, frame_ms: f64) {
        while let Some(times) = self.timing.next_frame() {
            if !times.passes_ms.is_empty() {
                self.passes.push(&times);
            }
            if let Some(truth) = self.show.truth() {
                truth.took(Some(&times), frame_ms);
            }
        }
        self.messages.status = self.show.truth().map(|truth| {
            if !self.timing.supported() {
                truth.took(None, frame_ms);
            }
            format!("path-traced: {} samples a pixel", truth.samples())
        });
    }
}
