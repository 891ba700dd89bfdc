//! The user's keys: which chords do which action. No chord does two.

use std::collections::BTreeMap;

use super::{ACTIONS, Action, Chord, Entry, Press};
use crate::app::texts::bindings as texts;

/// Most keys of an action.
pub const SLOTS: usize = 2;

/// What stands for the key of an action that has none.
const NO_KEY: &str = "no key";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bindings {
    chords: BTreeMap<Action, Vec<Chord>>,
}

impl Default for Bindings {
    fn default() -> Self {
        let of = |entry: &Entry| (entry.action, entry.defaults.to_vec());
        Self {
            chords: ACTIONS.iter().map(of).collect(),
        }
    }
}

impl Bindings {
    /// The keys of an action.
    pub fn chords(&self, action: Action) -> &[Chord] {
        self.chords.get(&action).map_or(&[], Vec::as_slice)
    }

    /// The first key of an action, in words.
    pub fn first(&self, action: Action) -> String {
        let first = self.chords(action).first();
        first.map_or_else(|| NO_KEY.to_owned(), Chord::to_string)
    }

    /// All keys of an action, in words.
    pub fn names(&self, action: Action) -> String {
        match self.chords(action) {
            [] => NO_KEY.to_owned(),
            chords => chords
                .iter()
                .map(Chord::to_string)
                .collect::<Vec<_>>()
                .join(", "),
        }
    }

    /// The action of exactly this chord.
    pub fn owner(&self, chord: Chord) -> Option<Action> {
        let owner = self.chords.iter().find(|(_, own)| own.contains(&chord));
        owner.map(|(action, _)| *action)
    }

    /// What a press does. A key that does nothing together with those that are held does what it does alone: who runs
    /// with Ctrl still walks with W.
    pub fn pressed(&self, press: Press) -> Option<Action> {
        self.owner(press.chord())
            .or_else(|| self.owner(Chord::plain(press.trigger)))
    }

    /// Gives a chord to an action, in place of its `slot`-th or as a further one. Another action loses it. Chords that
    /// cannot be bound change nothing.
    pub fn bind(&mut self, action: Action, slot: usize, chord: Chord) {
        if !chord.can_be_bound() {
            return;
        }
        let own = self.chords.entry(action).or_default();
        let before = own.get(slot).copied();
        // A chord that the action has already only changes its place.
        let twin = own.iter().position(|known| *known == chord);
        match (before, twin) {
            (Some(_), Some(twin)) => own.swap(slot, twin),
            (None, Some(_)) => {}
            (_, None) => {
                for others in self.chords.values_mut() {
                    others.retain(|known| *known != chord);
                }
                let own = self.chords.entry(action).or_default();
                if let Some(place) = own.get_mut(slot) {
                    *place = chord;
                } else if own.len() < SLOTS {
                    own.push(chord);
                }
            }
        }
    }

    /// Takes the `slot`-th chord from an action.
    pub fn clear(&mut self, action: Action, slot: usize) {
        if let Some(own) = self.chords.get_mut(&action)
            && slot < own.len()
        {
            own.remove(slot);
        }
    }

    pub fn is_default(&self, action: Action) -> bool {
        self.chords(action) == action.entry().defaults
    }

    /// Gives an action its first keys again, whoever has them now.
    pub fn reset(&mut self, action: Action) {
        self.chords.insert(action, Vec::new());
        for (slot, chord) in action.entry().defaults.iter().enumerate() {
            self.bind(action, slot, *chord);
        }
    }

    /// What differs from the defaults, by the names of the actions.
    pub fn changed(&self) -> BTreeMap<String, Vec<String>> {
        let changed = ACTIONS
            .iter()
            .filter(|entry| !self.is_default(entry.action));
        changed
            .map(|entry| {
                let chords = self.chords(entry.action).iter();
                (entry.id.to_owned(), chords.map(Chord::to_string).collect())
            })
            .collect()
    }

    /// The bindings that differ from the defaults by `changed`, and what of it cannot be. What a user chose comes before
    /// the defaults of other actions; actions that are not known are ignored.
    pub fn with(changed: &BTreeMap<String, Vec<String>>) -> (Self, Vec<String>) {
        let mut notes = Vec::new();
        let mut bindings = Self {
            chords: BTreeMap::new(),
        };
        let known = |entry: &&Entry| changed.contains_key(entry.id);
        for entry in ACTIONS.iter().filter(known) {
            bindings.chords.insert(entry.action, Vec::new());
            for text in &changed[entry.id] {
                match text.parse::<Chord>() {
                    Ok(chord) if chord.can_be_bound() => {
                        bindings.give(entry, chord, &mut notes);
                    }
                    _ => notes.push(texts::no_key(text, entry.id)),
                }
            }
        }
        for entry in ACTIONS.iter().filter(|entry| !known(entry)) {
            bindings.chords.insert(entry.action, Vec::new());
            for chord in entry.defaults {
                bindings.give(entry, *chord, &mut notes);
            }
        }
        (bindings, notes)
    }

