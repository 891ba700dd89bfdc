//! The inventory and the hotbar of the window: the input that goes to them.

use winit::event::{ElementState, MouseScrollDelta, WindowEvent};

use super::{Session, input::ESCAPE};
use crate::app::{controls::Action, input::Input};

/// Pixels of a touch pad that count as a notch of a wheel.
const PIXELS_PER_NOTCH: f32 = 40.0;

impl Session {
    /// Opens the inventory. The mouse is free, and keys that are down are released.
    pub(super) fn open_inventory(&mut self) {
        self.release_mouse();
        self.down.clear();
        self.give(Input::Focus(false));
        self.items.open(&self.play.hands.hotbar);
    }

    fn close_inventory(&mut self) {
        self.items.close();
        self.capture_mouse();
    }

    /// While the inventory is open, clicks and keys are its own; releases, sizes and focus are still passed on.
    pub(super) fn inventory_takes(&mut self, event: &WindowEvent) -> bool {
        if !self.items.is_open() {
            return false;
        }
        let press = match event {
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                self.press(event).filter(|_| !event.repeat)
            }
            WindowEvent::MouseWheel { .. } => None,
            WindowEvent::MouseInput { state, .. } if *state == ElementState::Pressed => None,
            _ => return false,
        };
        let _ = self.egui.on_window_event(&self.window, event);
        let is_typing = self.egui.egui_ctx().egui_wants_keyboard_input();
        let Some(press) = press else {
            return true;
        };
        if press.trigger == ESCAPE {
            self.close_inventory();
            return true;
        }
        if is_typing && !press.trigger.is_function_key() {
            return true;
        }
        match self.preferences.keys.pressed(press) {
            Some(Action::Inventory) => self.close_inventory(),
            Some(action @ (Action::Screenshot | Action::FullScreen | Action::Slot(_))) => {
                self.begin(action);
            }
            _ => {}
        }
        true
    }

    pub(super) fn scroll(&mut self, delta: &MouseScrollDelta) {
        let notches = match delta {
            MouseScrollDelta::LineDelta(_, lines) => *lines,
            MouseScrollDelta::PixelDelta(pixels) => pixels.y as f32 / PIXELS_PER_NOTCH,
        };
        if let Some(input) = self.items.scroll(notches) {
            self.give(input);
        }
    }
}
