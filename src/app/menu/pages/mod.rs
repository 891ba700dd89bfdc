//! Draws the menu: a column of buttons at the left, and the page that one of them opened.

mod how_to_play;
mod keys;
mod new_cave;
mod saves;
mod settings;
#[cfg(test)]
mod tests;
mod worlds;

use std::path::Path;

use egui::{
    Button, CentralPanel, Color32, Frame, Margin, Panel, Response, RichText, ScrollArea, Ui, Vec2,
};

pub use keys::KeyPage;
pub use saves::SavesPage;

use super::{Action, Menu, Occasion, Page};
use crate::app::{settings::Preferences, texts::column as texts};

const COLUMN: f32 = 210.0;
const BUTTON: Vec2 = Vec2::new(180.0, 34.0);
const GAP: f32 = 12.0;
/// Around a page.
const PAGE: Margin = Margin::same(18);
const TEXT: Color32 = Color32::from_gray(225);
const DIM: Color32 = Color32::from_black_alpha(185);
const CLEAR: Color32 = Color32::from_black_alpha(40);
const WARNING: Color32 = Color32::from_rgb(255, 190, 80);

/// What the pages show and change besides the menu itself.
pub struct Shown<'a> {
    pub preferences: &'a mut Preferences,
    /// Edge length of the picture relative to the window's, as it is now.
    pub scale: f32,
    /// The save that the run behind the menu goes on to write.
    pub played: Option<&'a Path>,
}

impl Menu {
    /// Draws the menu and returns what was chosen.
    pub fn show(&mut self, ui: &mut Ui, shown: &mut Shown<'_>) -> Option<Action> {
        let mut action = None;
        // The picture behind may be bright.
        ui.visuals_mut().override_text_color = Some(TEXT);
        let column = Frame::new().fill(DIM).inner_margin(Margin::same(14));
        Panel::left("menu")
            .frame(column)
            .exact_size(COLUMN)
            .resizable(false)
            .show(ui, |ui| {
                ScrollArea::vertical().show(ui, |ui| self.buttons(ui, &mut action));
            });
        // The cave that is being made must be seen.
        let fill = if self.page == Page::NewCave {
            CLEAR
        } else {
            DIM
        };
        let frame = Frame::new().fill(fill).inner_margin(PAGE);
        CentralPanel::default()
            .frame(frame)
            .show(ui, |ui| match self.page {
                Page::Saves => self.saves.show(ui, shown, &mut action),
                Page::Worlds => self.worlds(ui, &mut action),
                Page::NewCave => self.new_cave(ui, &mut action),
                Page::HowToPlay => how_to_play::show(ui, &shown.preferences.keys),
                Page::Settings => settings::show(ui, shown),
                Page::Keys => self.keys.show(ui, &mut shown.preferences.keys),
            });
        action
    }

    fn buttons(&mut self, ui: &mut Ui, action: &mut Option<Action>) {
        ui.label(RichText::new(texts::TITLE).size(40.0).strong());
        ui.label(match self.occasion {
            Occasion::Title => texts::SUBTITLE,
            Occasion::Pause => texts::PAUSED,
        });
        ui.add_space(GAP);
        if self.occasion == Occasion::Pause && large(ui, texts::RESUME, false).clicked() {
            *action = Some(Action::Resume);
        }
        if self.occasion == Occasion::Title
            && let Some(latest) = self.saves.latest()
        {
            let told = texts::go_on_in(&latest.name, &saves::since(latest));
            if large(ui, texts::CONTINUE, false)
                .on_hover_text(told)
                .clicked()
            {
                *action = Some(Action::Continue(latest.path.clone()));
            }
        }
        for (page, label) in [
            (Page::Saves, texts::SAVES),
            (Page::Worlds, texts::WORLDS),
            (Page::NewCave, texts::NEW_CAVE),
            (Page::HowToPlay, texts::HOW_TO_PLAY),
            (Page::Settings, texts::SETTINGS),
            (Page::Keys, texts::KEYS),
        ] {
            // Behind a pause lies the world that is played, not a preview.
            if page == Page::NewCave && self.occasion == Occasion::Pause {
                continue;
            }
            if large(ui, label, self.page == page).clicked() {
                self.page = page;
                self.is_stale = page == Page::NewCave;
                self.keys = KeyPage::default();
                self.saves.leave();
            }
        }
        ui.add_space(GAP);
        if self.occasion == Occasion::Pause && large(ui, texts::TITLE_SCREEN, false).clicked() {
            *action = Some(Action::ToTitle);
        }
        if large(ui, texts::QUIT, false).clicked() {
            *action = Some(Action::Quit);
        }
        ui.add_space(GAP);
        ui.weak(texts::DROP);
        if self.page == Page::NewCave
            && self.is_stale
            && !ui.input(|input| input.pointer.any_down())
        {
            self.is_stale = false;
            *action = action
                .take()
                .or_else(|| Some(Action::Preview(self.cave.clone())));
        }
    }
}

fn large(ui: &mut Ui, label: &str, is_chosen: bool) -> Response {
    let text = RichText::new(label).size(17.0);
    let button = Button::new(text).selected(is_chosen).min_size(BUTTON);
    ui.add(button)
}