    /// Gives a chord to an action if nobody has it and there is room.
    fn give(&mut self, entry: &Entry, chord: Chord, notes: &mut Vec<String>) {
        let own = self.chords(entry.action).len();
        match self.owner(chord) {
            Some(owner) if owner == entry.action => {}
            Some(owner) => notes.push(texts::kept(&chord.to_string(), owner.entry().id, entry.id)),
            None if own < SLOTS => self.bind(entry.action, own, chord),
            None => notes.push(texts::full(&chord.to_string(), entry.id, SLOTS)),
        }
    }

    /// A text with the first key of an action in place of its name in braces, as in `{fly}`.
    pub fn fill(&self, text: &str) -> String {
        let mut filled = text.to_owned();
        for entry in ACTIONS {
            let place = format!("{{{}}}", entry.id);
            if filled.contains(&place) {
                filled = filled.replace(&place, &self.first(entry.action));
            }
        }
        filled
    }
}

#[cfg(test)]
mod tests {
    use winit::keyboard::{Key, KeyCode};

    use super::{super::Modifiers, *};

    fn chord(text: &str) -> Chord {
        text.parse().expect("a key")
    }

    const HELD: Modifiers = Modifiers {
        ctrl: true,
        ..Modifiers::NONE
    };

    #[test]
    fn held_keys_make_another_chord_or_none() {
        let bindings = Bindings::default();
        let of = |code, letter: &str, modifiers| {
            let logical = Key::Character(letter.into());
            bindings.pressed(Press::of_key(code, &logical, modifiers))
        };
        assert_eq!(of(KeyCode::KeyS, "s", HELD), Some(Action::Save));
        assert_eq!(of(KeyCode::KeyS, "s", Modifiers::NONE), Some(Action::Back));
        assert_eq!(of(KeyCode::KeyW, "w", HELD), Some(Action::Forward), "runs");
        // On a French keyboard.
        assert_eq!(of(KeyCode::KeyA, "q", HELD), Some(Action::Left), "runs");
        assert_eq!(of(KeyCode::KeyW, "z", HELD), Some(Action::Undo));
        assert_eq!(of(KeyCode::ControlLeft, "", HELD), Some(Action::Run));
        assert_eq!(of(KeyCode::KeyZ, "z", Modifiers::NONE), None);
        assert_eq!(of(KeyCode::Escape, "", Modifiers::NONE), None);
    }

    #[test]
    fn a_chord_belongs_to_one_action_and_can_be_taken_and_given_back() {
        let mut bindings = Bindings::default();
        bindings.bind(Action::Fly, 0, chord("W"));
        assert_eq!(bindings.owner(chord("W")), Some(Action::Fly));
        assert_eq!(bindings.names(Action::Forward), NO_KEY);
        assert_eq!(bindings.owner(chord("K")), None);
        bindings.bind(Action::Fly, 1, chord("Ctrl+F"));
        assert_eq!(bindings.names(Action::Fly), "W, Ctrl+F");
        bindings.bind(Action::Fly, 1, chord("W"));
        assert_eq!(
            bindings.names(Action::Fly),
            "Ctrl+F, W",
            "they trade places"
        );
        bindings.bind(Action::Fly, 0, chord("Esc"));
        assert_eq!(bindings.names(Action::Fly), "Ctrl+F, W", "Esc stays free");
        bindings.clear(Action::Fly, 0);
        bindings.clear(Action::Fly, 7);
        assert_eq!(bindings.names(Action::Fly), "W");
        bindings.reset(Action::Forward);
        assert_eq!(bindings.names(Action::Fly), NO_KEY);
        bindings.reset(Action::Fly);
        assert_eq!(bindings, Bindings::default());
    }

    #[test]
    fn what_was_changed_is_kept_and_comes_before_the_defaults_of_others() {
        let mut bindings = Bindings::default();
        assert!(bindings.changed().is_empty());
        bindings.bind(Action::Up, 0, chord("E"));
        bindings.bind(Action::Fly, 0, chord("Space"));
        bindings.clear(Action::Save, 0);
        let (read, notes) = Bindings::with(&bindings.changed());
        assert_eq!(read, bindings);
        assert_eq!(notes, [""; 0]);

        // A file that was written by hand.
        let changed = [
            ("up", &["F", "no such key", "Esc"][..]),
            ("fly", &["W", "F", "U", "H"]),
            ("of another version", &["Q"]),
        ];
        let owned = |keys: &[&str]| keys.iter().map(|key| (*key).to_owned()).collect();
        let changed = changed.map(|(id, keys)| (id.to_owned(), owned(keys)));
        let (read, notes) = Bindings::with(&changed.into());
        assert_eq!(read.names(Action::Up), "F");
        assert_eq!(read.names(Action::Fly), "W, U");
        assert_eq!(read.names(Action::Forward), NO_KEY);
        let wanted = [
            "`no such key` cannot be a key of `up`",
            "`Esc` cannot be a key of `up`",
            "`F` stays the key of `up`, and `fly` does not get it",
            "`fly` has 2 keys already: `H` is left out",
            "`W` stays the key of `fly`, and `forward` does not get it",
        ];
        assert_eq!(notes, wanted);
    }

    #[test]
    fn texts_name_the_keys_of_the_user() {
        let mut bindings = Bindings::default();
        bindings.bind(Action::Fly, 0, chord("F"));
        let filled = bindings.fill("{fly} flies, {up} jumps, {nothing} stays");
        assert_eq!(filled, "F flies, Space jumps, {nothing} stays");
    }
}
