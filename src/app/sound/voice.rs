//! One noise as a sound: strikes, each a few resonances of the struck solid (modal synthesis, van den Doel & Pai
//! 1998, "The sounds of physical shapes") and grains of noise (PhISEM, Cook 1997, "Physically informed sonic
//! modeling"). A step is a heel and a toe (Cook 2002, "Modeling Bill's gait"). Nothing is read from a file.

use super::{
    chance::Chance,
    filter::{Filter, Mode, Pass},
    noise::{Kind, Noise},
};
use crate::world::materials::MaterialSound;

const MODES: usize = 4;
/// Pitches differ from noise to noise by up to this share to either side.
const VARIETY: f32 = 0.07;

/// What a material sounds like.
struct Timbre {
    /// Frequencies (Hz), seconds until they have faded by 60 dB, amplitudes.
    modes: [(f32, f32, f32); MODES],
    /// Middle of the band of the grains (Hz), and its quality.
    band: (f32, f32),
    /// Seconds until a grain, and all grains, have faded by 60 dB.
    grain_s: f32,
    grains_s: f32,
    /// Grains in a second while there are any.
    grains_hz: f32,
    /// Amplitude of the grains.
    grains: f32,
    /// Amplitude of the dull blow below it all.
    blow: f32,
}

/// Timbres are tuned by ear and by figures: a test holds their loudness together and their brightness apart.
fn timbre(material: MaterialSound) -> Timbre {
    match material {
        MaterialSound::Stone => Timbre {
            modes: [
                (1870.0, 0.040, 0.22),
                (2930.0, 0.030, 0.20),
                (4310.0, 0.022, 0.14),
                (6150.0, 0.015, 0.08),
            ],
            band: (3100.0, 0.8),
            grain_s: 0.012,
            grains_s: 0.11,
            grains_hz: 700.0,
            grains: 1.3,
            blow: 0.10,
        },
        MaterialSound::Soil => Timbre {
            modes: [
                (84.0, 0.11, 0.30),
                (131.0, 0.09, 0.20),
                (205.0, 0.06, 0.08),
                (310.0, 0.04, 0.05),
            ],
            band: (340.0, 0.7),
            grain_s: 0.03,
            grains_s: 0.19,
            grains_hz: 420.0,
            grains: 0.8,
            blow: 0.36,
        },
        MaterialSound::Grass => Timbre {
            modes: [
                (92.0, 0.07, 0.08),
                (150.0, 0.05, 0.04),
                (240.0, 0.04, 0.02),
                (390.0, 0.03, 0.01),
            ],
            band: (5600.0, 0.6),
            grain_s: 0.02,
            grains_s: 0.26,
            grains_hz: 2400.0,
            grains: 0.6,
            blow: 0.07,
        },
        MaterialSound::Wood => Timbre {
            modes: [
                (176.0, 0.20, 0.34),
                (421.0, 0.16, 0.24),
                (768.0, 0.11, 0.15),
                (1247.0, 0.08, 0.08),
            ],
            band: (1500.0, 0.9),
            grain_s: 0.012,
            grains_s: 0.07,
            grains_hz: 380.0,
            grains: 0.55,
            blow: 0.20,
        },
        MaterialSound::Glow => Timbre {
            modes: [
                (873.0, 0.55, 0.15),
                (1319.0, 0.48, 0.12),
                (1981.0, 0.36, 0.08),
                (2733.0, 0.25, 0.05),
            ],
            band: (1400.0, 0.8),
            grain_s: 0.02,
            grains_s: 0.09,
            grains_hz: 300.0,
            grains: 0.35,
            blow: 0.10,
        },
    }
}

/// How a kind of noise strikes a material.
struct Manner {
    /// Seconds after the first strike, and strength relative to it.
    second: (f32, f32),
    pitch: f32,
    /// How much longer than in a step the grains last.
    length: f32,
    /// How much stronger the dull blow is, and its frequency (Hz).
    blow: (f32, f32),
    /// Amplitudes of the weakest and of the strongest.
    loudness: (f32, f32),
}

fn manner(kind: Kind) -> Manner {
    match kind {
        Kind::Step => Manner {
            second: (0.072, 0.55),
            pitch: 1.0,
            length: 1.0,
            blow: (1.0, 72.0),
            loudness: (0.05, 0.22),
        },
        Kind::Land => Manner {
            second: (0.028, 0.7),
            pitch: 0.8,
            length: 1.6,
            blow: (4.0, 55.0),
            loudness: (0.12, 0.5),
        },
        Kind::Dig => Manner {
            second: (0.085, 0.5),
            pitch: 0.92,
            length: 2.4,
            blow: (1.6, 90.0),
            loudness: (0.3, 0.5),
        },
        Kind::Place => Manner {
            second: (0.02, 0.3),
            pitch: 0.74,
            length: 0.7,
            blow: (2.4, 105.0),
            loudness: (0.28, 0.45),
        },
        Kind::Switch => Manner {
            second: (0.03, 0.4),
            pitch: 1.25,
            length: 0.4,
            blow: (0.6, 140.0),
            loudness: (0.12, 0.2),
        },
    }
}

