//! Lamps whose power goes up and down, each for itself.
//!
//! Light is linear: what a lamp's light is now is its light at full power times its gain. Where [`CommonGain`] finds no factor
//! that all sources share, rays, probes and faces therefore know lamps that pulse or flicker at full power, so that for them
//! nothing changes; and with their light they keep which share of it comes from each rhythm. The picture is multiplied by what
//! follows from the shares and the gains of now (`shaders/light/rhythms.wesl`).
//!
//! [`CommonGain`]: super::CommonGain

use std::collections::BTreeMap;

use glam::DVec3;

use super::{
    LampState, Lights,
    table::{GpuRhythm, KNOWN_LAMPS, RHYTHMS_KNOWN},
};

/// The lamps of each rhythm in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rhythms {
    of_lamps: [OfLamps; RHYTHMS_KNOWN as usize],
    has_steady: bool,
}

/// Lamps whose gain is the same at all times.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct OfLamps {
    /// One bit for each lamp.
    lamps: u64,
    gain: f64,
    /// Sum of the channels of their intensities at full power.
    full: f64,
}

/// Whether light of lamps with these rhythms ([`super::Rhythm::number`]) can be told apart: some have one, and there are few.
pub fn are_told_apart(lamps: &[Option<u32>]) -> bool {
    let mut numbers: Vec<u32> = lamps.iter().copied().flatten().collect();
    numbers.sort_unstable();
    numbers.dedup();
    lamps.len() <= KNOWN_LAMPS as usize && (1..=RHYTHMS_KNOWN as usize).contains(&numbers.len())
}

/// Whether all lamps have the same rhythm: then they have a [`CommonGain`](super::CommonGain) where there is no other light.
pub fn is_one(lamps: &[Option<u32>]) -> bool {
    lamps.windows(2).all(|pair| pair[0] == pair[1])
}

impl Default for Rhythms {
    /// No lamp has a rhythm.
    fn default() -> Self {
        Self {
            of_lamps: Default::default(),
            has_steady: true,
        }
    }
}

impl Rhythms {
    /// The lights at full power, and how far from it each rhythm is; `None` where lamps cannot be told apart. `emits`: voxels
    /// emit light.
    pub fn split(lights: &Lights, emits: bool) -> Option<(Lights, Self)> {
        let lamps = &lights.lamps;
        let numbers = lamps.iter().map(|lamp| lamp.rhythm.map(|own| own.number));
        if !are_told_apart(&numbers.collect::<Vec<_>>()) {
            return None;
        }
        let mut by_number = BTreeMap::<u32, OfLamps>::new();
        let mut at_full = lights.clone();
        for (index, lamp) in at_full.lamps.iter_mut().enumerate() {
            if let Some(own) = lamp.rhythm {
                let all = by_number.entry(own.number).or_default();
                all.lamps |= 1 << index;
                all.gain = own.gain;
                all.full += own.full.element_sum();
                lamp.intensity = own.full;
            }
        }
        let is_steady = |lamp: &LampState| lamp.rhythm.is_none() && lamp.intensity != DVec3::ZERO;
        let mut rhythms = Self {
            has_steady: emits || !lights.sky.is_dark() || lamps.iter().any(is_steady),
            ..Self::default()
        };
        for (known, found) in rhythms.of_lamps.iter_mut().zip(by_number.into_values()) {
            *known = found;
        }
        Some((at_full, rhythms))
    }

    /// Whether some light comes from no lamp that has a rhythm.
    pub(super) fn has_steady(&self) -> bool {
        self.has_steady
    }

    pub(super) fn to_gpu(self) -> [GpuRhythm; RHYTHMS_KNOWN as usize] {
        let all: f64 = self.of_lamps.iter().map(|own| own.full).sum();
        self.of_lamps.map(|own| {
            let share = own.full / all.max(f64::MIN_POSITIVE);
            GpuRhythm {
                lamps: [own.lamps as u32, (own.lamps >> 32) as u32],
                gain: own.gain as f32,
                power: share as f32,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lights::{Rhythm, rest::tests};

    /// Lamps of these rhythms, at half of their power.
    fn lights(numbers: &[Option<u32>]) -> Lights {
        let places: Vec<(f64, f64)> = (0..numbers.len()).map(|x| (x as f64, 4.0)).collect();
        let mut lights = tests::lights(&places);
        for (lamp, number) in lights.lamps.iter_mut().zip(numbers) {
            lamp.rhythm = number.map(|number| Rhythm {
                number,
                gain: 0.5,
                full: lamp.intensity * 2.0,
            });
        }
        lights
    }

    #[test]
    fn rays_know_lamps_at_full_power() {
        let now = lights(&[None, Some(7), Some(3), Some(7)]);
        let (at_full, rhythms) = Rhythms::split(&now, false).expect("they are few");
        for (lamp, full) in now.lamps.iter().zip(&at_full.lamps) {
            let factor = if lamp.rhythm.is_some() { 2.0 } else { 1.0 };
            assert_eq!(full.intensity, lamp.intensity * factor);
        }
        let [first, second, third] = rhythms.to_gpu();
        assert_eq!(
            (first.lamps, second.lamps, third.lamps),
            ([4, 0], [10, 0], [0, 0])
        );
        assert_eq!((first.gain, second.gain), (0.5, 0.5));
        assert_eq!(first.power + second.power, 1.0);
    }

    #[test]
    fn a_few_rhythms_are_told_apart() {
        for (numbers, few) in [
            (vec![], false),
            (vec![None], false),
            (vec![Some(1)], true),
            (vec![Some(1), Some(2), Some(3), None], true),
            (vec![Some(1), Some(2), Some(3), Some(4)], false),
            (vec![Some(1); 64], true),
            (vec![Some(1); 65], false),
        ] {
            assert_eq!(
                Rhythms::split(&lights(&numbers), false).is_some(),
                few,
                "{numbers:?}"
            );
        }
    }
}
