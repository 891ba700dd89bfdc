//! The pages fit on the screen, and ask before they delete.

use std::path::Path;

use egui::{Event, Modifiers, PointerButton, Pos2, Rect, Shape, Ui, Vec2, pos2, vec2};

use super::{Shown, how_to_play, keys::KeyPage, saves::SavesPage, settings};
use crate::{
    app::{
        controls::{ACTIONS, Bindings, help},
        menu::Action,
        settings::Preferences,
        texts,
    },
    world::{
        Overlay,
        save::{Folder, sample::save_of, write},
    },
};

/// A text as it is drawn: where, which part of that is not cut off, and what it says.
struct Drawn {
    rect: Rect,
    clip: Rect,
    text: String,
}

/// A window of this size with a page beside the menu's column.
struct Stage {
    context: egui::Context,
    size: Vec2,
    drawn: Vec<Drawn>,
}

impl Stage {
    fn new(size: Vec2) -> Self {
        Self {
            context: egui::Context::default(),
            size,
            drawn: Vec::new(),
        }
    }

    fn frame(&mut self, events: Vec<Event>, mut page: impl FnMut(&mut Ui)) {
        let input = egui::RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, self.size)),
            events,
            ..Default::default()
        };
        let mut output = self.context.run_ui(input, |ui| {
            egui::Panel::left("menu")
                .exact_size(super::COLUMN)
                .resizable(false)
                .show(ui, |_| {});
            let frame = egui::Frame::new().inner_margin(super::PAGE);
            egui::CentralPanel::default()
                .frame(frame)
                .show(ui, &mut page);
        });
        output.textures_delta.clear();
        let drawn = output.shapes.iter().filter_map(|shape| match &shape.shape {
            Shape::Text(text) => Some(Drawn {
                rect: text.visual_bounding_rect(),
                clip: shape.clip_rect,
                text: text.galley.text().to_owned(),
            }),
            _ => None,
        });
        self.drawn = drawn.collect();
    }

    /// Clicks at a text.
    fn click(&mut self, text: &str, mut page: impl FnMut(&mut Ui)) {
        let found = self.drawn.iter().find(|drawn| drawn.text == text);
        let pos = found.unwrap_or_else(|| panic!("no `{text}`")).rect.center();
        for pressed in [true, false] {
            let button = Event::PointerButton {
                pos,
                button: PointerButton::Primary,
                pressed,
                modifiers: Modifiers::NONE,
            };
            self.frame(vec![Event::PointerMoved(pos), button], &mut page);
        }
        self.frame(Vec::new(), page);
    }

    fn shows(&self, part: &str) -> bool {
        self.drawn.iter().any(|drawn| drawn.text.contains(part))
    }
}

/// The texts of a page that lie outside of the window, or are cut off.
fn hidden(size: Vec2, mut page: impl FnMut(&mut Ui)) -> Vec<String> {
    let mut stage = Stage::new(size);
    for _ in 0..3 {
        stage.frame(Vec::new(), &mut page);
    }
    assert!(stage.drawn.len() > 10, "the page is drawn");
    let screen = Rect::from_min_max(pos2(super::COLUMN, 0.0), size.to_pos2());
    let is_hidden = |drawn: &&Drawn| {
        let seen = drawn.clip.intersect(screen).expand(1.0);
        !seen.contains_rect(drawn.rect)
    };
    let hidden = stage.drawn.iter().filter(is_hidden);
    hidden
        .map(|drawn| format!("{} {:?}", drawn.text, drawn.rect))
        .collect()
}

const SIZES: [Vec2; 2] = [vec2(800.0, 600.0), vec2(1280.0, 720.0)];

fn shown(preferences: &mut Preferences) -> Shown<'_> {
    Shown {
        preferences,
        scale: 1.0,
        played: None,
    }
}

#[test]
fn how_to_play_fits_on_one_screen() {
    let bindings = Bindings::default();
    for size in SIZES {
        let hidden = hidden(size, |ui| how_to_play::show(ui, &bindings));
        assert_eq!(hidden, [""; 0], "in {size:?}");
    }
    let small = hidden(vec2(500.0, 300.0), |ui| how_to_play::show(ui, &bindings));
    assert!(!small.is_empty(), "this test can fail");
}

