//! Keys and buttons, alone and with others held: their names, and which of them an event of the window is.

use std::fmt;

use winit::{
    event::MouseButton,
    keyboard::{Key, KeyCode, ModifiersState},
};

/// Keys that are held together with another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Modifiers {
    pub ctrl: bool,
    pub shift: bool,
    pub alt: bool,
}

impl Modifiers {
    pub const NONE: Self = Self {
        ctrl: false,
        shift: false,
        alt: false,
    };
}

impl From<ModifiersState> for Modifiers {
    fn from(state: ModifiersState) -> Self {
        Self {
            ctrl: state.control_key(),
            shift: state.shift_key(),
            alt: state.alt_key(),
        }
    }
}

/// A key of the keyboard by its place, or a button of the mouse. Together with Ctrl a key counts by its letter: Z and Y
/// trade places on some keyboards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Trigger {
    Key(KeyCode),
    Mouse(MouseButton),
}

impl Trigger {
    /// Whether it modifies other keys.
    pub fn is_modifier(self) -> bool {
        use KeyCode::{AltLeft, AltRight, ControlLeft, ShiftLeft};
        matches!(
            self,
            Self::Key(ControlLeft | ShiftLeft | AltLeft | AltRight)
        )
    }

    /// Whether it types nothing, and so works beside a field for text.
    pub fn is_function_key(self) -> bool {
        let name = self.to_string();
        let number = name.strip_prefix('F').unwrap_or_default();
        number.parse::<u8>().is_ok() || self == Self::Key(KeyCode::Escape)
    }
}

/// A key or a button that went down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Press {
    /// What it is by its place: left and right Shift are one key, and so are left and right Ctrl.
    pub trigger: Trigger,
    /// What it is by its letter, on a keyboard of the United States.
    letter: Option<KeyCode>,
    modifiers: Modifiers,
}

impl Press {
    pub fn of_key(code: KeyCode, logical: &Key, modifiers: impl Into<Modifiers>) -> Self {
        let letter = match logical {
            Key::Character(text) => {
                let name = format!("Key{}", text.to_uppercase());
                let mut codes = CODES.iter().copied();
                codes.find(|code| format!("{code:?}") == name)
            }
            _ => None,
        };
        Self {
            trigger: Trigger::Key(match code {
                KeyCode::ShiftRight => KeyCode::ShiftLeft,
                KeyCode::ControlRight => KeyCode::ControlLeft,
                code => code,
            }),
            letter,
            modifiers: modifiers.into(),
        }
    }

    pub fn of_button(button: MouseButton, modifiers: impl Into<Modifiers>) -> Self {
        Self {
            trigger: Trigger::Mouse(button),
            letter: None,
            modifiers: modifiers.into(),
        }
    }

    /// With what is held. A modifier alone is a key like others.
    pub fn chord(self) -> Chord {
        let trigger = match self.letter {
            Some(letter) if self.modifiers.ctrl => Trigger::Key(letter),
            _ => self.trigger,
        };
        Chord::of(trigger, self.modifiers)
    }
}

/// A key or button, with what is held together with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Chord {
    pub modifiers: Modifiers,
    pub trigger: Trigger,
}

impl Chord {
    pub const fn plain(trigger: Trigger) -> Self {
        Self {
            modifiers: Modifiers::NONE,
            trigger,
        }
    }

    /// A modifier alone is a key like others: nothing is held together with it.
    fn of(trigger: Trigger, modifiers: Modifiers) -> Self {
        let modifiers = match trigger.is_modifier() {
            true => Modifiers::NONE,
            false => modifiers,
        };
        Self { modifiers, trigger }
    }

    /// Esc is the way out of everything, and keys without a name cannot be written down.
    pub fn can_be_bound(self) -> bool {
        self.trigger != Trigger::Key(KeyCode::Escape) && self.to_string().parse() == Ok(self)
    }
}

/// A name that is no key or button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownKey;

const CTRL: &str = "Ctrl";
const SHIFT: &str = "Shift";
const ALT: &str = "Alt";
const BETWEEN: char = '+';