/// Grains of noise: more and more rarely, each fading.
#[derive(Clone, Debug)]
struct Grains {
    /// Amplitude of the next grain, and what remains of it after a sample.
    next: f32,
    next_keep: f32,
    /// Amplitude of those that sound, and what remains of it after a sample.
    now: f32,
    now_keep: f32,
    /// Chance of a grain in a sample.
    chance: f32,
    pass: Pass,
    filter: Filter,
}

#[derive(Clone, Debug)]
struct Strike {
    /// Samples until it begins.
    wait: u32,
    modes: [Mode; MODES],
    blow: Mode,
    grains: Grains,
}

/// A sound that fades to its end by itself.
#[derive(Clone, Debug)]
pub struct Voice {
    strikes: [Strike; 2],
    chance: Chance,
    /// Samples until it is over.
    left: u32,
}

impl Voice {
    /// `seed` tells two noises of one kind apart. `wait_s`: seconds until it begins.
    pub fn new(noise: &Noise, seed: u32, wait_s: f32, rate_hz: f32) -> Self {
        let mut chance = Chance::new(seed);
        let manner = manner(noise.kind);
        let timbre = timbre(noise.material);
        let strength = noise.strength.clamp(0.0, 1.0);
        let (weak, strong) = manner.loudness;
        let loudness = weak + (strong - weak) * strength;
        let (second_s, second) = manner.second;
        let mut strike = |after_s: f32, strength: f32| {
            let pitch = manner.pitch * (1.0 + VARIETY * chance.signed());
            let start = ((wait_s + after_s) * rate_hz) as u32;
            Strike::new(&timbre, &manner, strength * loudness, pitch, start, rate_hz)
        };
        let strikes = [strike(0.0, 1.0), strike(second_s, second)];
        let fades_s = timbre.modes.iter().map(|(_, fade_s, _)| *fade_s);
        let longest_s = fades_s.fold(timbre.grains_s * manner.length + timbre.grain_s, f32::max);
        Self {
            strikes,
            chance,
            left: ((wait_s + second_s + longest_s.max(BLOW_S)) * rate_hz) as u32,
        }
    }

    /// Samples until it is over.
    pub fn left(&self) -> u32 {
        self.left
    }

    pub fn next(&mut self) -> f32 {
        self.left = self.left.saturating_sub(1);
        let [heel, toe] = &mut self.strikes;
        heel.next(&mut self.chance) + toe.next(&mut self.chance)
    }
}

/// Seconds until the dull blow has faded by 60 dB.
const BLOW_S: f32 = 0.14;

impl Strike {
    fn new(
        timbre: &Timbre,
        manner: &Manner,
        loudness: f32,
        pitch: f32,
        wait: u32,
        rate_hz: f32,
    ) -> Self {
        let keep = |fade_s: f32| 0.001_f32.powf(1.0 / (fade_s * rate_hz));
        let (blow, blow_hz) = manner.blow;
        let (band_hz, quality) = timbre.band;
        Self {
            wait,
            modes: timbre.modes.map(|(hz, fade_s, amplitude)| {
                Mode::new(hz * pitch, fade_s, amplitude * loudness, rate_hz)
            }),
            blow: Mode::new(blow_hz, BLOW_S, blow * timbre.blow * loudness, rate_hz),
            grains: Grains {
                next: timbre.grains * loudness,
                next_keep: keep(timbre.grains_s * manner.length),
                // A blow begins with a grain.
                now: timbre.grains * loudness,
                now_keep: keep(timbre.grain_s),
                chance: timbre.grains_hz / rate_hz,
                pass: Pass::new(band_hz * pitch, quality, rate_hz),
                filter: Filter::default(),
            },
        }
    }

    fn next(&mut self, chance: &mut Chance) -> f32 {
        if self.wait > 0 {
            self.wait -= 1;
            return 0.0;
        }
        let rung: f32 = self.modes.iter_mut().map(Mode::next).sum();
        rung + self.blow.next() + self.grains.next(chance)
    }
}

