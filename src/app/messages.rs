//! Messages of the window: toasts that disappear, and diagnostics that stay until the error is fixed.

use std::time::{Duration, Instant};

use super::{controls::Bindings, texts::diagnostics as texts};
use egui::{Align2, Area, Color32, Frame, Id, RichText, ScrollArea, Ui, Window};

/// How long a toast is shown.
const SHOWN: Duration = Duration::from_secs(5);
/// Errors take longer to read.
const ERROR_SHOWN: Duration = Duration::from_secs(12);
const ERROR: Color32 = Color32::from_rgb(255, 120, 100);

#[derive(Default)]
pub struct Messages {
    /// What is wrong with the world file; the last good world is shown.
    pub world: Option<String>,
    /// Why a save cannot be opened.
    pub save: Option<String>,
    /// What is wrong with the shaders; the last good ones run.
    pub shaders: Option<String>,
    /// What is in progress, while it lasts.
    pub status: Option<String>,
    toasts: Vec<Toast>,
}

struct Toast {
    text: String,
    /// Whether names of actions in braces stand for their keys.
    names_keys: bool,
    error: bool,
    until: Instant,
}

impl Messages {
    pub fn toast(&mut self, text: impl Into<String>) {
        self.push(text.into(), false, SHOWN);
    }

    /// A toast in which the name of an action in braces, as in `{fly}`, stands for its key.
    pub fn hint(&mut self, text: impl Into<String>) {
        self.push(text.into(), false, SHOWN);
        if let Some(toast) = self.toasts.last_mut() {
            toast.names_keys = true;
        }
    }

    pub fn toast_error(&mut self, text: impl Into<String>) {
        self.push(text.into(), true, ERROR_SHOWN);
    }

    /// An error with names of actions in braces, as in [`Self::hint`].
    pub fn hint_error(&mut self, text: impl Into<String>) {
        self.push(text.into(), true, ERROR_SHOWN);
        if let Some(toast) = self.toasts.last_mut() {
            toast.names_keys = true;
        }
    }

    /// The errors so far, for where there is no window to show them.
    pub fn take_errors(&mut self) -> Vec<String> {
        let toasts = std::mem::take(&mut self.toasts).into_iter();
        let errors = toasts.filter(|toast| toast.error).map(|toast| toast.text);
        errors.chain(self.world.take()).collect()
    }

    fn push(&mut self, text: String, error: bool, shown: Duration) {
        // The same text again only lasts longer.
        self.toasts.retain(|toast| toast.text != text);
        self.toasts.push(Toast {
            text,
            names_keys: false,
            error,
            until: Instant::now() + shown,
        });
    }

    /// Draws the messages. Hints name the keys of `keys`.
    pub fn show(&mut self, ui: &mut Ui, keys: &Bindings) {
        let now = Instant::now();
        self.toasts.retain(|toast| toast.until > now);
        if let Some(status) = &self.status {
            Area::new(Id::unique("status"))
                .anchor(Align2::CENTER_TOP, [0.0, 12.0])
                .interactable(false)
                .show(ui.ctx(), |ui| {
                    Frame::popup(ui.style()).show(ui, |ui| ui.label(status));
                });
        }
        if !self.toasts.is_empty() {
            toasts(ui, &self.toasts, keys);
        }
        diagnostic(ui, texts::WORLD, 0.3, &mut self.world);
        diagnostic(ui, texts::SAVE, 0.5, &mut self.save);
        diagnostic(ui, texts::SHADERS, 0.7, &mut self.shaders);
    }
}

/// Space between a message and the edges of the window, in points, including the message's own frame, title and
/// margins.
const AROUND: egui::Vec2 = egui::vec2(48.0, 96.0);
/// Widest and highest text of a diagnostic, in points.
const DIAGNOSTIC: egui::Vec2 = egui::vec2(720.0, 420.0);

/// From the lower edge of the window to the toasts, in points: the hotbar and the name of what is in the hand lie there.
const ABOVE_HOTBAR: f32 = 96.0;

