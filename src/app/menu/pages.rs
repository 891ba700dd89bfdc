//! Draws the menu: a column of buttons at the left, and the page that one of them opened.

use egui::{
    Align, Button, CentralPanel, Color32, CornerRadius, Frame, Grid, Layout, Margin, Panel,
    Response, RichText, ScrollArea, Sense, Slider, TextEdit, Ui, Vec2,
};

use super::{Action, Entry, Menu, Occasion, Page};
use crate::{
    app::{
        controls,
        panel::{SCALES, Settings},
    },
    world::{
        new_cave::{MOST_LAMPS, NewCave},
        save::{Listed, now_s},
    },
};

const COLUMN: f32 = 210.0;
const BUTTON: Vec2 = Vec2::new(180.0, 34.0);
/// A card of a world: its picture, and its text below.
const CARD: Vec2 = Vec2::new(216.0, 214.0);
const PICTURE: Vec2 = Vec2::new(216.0, 121.5);
const GAP: f32 = 12.0;
/// Lines of a world's title on its card.
const LINES: usize = 3;
const TEXT: Color32 = Color32::from_gray(225);
const DIM: Color32 = Color32::from_black_alpha(185);
const CLEAR: Color32 = Color32::from_black_alpha(40);

impl Menu {
    /// Draws the menu and returns what was chosen.
    pub fn show(&mut self, ui: &mut Ui, settings: &mut Settings) -> Option<Action> {
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
        let frame = Frame::new().fill(fill).inner_margin(Margin::same(18));
        CentralPanel::default()
            .frame(frame)
            .show(ui, |ui| match self.page {
                Page::Saves => self.saves(ui, &mut action),
                Page::Worlds => self.worlds(ui, &mut action),
                Page::NewCave => self.new_cave(ui, &mut action),
                Page::HowToPlay => how_to_play(ui),
                Page::Settings => settings_page(ui, settings, &mut action),
            });
        action
    }

