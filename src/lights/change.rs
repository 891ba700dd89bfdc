//! How much the lights differ between two moments.

use glam::DVec3;

use super::{LampShape, LampState, Lights};

/// A lamp that moves this far counts as a full change.
const FAR_VOXELS: f64 = 4.0;
/// So does a lamp that turns by this angle (radians).
const WIDE_RAD: f64 = 0.5;

impl Lights {
    /// The greatest change of any lamp or of the sky since `before`, relative to the brighter of the
    /// two moments: 0 for none, 1 when a lamp was switched or moved far away. Lamps that flicker or
    /// wander change by a few hundredths per frame.
    pub fn change_since(&self, before: &Self) -> f32 {
        if self.lamps.len() != before.lamps.len() {
            return 1.0;
        }
        let pairs = self.lamps.iter().zip(&before.lamps);
        let lamps = pairs.map(|(now, then)| now.change_since(then));
        let sky = [
            (self.sky.zenith, before.sky.zenith),
            (self.sky.horizon, before.sky.horizon),
            (self.sky.ground, before.sky.ground),
        ];
        let sky = sky.map(|(now, then)| relative(now.as_dvec3(), then.as_dvec3()));
        lamps.chain(sky).fold(0.0, f64::max) as f32
    }
}

impl LampState {
    fn change_since(&self, before: &Self) -> f64 {
        let kind = std::mem::discriminant::<LampShape>;
        if kind(&self.shape) != kind(&before.shape) {
            return 1.0;
        }
        let power = relative(self.intensity, before.intensity);
        let dark = self.intensity == DVec3::ZERO && before.intensity == DVec3::ZERO;
        if dark {
            return 0.0;
        }
        let way = match self.shape {
            LampShape::Directional => 0.0,
            LampShape::Point | LampShape::Spot { .. } => {
                self.position_ws.distance(before.position_ws) / FAR_VOXELS
            }
        };
        // For small angles the chord is close to the angle.
        let turn = self.direction_ws.distance(before.direction_ws) / WIDE_RAD;
        let cone = match (self.shape, before.shape) {
            (
                LampShape::Spot {
                    cos_outer: now_outer,
                    cos_inner: now_inner,
                },
                LampShape::Spot {
                    cos_outer,
                    cos_inner,
                },
            ) => {
                let angle = |cosine: f64| cosine.clamp(-1.0, 1.0).acos();
                let outer = angle(now_outer) - angle(cos_outer);
                let inner = angle(now_inner) - angle(cos_inner);
                outer.abs().max(inner.abs()) / WIDE_RAD
            }
            _ => 0.0,
        };
        power.max(way).max(turn).max(cone).min(1.0)
    }
}

/// The greatest difference of any channel, relative to the brightest channel of both colours.
fn relative(now: DVec3, before: DVec3) -> f64 {
    let most = now.max_element().max(before.max_element());
    if most <= 0.0 {
        return 0.0;
    }
    (now - before).abs().max_element() / most
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::world::Sky;

    fn lamp(position: [f64; 3], power: f64) -> LampState {
        LampState {
            shape: LampShape::Point,
            position_ws: position.into(),
            direction_ws: DVec3::ZERO,
            intensity: DVec3::splat(power),
            radius: 0.5,
            soft_radius: 0.0,
            rhythm: None,
        }
    }

    fn lights(lamps: &[LampState]) -> Lights {
        Lights {
            lamps: lamps.to_vec(),
            sky: Sky {
                zenith: Vec3::splat(0.5),
                horizon: Vec3::ONE,
                ground: Vec3::ZERO,
            },
        }
    }

    #[test]
    fn unchanged_lights_do_not_change() {
        let still = lights(&[lamp([1.0, 2.0, 3.0], 100.0), lamp([0.0; 3], 0.0)]);
        assert_eq!(still.change_since(&still.clone()), 0.0);
        let moved_in_the_dark = lights(&[lamp([1.0, 2.0, 3.0], 100.0), lamp([9.0; 3], 0.0)]);
        assert_eq!(moved_in_the_dark.change_since(&still), 0.0);
    }

    #[test]
    fn a_switched_or_moved_lamp_is_a_full_change() {
        let on = lights(&[lamp([0.0; 3], 100.0)]);
        for other in [
            lights(&[]),
            lights(&[lamp([0.0; 3], 0.0)]),
            lights(&[lamp([0.0, 5.0, 0.0], 100.0)]),
        ] {
            assert_eq!(on.change_since(&other), 1.0, "{other:?}");
            assert_eq!(other.change_since(&on), 1.0, "{other:?}");
        }
        let mut day = on.clone();
        day.sky.zenith = Vec3::ZERO;
        assert_eq!(day.change_since(&on), 1.0);
    }

    #[test]
    fn small_changes_are_small() {
        let at = |x: f64, power: f64| lights(&[lamp([x, 0.0, 0.0], power), lamp([9.0; 3], 1e6)]);
        let flickered = at(0.0, 95.0).change_since(&at(0.0, 100.0));
        assert!((flickered - 0.05).abs() < 1e-6, "{flickered}");
        let walked = at(0.1, 100.0).change_since(&at(0.0, 100.0));
        assert!((walked - 0.025).abs() < 1e-6, "{walked}");
    }

    #[test]
    fn spots_change_as_they_turn_and_open() {
        let spot = |degrees: f64, outer: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            lights(&[LampState {
                shape: LampShape::Spot {
                    cos_inner: 0.99,
                    cos_outer: outer.to_radians().cos(),
                },
                direction_ws: DVec3::new(sin, -cos, 0.0),
                ..lamp([0.0; 3], 100.0)
            }])
        };
        let turned = spot(1.0, 30.0).change_since(&spot(0.0, 30.0));
        assert!((turned - 0.0349).abs() < 1e-3, "{turned}");
        assert_eq!(spot(90.0, 30.0).change_since(&spot(0.0, 30.0)), 1.0);
        assert_eq!(spot(0.0, 80.0).change_since(&spot(0.0, 30.0)), 1.0);
    }
}
