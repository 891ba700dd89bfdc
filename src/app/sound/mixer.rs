//! From noises and a room to samples for two ears. No thread and no device: the device's thread and a file both
//! play through it, and the same commands give the same samples to the bit.

use super::{
    noise::Noise,
    reverb::{Echo, Reverb},
    voice::Voice,
    wind::Wind,
};

/// Voices that sound at the same time; the one that is nearest to its end makes room for another.
const VOICES: usize = 16;
/// Samples between two looks at what changes slowly.
const BLOCK: u32 = 64;
/// Seconds in which the room and the volume close 63 % of their distance to what was asked for.
const ROOM_S: f32 = 0.4;
const VOLUME_S: f32 = 0.03;
/// Louder samples are bent, so that none reaches 1.
const KNEE: f32 = 0.7;
/// Steps are heard slightly from the left and from the right in turn.
const WIDTH: f32 = 0.12;

/// What surrounds the ear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    pub echo: Echo,
    /// Amplitude of the echo relative to the sound itself, 0 to 1.
    pub wet: f32,
    /// Share of the sky that is open, 0 to 1.
    pub sky: f32,
}

impl Default for Room {
    /// Silence outdoors.
    fn default() -> Self {
        Self {
            echo: Echo {
                time_s: 0.3,
                between_s: 0.02,
            },
            wet: 0.0,
            sky: 0.0,
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub enum Command {
    /// A noise, this many seconds from now.
    Make(Noise, f32),
    Room(Room),
    /// 0 to 1.
    Volume(f32),
}

#[derive(Clone, Debug)]
pub struct Mixer {
    rate_hz: f32,
    seed: u32,
    /// Noises so far.
    made: u32,
    voices: Vec<(Voice, [f32; 2])>,
    reverb: Reverb,
    wind: Wind,
    wanted: Room,
    room: Room,
    wanted_volume: f32,
    volume: f32,
    /// Samples until the next block.
    left: u32,
}

impl Mixer {
    pub fn new(rate_hz: f32, seed: u32) -> Self {
        let room = Room::default();
        Self {
            rate_hz,
            seed,
            made: 0,
            voices: Vec::with_capacity(VOICES),
            reverb: Reverb::new(room.echo, rate_hz),
            wind: Wind::new(seed, rate_hz),
            wanted: room,
            room,
            wanted_volume: 0.0,
            volume: 0.0,
            left: 0,
        }
    }

    pub fn take(&mut self, command: Command) {
        match command {
            Command::Make(noise, wait_s) => self.make(&noise, wait_s),
            Command::Room(room) => self.wanted = room,
            Command::Volume(volume) => self.wanted_volume = volume.clamp(0.0, 1.0),
        }
    }

    /// What was last asked for, apart from noises: another mixer goes on with it.
    pub fn settings(&self) -> [Command; 2] {
        [
            Command::Room(self.wanted),
            Command::Volume(self.wanted_volume),
        ]
    }

    fn make(&mut self, noise: &Noise, wait_s: f32) {
        let side = if self.made.is_multiple_of(2) {
            WIDTH
        } else {
            -WIDTH
        };
        self.made = self.made.wrapping_add(1);
        let voice = Voice::new(noise, self.seed ^ self.made, wait_s, self.rate_hz);
        if self.voices.len() == VOICES {
            let first = (0..VOICES).min_by_key(|index| self.voices[*index].0.left());
            self.voices.swap_remove(first.expect("there are voices"));
        }
        self.voices.push((voice, [1.0 + side, 1.0 - side]));
    }

    /// The next sample of the left and the right ear, within (−1, 1).
    pub fn next(&mut self) -> [f32; 2] {
        if self.left == 0 {
            self.left = BLOCK;
            self.follow();
        }
        self.left -= 1;
        let (mut dry, mut near) = (0.0, [0.0; 2]);
        for (voice, sides) in &mut self.voices {
            let sample = voice.next();
            dry += sample;
            near[0] += sides[0] * sample;
            near[1] += sides[1] * sample;
        }
        let echo = self.reverb.next(dry);
        let wind = self.wind.next();
        let ears = [0, 1].map(|ear| {
            let sum = near[ear] + self.room.wet * echo[ear] + self.room.sky * wind[ear];
            bent(sum) * self.volume
        });
        if self.left == 0 {
            self.voices.retain(|(voice, _)| voice.left() > 0);
        }
        ears
    }

    /// What changes slowly comes closer to what was asked for.
    fn follow(&mut self) {
        let block_s = BLOCK as f32 / self.rate_hz;
        let closer = |now: f32, wanted: f32, lag_s: f32| {
            now + (wanted - now) * (1.0 - (-block_s / lag_s).exp())
        };
        let (room, wanted) = (&mut self.room, &self.wanted);
        room.wet = closer(room.wet, wanted.wet, ROOM_S);
        room.sky = closer(room.sky, wanted.sky, ROOM_S);
        let echo = &mut room.echo;
        echo.time_s = closer(echo.time_s, wanted.echo.time_s, ROOM_S);
        echo.between_s = closer(echo.between_s, wanted.echo.between_s, ROOM_S);
        self.reverb.set(*echo);
        self.wind.turn(BLOCK);
        self.volume = closer(self.volume, self.wanted_volume, VOLUME_S);
    }
}

/// Below [`KNEE`] the sample itself; above it ever less of it, and never 1.
fn bent(sample: f32) -> f32 {
    let size = sample.abs();
    if size <= KNEE {
        return sample;
    }
    let rest = 1.0 - KNEE;
    // At most 0.999 of the rest: tanh rounds to 1 soon.
    sample.signum() * (KNEE + 0.999 * rest * ((size - KNEE) / rest).tanh())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::sound::{
        noise::Kind,
        signal::{energy, low_passed, peak, reverberation_s},
    };
    use crate::world::materials::MaterialSound;

    const RATE_HZ: f32 = 48_000.0;

    fn noise(kind: Kind) -> Noise {
        Noise {
            kind,
            material: MaterialSound::Stone,
            strength: 1.0,
            at_ns: 0,
        }
    }

    fn hall(wet: f32, time_s: f32) -> Room {
        Room {
            echo: Echo {
                time_s,
                between_s: 0.03,
            },
            wet,
            sky: 0.0,
        }
    }

    /// The left ear for some seconds.
    fn left(mixer: &mut Mixer, seconds: f32) -> Vec<f32> {
        let samples = (seconds * RATE_HZ) as usize;
        (0..samples).map(|_| mixer.next()[0]).collect()
    }

    /// A mixer at full volume that has come to rest in a room.
    fn settled(room: Room) -> Mixer {
        let mut mixer = Mixer::new(RATE_HZ, 1);
        mixer.take(Command::Volume(1.0));
        mixer.take(Command::Room(room));
        left(&mut mixer, 4.0);
        mixer
    }

    #[test]
    fn a_din_never_clips() {
        let mut mixer = settled(Room {
            sky: 1.0,
            ..hall(1.0, 6.0)
        });
        for _ in 0..200 {
            mixer.take(Command::Make(noise(Kind::Land), 0.0));
        }
        assert_eq!(mixer.voices.len(), VOICES);
        let samples = left(&mut mixer, 2.0);
        assert!(samples.iter().all(|x| x.is_finite()));
        let loudest = peak(&samples);
        assert!((0.9..1.0).contains(&loudest), "{loudest}");
        assert!(mixer.voices.is_empty());
    }

    #[test]
    fn a_room_answers_for_as_long_as_was_asked_and_the_open_does_not() {
        let ring = |room: Room| {
            let mut mixer = settled(room);
            mixer.take(Command::Make(noise(Kind::Place), 0.0));
            left(&mut mixer, 3.5)
        };
        let hall_rings = ring(hall(0.8, 2.0));
        // After the noise itself.
        let echo = low_passed(&hall_rings[24_000..], 500.0, RATE_HZ);
        let measured = reverberation_s(&echo, RATE_HZ);
        assert!((measured / 2.0 - 1.0).abs() < 0.15, "{measured} s");
        let open = ring(hall(0.0, 2.0));
        assert!(energy(&open[24_000..]) < 1e-6 * energy(&hall_rings[24_000..]));
    }

    #[test]
    fn volume_mutes_without_a_click_and_silence_is_silent() {
        let mut mixer = settled(hall(0.5, 1.0));
        assert_eq!(
            peak(&left(&mut mixer, 0.5)),
            0.0,
            "nothing sounds by itself"
        );
        mixer.take(Command::Room(Room {
            sky: 1.0,
            ..hall(0.5, 1.0)
        }));
        left(&mut mixer, 3.0);
        let loud = left(&mut mixer, 1.0);
        mixer.take(Command::Volume(0.0));
        let mut last = *loud.last().expect("samples");
        for now in left(&mut mixer, 0.5) {
            assert!((now - last).abs() < 0.02, "a click");
            last = now;
        }
        assert!(energy(&loud) > 0.01);
        assert!(peak(&left(&mut mixer, 0.1)) < 1e-6);
    }

    #[test]
    fn the_same_commands_give_the_same_samples() {
        let play = |seed: u32| -> Vec<[f32; 2]> {
            let mut mixer = Mixer::new(RATE_HZ, seed);
            mixer.take(Command::Volume(0.7));
            mixer.take(Command::Room(Room {
                sky: 0.4,
                ..hall(0.6, 1.5)
            }));
            mixer.take(Command::Make(noise(Kind::Step), 0.01));
            mixer.take(Command::Make(noise(Kind::Dig), 0.2));
            (0..20_000).map(|_| mixer.next()).collect()
        };
        assert_eq!(play(3), play(3));
        assert_ne!(play(3), play(4));
    }
}
