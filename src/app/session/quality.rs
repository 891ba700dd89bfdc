//! Holds the frame time that the user chose.

use super::Session;
use crate::{
    app::{
        Options,
        quality::{Auto, Preset},
    },
    parameters::Parameters,
};

/// The parameters of a window that opens: those of the preset, and over them what was set by hand. A replay has those of
/// its record.
pub(super) fn parameters_at_start(options: &Options, preset: Preset) -> Parameters {
    let mut parameters = options.parameters.clone();
    if options.replay.is_none() {
        preset.apply(&mut parameters);
        for assignment in &options.set {
            // A save may name keys of another version; notes of the world say so.
            let _ = parameters.set(assignment);
        }
    }
    parameters
}

impl Session {
    /// Whether the effort may change now. A benchmark compares its frames with each other, the path-traced reference
    /// would begin again, and a replay shows what was recorded.
    fn holds_frame_time(&self) -> bool {
        self.settings.auto
            && self.benchmarks.running.is_none()
            && !self.viewport.choice().traced
            && !self.play.is_replay()
    }

    /// A frame took so many milliseconds.
    pub(super) fn frame_took(&mut self, ms: f64) {
        if self.holds_frame_time() && self.pause().is_none() {
            self.auto.frame(ms);
        } else {
            self.auto.interrupt();
        }
    }

    /// Draws the next frame with the effort that the last ones allow.
    pub(super) fn hold_frame_time(&mut self) {
        if self.settings.auto {
            self.auto.target_ms = self.settings.target_ms;
        } else {
            self.auto = Auto::new(self.settings.target_ms);
        }
        let effort = self.auto.effort();
        let may_change = !self.settings.auto || self.holds_frame_time();
        if !may_change || effort == self.viewport.effort() {
            return;
        }
        if let Err(error) = self.viewport.make(effort) {
            self.messages.toast_error(error.to_string());
            self.settings.auto = false;
        }
    }
}
