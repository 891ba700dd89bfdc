//! Applies the user's choices to the viewport.

use clap::ValueEnum as _;

use super::Session;
use crate::{
    app::{texts::toasts, views::name},
    parameters::Remake,
    passes::view::{Inspection, ProbeColour},
};

impl Session {
    /// Applies the settings: cheap changes at once, others when the mouse button is released.
    pub(super) fn apply_settings(&mut self) {
        let dragging = self.egui.egui_ctx().input(|input| input.pointer.any_down());
        let minimised = self.screen.size().contains(&0);
        let mut next = self.settings.choice.clone();
        next.size = if dragging || minimised {
            self.viewport.choice().size
        } else {
            self.screen.size()
        };
        let shown = self.viewport.choice();
        let remake = shown.parameters.remake_for(&next.parameters);
        if next == *shown || (dragging && remake != Remake::Nothing) {
            return;
        }
        match self.viewport.apply(next) {
            Ok(true) => {
                self.abandon_benchmark(toasts::OTHER_SIZE);
                self.remade();
            }
            Ok(false) => {}
            Err(error) => {
                self.messages.toast_error(error.to_string());
            }
        }
        // Choices that the world lacks or the adapter cannot hold are reverted.
        self.settings.choice = self.viewport.choice().clone();
    }

    /// Applies the choice of the view and of the probes in it. A choice that cannot be shown is reverted.
    pub(super) fn inspect_probes(&mut self) {
        if let Err(error) = self.viewport.inspect(&mut self.settings.inspection) {
            self.messages.toast_error(error.to_string());
            self.settings.inspection = Inspection::default();
        }
    }

    /// Steps from no probes in the picture through all their colourings, and back to no probes.
    pub(super) fn next_probes(&mut self) {
        let inspection = &mut self.settings.inspection;
        inspection.atlas = None;
        inspection.probes = after(inspection.probes);
        self.messages.toast(match inspection.probes {
            Some(colour) => toasts::probes_by(&name(&colour)),
            None => toasts::NO_PROBES.to_owned(),
        });
    }
}

fn after(shown: Option<ProbeColour>) -> Option<ProbeColour> {
    let all = ProbeColour::value_variants();
    let at = shown.and_then(|shown| all.iter().position(|colour| *colour == shown));
    all.get(at.map_or(0, |at| at + 1)).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_key_goes_round_through_all_colours() {
        let mut shown = None;
        let mut seen = Vec::new();
        for _ in ProbeColour::value_variants() {
            shown = after(shown);
            seen.push(shown.expect("a colour"));
        }
        assert_eq!(seen, ProbeColour::value_variants());
        assert_eq!(after(shown), None);
    }
}