    fn buttons(&mut self, ui: &mut Ui, action: &mut Option<Action>) {
        ui.label(RichText::new("grotto").size(40.0).strong());
        ui.label(match self.occasion {
            Occasion::Title => "voxel caves in real light",
            Occasion::Pause => "paused",
        });
        ui.add_space(GAP);
        if self.occasion == Occasion::Pause && large(ui, "Resume", false).clicked() {
            *action = Some(Action::Resume);
        }
        if self.occasion == Occasion::Title
            && let Some(latest) = self.saves.first()
        {
            let told = format!("Go on in {}, {}", latest.name, since(latest));
            if large(ui, "Continue", false).on_hover_text(told).clicked() {
                *action = Some(Action::Continue(latest.path.clone()));
            }
        }
        for (page, label) in [
            (Page::Saves, "Saves"),
            (Page::Worlds, "Worlds"),
            (Page::NewCave, "New cave"),
            (Page::HowToPlay, "How to play"),
            (Page::Settings, "Settings"),
        ] {
            // Behind a pause lies the world that is played, not a preview.
            if page == Page::NewCave && self.occasion == Occasion::Pause {
                continue;
            }
            if large(ui, label, self.page == page).clicked() {
                self.page = page;
                self.is_stale = page == Page::NewCave;
            }
        }
        ui.add_space(GAP);
        if self.occasion == Occasion::Pause && large(ui, "Title screen", false).clicked() {
            *action = Some(Action::ToTitle);
        }
        if large(ui, "Quit", false).clicked() {
            *action = Some(Action::Quit);
        }
        ui.add_space(GAP);
        ui.weak("A world file (.ron) or a model (.vox) can be dropped on the window.");
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

    fn saves(&mut self, ui: &mut Ui, action: &mut Option<Action>) {
        ui.heading("Go on from a save");
        ui.add_space(GAP);
        if self.saves.is_empty() {
            ui.label("There are no saves yet. What you dig and build is saved every minute, at the end, and by Ctrl + S.");
        }
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            Grid::new("saves")
                .num_columns(4)
                .spacing([18.0, 10.0])
                .show(ui, |ui| {
                    for save in &self.saves {
                        ui.strong(&save.name);
                        match &save.head {
                            Ok(head) => ui.label(format!("in {}, {}", head.world, head.changes())),
                            Err(error) => ui.label(error.to_string()),
                        };
                        ui.label(since(save));
                        if ui.button("Go on").clicked() {
                            *action = Some(Action::Continue(save.path.clone()));
                        }
                        ui.end_row();
                    }
                });
            ui.add_space(GAP);
            ui.weak("`grotto saves` copies, renames and deletes them.");
        });
    }

    fn worlds(&mut self, ui: &mut Ui, action: &mut Option<Action>) {
        ui.heading("Choose a world");
        ui.add_space(GAP);
        let columns = ((ui.available_width() + GAP) / (CARD.x + GAP))
            .floor()
            .max(1.0) as usize;
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            Grid::new("worlds")
                .spacing(Vec2::splat(GAP))
                .show(ui, |ui| {
                    for (index, entry) in self.entries.iter().enumerate() {
                        let texture = self.pictures.texture(ui.ctx(), &entry.name);
                        if card(ui, entry, texture) {
                            *action = Some(Action::EnterWorld(entry.clone()));
                        }
                        if (index + 1) % columns == 0 {
                            ui.end_row();
                        }
                    }
                });
        });
    }

    fn new_cave(&mut self, ui: &mut Ui, action: &mut Option<Action>) {
        let frame = Frame::window(ui.style()).fill(DIM);
        frame.show(ui, |ui| {
            ui.set_width(330.0);
            ui.heading("New cave");
            ui.add_space(GAP);
            let before = self.cave.clone();
            ui.spacing_mut().slider_width = 150.0;
            Grid::new("new cave")
                .num_columns(2)
                .spacing([12.0, 8.0])
                .show(ui, |ui| {
                    ui.label("Name");
                    ui.add(
                        TextEdit::singleline(&mut self.name)
                            .hint_text("new cave")
                            .desired_width(190.0),
                    );
                    ui.end_row();
                    ui.label("Seed");
                    ui.horizontal(|ui| {
                        ui.add(egui::DragValue::new(&mut self.cave.seed));
                        if ui.button("another").clicked() {
                            // Any other seed is as good; a multiplier of full period never comes back soon.
                            self.cave.seed = self
                                .cave
                                .seed
                                .wrapping_mul(1_664_525)
                                .wrapping_add(1_013_904_223);
                        }
                    });
                    ui.end_row();
                    let NewCave {
                        rooms,
                        roughness,
                        mushrooms,
                        lamps,
                        lava,
                        ..
                    } = &mut self.cave;
                    for (label, share) in [
                        ("Size of rooms", rooms),
                        ("Roughness", roughness),
                        ("Mushrooms", mushrooms),
                        ("Lava", lava),
                    ] {
                        ui.label(label);
                        ui.add(Slider::new(share, 0.0..=1.0).show_value(false));
                        ui.end_row();
                    }
                    ui.label("Lamps");
                    ui.add(Slider::new(lamps, 0..=MOST_LAMPS));
                    ui.end_row();
                });
            self.is_stale |= self.cave != before;
            ui.add_space(GAP);
            if large(ui, "Enter the cave", true).clicked() {
                *action = Some(Action::Create(self.cave.clone(), self.name.clone()));
            }
        });
    }
}

/// How long ago a save was written.
fn since(save: &Listed) -> String {
    let Ok(head) = &save.head else {
        return String::new();
    };
    let seconds = now_s().saturating_sub(head.saved_s);
    match seconds {
        0..60 => "just now".to_owned(),
        60..3600 => format!("{} min ago", seconds / 60),
        3600..86_400 => format!("{} h ago", seconds / 3600),
        _ => format!("{} days ago", seconds / 86_400),
    }
}

fn large(ui: &mut Ui, label: &str, is_chosen: bool) -> Response {
    let text = RichText::new(label).size(17.0);
    let button = Button::new(text).selected(is_chosen).min_size(BUTTON);
    ui.add(button)
}

