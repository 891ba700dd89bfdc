//! Sound: what the player does is heard, in the room that surrounds the ear. All of it is computed; see
//! `docs/notes/sound.md`.
//!
//! A run makes `noise`s, a `Listener` (its `ears` send rays) turns them into commands, and a `mixer` with its `voice`s,
//! `reverb` and `wind` turns commands into samples: on the thread of a `device`, or frame by frame for a file (`wav`).

mod chance;
mod device;
mod ears;
mod filter;
mod mixer;
mod noise;
mod reverb;
#[cfg(test)]
mod signal;
mod voice;
pub mod wav;
mod wind;

use device::{Device, State};
use ears::Ears;
pub use ears::Place;
use mixer::{Command, Mixer, Room};
pub use noise::{Kind, Noise, Noises};

/// The seed of all sounds: runs differ by what happens in them.
const SEED: u32 = 0x6772_6f74;
/// Loudness at first: 0 to 1.
const VOLUME: f32 = 0.7;

/// Turns what happens in frames into commands.
struct Listener {
    ears: Ears,
    /// Simulated time of the last frame (nanoseconds).
    heard_ns: u64,
    room: Room,
}

impl Listener {
    fn new() -> Self {
        Self {
            ears: Ears::new(SEED),
            heard_ns: 0,
            room: Room::default(),
        }
    }

    /// One frame until a simulated time: a noise sounds as long after the frame's begin as it was made.
    fn frame(
        &mut self,
        place: &Place<'_>,
        noises: &mut Noises,
        now_ns: u64,
        mut send: impl FnMut(Command),
    ) {
        // Another run begins at its own zero.
        let from_ns = self.heard_ns.min(now_ns);
        self.heard_ns = now_ns;
        let room = self.ears.listen(place, now_ns);
        if room != self.room {
            self.room = room;
            send(Command::Room(room));
        }
        for noise in noises.drain() {
            let wait_ns = noise.at_ns.saturating_sub(from_ns);
            send(Command::Make(noise, wait_ns as f32 * 1e-9));
        }
    }
}

/// The sound of a window.
pub struct Sound {
    listener: Listener,
    device: Device,
    volume: f32,
    muted: bool,
    paused: bool,
}

impl Sound {
    /// Begins to look for a device. Without one everything goes on in silence.
    pub fn open() -> Self {
        let sound = Self {
            listener: Listener::new(),
            device: Device::open(SEED),
            volume: VOLUME,
            muted: false,
            paused: false,
        };
        sound.tell_volume();
        sound
    }

    /// 0 to 1, as loudness is perceived.
    pub fn set_volume(&mut self, volume: f32) {
        if self.volume != volume {
            self.volume = volume;
            self.tell_volume();
        }
    }

    pub fn set_muted(&mut self, muted: bool) {
        if self.muted != muted {
            self.muted = muted;
            self.tell_volume();
        }
    }

    /// While a run stands still nothing is heard.
    pub fn set_paused(&mut self, paused: bool) {
        if self.paused != paused {
            self.paused = paused;
            self.tell_volume();
        }
    }

    fn tell_volume(&self) {
        let heard = if self.muted || self.paused {
            0.0
        } else {
            // Half of it sounds about half as loud: −12 dB.
            self.volume * self.volume
        };
        self.device.send(Command::Volume(heard));
    }

    /// Hears the noises of a frame that ends at a simulated time. Never waits.
    pub fn hear(&mut self, place: &Place<'_>, noises: &mut Noises, now_ns: u64) {
        let device = &self.device;
        self.listener.frame(place, noises, now_ns, |command| {
            device.send(command);
        });
    }

    /// Why nothing is heard, if so.
    pub fn silence(&self) -> Option<String> {
        match self.device.state() {
            State::Silent(reason) => Some(reason),
            State::Opening | State::Playing if self.muted => Some("it is muted".into()),
            State::Opening | State::Playing => None,
        }
    }
}

/// What a player would hear, sample by sample, without a device.
pub struct Soundtrack {
    listener: Listener,
    mixer: Mixer,
    /// Samples so far.
    samples: u64,
}

impl Default for Soundtrack {
    fn default() -> Self {
        Self::new()
    }
}

impl Soundtrack {
    pub fn new() -> Self {
        let mut mixer = Mixer::new(wav::RATE_HZ as f32, SEED);
        mixer.take(Command::Volume(VOLUME * VOLUME));
        Self {
            listener: Listener::new(),
            mixer,
            samples: 0,
        }
    }

    /// The samples of both ears of a frame that ends at a simulated time.
    pub fn frame(&mut self, place: &Place<'_>, noises: &mut Noises, now_ns: u64) -> Vec<[f32; 2]> {
        let mixer = &mut self.mixer;
        self.listener
            .frame(place, noises, now_ns, |command| mixer.take(command));
        let end = u128::from(now_ns) * u128::from(wav::RATE_HZ) / 1_000_000_000;
        let count = (end as u64).saturating_sub(self.samples);
        self.samples += count;
        (0..count).map(|_| self.mixer.next()).collect()
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, IVec3, UVec3};

    use super::*;
    use crate::world::{MaterialSound, voxels::Voxels};

    #[test]
    fn noises_keep_their_times_and_a_room_is_told_once() {
        let mut voxels = Voxels::empty(UVec3::splat(16));
        voxels.fill_box(IVec3::ZERO, IVec3::splat(15), 1);
        // Within stone nothing changes from frame to frame.
        let place = Place {
            voxels: &voxels,
            sounds: &[MaterialSound::Stone],
            ear: DVec3::splat(8.0),
            voxels_per_m: 1.0,
        };
        let mut listener = Listener::new();
        let mut noises = Noises::default();
        let mut told = Vec::new();
        listener.frame(&place, &mut noises, 1_000_000_000, |command| {
            told.push(command)
        });
        told.clear();
        noises.make(Noise {
            kind: Kind::Step,
            material: MaterialSound::Wood,
            strength: 1.0,
            at_ns: 1_012_000_000,
        });
        for now_ns in [1_020_000_000, 1_040_000_000] {
            listener.frame(&place, &mut noises, now_ns, |command| told.push(command));
        }
        let [Command::Make(noise, wait_s)] = told[..] else {
            panic!("{told:?}");
        };
        assert_eq!(noise.material, MaterialSound::Wood);
        assert!((wait_s - 0.012).abs() < 1e-6, "{wait_s}");
    }

    #[test]
    fn a_soundtrack_is_as_long_as_the_run_at_any_frame_rate() {
        let voxels = Voxels::empty(UVec3::splat(8));
        let place = Place {
            voxels: &voxels,
            sounds: &[],
            ear: DVec3::splat(4.0),
            voxels_per_m: 1.0,
        };
        for frames in [7_u64, 60, 144] {
            let mut track = Soundtrack::new();
            let end = |frame: u64| frame * 2_000_000_000 / frames;
            let samples: usize = (1..=frames)
                .map(|frame| {
                    track
                        .frame(&place, &mut Noises::default(), end(frame))
                        .len()
                })
                .sum();
            assert_eq!(samples, 96_000);
        }
    }
}
