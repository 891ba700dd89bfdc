//! User input to the window: keys and mouse steer the camera or go to the panel.

use winit::{
    event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, WindowEvent},
    keyboard::{KeyCode, PhysicalKey},
    window::CursorGrabMode,
};

use super::{
    super::{
        controls::{Action, Press, Trigger},
        input::Input,
    },
    Session,
};

/// It leads out of everything, and belongs to no action.
pub(super) const ESCAPE: Trigger = Trigger::Key(KeyCode::Escape);

impl Session {
    /// The mouse was moved by this many pixels, right and down.
    pub fn mouse_moved(&mut self, pixels: (f64, f64)) {
        if self.captured {
            let (right, down) = self.preferences.look(pixels);
            self.give(Input::Look(right, down));
        }
    }

    /// Handles any event except requests to close or to draw.
    pub fn event(&mut self, event: &WindowEvent) {
        if self.benchmark_takes(event) || self.menu_takes(event) {
            return;
        }
        // The panel ignores input that steers the camera, but it must receive releases.
        let steers = match event {
            WindowEvent::CursorMoved { .. } | WindowEvent::MouseWheel { .. } => true,
            WindowEvent::MouseInput { state, .. }
            | WindowEvent::KeyboardInput {
                event: KeyEvent { state, .. },
                ..
            } => *state == ElementState::Pressed,
            _ => false,
        };
        if !(self.captured && steers) {
            let _ = self.egui.on_window_event(&self.window, event);
        }
        match event {
            WindowEvent::Resized(size) => self.screen.resize([size.width, size.height]),
            WindowEvent::Focused(focused) => {
                self.focused = *focused;
                // Frames before and after a change of pace do not belong to the same statistics.
                self.rate.clear();
                if !focused {
                    self.release_mouse();
                    self.down.clear();
                }
                self.give(Input::Focus(*focused));
            }
            WindowEvent::Occluded(occluded) => {
                self.occluded = *occluded;
                self.hidden = *occluded;
            }
            WindowEvent::KeyboardInput { event, .. } => self.key(event),
            WindowEvent::MouseInput { state, button, .. } => {
                let press = Press::of_button(*button, self.modifiers);
                match state {
                    ElementState::Pressed => self.clicked(press),
                    ElementState::Released => self.released(press.trigger),
                }
            }
            WindowEvent::ModifiersChanged(modifiers) => self.modifiers = modifiers.state(),
            WindowEvent::MouseWheel { delta, .. } if self.captured || !self.over_panel() => {
                let notches = match delta {
                    MouseScrollDelta::LineDelta(_, lines) => *lines,
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y as f32 / 40.0,
                };
                self.give(Input::Wheel(notches));
            }
            _ => {}
        }
    }

    /// While the menu is open all input is its own; releases, sizes and focus are still passed on.
    fn menu_takes(&mut self, event: &WindowEvent) -> bool {
        if let WindowEvent::DroppedFile(path) = event {
            self.dropped(path);
            return true;
        }
        if self.key_page_takes(event) {
            return true;
        }
        let (pressed, press) = match event {
            WindowEvent::KeyboardInput { event, .. } => {
                let pressed = event.state == ElementState::Pressed;
                let press = self.press(event).filter(|_| pressed && !event.repeat);
                (pressed, press)
            }
            WindowEvent::MouseInput { state, .. } => (*state == ElementState::Pressed, None),
            WindowEvent::MouseWheel { .. } => (true, None),
            _ => (false, None),
        };
        if self.menu.is_none() || !pressed {
            return false;
        }
        let _ = self.egui.on_window_event(&self.window, event);
        if let Some(press) = press.filter(|press| press.trigger.is_function_key()) {
            match self.preferences.keys.pressed(press) {
                _ if press.trigger == ESCAPE => self.leave_menu(),
                Some(Action::Help) => self.leave_menu(),
                Some(action @ (Action::Screenshot | Action::FullScreen)) => self.begin(action),
                _ => {}
            }
        }
        true
    }