impl fmt::Display for Chord {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Modifiers { ctrl, shift, alt } = self.modifiers;
        for (held, name) in [(ctrl, CTRL), (alt, ALT), (shift, SHIFT)] {
            if held {
                write!(formatter, "{name}{BETWEEN}")?;
            }
        }
        self.trigger.fmt(formatter)
    }
}

impl std::str::FromStr for Chord {
    type Err = UnknownKey;

    fn from_str(text: &str) -> Result<Self, UnknownKey> {
        let mut modifiers = Modifiers::NONE;
        let mut parts = text.split(BETWEEN).map(str::trim);
        let last = parts.next_back().ok_or(UnknownKey)?;
        for part in parts {
            match part {
                CTRL => modifiers.ctrl = true,
                SHIFT => modifiers.shift = true,
                ALT => modifiers.alt = true,
                _ => return Err(UnknownKey),
            }
        }
        let trigger = last.parse()?;
        Ok(Self::of(trigger, modifiers))
    }
}

/// Words of the mouse's buttons.
const BUTTONS: &[(MouseButton, &str)] = &[
    (MouseButton::Left, "left click"),
    (MouseButton::Right, "right click"),
    (MouseButton::Middle, "middle click"),
    (MouseButton::Back, "mouse back"),
    (MouseButton::Forward, "mouse forward"),
];
/// Begins the name of another button of the mouse.
const BUTTON: &str = "mouse button ";

impl fmt::Display for Trigger {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let code = match self {
            Self::Key(code) => code,
            Self::Mouse(MouseButton::Other(number)) => {
                return write!(formatter, "{BUTTON}{number}");
            }
            Self::Mouse(button) => {
                let known = BUTTONS.iter().find(|known| known.0 == *button);
                return formatter.write_str(known.map_or("mouse", |known| known.1));
            }
        };
        match code {
            KeyCode::ControlLeft => formatter.write_str(CTRL),
            KeyCode::ShiftLeft => formatter.write_str(SHIFT),
            KeyCode::Escape => formatter.write_str("Esc"),
            KeyCode::BracketLeft => formatter.write_str("["),
            KeyCode::BracketRight => formatter.write_str("]"),
            code => {
                let name = format!("{code:?}");
                let short = name.strip_prefix("Key").or(name.strip_prefix("Digit"));
                formatter.write_str(&spaced(short.unwrap_or(&name)))
            }
        }
    }
}

/// `ArrowUp` as `Arrow Up`, `Numpad1` as `Numpad 1`.
fn spaced(name: &str) -> String {
    let mut words = String::new();
    let mut was_lower = false;
    for letter in name.chars() {
        if was_lower && !letter.is_lowercase() {
            words.push(' ');
        }
        words.push(letter);
        was_lower = letter.is_lowercase();
    }
    words
}

impl std::str::FromStr for Trigger {
    type Err = UnknownKey;

    fn from_str(text: &str) -> Result<Self, UnknownKey> {
        if let Some(number) = text.strip_prefix(BUTTON) {
            let number = number.parse().map_err(|_| UnknownKey)?;
            return Ok(Self::Mouse(MouseButton::Other(number)));
        }
        let buttons = BUTTONS.iter().map(|known| Self::Mouse(known.0));
        let keys = CODES.iter().map(|code| Self::Key(*code));
        buttons
            .chain(keys)
            .find(|known| known.to_string().eq_ignore_ascii_case(text))
            .ok_or(UnknownKey)
    }
}

macro_rules! codes {
    ($($name:ident),* $(,)?) => {
        /// The keys that can be bound, and Escape.
        const CODES: &[KeyCode] = &[$(KeyCode::$name),*];
    };
}

