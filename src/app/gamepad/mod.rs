//! Gamepads: sticks move and look, buttons and triggers do what keys do.
//!
//! Here is what their events mean; `device` hears them from the system, where grotto is built with the feature `gamepad`.

#[cfg(feature = "gamepad")]
mod device;

use std::{collections::BTreeSet, time::Duration};

#[cfg(feature = "gamepad")]
pub use device::Gamepads;

use super::controls::Action;

/// The buttons of a gamepad by their places: South is A on some and a cross on others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Button {
    South,
    East,
    West,
    North,
    LeftShoulder,
    RightShoulder,
    LeftTrigger,
    RightTrigger,
    LeftStick,
    RightStick,
    Start,
    Select,
}

/// What the buttons do.
const BUTTONS: &[(Button, Action)] = &[
    (Button::South, Action::Up),
    (Button::East, Action::Down),
    (Button::West, Action::Pick),
    (Button::North, Action::Fly),
    (Button::LeftShoulder, Action::Undo),
    (Button::RightShoulder, Action::Redo),
    (Button::LeftTrigger, Action::Place),
    (Button::RightTrigger, Action::Dig),
    (Button::LeftStick, Action::Run),
    (Button::RightStick, Action::Down),
    (Button::Start, Action::Help),
    (Button::Select, Action::Save),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stick {
    /// Moves.
    Left,
    /// Looks.
    Right,
}

/// What a gamepad reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    Press(Button),
    Release(Button),
    /// One axis of a stick: x to the right or y up, in [−1, 1].
    Tilt {
        stick: Stick,
        is_y: bool,
        value: f32,
    },
    Gone,
}

/// What an event leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    Begin(Action),
    End(Action),
}

/// Tilts of a stick at rest are smaller than this: sticks do not come back to their very centre.
const DEAD_ZONE: f32 = 0.2;
/// A direction counts for a key from this share of the tilt: eight directions of equal width.
const DIRECTION: f32 = 0.383;
/// The view turns this fast at full tilt (degrees per second).
const TURN_DEG_PER_S: f64 = 200.0;
/// Pixels of the mouse that turn the view by a degree.
const PIXELS_PER_DEG: f64 = 10.0;

/// All gamepads. The one that was used last leads.
#[derive(Debug, Default)]
pub struct Pads {
    leader: Option<usize>,
    /// The tilts of the leader's sticks: right, up.
    left: [f32; 2],
    right: [f32; 2],
    pressed: BTreeSet<Button>,
    /// The directions of the left stick.
    moves: BTreeSet<Action>,
}

impl Pads {
    /// Takes an event of the gamepad with this number. Sticks at rest and releases do not make it the leader.
    pub fn take(&mut self, pad: usize, event: Event) -> Vec<Effect> {
        let mut effects = Vec::new();
        if self.leader != Some(pad) {
            let leads = match event {
                Event::Press(_) => true,
                Event::Tilt { value, .. } => value.abs() > DEAD_ZONE,
                Event::Release(_) | Event::Gone => false,
            };
            if !leads {
                return effects;
            }
            effects = self.release();
            self.leader = Some(pad);
        }
        match event {
            Event::Press(button) => {
                self.pressed.insert(button);
                effects.extend(action(button).map(Effect::Begin));
            }
            Event::Release(button) => {
                // What was pressed before the menu opened has ended with it.
                let was_pressed = self.pressed.remove(&button);
                let ended = action(button).filter(|action| was_pressed && !self.holds(*action));
                effects.extend(ended.map(Effect::End));
            }
            Event::Tilt { stick, is_y, value } => {
                let tilt = match stick {
                    Stick::Left => &mut self.left,
                    Stick::Right => &mut self.right,
                };
                tilt[usize::from(is_y)] = if value.is_finite() { value } else { 0.0 };
                effects.extend(self.follow());
            }
            Event::Gone => {
                effects = self.release();
                self.leader = None;
            }
        }
        effects
    }

    /// Ends everything, as when the window loses the keyboard or the menu opens.
    pub fn release(&mut self) -> Vec<Effect> {
        let buttons = std::mem::take(&mut self.pressed);
        let moves = std::mem::take(&mut self.moves);
        (self.left, self.right) = Default::default();
        let held: BTreeSet<Action> = buttons
            .into_iter()
            .filter_map(action)
            .chain(moves)
            .collect();
        held.into_iter().map(Effect::End).collect()
    }

    /// Where the view goes in this time, in pixels of the mouse: right, down.
    pub fn look(&self, elapsed: Duration) -> Option<(f64, f64)> {
        let [right, up] = outside_dead_zone(self.right);
        // Small tilts aim, large ones turn.
        let speed = f64::from(right.hypot(up)) * TURN_DEG_PER_S * PIXELS_PER_DEG;
        let pixels = [right, -up].map(|share| f64::from(share) * speed * elapsed.as_secs_f64());
        (pixels != [0.0, 0.0]).then_some((pixels[0], pixels[1]))
    }

    fn holds(&self, wanted: Action) -> bool {
        let buttons = self.pressed.iter().copied();
        buttons.filter_map(action).any(|action| action == wanted)
    }