impl Grains {
    fn next(&mut self, chance: &mut Chance) -> f32 {
        if chance.unit() < self.chance {
            self.now = self.now.max(self.next * chance.unit());
        }
        self.next *= self.next_keep;
        self.now *= self.now_keep;
        self.filter
            .next(self.now * chance.signed(), &self.pass)
            .band
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::sound::signal::{centroid_hz, energy, peak};

    const RATE_HZ: f32 = 48_000.0;
    const KINDS: [Kind; 5] = [Kind::Step, Kind::Land, Kind::Dig, Kind::Place, Kind::Switch];

    fn sound(kind: Kind, material: MaterialSound, strength: f32, seed: u32) -> Vec<f32> {
        let noise = Noise {
            kind,
            material,
            strength,
            at_ns: 0,
        };
        let mut voice = Voice::new(&noise, seed, 0.0, RATE_HZ);
        let mut samples = Vec::new();
        while voice.left() > 0 {
            samples.push(voice.next());
        }
        samples
    }

    /// Mean over some seeds.
    fn mean(measure: impl Fn(u32) -> f32) -> f32 {
        (0..6).map(measure).sum::<f32>() / 6.0
    }

    #[test]
    fn sounds_are_finite_short_within_bounds_and_fade_to_silence() {
        for kind in KINDS {
            for material in MaterialSound::ALL {
                for (strength, seed) in [(0.0, 1), (1.0, 2), (1.0, 3)] {
                    let samples = sound(kind, material, strength, seed);
                    assert!(samples.len() < 48_000, "{kind:?} {material:?}");
                    assert!(samples.iter().all(|x| x.is_finite()));
                    let loudest = peak(&samples);
                    assert!(
                        (0.01..0.9).contains(&loudest),
                        "{kind:?} {material:?}: {loudest}"
                    );
                    let end = peak(&samples[samples.len() - 48..]);
                    assert!(end < 0.01 * loudest, "{kind:?} {material:?}: {end}");
                }
            }
        }
    }

    #[test]
    fn materials_differ_in_brightness_and_hardly_in_loudness() {
        let of = |material| {
            let hz = mean(|seed| centroid_hz(&sound(Kind::Step, material, 1.0, seed), RATE_HZ));
            let db = 10.0 * mean(|seed| energy(&sound(Kind::Step, material, 1.0, seed))).log10();
            (hz, db)
        };
        let row = [
            MaterialSound::Soil,
            MaterialSound::Wood,
            MaterialSound::Glow,
            MaterialSound::Stone,
            MaterialSound::Grass,
        ];
        let figures = row.map(of);
        for (pair, names) in figures.windows(2).zip(row.windows(2)) {
            let brighter = pair[1].0 / pair[0].0;
            assert!(brighter > 1.2, "{names:?}: {figures:?}");
        }
        let loudness = figures.map(|(_, db)| db);
        let most = loudness.iter().fold(f32::MIN, |a, b| a.max(*b));
        let least = loudness.iter().fold(f32::MAX, |a, b| a.min(*b));
        // Dull sounds need more energy to be heard as loud.
        assert!(most - least < 8.0, "{figures:?}");
    }

    #[test]
    fn strength_is_loudness_and_kinds_are_told_apart() {
        for material in MaterialSound::ALL {
            let level =
                |kind, strength| mean(|seed| energy(&sound(kind, material, strength, seed)));
            for kind in KINDS {
                assert!(
                    level(kind, 1.0) > 1.5 * level(kind, 0.0),
                    "{kind:?} {material:?}"
                );
            }
            assert!(level(Kind::Land, 1.0) > 3.0 * level(Kind::Step, 1.0));
            let hz = |kind| mean(|seed| centroid_hz(&sound(kind, material, 1.0, seed), RATE_HZ));
            assert!(hz(Kind::Place) < hz(Kind::Dig), "{material:?}");
        }
    }

    #[test]
    fn a_seed_repeats_to_the_bit_another_does_not_and_waiting_only_delays() {
        let first = sound(Kind::Dig, MaterialSound::Stone, 0.5, 11);
        assert_eq!(first, sound(Kind::Dig, MaterialSound::Stone, 0.5, 11));
        assert_ne!(first, sound(Kind::Dig, MaterialSound::Stone, 0.5, 12));
        let noise = Noise {
            kind: Kind::Dig,
            material: MaterialSound::Stone,
            strength: 0.5,
            at_ns: 0,
        };
        let mut late = Voice::new(&noise, 11, 0.01, RATE_HZ);
        assert!((0..480).all(|_| late.next() == 0.0));
        assert!((0..480).all(|at| late.next() == first[at]));
    }
}
