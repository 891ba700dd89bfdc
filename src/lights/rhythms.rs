//! Lamps whose power goes up and down or whose hue turns, each for itself.
//!
//! Light is linear: what a lamp's light is now is its light at full power times its gain. Where [`CommonGain`] finds no factor
//! that all sources share, rays, probes and faces therefore know lamps that pulse, flicker or turn their hue at full power, so
//! that for them nothing changes; and with their light they keep which share of it comes from each rhythm. The picture is
//! multiplied by what follows from the shares and the gains of now (`shaders/light/rhythms.wesl`).
//!
//! [`CommonGain`]: super::CommonGain

use glam::{DVec3, Vec3};

use super::{
    Lights, Rhythm,
    table::{GpuRhythm, KNOWN_LAMPS, RHYTHMS_KNOWN, TOLD_BY_CHANNEL},
};

/// The lamps of each rhythm in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rhythms {
    of_lamps: [OfLamps; RHYTHMS_KNOWN as usize],
    has_steady: bool,
}

/// Lamps whose gain is the same at all times.
#[derive(Clone, Copy, Debug, PartialEq)]
struct OfLamps {
    /// One bit for each lamp.
    lamps: u64,
    gain: DVec3,
    /// Sum of their intensities at full power.
    full: DVec3,
}

/// How kernels tell apart the light of lamps that have rhythms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum RhythmsTold {
    /// Not at all.
    #[default]
    None,
    /// Up to [`TOLD_BY_CHANNEL`], by their share of each colour channel.
    ByChannel,
    /// Up to [`RHYTHMS_KNOWN`], by their share of the brightness: their light counts as coloured as the lamps are.
    ByBrightness,
}

impl RhythmsTold {
    /// What lamps with these rhythms ([`super::Rhythm::number`]) need. None, where they are too many.
    pub fn needed(lamps: &[Option<u32>]) -> Self {
        let mut numbers: Vec<u32> = lamps.iter().copied().flatten().collect();
        numbers.sort_unstable();
        numbers.dedup();
        let count = numbers.len() as u32;
        if count == 0 || count > RHYTHMS_KNOWN || lamps.len() > KNOWN_LAMPS as usize {
            Self::None
        } else if count <= TOLD_BY_CHANNEL {
            Self::ByChannel
        } else {
            Self::ByBrightness
        }
    }

    /// Most rhythms that are told apart.
    fn most(self) -> usize {
        match self {
            Self::None => 0,
            Self::ByChannel => TOLD_BY_CHANNEL as usize,
            Self::ByBrightness => RHYTHMS_KNOWN as usize,
        }
    }
}

/// Whether all lamps have the same rhythm: then they have a [`CommonGain`](super::CommonGain) where there is no other light.
pub fn is_one(lamps: &[Option<u32>]) -> bool {
    lamps.windows(2).all(|pair| pair[0] == pair[1])
}

impl OfLamps {
    /// No lamps. Their gain is 1: probes may still have shares for them, and that light stays as it is until rays say more.
    const NONE: Self = Self {
        lamps: 0,
        gain: DVec3::ONE,
        full: DVec3::ZERO,
    };
}

impl Default for Rhythms {
    /// No lamp has a rhythm.
    fn default() -> Self {
        Self {
            of_lamps: [OfLamps::NONE; RHYTHMS_KNOWN as usize],
            has_steady: true,
        }
    }
}

impl Rhythms {
    /// The lights at full power, and how far from it each rhythm is; `None` where no lamp has one that kernels which know `told` can
    /// tell. Of more rhythms than these can tell, later ones stay as they are now: their light is followed like any that changes.
    /// `emits`: voxels emit light.
    pub fn split(lights: &Lights, emits: bool, told: RhythmsTold) -> Option<(Lights, Self)> {
        if lights.lamps.len() > KNOWN_LAMPS as usize {
            return None;
        }
        // In the order of the lamps: those that a player hangs come last, and leave the others' shares theirs.
        let mut found = Vec::<(u32, OfLamps)>::new();
        let mut at_full = lights.clone();
        let mut has_steady = emits || !lights.sky.is_dark();
        for (index, lamp) in at_full.lamps.iter_mut().enumerate() {
            let place_of = |own: Rhythm| {
                let known = found.iter().position(|(number, _)| *number == own.number);
                known.or((found.len() < told.most()).then_some(found.len()))
            };
            let Some((own, place)) = lamp.rhythm.and_then(|own| Some((own, place_of(own)?))) else {
                has_steady |= lamp.intensity != DVec3::ZERO;
                continue;
            };
            if place == found.len() {
                found.push((own.number, OfLamps::NONE));
            }
            let all = &mut found[place].1;
            all.lamps |= 1 << index;
            all.gain = own.gain;
            all.full += own.full;
            lamp.intensity = own.full;
        }
        if found.is_empty() {
            return None;
        }
        let mut rhythms = Self {
            has_steady,
            ..Self::default()
        };
        for (known, (_, found)) in rhythms.of_lamps.iter_mut().zip(found) {
            *known = found;
        }
        Some((at_full, rhythms))
    }

