//! Changes of power that all sources of light share.
//!
//! Light is linear: if every source is multiplied by one factor, every radiance is. A world whose only source is a lamp
//! that pulses or flickers therefore needs no new rays. Its probes and faces keep the light of the lamp at a reference
//! intensity, and the picture is multiplied by the gain: exact in every frame, at every bounce.

use glam::{DVec3, Vec3};

use super::{Lights, Rhythms, RhythmsTold};

/// Gains of two lamps that differ by less than this share are one gain.
const SAME: f64 = 1e-6;
/// A gain above this begins again at a new reference, so that light at the reference stays well within half floats.
const MOST_GAIN: f64 = 64.0;

/// Splits lights into lights at their reference intensities and a gain.
#[derive(Clone, Debug, Default)]
pub struct CommonGain {
    /// Intensity of each lamp.
    reference: Vec<DVec3>,
}

/// The lights that rays, probes and faces know, and by what the picture is multiplied.
#[derive(Clone, Debug, PartialEq)]
pub struct LightsKept {
    pub lights: Lights,
    /// For all light (linear RGB).
    pub gain: Vec3,
    /// For the light of each rhythm.
    pub rhythms: Rhythms,
}

impl CommonGain {
    /// Takes out of the lights by what their power changes, so far as that is known. `emits`: as in [`split`](Self::split);
    /// `told`: what kernels know of [`Rhythms`].
    pub fn keep(&mut self, lights: &Lights, emits: bool, told: RhythmsTold) -> LightsKept {
        let apart = Rhythms::split(lights, emits, told);
        let ((lights, gain), rhythms) = match apart {
            Some((at_full, rhythms)) => ((at_full, Vec3::ONE), rhythms),
            None => (self.split(lights, emits), Rhythms::default()),
        };
        LightsKept {
            lights,
            gain,
            rhythms,
        }
    }

    /// The lights at their reference intensities, and the factor (linear RGB) that gives the lights of now. Where
    /// sources differ in how their power changes, the lights of now become the reference and the factor is 1.
    ///
    /// `emits` says that voxels emit light: like the sky, they have constant power.
    pub fn split(&mut self, lights: &Lights, emits: bool) -> (Lights, Vec3) {
        let gain = self.gain_of(lights, emits);
        let Some(gain) = gain.filter(|gain| gain.max_element() <= MOST_GAIN) else {
            self.reference = lights.lamps.iter().map(|lamp| lamp.intensity).collect();
            return (lights.clone(), Vec3::ONE);
        };
        let mut at_reference = lights.clone();
        for (lamp, reference) in at_reference.lamps.iter_mut().zip(&self.reference) {
            lamp.intensity = *reference;
        }
        (at_reference, gain.as_vec3())
    }

    /// `None` where there is no common gain.
    fn gain_of(&self, lights: &Lights, emits: bool) -> Option<DVec3> {
        if self.reference.len() != lights.lamps.len() {
            return None;
        }
        let is_constant = emits || !lights.sky.is_dark();
        // By channel; `None` as long as no source has light in it.
        let mut gains = [is_constant.then_some(1.0); 3];
        for (lamp, reference) in lights.lamps.iter().zip(&self.reference) {
            for (channel, gain) in gains.iter_mut().enumerate() {
                let (now, before) = (lamp.intensity[channel], reference[channel]);
                if now == 0.0 && before == 0.0 {
                    continue;
                }
                if before <= 0.0 {
                    return None;
                }
                let own = now / before;
                let known = *gain.get_or_insert(own);
                if (own - known).abs() > SAME * own.max(known) {
                    return None;
                }
            }
        }
        Some(DVec3::from_array(gains.map(|gain| gain.unwrap_or(1.0))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        lights::{LampShape, LampState},
        world::Sky,
    };

    fn lights(powers: &[[f64; 3]]) -> Lights {
        let lamp = |power: &[f64; 3]| LampState {
            shape: LampShape::Point,
            position_ws: DVec3::ZERO,
            direction_ws: DVec3::ZERO,
            intensity: DVec3::from_array(*power),
            radius: 0.1,
            soft_radius: 0.0,
            rhythm: None,
        };
        Lights {
            lamps: powers.iter().map(lamp).collect(),
            sky: Sky {
                zenith: Vec3::ZERO,
                horizon: Vec3::ZERO,
                ground: Vec3::ZERO,
            },
        }
    }

    #[test]
    fn a_lone_lamp_keeps_its_reference_whatever_its_power() {
        let mut gain = CommonGain::default();
        let first = lights(&[[8.0, 4.0, 0.0]]);
        assert_eq!(gain.split(&first, false), (first.clone(), Vec3::ONE));
        for factor in [0.0, 0.25, 1.0, 3.0] {
            let now = lights(&[[8.0 * factor, 2.0 * factor, 0.0]]);
            let (kept, found) = gain.split(&now, false);
            assert_eq!(kept, first);
            assert_eq!(
                found,
                Vec3::new(factor as f32, 0.5 * factor as f32, 1.0),
                "by channel"
            );
        }
    }

    #[test]
    fn several_lamps_share_a_gain_or_have_none() {
        let mut gain = CommonGain::default();
        let first = lights(&[[8.0; 3], [2.0; 3]]);
        gain.split(&first, false);
        let alike = lights(&[[4.0; 3], [1.0; 3]]);
        assert_eq!(gain.split(&alike, false), (first, Vec3::splat(0.5)));
        let apart = lights(&[[4.0; 3], [2.0; 3]]);
        assert_eq!(gain.split(&apart, false), (apart.clone(), Vec3::ONE));
        // The lights of now have become the reference.
        assert_eq!(gain.split(&apart, false), (apart, Vec3::ONE));
    }

    #[test]
    fn sources_of_constant_power_end_it() {
        let first = lights(&[[8.0; 3]]);
        let now = lights(&[[4.0; 3]]);
        let mut gain = CommonGain::default();
        gain.split(&first, true);
        assert_eq!(gain.split(&now, true), (now.clone(), Vec3::ONE));
        let mut blue = (first, now);
        blue.0.sky.zenith = Vec3::Z;
        blue.1.sky.zenith = Vec3::Z;
        let mut gain = CommonGain::default();
        gain.split(&blue.0, false);
        assert_eq!(gain.split(&blue.1, false), (blue.1, Vec3::ONE));
    }

    #[test]
    fn a_lamp_that_was_dark_begins_again_when_it_shines() {
        let mut gain = CommonGain::default();
        for power in [0.0, 1e-3, 8.0] {
            let now = lights(&[[power; 3]]);
            let (kept, factor) = gain.split(&now, false);
            assert_eq!((kept, factor), (now, Vec3::ONE), "{power}");
        }
    }
}
