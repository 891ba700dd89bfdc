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
    let parameters = options.parameters.clone();
    if options.replay.is_some() {
        return parameters;
    }
    let continued = options.saves.continued.as_ref();
    let saved = continued.into_iter().flat_map(|(_, save)| &save.state.set);
    over_preset(parameters, preset, saved.chain(&options.set))
}

/// Parameters with those of a preset, and over them what was set by hand (`KEY=VALUE`).
pub(super) fn over_preset<'a>(
    mut parameters: Parameters,
    preset: Preset,
    set: impl IntoIterator<Item = &'a String>,
) -> Parameters {
    preset.apply(&mut parameters);
    for assignment in set {
        // A save may name keys of another version; notes of the world say so.
        let _ = parameters.set(assignment);
    }
    parameters
}

/// Frames that come after less than this multiple of the interval of the user's limit come at the limit.
const LIMITED: f64 = 1.1;

impl Session {
    /// Whether the effort may change now. A benchmark compares its frames with each other, the path-traced reference
    /// would begin again, and a replay shows what was recorded.
    fn holds_frame_time(&self) -> bool {
        self.settings.auto
            && (self.focused || self.counted)
            && self.benchmarks.running.is_none()
            && !self.viewport.choice().traced
            && !self.play.is_replay()
    }

    /// A frame began so many milliseconds after the last, where nothing else tells how long frames take. What the
    /// user's limit makes of it says nothing.
    pub(super) fn frame_came_after(&mut self, ms: f64) {
        let is_limited = self
            .interval()
            .is_some_and(|interval| ms <= LIMITED * 1e3 * interval.as_secs_f64());
        if !is_limited {
            self.frame_took(ms);
        }
    }

    /// A frame took so many milliseconds.
    pub(super) fn frame_took(&mut self, ms: f64) {
        if self.holds_frame_time() {
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
