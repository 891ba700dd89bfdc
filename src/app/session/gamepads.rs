//! Gamepads steer the player as keys do: their events become the same inputs.

use std::time::Duration;

use super::Session;
use crate::app::{controls::Action, gamepad::Effect, input::Input};

impl Session {
    /// Takes what gamepads did since the last frame. A window that is not in use lets it pass.
    pub(super) fn hear_gamepads(&mut self, elapsed: Duration) {
        let Some(gamepads) = &mut self.gamepads else {
            return;
        };
        let events = gamepads.events();
        let mut effects = Vec::new();
        for (pad, event) in events {
            effects.extend(gamepads.pads.take(pad, event));
        }
        let is_watching = self.benchmarks.running.is_some() || self.menu.is_some();
        if !self.focused || is_watching {
            gamepads.pads.release();
            // Only the way out of the menu is left.
            if self.focused && effects.contains(&Effect::Begin(Action::Help)) {
                self.leave_menu();
            }
            return;
        }
        let look = gamepads.pads.look(elapsed);
        for effect in effects {
            match effect {
                Effect::Begin(action) => {
                    self.begin(action);
                    if self.menu.is_none() && !self.panel_open {
                        self.capture_mouse();
                    }
                }
                // A key may hold it as well.
                Effect::End(action) if self.down.values().any(|held| *held == action) => {}
                Effect::End(action) => self.end(action),
            }
        }
        if let Some(pixels) = look {
            let (right, down) = self.preferences.look(pixels);
            self.give(Input::Look(right, down));
        }
    }
}