    /// While the page of keys waits for a key, the next one is it. A modifier counts when it goes up alone, for until then
    /// it may belong to another key.
    fn key_page_takes(&mut self, event: &WindowEvent) -> bool {
        let press = match event {
            WindowEvent::KeyboardInput { event, .. } => self.press(event).filter(|press| {
                let goes_up = event.state == ElementState::Released;
                !event.repeat && press.trigger.is_modifier() == goes_up
            }),
            WindowEvent::MouseInput {
                state: ElementState::Pressed,
                button,
                ..
            } => Some(Press::of_button(*button, self.modifiers)),
            _ => return false,
        };
        let waiting = self.menu.as_mut().filter(|menu| menu.keys.waits());
        let Some(menu) = waiting else {
            return false;
        };
        match press {
            Some(press) if press.trigger == ESCAPE => menu.keys.leave(),
            Some(press) => menu.keys.take(press.chord(), &mut self.preferences.keys),
            None => {}
        }
        true
    }

    pub(super) fn press(&self, event: &KeyEvent) -> Option<Press> {
        match event.physical_key {
            PhysicalKey::Code(code) => {
                Some(Press::of_key(code, &event.logical_key, self.modifiers))
            }
            PhysicalKey::Unidentified(_) => None,
        }
    }

    /// A button of the mouse went down. The first click into the picture only takes the mouse.
    fn clicked(&mut self, press: Press) {
        if self.captured {
            self.pressed(press);
        } else if press.trigger == Trigger::Mouse(MouseButton::Left) && !self.over_panel() {
            self.capture_mouse();
        }
    }

    fn pressed(&mut self, press: Press) {
        if let Some(action) = self.preferences.keys.pressed(press) {
            self.down.insert(press.trigger, action);
            self.begin(action);
        }
    }

    /// A key or a button went up: what it began ends, unless another key still holds it.
    fn released(&mut self, trigger: Trigger) {
        if let Some(action) = self.down.remove(&trigger)
            && !self.down.values().any(|held| *held == action)
        {
            self.end(action);
        }
    }

    fn over_panel(&self) -> bool {
        let context = self.egui.egui_ctx();
        !self.captured && (context.is_pointer_over_egui() || context.egui_is_using_pointer())
    }

    fn key(&mut self, event: &KeyEvent) {
        let Some(press) = self.press(event) else {
            return;
        };
        if event.state == ElementState::Released {
            return self.released(press.trigger);
        }
        if press.trigger == ESCAPE {
            return self.begin(Action::Help);
        }
        // The user types a number into the panel.
        let is_typing = !self.captured && self.egui.egui_ctx().egui_wants_keyboard_input();
        if is_typing && !press.trigger.is_function_key() {
            return;
        }
        if !event.repeat
            || self
                .preferences
                .keys
                .pressed(press)
                .is_some_and(Action::repeats)
        {
            self.pressed(press);
        }
    }

    pub(super) fn capture_mouse(&mut self) {
        // If neither mode is available, the mouse still turns the camera.
        let _ = self
            .window
            .set_cursor_grab(CursorGrabMode::Locked)
            .or_else(|_| self.window.set_cursor_grab(CursorGrabMode::Confined));
        self.window.set_cursor_visible(false);
        self.captured = true;
        let input = self.egui.egui_input_mut();
        input.events.push(egui::Event::PointerGone);
    }

    pub(super) fn release_mouse(&mut self) {
        if self.captured {
            // Releasing a grab that was never obtained fails.
            let _ = self.window.set_cursor_grab(CursorGrabMode::None);
            self.window.set_cursor_visible(true);
            self.captured = false;
            let held: Vec<Trigger> = self.down.keys().copied().collect();
            for trigger in held {
                if matches!(trigger, Trigger::Mouse(_)) {
                    self.released(trigger);
                }
            }
        }
    }
}