#[rustfmt::skip]
codes![
    KeyA, KeyB, KeyC, KeyD, KeyE, KeyF, KeyG, KeyH, KeyI, KeyJ, KeyK, KeyL, KeyM, KeyN, KeyO, KeyP, KeyQ, KeyR, KeyS,
    KeyT, KeyU, KeyV, KeyW, KeyX, KeyY, KeyZ, Digit0, Digit1, Digit2, Digit3, Digit4, Digit5, Digit6, Digit7, Digit8,
    Digit9, F1, F2, F3, F4, F5, F6, F7, F8, F9, F10, F11, F12, F13, F14, F15, F16, F17, F18, F19, F20, F21, F22, F23, F24,
    Escape, Space, Tab, Enter, Backspace, CapsLock, ShiftLeft, ControlLeft, AltLeft, AltRight, SuperLeft, SuperRight,
    ContextMenu, ArrowUp, ArrowDown, ArrowLeft, ArrowRight, Insert, Delete, Home, End, PageUp, PageDown, PrintScreen,
    ScrollLock, Pause, Backquote, Minus, Equal, BracketLeft, BracketRight, Backslash, Semicolon, Quote, Comma, Period,
    Slash, IntlBackslash, IntlRo, IntlYen, NumLock, Numpad0, Numpad1, Numpad2, Numpad3, Numpad4, Numpad5, Numpad6,
    Numpad7, Numpad8, Numpad9, NumpadAdd, NumpadSubtract, NumpadMultiply, NumpadDivide, NumpadDecimal, NumpadComma,
    NumpadEnter, NumpadEqual,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back_as_the_same_keys() {
        let buttons = BUTTONS.iter().map(|known| known.0);
        let buttons = buttons.chain([MouseButton::Other(9)]).map(Trigger::Mouse);
        let keys = CODES.iter().map(|code| Trigger::Key(*code));
        let ctrl = Modifiers {
            ctrl: true,
            ..Modifiers::NONE
        };
        for trigger in keys.chain(buttons) {
            for modifiers in [Modifiers::NONE, ctrl] {
                let chord = Chord::of(trigger, modifiers);
                assert_eq!(chord.to_string().parse(), Ok(chord), "{chord}");
                let is_esc = trigger == Trigger::Key(KeyCode::Escape);
                assert_eq!(chord.can_be_bound(), !is_esc, "{chord}");
            }
        }
        for (name, code) in [
            ("W", KeyCode::KeyW),
            ("Arrow Up", KeyCode::ArrowUp),
            ("Numpad 7", KeyCode::Numpad7),
            ("f11", KeyCode::F11),
        ] {
            assert_eq!(name.parse(), Ok(Chord::plain(Trigger::Key(code))));
        }
        for name in ["", "+", "Hyper+A", "WW", "mouse button x", "Ctrl+"] {
            assert_eq!(name.parse::<Chord>(), Err(UnknownKey), "{name}");
        }
        assert!(!Chord::plain(Trigger::Key(KeyCode::Fn)).can_be_bound());
    }

    #[test]
    fn with_ctrl_the_letter_counts_and_not_its_place() {
        let z = Key::Character("z".into());
        let ctrl = Modifiers {
            ctrl: true,
            ..Modifiers::NONE
        };
        let of = |modifiers| Press::of_key(KeyCode::KeyY, &z, modifiers);
        assert_eq!(of(ctrl).chord().to_string(), "Ctrl+Z");
        assert_eq!(of(Modifiers::NONE).chord().to_string(), "Y");
        assert_eq!(of(ctrl).trigger, of(Modifiers::NONE).trigger);
        let right = Press::of_key(KeyCode::ControlRight, &z, Modifiers::NONE);
        assert_eq!(right.chord().to_string(), "Ctrl");
        let click = Press::of_button(MouseButton::Left, ctrl);
        assert_eq!(click.chord().to_string(), "Ctrl+left click");
    }

    #[test]
    fn function_keys_are_those_that_type_nothing() {
        for (code, is_one) in [
            (KeyCode::F1, true),
            (KeyCode::F12, true),
            (KeyCode::Escape, true),
            (KeyCode::KeyF, false),
            (KeyCode::Tab, false),
        ] {
            assert_eq!(Trigger::Key(code).is_function_key(), is_one, "{code:?}");
        }
    }
}