/// A world with its picture; returns whether it was clicked.
fn card(ui: &mut Ui, entry: &Entry, texture: Option<&egui::TextureHandle>) -> bool {
    let (area, response) = ui.allocate_exact_size(CARD, Sense::click());
    let fill = if response.hovered() {
        ui.visuals().widgets.hovered.bg_fill
    } else {
        ui.visuals().widgets.inactive.bg_fill
    };
    ui.painter().rect_filled(area, CornerRadius::same(6), fill);
    let picture = egui::Rect::from_min_size(area.min, PICTURE);
    match texture {
        Some(texture) => {
            egui::Image::new((texture.id(), PICTURE)).paint_at(ui, picture);
        }
        None => {
            ui.painter().text(
                picture.center(),
                egui::Align2::CENTER_CENTER,
                "…",
                egui::FontId::proportional(24.0),
                ui.visuals().weak_text_color(),
            );
        }
    }
    let below = egui::Rect::from_min_max(picture.left_bottom(), area.max).shrink(8.0);
    let mut text = ui.new_child(
        egui::UiBuilder::new()
            .max_rect(below)
            .layout(Layout::top_down(Align::LEFT)),
    );
    text.add(
        egui::Label::new(RichText::new(&entry.name).strong().size(15.0))
            .truncate()
            .selectable(false),
    );
    let job = egui::text::LayoutJob {
        wrap: egui::text::TextWrapping {
            max_width: below.width(),
            max_rows: LINES,
            ..Default::default()
        },
        ..egui::text::LayoutJob::simple(
            entry.title.clone(),
            egui::FontId::proportional(12.0),
            ui.visuals().text_color(),
            below.width(),
        )
    };
    text.add(egui::Label::new(job).selectable(false));
    response
        .on_hover_cursor(egui::CursorIcon::PointingHand)
        .clicked()
}

/// The keys, on one screen.
fn how_to_play(ui: &mut Ui) {
    ui.heading("How to play");
    ui.add_space(GAP);
    ui.label(
        "Walk through the cave, dig and build; the light follows. Click into the picture to look around, \
         Esc opens this menu.",
    );
    ui.add_space(GAP);
    keys(ui);
}

/// A table of the keys in two columns.
fn keys(ui: &mut Ui) {
    let half = controls::HELP.len().div_ceil(2);
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        Grid::new("keys")
            .num_columns(4)
            .spacing([16.0, 6.0])
            .show(ui, |ui| {
                for row in 0..half {
                    for (key, does) in [row, row + half]
                        .iter()
                        .filter_map(|at| controls::HELP.get(*at))
                    {
                        ui.strong(*key);
                        ui.label(*does);
                    }
                    ui.end_row();
                }
            });
    });
}

fn settings_page(ui: &mut Ui, settings: &mut Settings, action: &mut Option<Action>) {
    ui.heading("Settings");
    ui.add_space(GAP);
    Grid::new("settings")
        .num_columns(2)
        .spacing([16.0, 8.0])
        .show(ui, |ui| {
            ui.label("Picture's size, as a share of the window's");
            ui.add(Slider::new(&mut settings.scale, SCALES).fixed_decimals(2));
            ui.end_row();
            ui.label("Brightness (stops)");
            ui.add(
                Slider::new(
                    &mut settings.choice.parameters.picture.exposure_ev,
                    -4.0..=4.0,
                )
                .fixed_decimals(1),
            );
            ui.end_row();
            ui.label("Wait for the screen (vsync)");
            ui.checkbox(&mut settings.vsync, "");
            ui.end_row();
            ui.label("Textures");
            ui.checkbox(&mut settings.choice.parameters.textures.enabled, "");
            ui.end_row();
            ui.label("Full screen");
            if ui.button("switch (F11)").clicked() {
                *action = Some(Action::FullScreen);
            }
            ui.end_row();
        });
    ui.add_space(GAP);
    ui.weak("Every parameter of the renderer is in the panel that Tab opens while you play.");
}