#[test]
fn the_settings_fit_on_one_screen() {
    for size in SIZES {
        let mut preferences = Preferences {
            frame_limit: Some(60),
            field_of_view_deg: Some(90.0),
            picture_scale: Some(0.5),
            ..Preferences::default()
        };
        let hidden = hidden(size, |ui| settings::show(ui, &mut shown(&mut preferences)));
        assert_eq!(hidden, [""; 0], "in {size:?}");
    }
}

#[test]
fn a_key_is_chosen_with_a_click() {
    let (mut page, mut bindings) = (KeyPage::default(), Bindings::default());
    let mut stage = Stage::new(SIZES[1]);
    stage.frame(Vec::new(), |ui| page.show(ui, &mut bindings));
    assert_eq!(help(&bindings).len(), help(&Bindings::default()).len());
    for entry in ACTIONS.iter().take(5) {
        assert!(stage.shows(entry.name), "{}", entry.name);
    }
    stage.click("K", |ui| page.show(ui, &mut bindings));
    assert!(page.waits() && stage.shows(texts::keys::PRESS));
    let chord = "W".parse().expect("a key");
    page.take(chord, &mut bindings);
    stage.frame(Vec::new(), |ui| page.show(ui, &mut bindings));
    stage.frame(Vec::new(), |ui| page.show(ui, &mut bindings));
    assert!(stage.shows("W is the key of “forward”"));
    stage.click(texts::keys::TAKE, |ui| page.show(ui, &mut bindings));
    assert_eq!(
        bindings.owner(chord),
        Some(crate::app::controls::Action::Fly)
    );
    stage.click(texts::keys::RESET_ALL, |ui| page.show(ui, &mut bindings));
    assert_eq!(bindings, Bindings::default());
}

#[test]
fn a_save_is_deleted_only_after_a_question() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let folder = Folder::at(place.path());
    let path = folder.free("castle").expect("a name");
    write(&path, &save_of(Overlay::default())).expect("writable");
    let mut page = SavesPage::of(Some(&folder));
    let mut preferences = Preferences::default();
    let mut chosen = None;
    let mut stage = Stage::new(SIZES[0]);
    let mut show = |ui: &mut Ui| page.show(ui, &shown(&mut preferences), &mut chosen);
    stage.frame(Vec::new(), &mut show);
    assert!(stage.shows("castle"));
    stage.click(texts::saves::DELETE, &mut show);
    assert!(stage.shows("Delete `castle` and its backup for ever?"));
    stage.click(texts::saves::KEEP_IT, &mut show);
    assert!(!stage.shows("for ever?"));
    stage.click(texts::saves::DELETE, &mut show);
    stage.click(texts::saves::DELETE_IT, &mut show);
    assert_eq!(chosen, Some(Action::DeleteSave(path.clone())));

    // Nor is the one that is being played.
    let mut page = SavesPage::of(Some(&folder));
    let mut chosen = None;
    let mut preferences = Preferences::default();
    let played: Option<&Path> = Some(&path);
    let mut show = |ui: &mut Ui| {
        let shown = Shown {
            played,
            ..shown(&mut preferences)
        };
        page.show(ui, &shown, &mut chosen);
    };
    stage.frame(Vec::new(), &mut show);
    stage.click(texts::saves::DELETE, &mut show);
    assert!(!stage.shows("for ever?"));
}

/// Texts that a translator must find stand in `texts` and in the table of actions: no sentence stands in a page.
#[test]
fn the_pages_have_no_texts_of_their_own() {
    let pages = [
        include_str!("mod.rs"),
        include_str!("how_to_play.rs"),
        include_str!("new_cave.rs"),
        include_str!("saves.rs"),
        include_str!("settings.rs"),
        include_str!("worlds.rs"),
        include_str!("keys.rs"),
    ];
    for page in pages {
        let code = page
            .split("#[cfg(test)]\nmod tests {")
            .next()
            .unwrap_or(page);
        let lines = code
            .lines()
            .filter(|line| !line.trim_start().starts_with("//"));
        for line in lines {
            let literals = line.split('"').skip(1).step_by(2);
            for literal in literals {
                let is_name = literal
                    .chars()
                    .all(|letter| letter.is_ascii_lowercase() || letter == '_');
                assert!(is_name, "`{literal}` belongs into src/app/texts.rs: {line}");
            }
        }
    }
}
