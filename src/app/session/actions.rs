//! What the user's actions do: a key, a button of the mouse or of a gamepad begins one and ends it.

use super::Session;
use crate::app::{
    controls::Action,
    hands::{
        brush::{Brush, Stroke},
        clipboard::Clip,
    },
    input::Input,
    menu::Occasion,
    texts::{bodies, toasts},
};

impl Session {
    /// An action begins.
    pub(super) fn begin(&mut self, action: Action) {
        if let Some(key) = action.player_key() {
            return self.give(Input::Press(key));
        }
        match action {
            Action::Dig => self.give(Input::Hold(Stroke::Dig)),
            Action::Place if self.play.hands.clipboard.is_active() => {
                self.give(Input::Clip(Clip::Cancel));
            }
            Action::Place => self.give(Input::Hold(Stroke::Place)),
            Action::Replace => self.give(Input::Hold(Stroke::Replace)),
            Action::BrushShape => self.set_brush(Brush {
                shape: self.settings.brush.shape.next(),
                ..self.settings.brush
            }),
            Action::SmallerBrush => self.set_brush(self.settings.brush.resized(-1.0)),
            Action::LargerBrush => self.set_brush(self.settings.brush.resized(1.0)),
            Action::Mark => self.give(Input::Clip(Clip::Mark)),
            Action::Paste => self.give(Input::Clip(Clip::Paste)),
            Action::Turn => self.give(Input::Clip(Clip::Turn)),
            Action::Air => self.give(Input::Clip(Clip::Air)),
            Action::Lift => self.lift(),
            Action::Settle => self.give(Input::Clip(Clip::Settle)),
            Action::Pick => self.give(Input::Stroke(Stroke::Pick)),
            Action::Undo => self.give(Input::Undo),
            Action::Redo => self.give(Input::Redo),
            Action::Slot(index) => self.give(Input::Slot(usize::from(index))),
            Action::Inventory => self.open_inventory(),
            Action::FlyFaster => self.give(Input::FlySpeed(1.0)),
            Action::FlySlower => self.give(Input::FlySpeed(-1.0)),
            Action::Camera(index) => self.give(Input::Camera(usize::from(index))),
            Action::PauseTime => self.settings.clock.paused = !self.settings.clock.paused,
            Action::Mute => self.toggle_mute(),
            Action::Save => self.save(),
            Action::Help => self.open_menu(Occasion::Pause),
            Action::Panel => {
                self.panel_open = !self.panel_open;
                if self.panel_open {
                    self.release_mouse();
                }
            }
            Action::Screenshot => self.screenshot_wanted = true,
            Action::Readout => self.readout_open = !self.readout_open,
            Action::Probes => self.next_probes(),
            Action::Benchmark => self.begin_benchmark(),
            Action::Reload => self.reload(true, true),
            Action::Reference => self.toggle_reference(),
            Action::FullScreen => self.toggle_full_screen(),
            // They are keys of the player.
            Action::Forward
            | Action::Left
            | Action::Back
            | Action::Right
            | Action::Up
            | Action::Down
            | Action::Run
            | Action::Fly
            | Action::NoClip => {}
        }
    }

    /// An action ends that lasts as long as its key is held.
    pub(super) fn end(&mut self, action: Action) {
        if let Some(key) = action.player_key() {
            return self.give(Input::Release(key));
        }
        match action {
            Action::Dig => self.give(Input::LetGo(Stroke::Dig)),
            Action::Place => self.give(Input::LetGo(Stroke::Place)),
            Action::Replace => self.give(Input::LetGo(Stroke::Replace)),
            _ => {}
        }
    }

    /// Lifts at once, or after the next frame, which says that the picture will stop.
    fn lift(&mut self) {
        match self.viewport.does_first_body_stop() {
            true => {
                self.messages.toast(bodies::IN_A_MOMENT);
                self.lifts_after_frame = true;
            }
            false => self.give(Input::Clip(Clip::Lift)),
        }
    }

    /// A frame was shown.
    pub(super) fn lift_after_frame(&mut self) {
        if std::mem::take(&mut self.lifts_after_frame) {
            self.give(Input::Clip(Clip::Lift));
        }
    }

    /// Changes the brush, and says what it is now.
    fn set_brush(&mut self, brush: Brush) {
        self.settings.brush = brush;
        self.messages.hint(toasts::brush(&brush));
    }

    fn toggle_mute(&mut self) {
        self.prefer(|preferences| preferences.muted = !preferences.muted);
        self.messages.hint(match self.play.sound.silence() {
            Some(reason) => toasts::silent(&reason),
            None => toasts::HEARD.to_owned(),
        });
    }

    /// Switches between light by probes and path tracing. World time is paused for path tracing: moving lamps
    /// would restart it at every frame.
    fn toggle_reference(&mut self) {
        let traced = !self.settings.choice.traced;
        self.settings.choice.traced = traced;
        if traced {
            self.settings.clock.paused = true;
            self.messages.hint(toasts::TRACED);
        }
    }
}
