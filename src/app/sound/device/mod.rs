//! The system's sound device, on a thread of its own. Frames hand over commands and never wait; without a device
//! they go nowhere. A device that comes later, or again, is used from then on.

#[cfg(any(windows, target_vendor = "apple"))]
#[path = "cpal.rs"]
mod system;
#[cfg(all(unix, not(target_vendor = "apple")))]
#[path = "pulse.rs"]
mod system;

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::{self, Receiver, SyncSender, TrySendError},
    },
    thread,
    time::Duration,
};

use super::mixer::{Command, Mixer};

/// Commands that may wait for the device. When there are more, the newest are dropped: a noise that is heard late is
/// worse than none.
const WAITING: usize = 256;
/// How long to wait for another device.
const RETRY: Duration = Duration::from_secs(3);

/// Whether anything is heard.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum State {
    Opening,
    Playing,
    /// Why nothing is heard.
    Silent(String),
}

/// What both threads know.
struct Shared {
    state: Mutex<State>,
    /// The window is closed.
    is_over: AtomicBool,
}

pub struct Device {
    commands: SyncSender<Command>,
    shared: Arc<Shared>,
}

/// The mixer on the device's side.
pub struct Player {
    mixer: Mixer,
    seed: u32,
    commands: Receiver<Command>,
    shared: Arc<Shared>,
}

impl Device {
    /// Begins to look for a device. Returns at once.
    pub fn open(seed: u32) -> Self {
        let (commands, received) = mpsc::sync_channel(WAITING);
        let shared = Arc::new(Shared {
            state: Mutex::new(State::Opening),
            is_over: AtomicBool::new(false),
        });
        let player = Arc::new(Mutex::new(Player {
            mixer: Mixer::new(48_000.0, seed),
            seed,
            commands: received,
            shared: shared.clone(),
        }));
        let own = shared.clone();
        let spawned = thread::Builder::new()
            .name("sound".into())
            .spawn(move || play_on(&player, &own));
        if let Err(error) = spawned {
            *locked(&shared.state) = State::Silent(format!("no thread can be started: {error}"));
        }
        Self { commands, shared }
    }

    /// Hands over a command. Returns false if it was dropped.
    pub fn send(&self, command: Command) -> bool {
        match self.commands.try_send(command) {
            Ok(()) => true,
            Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => false,
        }
    }

    pub fn state(&self) -> State {
        locked(&self.shared.state).clone()
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        self.shared.is_over.store(true, Ordering::Relaxed);
    }
}

impl Player {
    /// Begins again on a device with this many samples a second. What waited for it is forgotten, except how the
    /// room is and how loud.
    pub fn begin(&mut self, rate_hz: f32) {
        let mut mixer = Mixer::new(rate_hz, self.seed);
        self.mixer
            .settings()
            .into_iter()
            .for_each(|setting| mixer.take(setting));
        while let Ok(command) = self.commands.try_recv() {
            if !matches!(command, Command::Make(..)) {
                mixer.take(command);
            }
        }
        self.mixer = mixer;
        *locked(&self.shared.state) = State::Playing;
    }

    /// Takes what was sent since the last call, before the next samples are taken. Returns false once the window is
    /// closed.
    pub fn catch_up(&mut self) -> bool {
        while let Ok(command) = self.commands.try_recv() {
            self.mixer.take(command);
        }
        !self.shared.is_over.load(Ordering::Relaxed)
    }

    /// The next sample of the left and the right ear.
    pub fn next(&mut self) -> [f32; 2] {
        self.mixer.next()
    }
}

/// Plays on one device after the other until the window is closed.
fn play_on(player: &Arc<Mutex<Player>>, shared: &Shared) {
    let is_over = || shared.is_over.load(Ordering::Relaxed);
    while !is_over() {
        let ended = system::play(player, &is_over);
        let Err(reason) = ended else {
            return;
        };
        tracing::info!("no sound: {reason}");
        *locked(&shared.state) = State::Silent(reason);
        let mut waited = Duration::ZERO;
        while waited < RETRY && !is_over() {
            let part = Duration::from_millis(100);
            thread::sleep(part);
            waited += part;
        }
    }
}

/// What a thread that panicked has left is still a state.
pub fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        app::sound::{
            mixer::Room,
            noise::{Kind, Noise},
        },
        world::materials::MaterialSound,
    };

    /// Both sides, without a thread and without a device.
    fn both() -> (Device, Player) {
        let (commands, received) = mpsc::sync_channel(WAITING);
        let shared = Arc::new(Shared {
            state: Mutex::new(State::Opening),
            is_over: AtomicBool::new(false),
        });
        let player = Player {
            mixer: Mixer::new(48_000.0, 1),
            seed: 1,
            commands: received,
            shared: shared.clone(),
        };
        (Device { commands, shared }, player)
    }

    fn dig() -> Command {
        let noise = Noise {
            kind: Kind::Dig,
            material: MaterialSound::Stone,
            strength: 1.0,
            at_ns: 0,
        };
        Command::Make(noise, 0.0)
    }

    fn is_silent(player: &mut Player) -> bool {
        (0..48_000).all(|_| player.next() == [0.0; 2])
    }

    #[test]
    fn commands_are_heard_and_a_device_that_does_not_play_makes_nobody_wait() {
        let (device, mut player) = both();
        assert!(device.send(Command::Volume(1.0)) && device.send(dig()));
        assert!(player.catch_up());
        assert!(!is_silent(&mut player));
        assert!((0..WAITING).all(|_| device.send(dig())));
        assert!(!device.send(dig()), "the queue is full");
    }

    #[test]
    fn another_device_goes_on_in_the_same_room_and_forgets_old_noises() {
        let (device, mut player) = both();
        let windy = Room {
            sky: 1.0,
            ..Room::default()
        };
        assert!(device.send(Command::Volume(1.0)));
        assert!(player.catch_up());
        assert!(device.send(Command::Room(windy)) && device.send(dig()));
        player.begin(44_100.0);
        assert_eq!(device.state(), State::Playing);
        let loudest = |player: &mut Player| {
            let samples = (0..44_100).map(|_| player.next()[0].abs());
            samples.fold(0.0, f32::max)
        };
        let wind = loudest(&mut player);
        assert!(wind > 0.001 && wind < 0.1, "{wind}: wind, and no dig");
        assert!(device.send(dig()) && player.catch_up());
        assert!(loudest(&mut player) > 3.0 * wind);
    }

    #[test]
    fn a_closed_window_ends_the_sound() {
        let (device, mut player) = both();
        drop(device);
        assert!(!player.catch_up());
    }
}
