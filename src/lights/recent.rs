//! The lights of the last frames: how much they change, and how steadily.

use glam::DVec3;

use super::Lights;

/// Share of each frame in the means over the last frames.
const RATE: f64 = 1.0 / 16.0;
/// A power that changes by less than this share in a frame counts as steady, so that a lamp that flickered once is soon forgotten.
const LITTLE: f64 = 1e-3;
/// So many lamps say how steady all of them are.
const MOST_LAMPS: usize = 4096;

/// What is remembered of the lights of the frames before.
#[derive(Clone, Debug, Default)]
pub struct RecentLights {
    before: Option<Lights>,
    drifts: Vec<Drift>,
}

/// Means over the last frames, by channel, of how a lamp's intensity has changed.
#[derive(Clone, Copy, Debug, Default)]
struct Drift {
    signed: DVec3,
    unsigned: DVec3,
}

impl RecentLights {
    /// Forgets all frames.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// How much these lights differ from those of the frame before, as [`Lights::change_since`] says it; 0 for the first ones.
    pub fn change(&self, lights: &Lights) -> f32 {
        let before = self.before.as_ref();
        before.map_or(0.0, |before| lights.change_since(before))
    }

    /// Takes these lights as those of the frame before.
    pub fn keep(&mut self, lights: Lights) {
        let before = self.before.take();
        let before = before.filter(|before| before.lamps.len() == lights.lamps.len());
        if let Some(before) = before {
            let count = lights.lamps.len().min(MOST_LAMPS);
            self.drifts.resize(count, Drift::default());
            let pairs = lights.lamps.iter().zip(&before.lamps);
            for (drift, (now, then)) in self.drifts.iter_mut().zip(pairs) {
                let change = now.intensity - then.intensity;
                drift.signed += (change - drift.signed) * RATE;
                drift.unsigned += (change.abs() - drift.unsigned) * RATE;
            }
        } else {
            self.drifts.clear();
        }
        self.before = Some(lights);
    }

    /// How steadily the power of lamps rises or falls, 0 to 1: 1 where every lamp goes on as it has begun or keeps its power,
    /// near 0 where they flicker, so that what they did last says nothing of what they do next.
    pub fn steadiness(&self) -> f32 {
        let drifts = self.drifts.iter();
        let [signed, unsigned] = drifts.fold([0.0; 2], |[signed, unsigned], drift| {
            [
                signed + drift.signed.abs().element_sum(),
                unsigned + drift.unsigned.element_sum(),
            ]
        });
        let lamps = self.before.iter().flat_map(|lights| &lights.lamps);
        let power: f64 = lamps
            .take(MOST_LAMPS)
            .map(|lamp| lamp.intensity.element_sum())
            .sum();
        let little = LITTLE * power;
        match unsigned + little {
            0.0 => 1.0,
            all => ((signed + little) / all) as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::rest::tests::lights, *};

    /// The steadiness of a lamp of this power by frame, after a second, beside one that never changes.
    fn steadiness_of(power: impl Fn(u32) -> f64) -> f32 {
        let mut recent = RecentLights::default();
        for frame in 0..60 {
            recent.keep(lights(&[(0.0, power(frame)), (1.0, 50.0)]));
        }
        recent.steadiness()
    }

    #[test]
    fn what_glides_is_steady_and_what_flickers_is_not() {
        let rising = steadiness_of(|frame| 10.0 + f64::from(frame));
        assert!((rising - 1.0).abs() < 1e-6, "{rising}");
        assert_eq!(steadiness_of(|_| 10.0), 1.0, "nothing changes");
        let pulse = steadiness_of(|frame| 10.0 + 5.0 * (f64::from(frame) * 0.02).sin());
        assert!(pulse > 0.5, "{pulse}");
        let flicker = steadiness_of(|frame| 10.0 + 5.0 * f64::from(frame * 7 % 5));
        assert!(flicker < 0.3, "{flicker}");
    }

    #[test]
    fn a_lamp_that_has_flickered_is_soon_forgotten() {
        let mut recent = RecentLights::default();
        for frame in 0..180 {
            let power = 10.0 + 5.0 * f64::from(frame.min(60) * 7 % 5);
            recent.keep(lights(&[(0.0, power), (1.0, 50.0)]));
        }
        assert!(recent.steadiness() > 0.9, "{}", recent.steadiness());
    }

    #[test]
    fn lamps_that_come_or_go_are_known_anew() {
        let mut recent = RecentLights::default();
        assert_eq!(
            recent.change(&lights(&[(0.0, 1.0)])),
            0.0,
            "the first frame"
        );
        recent.keep(lights(&[(0.0, 1.0)]));
        assert!((recent.change(&lights(&[(0.0, 0.9)])) - 0.1).abs() < 1e-6);
        recent.keep(lights(&[(0.0, 0.9)]));
        recent.keep(lights(&[(0.0, 0.9), (1.0, 5.0)]));
        assert_eq!(recent.steadiness(), 1.0);
        recent.forget();
        assert_eq!(recent.change(&lights(&[(0.0, 9.0)])), 0.0);
    }
}