fn toasts(ui: &Ui, toasts: &[Toast], keys: &Bindings) {
    let room = ui.ctx().content_rect().size() - AROUND;
    Area::new(Id::unique("toasts"))
        .anchor(Align2::CENTER_BOTTOM, [0.0, -ABOVE_HOTBAR])
        .interactable(false)
        .show(ui.ctx(), |ui| {
            ui.set_max_width(room.x.clamp(1.0, DIAGNOSTIC.x));
            ui.vertical_centered(|ui| {
                for toast in toasts {
                    Frame::popup(ui.style()).show(ui, |ui| {
                        let text = RichText::new(match toast.names_keys {
                            true => keys.fill(&toast.text),
                            false => toast.text.clone(),
                        });
                        let text = if toast.error { text.color(ERROR) } else { text };
                        ui.add(egui::Label::new(text).wrap());
                    });
                }
            });
        });
}

/// A window with a text as a terminal would show it, until it is closed. It first appears at `height` of the
/// way down. Long lines wrap, and longer texts scroll: the window stays within the application's window.
fn diagnostic(ui: &Ui, title: &str, height: f32, text: &mut Option<String>) {
    let Some(shown) = text else {
        return;
    };
    let window = ui.ctx().content_rect();
    let room = (window.size() - AROUND).clamp(egui::Vec2::splat(1.0), DIAGNOSTIC);
    let mut open = true;
    Window::new(RichText::new(title).color(ERROR))
        .id(Id::unique(title))
        .open(&mut open)
        .pivot(Align2::CENTER_CENTER)
        .default_pos(window.lerp_inside(egui::vec2(0.5, height)))
        .constrain(true)
        .resizable(false)
        .show(ui.ctx(), |ui| {
            ui.set_width(room.x);
            ScrollArea::vertical()
                .max_height(room.y)
                .auto_shrink([false, true])
                .show(ui, |ui| {
                    let lines = RichText::new(shown.trim_end()).monospace();
                    ui.add(egui::Label::new(lines).wrap());
                });
        });
    if !open {
        *text = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rectangles of all shapes of a frame of this size with this diagnostic of the world file.
    fn drawn(size: egui::Vec2, text: &str) -> (egui::Rect, usize) {
        let context = egui::Context::default();
        let mut messages = Messages {
            world: Some(text.to_owned()),
            ..Messages::default()
        };
        messages.toast_error(text.lines().next().unwrap_or_default());
        let mut painted = (egui::Rect::NOTHING, 0);
        // Windows settle on their size in the frames after the first.
        for _ in 0..4 {
            let input = egui::RawInput {
                screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size)),
                ..Default::default()
            };
            let mut output = context.run_ui(input, |ui| messages.show(ui, &Bindings::default()));
            output.textures_delta.clear();
            let shapes = output.shapes.iter();
            let texts = shapes.filter_map(|shape| match &shape.shape {
                egui::Shape::Text(text) => {
                    Some((text.visual_bounding_rect(), text.galley.rows.len()))
                }
                _ => None,
            });
            painted = texts.fold((egui::Rect::NOTHING, 0), |(all, rows), (rect, more)| {
                (all.union(rect), rows.max(more))
            });
        }
        painted
    }

    #[test]
    fn long_lines_wrap_in_windows_of_any_size() {
        let text = "a message without an end ".repeat(40);
        for size in [egui::vec2(320.0, 240.0), egui::vec2(1280.0, 720.0)] {
            let (rect, rows) = drawn(size, &text);
            assert!(
                rect.left() >= 0.0 && rect.right() <= size.x,
                "{rect:?} in {size:?}"
            );
            assert!(rows > 5, "{rows} rows");
        }
    }

    #[test]
    fn many_lines_scroll() {
        let text = "line\n".repeat(400);
        let size = egui::vec2(640.0, 480.0);
        let context = egui::Context::default();
        let mut messages = Messages {
            world: Some(text),
            ..Messages::default()
        };
        for _ in 0..4 {
            let input = egui::RawInput {
                screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size)),
                ..Default::default()
            };
            let mut output = context.run_ui(input, |ui| messages.show(ui, &Bindings::default()));
            output.textures_delta.clear();
        }
        let rect = context.memory(|memory| memory.area_rect(Id::unique(texts::WORLD)));
        let rect = rect.expect("it is shown");
        assert!(rect.top() >= 0.0 && rect.bottom() <= size.y, "{rect:?}");
    }
}
