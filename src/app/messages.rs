//! What the window says: toasts that go away, and diagnostics that stay until they are mended.

use std::time::{Duration, Instant};

use egui::{Align2, Area, Color32, Frame, Id, RichText, ScrollArea, Ui, Window};

/// How long a toast is shown.
const SHOWN: Duration = Duration::from_secs(5);
/// Errors are longer to read.
const ERROR_SHOWN: Duration = Duration::from_secs(12);
const ERROR: Color32 = Color32::from_rgb(255, 120, 100);

#[derive(Default)]
pub struct Messages {
    /// What is wrong with the world file; the last good world is shown.
    pub world: Option<String>,
    /// What is wrong with the shaders; the last good ones run.
    pub shaders: Option<String>,
    /// What is going on, as long as it does.
    pub status: Option<String>,
    toasts: Vec<Toast>,
}

struct Toast {
    text: String,
    error: bool,
    until: Instant,
}

impl Messages {
    pub fn toast(&mut self, text: impl Into<String>) {
        self.push(text.into(), false, SHOWN);
    }

    pub fn toast_error(&mut self, text: impl Into<String>) {
        self.push(text.into(), true, ERROR_SHOWN);
    }

    fn push(&mut self, text: String, error: bool, shown: Duration) {
        // The same again only lasts longer.
        self.toasts.retain(|toast| toast.text != text);
        self.toasts.push(Toast {
            text,
            error,
            until: Instant::now() + shown,
        });
    }

    /// Draws what there is to say.
    pub fn show(&mut self, ui: &mut Ui) {
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
            toasts(ui, &self.toasts);
        }
        diagnostic(
            ui,
            "The world file has an error; the last good world is shown",
            0.3,
            &mut self.world,
        );
        diagnostic(
            ui,
            "The shaders do not compile; the last good ones run",
            0.7,
            &mut self.shaders,
        );
    }
}

fn toasts(ui: &Ui, toasts: &[Toast]) {
    Area::new(Id::unique("toasts"))
        .anchor(Align2::CENTER_BOTTOM, [0.0, -24.0])
        .interactable(false)
        .show(ui.ctx(), |ui| {
            ui.vertical_centered(|ui| {
                for toast in toasts {
                    Frame::popup(ui.style()).show(ui, |ui| {
                        let text = RichText::new(&toast.text);
                        ui.label(if toast.error { text.color(ERROR) } else { text });
                    });
                }
            });
        });
}

/// A window with a text as a terminal would show it, until it is closed. It first appears at `height`
/// of the way down.
fn diagnostic(ui: &Ui, title: &str, height: f32, text: &mut Option<String>) {
    let Some(shown) = text else {
        return;
    };
    let window = ui.ctx().content_rect();
    let mut open = true;
    Window::new(RichText::new(title).color(ERROR))
        .id(Id::unique(title))
        .open(&mut open)
        .pivot(Align2::CENTER_CENTER)
        .default_pos(window.lerp_inside(egui::vec2(0.5, height)))
        .default_width(720.0)
        .show(ui.ctx(), |ui| {
            ScrollArea::both().max_height(420.0).show(ui, |ui| {
                let lines = RichText::new(shown.trim_end()).monospace();
                ui.add(egui::Label::new(lines).extend());
            });
        });
    if !open {
        *text = None;
    }
}
