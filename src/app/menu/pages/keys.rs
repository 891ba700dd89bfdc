//! The page of keys: which key does what, and another key for it.

use egui::{Button, Grid, RichText, ScrollArea, Ui, Vec2};

use super::{GAP, WARNING};
use crate::app::{
    controls::{ACTIONS, Action, Bindings, Chord, Entry, SLOTS},
    texts::keys as texts,
};

const KEY: Vec2 = Vec2::new(112.0, 0.0);
/// Width of an action with its keys, for as many columns as there is room for.
const WIDTH: f32 = 430.0;

/// What the page of keys waits for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KeyPage {
    /// The key that the next press replaces: the action's, and which of its keys.
    waits: Option<(Action, usize)>,
    /// A key that was pressed for an action, while it is another's.
    asks: Option<Question>,
    /// A key that was pressed and cannot be bound.
    refused: Option<Chord>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Question {
    action: Action,
    slot: usize,
    chord: Chord,
}

impl KeyPage {
    /// Whether the next press is a new key.
    pub fn waits(&self) -> bool {
        self.waits.is_some()
    }

    /// The user thought better of it.
    pub fn leave(&mut self) {
        self.waits = None;
    }

    /// A key was pressed for the action that waits: it gets it, unless it is another's. Then the page asks.
    pub fn take(&mut self, chord: Chord, bindings: &mut Bindings) {
        let Some((action, slot)) = self.waits.take() else {
            return;
        };
        self.refused = (!chord.can_be_bound()).then_some(chord);
        match bindings.owner(chord) {
            Some(owner) if owner != action => {
                self.asks = Some(Question {
                    action,
                    slot,
                    chord,
                });
            }
            _ => bindings.bind(action, slot, chord),
        }
    }

    pub fn show(&mut self, ui: &mut Ui, bindings: &mut Bindings) {
        ui.horizontal(|ui| {
            ui.heading(texts::HEADING);
            ui.add_space(GAP);
            if ui.button(texts::RESET_ALL).clicked() {
                *bindings = Bindings::default();
                *self = Self::default();
            }
        });
        ui.label(texts::ABOUT);
        self.question(ui, bindings);
        ui.add_space(0.5 * GAP);
        let columns = (ui.available_width() / WIDTH).floor().max(1.0) as usize;
        let rows = ACTIONS.len().div_ceil(columns);
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.columns(columns, |columns| {
                for (index, entries) in ACTIONS.chunks(rows).enumerate() {
                    Grid::new(("bindings", index))
                        .num_columns(2 + SLOTS)
                        .spacing([8.0, 3.0])
                        .show(&mut columns[index], |ui| {
                            for entry in entries {
                                self.row(ui, entry, bindings);
                                ui.end_row();
                            }
                        });
                }
            });
        });
    }

    /// Asks whose a key shall be.
    fn question(&mut self, ui: &mut Ui, bindings: &mut Bindings) {
        if let Some(chord) = self.refused {
            ui.colored_label(WARNING, texts::cannot(&chord.to_string()));
        }
        let Some(Question {
            action,
            slot,
            chord,
        }) = self.asks
        else {
            return;
        };
        let Some(owner) = bindings.owner(chord) else {
            self.asks = None;
            return;
        };
        ui.horizontal_wrapped(|ui| {
            let [owner, wanted] = [owner, action].map(|action| action.entry().name);
            ui.colored_label(WARNING, texts::taken(&chord.to_string(), owner, wanted));
            if ui.button(texts::TAKE).clicked() {
                bindings.bind(action, slot, chord);
                self.asks = None;
            }
            if ui.button(texts::LEAVE).clicked() {
                self.asks = None;
            }
        });
    }

    fn row(&mut self, ui: &mut Ui, entry: &Entry, bindings: &mut Bindings) {
        let action = entry.action;
        let chords = bindings.chords(action).to_vec();
        let name = match chords.is_empty() {
            true => RichText::new(entry.name).color(WARNING),
            false => RichText::new(entry.name),
        };
        let label = ui.label(name);
        match chords.is_empty() {
            true => label.on_hover_text(texts::NO_KEY),
            false => label.on_hover_text(entry.help),
        };
        for slot in 0..SLOTS {
            let is_waiting = self.waits == Some((action, slot));
            let text = match (is_waiting, chords.get(slot)) {
                (true, _) => texts::PRESS.to_owned(),
                (false, Some(chord)) => chord.to_string(),
                (false, None) => texts::NONE.to_owned(),
            };
            let button = Button::new(text).selected(is_waiting).min_size(KEY);
            // The second key comes after the first.
            let response = ui.add_enabled(slot <= chords.len(), button);
            if response.clicked() {
                *self = Self {
                    waits: Some((action, slot)),
                    ..Self::default()
                };
            }
            if response.secondary_clicked() {
                bindings.clear(action, slot);
            }
        }
        if !bindings.is_default(action)
            && ui
                .small_button(RichText::new(texts::RESET).monospace())
                .on_hover_text(texts::RESET_HINT)
                .clicked()
        {
            self.reset(action, bindings);
        }
    }

    /// Gives an action its first keys, but asks if one of them is another's by now.
    fn reset(&mut self, action: Action, bindings: &mut Bindings) {
        *self = Self::default();
        let defaults = action.entry().defaults;
        let taken = defaults
            .iter()
            .enumerate()
            .find(|(_, chord)| bindings.owner(**chord).is_some_and(|owner| owner != action));
        match taken {
            None => bindings.reset(action),
            Some((slot, chord)) => {
                self.asks = Some(Question {
                    action,
                    slot,
                    chord: *chord,
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chord(text: &str) -> Chord {
        text.parse().expect("a key")
    }

    fn waiting() -> KeyPage {
        KeyPage {
            waits: Some((Action::Fly, 0)),
            ..KeyPage::default()
        }
    }

    #[test]
    fn a_press_is_bound_a_taken_one_asked_about_and_esc_refused() {
        let mut bindings = Bindings::default();
        let mut page = waiting();
        page.take(chord("T"), &mut bindings);
        assert_eq!(page, KeyPage::default());
        assert_eq!(bindings.names(Action::Fly), "T");

        page = waiting();
        page.take(chord("W"), &mut bindings);
        assert!(page.asks.is_some() && !page.waits());
        assert_eq!(bindings.names(Action::Fly), "T", "nothing without a word");
        assert_eq!(bindings.names(Action::Forward), "W");

        page = waiting();
        page.take(chord("Esc"), &mut bindings);
        assert_eq!(page.refused, Some(chord("Esc")));
        page = waiting();
        page.leave();
        page.take(chord("X"), &mut bindings);
        assert_eq!(bindings.names(Action::Fly), "T");
    }

    #[test]
    fn a_reset_asks_before_it_takes_a_key_from_another() {
        let mut bindings = Bindings::default();
        bindings.bind(Action::Fly, 0, chord("T"));
        bindings.bind(Action::Up, 0, chord("K"));
        let mut page = KeyPage::default();
        page.reset(Action::Fly, &mut bindings);
        assert!(page.asks.is_some());
        assert_eq!(bindings.names(Action::Up), "K");
        page.reset(Action::Up, &mut bindings);
        page.reset(Action::Fly, &mut bindings);
        assert_eq!(
            (&page, &bindings),
            (&KeyPage::default(), &Bindings::default())
        );
    }
}
