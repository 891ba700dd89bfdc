//! Hears gamepads through gilrs.

use gilrs::{Axis, EventType, Gilrs};

use super::{Button, Event, Pads, Stick};

/// The gamepads of the system.
pub struct Gamepads {
    gilrs: Gilrs,
    pub pads: Pads,
}

impl Gamepads {
    /// `None` where the system offers no gamepads. Nobody is told: most have none.
    pub fn open() -> Option<Self> {
        match Gilrs::new() {
            Ok(gilrs) => Some(Self {
                gilrs,
                pads: Pads::default(),
            }),
            Err(error) => {
                tracing::debug!("no gamepads: {error}");
                None
            }
        }
    }

    /// What has happened since the last call, with the numbers of the gamepads.
    pub fn events(&mut self) -> Vec<(usize, Event)> {
        let mut events = Vec::new();
        while let Some(gilrs::Event { id, event, .. }) = self.gilrs.next_event() {
            events.extend(translated(event).map(|event| (usize::from(id), event)));
        }
        events
    }
}

fn translated(event: EventType) -> Option<Event> {
    match event {
        EventType::ButtonPressed(button, _) => named(button).map(Event::Press),
        EventType::ButtonReleased(button, _) => named(button).map(Event::Release),
        EventType::AxisChanged(axis, value, _) => {
            let (stick, is_y) = match axis {
                Axis::LeftStickX => (Stick::Left, false),
                Axis::LeftStickY => (Stick::Left, true),
                Axis::RightStickX => (Stick::Right, false),
                Axis::RightStickY => (Stick::Right, true),
                _ => return None,
            };
            Some(Event::Tilt { stick, is_y, value })
        }
        EventType::Disconnected => Some(Event::Gone),
        _ => None,
    }
}

fn named(button: gilrs::Button) -> Option<Button> {
    Some(match button {
        gilrs::Button::South => Button::South,
        gilrs::Button::East => Button::East,
        gilrs::Button::West => Button::West,
        gilrs::Button::North => Button::North,
        gilrs::Button::LeftTrigger => Button::LeftShoulder,
        gilrs::Button::RightTrigger => Button::RightShoulder,
        gilrs::Button::LeftTrigger2 => Button::LeftTrigger,
        gilrs::Button::RightTrigger2 => Button::RightTrigger,
        gilrs::Button::LeftThumb => Button::LeftStick,
        gilrs::Button::RightThumb => Button::RightStick,
        gilrs::Button::Start => Button::Start,
        gilrs::Button::Select => Button::Select,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_machine_without_gamepads_has_nothing_to_say() {
        if let Some(mut gamepads) = Gamepads::open() {
            assert!(
                gamepads
                    .pads
                    .look(std::time::Duration::from_secs(1))
                    .is_none()
            );
            gamepads.events();
        }
    }
}