    /// Whether some light comes from no lamp that has a rhythm.
    pub(super) fn has_steady(&self) -> bool {
        self.has_steady
    }

    /// The gain of each of the first lamps, and a 0.
    pub(super) fn lamp_gains(&self) -> [[f32; 4]; KNOWN_LAMPS as usize] {
        std::array::from_fn(|lamp| {
            let own = |of: &&OfLamps| of.lamps >> lamp & 1 == 1;
            let found = self.of_lamps.iter().find(own);
            let gain = found.map_or(Vec3::ONE, |of| of.gain.as_vec3());
            gain.extend(0.0).to_array()
        })
    }

    pub(super) fn to_gpu(self) -> [GpuRhythm; RHYTHMS_KNOWN as usize] {
        let power = |own: &OfLamps| own.full.element_sum();
        let all: f64 = self.of_lamps.iter().map(power).sum();
        self.of_lamps.map(|own| GpuRhythm {
            lamps: [own.lamps as u32, (own.lamps >> 32) as u32],
            gain: own.gain.as_vec3().to_array(),
            power: (power(&own) / all.max(f64::MIN_POSITIVE)) as f32,
            colour: (own.full / power(&own).max(f64::MIN_POSITIVE))
                .as_vec3()
                .to_array(),
            ..GpuRhythm::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lights::rest::tests;

    /// Lamps of these rhythms, at half of their power.
    fn lights(numbers: &[Option<u32>]) -> Lights {
        let places: Vec<(f64, f64)> = (0..numbers.len()).map(|x| (x as f64, 4.0)).collect();
        let mut lights = tests::lights(&places);
        for (lamp, number) in lights.lamps.iter_mut().zip(numbers) {
            lamp.rhythm = number.map(|number| Rhythm {
                number,
                gain: DVec3::new(0.5, 0.25, 1.0),
                full: lamp.intensity * 2.0,
            });
        }
        lights
    }

    #[test]
    fn rays_know_lamps_at_full_power() {
        let now = lights(&[None, Some(7), Some(3), Some(7)]);
        let told = RhythmsTold::ByChannel;
        let (at_full, rhythms) = Rhythms::split(&now, false, told).expect("they are few");
        for (lamp, full) in now.lamps.iter().zip(&at_full.lamps) {
            let factor = if lamp.rhythm.is_some() { 2.0 } else { 1.0 };
            assert_eq!(full.intensity, lamp.intensity * factor);
        }
        let [first, second, third, ..] = rhythms.to_gpu();
        let lamps = [first.lamps, second.lamps, third.lamps];
        assert_eq!(
            lamps,
            [[10, 0], [4, 0], [0, 0]],
            "in the order of the lamps"
        );
        assert_eq!(third.gain, [1.0; 3], "what no lamp gives stays as it is");
        assert_eq!((first.gain, second.gain), ([0.5, 0.25, 1.0], first.gain));
        let (steady, own) = ([1.0, 1.0, 1.0, 0.0], [0.5, 0.25, 1.0, 0.0]);
        assert_eq!(rhythms.lamp_gains()[..5], [steady, own, own, own, steady]);
        assert_eq!(first.power + second.power, 1.0);
        assert!((first.colour.iter().sum::<f32>() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_few_rhythms_are_told_apart() {
        use RhythmsTold::{ByBrightness, ByChannel, None as Not};
        let rhythms = |count: u32| (0..count).map(Some).collect::<Vec<_>>();
        for (numbers, needed) in [
            (vec![], Not),
            (vec![None], Not),
            (vec![Some(1)], ByChannel),
            (vec![Some(1), Some(2), Some(3), None], ByChannel),
            (rhythms(4), ByBrightness),
            (rhythms(9), ByBrightness),
            (rhythms(10), Not),
            (vec![Some(1); 64], ByChannel),
            (vec![Some(1); 65], Not),
        ] {
            assert_eq!(RhythmsTold::needed(&numbers), needed, "{numbers:?}");
        }
    }

    #[test]
    fn of_more_rhythms_than_kernels_tell_the_first_are_told() {
        use RhythmsTold::{ByBrightness, ByChannel, None as Not};
        for (count, told, known) in [
            (2, ByChannel, 2),
            (4, ByChannel, 3),
            (4, ByBrightness, 4),
            (12, ByBrightness, 9),
        ] {
            let now = lights(&(0..count).map(Some).collect::<Vec<_>>());
            let (at_full, rhythms) = Rhythms::split(&now, false, told).expect("some are told");
            let lamps = now.lamps.iter().zip(&at_full.lamps);
            let raised = lamps.filter(|(now, full)| now.intensity != full.intensity);
            assert_eq!(raised.count(), known, "{count} {told:?}");
            // The light of the others counts as steady.
            assert_eq!(rhythms.has_steady(), known < count as usize);
            assert_eq!(Rhythms::split(&now, false, Not), None);
        }
        assert_eq!(Rhythms::split(&lights(&[None]), true, ByChannel), None);
        assert_eq!(
            Rhythms::split(&lights(&[Some(1); 65]), true, ByChannel),
            None
        );
    }
}
