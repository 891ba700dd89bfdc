//! User input to the window: keys and mouse steer the camera or go to the panel.

use winit::{
    event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, WindowEvent},
    keyboard::{KeyCode, PhysicalKey},
    window::CursorGrabMode,
};

use super::{
    super::{
        controls::{Shortcut, player_key, shortcut},
        hands::brush::Stroke,
        input::Input,
        menu::Occasion,
    },
    Session,
};

impl Session {
    /// The mouse was moved by this many pixels, right and down.
    pub fn mouse_moved(&mut self, (right, down): (f64, f64)) {
        if self.captured {
            self.give(Input::Look(right as f32, down as f32));
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
                self.give(Input::Focus(*focused));
                if !focused {
                    self.release_mouse();
                }
            }
            WindowEvent::Occluded(occluded) => {
                self.occluded = *occluded;
                self.hidden = *occluded;
            }
            WindowEvent::KeyboardInput { event, .. } => self.key(event),
            WindowEvent::MouseInput { state, button, .. } => match state {
                ElementState::Pressed => self.clicked(*button),
                ElementState::Released => self.let_go(*button),
            },
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
        let (pressed, key) = match event {
            WindowEvent::KeyboardInput { event, .. } => {
                let pressed = event.state == ElementState::Pressed;
                let key = match event.physical_key {
                    PhysicalKey::Code(code) if pressed && !event.repeat => Some(code),
                    _ => None,
                };
                (pressed, key)
            }
            WindowEvent::MouseInput { state, .. } => (*state == ElementState::Pressed, None),
            WindowEvent::MouseWheel { .. } => (true, None),
            _ => (false, None),
        };
        if self.menu.is_none() || !pressed {
            return false;
        }
        let _ = self.egui.on_window_event(&self.window, event);
        match key {
            Some(KeyCode::Escape | KeyCode::F1) => self.leave_menu(),
            Some(KeyCode::F2) => self.screenshot_wanted = true,
            Some(KeyCode::F11) => self.toggle_full_screen(),
            _ => {}
        }
        true
    }

    fn clicked(&mut self, button: MouseButton) {
        match button {
            MouseButton::Left if !self.captured && !self.over_panel() => self.capture_mouse(),
            _ if !self.captured => {}
            MouseButton::Left => self.give(Input::Hold(Stroke::Dig)),
            MouseButton::Right => self.give(Input::Hold(Stroke::Place)),
            MouseButton::Middle => self.give(Input::Stroke(Stroke::Pick)),
            _ => {}
        }
    }

    fn let_go(&mut self, button: MouseButton) {
        match button {
            _ if !self.captured => {}
            MouseButton::Left => self.give(Input::LetGo(Stroke::Dig)),
            MouseButton::Right => self.give(Input::LetGo(Stroke::Place)),
            _ => {}
        }
    }

    fn over_panel(&self) -> bool {
        let context = self.egui.egui_ctx();
        !self.captured && (context.is_pointer_over_egui() || context.egui_is_using_pointer())
    }

    fn key(&mut self, event: &KeyEvent) {
        let PhysicalKey::Code(code) = event.physical_key else {
            return;
        };
        let key = player_key(code);
        if event.state == ElementState::Released {
            if let Some(key) = key {
                self.give(Input::Release(key));
            }
            return;
        }
        let is_typing = !self.captured && self.egui.egui_ctx().egui_wants_keyboard_input();
        if let Some(shortcut) = shortcut(self.modifiers, &event.logical_key)
            && !is_typing
        {
            // A held key undoes stroke after stroke.
            return match shortcut {
                Shortcut::Undo => self.give(Input::Undo),
                Shortcut::Redo => self.give(Input::Redo),
                Shortcut::Save if event.repeat => {}
                Shortcut::Save => self.save(),
            };
        }
        if event.repeat {
            return;
        }
        match code {
            KeyCode::Escape | KeyCode::F1 => self.open_menu(Occasion::Pause),
            KeyCode::Tab if !is_typing => {
                self.panel_open = !self.panel_open;
                if self.panel_open {
                    self.release_mouse();
                }
            }
            KeyCode::F2 => self.screenshot_wanted = true,
            KeyCode::F3 => self.readout_open = !self.readout_open,
            KeyCode::F4 => self.begin_benchmark(),
            KeyCode::F5 => self.reload(true, true),
            KeyCode::F6 => self.toggle_reference(),
            KeyCode::F7 => self.next_probes(),
            KeyCode::F11 => self.toggle_full_screen(),
            // The user types a number into the panel.
            _ if is_typing => {}
            KeyCode::KeyP => self.settings.clock.paused = !self.settings.clock.paused,
            code => {
                let camera = digit(code).map(Input::Camera);
                if let Some(input) = key.map(Input::Press).or(camera) {
                    self.give(input);
                }
            }
        }
    }

    /// Switches between light by probes and path tracing. World time is paused for path tracing: moving lamps
    /// would restart it at every frame.
    fn toggle_reference(&mut self) {
        let traced = !self.settings.choice.traced;
        self.settings.choice.traced = traced;
        if traced {
            self.settings.clock.paused = true;
            self.messages.toast(
                "Path-traced reference: time is paused (P resumes it), F6 returns to the probes",
            );
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
            for stroke in [Stroke::Dig, Stroke::Place] {
                self.give(Input::LetGo(stroke));
            }
        }
    }
}

/// 0 for the key 1, and so on.
fn digit(code: KeyCode) -> Option<usize> {
    use KeyCode::{Digit1, Digit2, Digit3, Digit4, Digit5, Digit6, Digit7, Digit8, Digit9};
    [
        Digit1, Digit2, Digit3, Digit4, Digit5, Digit6, Digit7, Digit8, Digit9,
    ]
    .iter()
    .position(|known| *known == code)
}
