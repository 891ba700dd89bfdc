//! The page of saves: go on from one, copy, rename or delete it.

use std::path::PathBuf;

use egui::{Align, Frame, Layout, ScrollArea, TextEdit, Ui};

use super::{super::Action, GAP, Shown, WARNING};
use crate::{
    app::texts::saves as texts,
    world::save::{Folder, Listed, now_s},
};

/// The saves, and what is about to be done with one.
#[derive(Debug, Default)]
pub struct SavesPage {
    /// The latest first.
    listed: Vec<Listed>,
    doing: Option<Doing>,
}

/// What the user is asked about a save.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Doing {
    path: PathBuf,
    what: What,
    /// The new name.
    name: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum What {
    Copy,
    Rename,
    Delete,
}

impl SavesPage {
    /// Those of a folder. If it cannot be read, that is told when a run begins that would be saved there.
    pub fn of(folder: Option<&Folder>) -> Self {
        let listed = folder.and_then(|folder| folder.list().ok());
        Self {
            listed: listed.unwrap_or_default(),
            doing: None,
        }
    }

    pub fn latest(&self) -> Option<&Listed> {
        self.listed.first()
    }

    /// Whatever was begun with a save is left.
    pub fn leave(&mut self) {
        self.doing = None;
    }

    pub fn show(&mut self, ui: &mut Ui, shown: &Shown<'_>, action: &mut Option<Action>) {
        ui.heading(texts::HEADING);
        ui.add_space(GAP);
        if self.listed.is_empty() {
            ui.label(shown.preferences.keys.fill(texts::NONE));
        }
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for index in 0..self.listed.len() {
                let is_played = shown.played == Some(&*self.listed[index].path);
                Frame::group(ui.style()).show(ui, |ui| {
                    ui.set_width(ui.available_width());
                    self.row(ui, index, is_played, action);
                });
            }
        });
    }

    fn row(&mut self, ui: &mut Ui, index: usize, is_played: bool, action: &mut Option<Action>) {
        let save = &self.listed[index];
        ui.horizontal(|ui| {
            ui.strong(&save.name);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.weak(since(save))
            });
        });
        match &save.head {
            Ok(head) => ui.label(texts::about(&head.world, head.voxels)),
            Err(error) => ui.label(error.to_string()),
        };
        let mut begun = None;
        ui.horizontal(|ui| {
            if ui.button(texts::GO_ON).clicked() {
                *action = Some(Action::Continue(save.path.clone()));
            }
            let is_whole = save.head.is_ok();
            for (what, label, reason) in [
                (
                    What::Copy,
                    texts::COPY,
                    (!is_whole).then_some(texts::DAMAGED),
                ),
                (
                    What::Rename,
                    texts::RENAME,
                    is_played.then_some(texts::PLAYED),
                ),
                (
                    What::Delete,
                    texts::DELETE,
                    is_played.then_some(texts::PLAYED),
                ),
            ] {
                let button = ui.add_enabled(reason.is_none(), egui::Button::new(label));
                let button = button.on_disabled_hover_text(reason.unwrap_or_default());
                if button.clicked() {
                    begun = Some(what);
                }
            }
        });
        if let Some(what) = begun {
            self.doing = Some(Doing {
                path: save.path.clone(),
                what,
                name: save.name.clone(),
            });
        }
        let path = &self.listed[index].path;
        if self.doing.as_ref().is_some_and(|doing| doing.path == *path) {
            self.ask(ui, index, action);
        }
    }

    /// The question below a save, with its answers.
    fn ask(&mut self, ui: &mut Ui, index: usize, action: &mut Option<Action>) {
        let Some(Doing { path, what, name }) = &mut self.doing else {
            return;
        };
        let save = &self.listed[index];
        let mut is_answered = false;
        ui.horizontal_wrapped(|ui| {
            let (yes, no) = match what {
                What::Copy => (texts::COPY_IT, texts::LEAVE),
                What::Rename => (texts::RENAME_IT, texts::LEAVE),
                What::Delete => (texts::DELETE_IT, texts::KEEP_IT),
            };
            let is_free = if *what == What::Delete {
                ui.colored_label(WARNING, texts::delete(&save.name));
                true
            } else {
                ui.label(texts::NEW_NAME);
                ui.add(TextEdit::singleline(name).desired_width(170.0));
                *name != save.name && !name.trim().is_empty()
            };
            if ui.add_enabled(is_free, egui::Button::new(yes)).clicked() {
                let (path, name) = (path.clone(), name.trim().to_owned());
                *action = Some(match what {
                    What::Copy => Action::CopySave(path, name),
                    What::Rename => Action::RenameSave(path, name),
                    What::Delete => Action::DeleteSave(path),
                });
            }
            is_answered = ui.button(no).clicked();
        });
        if is_answered {
            self.doing = None;
        }
    }
}

/// How long ago a save was written.
pub fn since(save: &Listed) -> String {
    let head = save.head.as_ref();
    head.map_or_else(
        |_| String::new(),
        |head| texts::since(now_s().saturating_sub(head.saved_s)),
    )
}