    /// Presses and releases the directions of the left stick.
    fn follow(&mut self) -> Vec<Effect> {
        let [right, up] = outside_dead_zone(self.left);
        let least = DIRECTION * right.hypot(up);
        let directions = [
            (Action::Right, right),
            (Action::Left, -right),
            (Action::Forward, up),
            (Action::Back, -up),
        ];
        let next: BTreeSet<Action> = directions
            .into_iter()
            .filter(|(_, tilt)| *tilt > least)
            .map(|(action, _)| action)
            .collect();
        let ended = self.moves.difference(&next).copied().map(Effect::End);
        let begun = next.difference(&self.moves).copied().map(Effect::Begin);
        let effects = ended.chain(begun).collect();
        self.moves = next;
        effects
    }
}

fn action(button: Button) -> Option<Action> {
    let row = BUTTONS.iter().find(|row| row.0 == button);
    row.map(|row| row.1)
}

/// The tilt beyond the dead zone, which is round: 0 at its edge, at most 1.
fn outside_dead_zone([x, y]: [f32; 2]) -> [f32; 2] {
    let length = x.hypot(y);
    if length <= DEAD_ZONE {
        return [0.0, 0.0];
    }
    let reach = ((length - DEAD_ZONE) / (1.0 - DEAD_ZONE)).min(1.0);
    [x, y].map(|part| part / length * reach)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tilt(stick: Stick, is_y: bool, value: f32) -> Event {
        Event::Tilt { stick, is_y, value }
    }

    #[test]
    fn sticks_at_rest_do_nothing() {
        let mut pads = Pads::default();
        for value in [0.1, -0.19, f32::NAN, 0.0] {
            assert!(pads.take(0, tilt(Stick::Left, false, value)).is_empty());
            assert!(pads.take(0, tilt(Stick::Right, true, value)).is_empty());
            assert_eq!(pads.look(Duration::from_secs(1)), None);
        }
        assert_eq!(pads.leader, None);
    }

    #[test]
    fn the_left_stick_moves_in_eight_directions() {
        let mut pads = Pads::default();
        let up = pads.take(0, tilt(Stick::Left, true, 0.9));
        assert_eq!(up, [Effect::Begin(Action::Forward)]);
        assert!(
            pads.take(0, tilt(Stick::Left, false, 0.3)).is_empty(),
            "nearly ahead"
        );
        let aslant = pads.take(0, tilt(Stick::Left, false, 0.8));
        assert_eq!(aslant, [Effect::Begin(Action::Right)]);
        let down = pads.take(0, tilt(Stick::Left, true, -0.1));
        assert_eq!(down, [Effect::End(Action::Forward)]);
        let rest = pads.take(0, tilt(Stick::Left, false, 0.05));
        assert_eq!(rest, [Effect::End(Action::Right)]);
    }

    #[test]
    fn the_right_stick_looks_as_long_as_it_is_tilted() {
        let mut pads = Pads::default();
        pads.take(0, tilt(Stick::Right, true, 1.0));
        let tenth = Duration::from_millis(100);
        let (right, down) = pads.look(tenth).expect("it is tilted");
        assert!(
            right == 0.0 && (down + 200.0).abs() < 1e-3,
            "20° up: {down}"
        );
        pads.take(0, tilt(Stick::Right, true, 0.6));
        let (_, half) = pads.look(tenth).expect("it is tilted");
        assert!((half + 50.0).abs() < 1e-3, "a quarter of the speed: {half}");
        assert_eq!(outside_dead_zone([2.0, 0.0]), [1.0, 0.0]);
    }

    #[test]
    fn buttons_do_what_keys_do() {
        let mut pads = Pads::default();
        for (button, action) in BUTTONS {
            assert_eq!(
                pads.take(0, Event::Press(*button)),
                [Effect::Begin(*action)]
            );
            assert_eq!(
                pads.take(0, Event::Release(*button)),
                [Effect::End(*action)]
            );
            assert!(pads.take(0, Event::Release(*button)).is_empty());
        }
        // Two buttons sneak.
        pads.take(0, Event::Press(Button::East));
        pads.take(0, Event::Press(Button::RightStick));
        assert!(pads.take(0, Event::Release(Button::East)).is_empty());
        let last = pads.take(0, Event::Release(Button::RightStick));
        assert_eq!(last, [Effect::End(Action::Down)]);
    }

    #[test]
    fn the_gamepad_that_was_used_last_leads() {
        let mut pads = Pads::default();
        pads.take(0, tilt(Stick::Left, true, 1.0));
        pads.take(0, Event::Press(Button::RightTrigger));
        assert!(pads.take(1, tilt(Stick::Left, true, 0.1)).is_empty());
        assert!(pads.take(1, Event::Release(Button::South)).is_empty());
        let taken = pads.take(1, Event::Press(Button::South));
        let wanted = [
            Effect::End(Action::Forward),
            Effect::End(Action::Dig),
            Effect::Begin(Action::Up),
        ];
        assert_eq!(taken, wanted, "what the other held has ended");
        assert!(pads.take(0, Event::Gone).is_empty());
        assert_eq!(pads.take(1, Event::Gone), [Effect::End(Action::Up)]);
        assert_eq!(pads.leader, None);
    }
}
