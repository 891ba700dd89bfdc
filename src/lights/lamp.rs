//! A lamp at one moment, and the light that it sends to a point.

use std::f64::consts::PI;

use glam::DVec3;

use super::{
    motion::{self, Moment},
    sphere,
};
use crate::world::{
    Lamp, LampKind, LampPreset, PlacedLamp, Sun, World, materials::hash::hash_voxel,
};

/// Smaller distances count as this one, whatever the lamp's radius (voxels): keeps 1/d² finite.
pub const MIN_RADIUS: f64 = 0.01;

/// Narrowest edge of a spot, as a difference of cosines: keeps its ramp finite.
pub const MIN_SPOT_EDGE: f64 = 1e-4;

/// A lamp at one moment. World space, voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LampState {
    pub shape: LampShape,
    /// Unused by directional lamps.
    pub position_ws: DVec3,
    /// Unit vector along which the light goes; zero for point lamps.
    pub direction_ws: DVec3,
    /// Linear RGB. Point and spot: radiant intensity W/(4π) per steradian. Directional: irradiance
    /// on a facing surface.
    pub intensity: DVec3,
    /// Smaller distances count as this one. At least [`MIN_RADIUS`]. Unused by spheres.
    pub radius: f64,
    /// Point and spot: radius of the sphere that shines (voxels); 0 for a point.
    pub soft_radius: f64,
    /// How its power and colour come and go; `None` while both are constant.
    pub rhythm: Option<Rhythm>,
}

/// How the power of a lamp goes up and down, or its hue turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rhythm {
    /// Lamps with the same number have the same gain at all times.
    pub number: u32,
    /// The factors of now (linear RGB).
    pub gain: DVec3,
    /// The intensity at a gain of 1.
    pub full: DVec3,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LampShape {
    Point,
    /// Cosines of the half angles: full light above `cos_inner`, none below `cos_outer`.
    Spot {
        cos_inner: f64,
        cos_outer: f64,
    },
    Directional,
}

/// What shading a point needs from a lamp: where to send the shadow ray, and what arrives if it is
/// unblocked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LampRay {
    /// Unit vector from the point towards the lamp's centre (zero at the lamp itself).
    pub towards_ws: DVec3,
    /// Voxels to the lamp; infinite for directional lamps.
    pub distance: f64,
    /// On a surface that faces the lamp (linear RGB). Of a sphere: as if all of its light came from its centre.
    pub irradiance: DVec3,
}

/// The lamps of a preset at world time `time_s` (s), in the order of the file. `seed` is the world's
/// seed; every lamp derives its own flicker noise from it.
pub fn evaluate(preset: &LampPreset, time_s: f64, seed: u32) -> Vec<LampState> {
    let lamps = preset.lamps.iter().enumerate();
    lamps
        .map(|(index, lamp)| LampState::at(lamp, time_s, motion::lamp_seed(seed, index as u32)))
        .collect()
}

impl LampState {
    /// One lamp at one moment; `seed` belongs to this lamp alone.
    fn at(lamp: &Lamp, time_s: f64, seed: u32) -> Self {
        let still = Moment {
            position_ws: lamp.position.as_dvec3(),
            colour: lamp.colour.as_dvec3(),
            gain: 1.0,
        };
        let now = motion::apply(&lamp.motion, still, time_s, seed);
        let power = f64::from(lamp.power);
        let (shape, direction, strength) = match lamp.kind {
            LampKind::Point => (LampShape::Point, DVec3::ZERO, power / (4.0 * PI)),
            LampKind::Spot {
                direction,
                inner_deg,
                outer_deg,
            } => {
                let cosine = |degrees: f32| f64::from(degrees).to_radians().cos();
                let shape = LampShape::Spot {
                    cos_inner: cosine(inner_deg),
                    cos_outer: cosine(outer_deg),
                };
                (shape, direction.as_dvec3(), power / (4.0 * PI))
            }
            LampKind::Directional { direction } => {
                (LampShape::Directional, direction.as_dvec3(), power)
            }
        };
        Self {
            shape,
            position_ws: now.position_ws,
            direction_ws: direction.normalize_or_zero(),
            intensity: now.colour * (strength * now.gain),
            radius: f64::from(lamp.radius).max(MIN_RADIUS),
            soft_radius: match lamp.is_sphere() {
                true => f64::from(lamp.soft_radius),
                false => 0.0,
            },
            rhythm: motion::rhythm(&lamp.motion, lamp.colour, seed).map(|number| {
                let full = motion::colour_at_full(&lamp.motion, still.colour);
                let colours = now.colour / full.max(DVec3::splat(f64::MIN_POSITIVE));
                Rhythm {
                    number,
                    gain: colours * now.gain,
                    full: full * strength,
                }
            }),
        }
    }

    /// A lamp that a player has placed; dark while it is off.
    pub fn of_placed(lamp: &PlacedLamp, world: &World, time_s: f64) -> Self {
        // Its flicker belongs to its place: other lamps that come and go do not change it.
        let seed = motion::lamp_seed(world.seed, hash_voxel(lamp.voxel));
        let state = Self::at(&lamp.lamp(world.voxel_m), time_s, seed);
        if lamp.is_on { state } else { state.dark() }
    }

    /// The same lamp while it is off.
    #[must_use]
    pub fn dark(self) -> Self {
        Self {
            intensity: DVec3::ZERO,
            rhythm: None,
            ..self
        }
    }

    /// The sun as a directional lamp.
    pub fn from_sun(sun: &Sun) -> Self {
        Self {
            shape: LampShape::Directional,
            position_ws: DVec3::ZERO,
            direction_ws: -sun.towards.as_dvec3().normalize_or_zero(),
            intensity: sun.irradiance.as_dvec3(),
            radius: MIN_RADIUS,
            soft_radius: 0.0,
            rhythm: None,
        }
    }

    /// Whether the lamp is a sphere, whose shadows are soft.
    pub fn is_soft(&self) -> bool {
        self.soft_radius > 0.0
    }

    /// Sum of the channels of the intensity.
    pub fn brightness(&self) -> f32 {
        self.intensity.element_sum() as f32
    }

    /// The unshadowed light that reaches a point.
    pub fn ray_from(&self, point_ws: DVec3) -> LampRay {
        if self.shape == LampShape::Directional {
            return LampRay {
                towards_ws: -self.direction_ws,
                distance: f64::INFINITY,
                irradiance: self.intensity,
            };
        }
        let offset = self.position_ws - point_ws;
        let distance = offset.length();
        let towards_ws = offset.normalize_or_zero();
        let nearest = if self.is_soft() {
            self.soft_radius
        } else {
            self.radius
        };
        let falloff = 1.0 / distance.max(nearest).powi(2);
        let spot = self.spot_factor(-towards_ws);
        LampRay {
            towards_ws,
            distance,
            irradiance: self.intensity * (falloff * spot),
        }
    }

    /// Unshadowed irradiance (linear RGB) on a surface with this unit normal.
    pub fn irradiance(&self, point_ws: DVec3, normal_ws: DVec3) -> DVec3 {
        let ray = self.ray_from(point_ws);
        let cosine = normal_ws.dot(ray.towards_ws);
        if self.is_soft() {
            let share = sphere::irradiance(self.soft_radius, ray.distance, cosine);
            return self.intensity * (self.spot_factor(-ray.towards_ws) * share);
        }
        ray.irradiance * cosine.max(0.0)
    }

    /// Share of the full intensity that leaves along a unit direction.
    pub fn spot_factor(&self, leaving_ws: DVec3) -> f64 {
        match self.shape {
            LampShape::Spot {
                cos_inner,
                cos_outer,
            } => {
                let edge = (cos_inner - cos_outer).max(MIN_SPOT_EDGE);
                let t = ((leaving_ws.dot(self.direction_ws) - cos_outer) / edge).clamp(0.0, 1.0);
                t * t * (3.0 - 2.0 * t)
            }
            LampShape::Point | LampShape::Directional => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Motion;
    use glam::Vec3;
    use proptest::prelude::*;

    fn lamp(kind: LampKind, motion: Vec<Motion>) -> Lamp {
        Lamp {
            name: "lamp".into(),
            kind,
            position: Vec3::new(1.0, 5.0, -2.0),
            colour: Vec3::new(1.0, 0.5, 0.25),
            power: 100.0,
            radius: 0.25,
            soft_radius: 0.0,
            motion,
        }
    }

    fn still(kind: LampKind) -> LampState {
        LampState::at(&lamp(kind, Vec::new()), 0.0, 0)
    }

    const SPOT: LampKind = LampKind::Spot {
        direction: Vec3::NEG_Y,
        inner_deg: 20.0,
        outer_deg: 35.0,
    };

    #[test]
    fn the_light_of_a_lamp_whose_hue_turns_is_white_times_its_gain() {
        let turning = [
            Motion::HueCycle { rate: 0.4 },
            Motion::Pulse {
                amount: 0.9,
                rate: 3.0,
                phase: 0.0,
            },
        ];
        let turning = lamp(LampKind::Point, turning.to_vec());
        let rhythm = |state: &LampState| state.rhythm.expect("its hue turns");
        let first = rhythm(&LampState::at(&turning, 0.0, 5));
        assert_eq!(first.full, DVec3::splat(first.full.x));
        for time_s in [0.0, 0.3, 1.1, 2.4] {
            let now = LampState::at(&turning, time_s, 5);
            let own = rhythm(&now);
            assert_eq!((own.number, own.full), (first.number, first.full));
            let apart = (own.full * own.gain - now.intensity).abs().max_element();
            assert!(apart < 1e-9 * now.intensity.max_element(), "{time_s}");
        }
        // Others have their own gain.
        let blue = Lamp {
            colour: Vec3::Z,
            ..turning
        };
        assert_ne!(rhythm(&LampState::at(&blue, 0.0, 5)).number, first.number);
    }

    /// E = W/(4π) · h/(h² + r²)^(3/2) at distance r from the foot of a point lamp at height h.
    #[test]
    fn a_lamp_over_a_plane_follows_inverse_square_and_cosine() {
        let lamp = still(LampKind::Point);
        for r in [0.0, 1.0, 3.0, 10.0] {
            let irradiance = lamp.irradiance(DVec3::new(1.0 + r, 0.0, -2.0), DVec3::Y);
            let expected = 100.0 / (4.0 * PI) * 5.0 / (25.0 + r * r).powf(1.5);
            assert!(
                (irradiance.x - expected).abs() < 1e-12,
                "{irradiance} at {r}"
            );
            assert!((irradiance.y - 0.5 * expected).abs() < 1e-12);
        }
        assert_eq!(
            lamp.irradiance(DVec3::ZERO, DVec3::NEG_Y),
            DVec3::ZERO,
            "nothing from behind"
        );
    }

    /// The flux through a closed box around a point lamp is its power.
    #[test]
    fn the_power_of_a_lamp_comes_out_of_a_box_around_it() {
        let lamp = still(LampKind::Point);
        let steps = 64;
        let mut flux = 0.0;
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let mut outwards = DVec3::ZERO;
                outwards[axis] = side;
                for i in 0..steps {
                    for j in 0..steps {
                        let mut at = outwards;
                        at[(axis + 1) % 3] = (f64::from(i) + 0.5) / f64::from(steps) * 2.0 - 1.0;
                        at[(axis + 2) % 3] = (f64::from(j) + 0.5) / f64::from(steps) * 2.0 - 1.0;
                        let area = (2.0 / f64::from(steps)).powi(2);
                        flux += lamp.irradiance(lamp.position_ws + at, -outwards).x * area;
                    }
                }
            }
        }
        assert!((flux - 100.0).abs() < 0.05, "{flux} W");
    }

    #[test]
    fn distances_below_the_radius_count_as_the_radius() {
        let lamp = still(LampKind::Point);
        let at = |d: f64| lamp.ray_from(lamp.position_ws - DVec3::Y * d).irradiance.x;
        assert_eq!(at(0.1), at(0.25));
        assert!(at(0.26) < at(0.25));
        assert!(at(0.0).is_finite());
    }

    /// Where all of a sphere is above a surface's horizon, it lights the surface as a point lamp does.
    #[test]
    fn a_sphere_over_a_plane_is_a_point_lamp() {
        let point = still(LampKind::Point);
        let sphere = |soft_radius| LampState {
            soft_radius,
            ..point
        };
        for r in [0.0, 1.0, 3.0, 10.0] {
            let at = DVec3::new(1.0 + r, 0.0, -2.0);
            let truth = point.irradiance(at, DVec3::Y);
            let error = (sphere(1.5).irradiance(at, DVec3::Y) - truth).length() / truth.length();
            assert!(error < 1e-12, "{error} at {r}");
        }
        // Half of it is below the horizon of a wall that points at it edge on.
        let edge = sphere(1.5).irradiance(DVec3::new(1.0, 0.0, -2.0), DVec3::X);
        assert!(edge.x > 0.0 && point.irradiance(DVec3::new(1.0, 0.0, -2.0), DVec3::X).x == 0.0);
    }

    #[test]
    fn spheres_too_small_to_matter_are_points_and_directional_lamps_have_none() {
        let with = |kind, soft_radius| {
            let lamp = Lamp {
                soft_radius,
                ..lamp(kind, Vec::new())
            };
            LampState::at(&lamp, 0.0, 0).soft_radius
        };
        assert_eq!(with(LampKind::Point, 0.005), 0.0);
        assert_eq!(with(SPOT, 2.0), 2.0);
        let direction = Vec3::NEG_Y;
        assert_eq!(with(LampKind::Directional { direction }, 2.0), 0.0);
    }

    #[test]
    fn a_directional_lamp_does_not_fall_off() {
        let lamp = still(LampKind::Directional {
            direction: Vec3::new(0.0, -2.0, 0.0),
        });
        let near = lamp.irradiance(DVec3::ZERO, DVec3::Y);
        assert_eq!(near, DVec3::new(100.0, 50.0, 25.0));
        assert_eq!(near, lamp.irradiance(DVec3::splat(1e6), DVec3::Y));
        assert_eq!(lamp.ray_from(DVec3::ZERO).distance, f64::INFINITY);
    }

    #[test]
    fn the_sun_comes_from_where_it_stands() {
        let sun = Sun {
            towards: Vec3::new(0.6, 0.8, 0.0),
            irradiance: Vec3::splat(3.0),
        };
        let irradiance = LampState::from_sun(&sun).irradiance(DVec3::ZERO, DVec3::Y);
        assert!(
            (irradiance - DVec3::splat(2.4)).length() < 1e-6,
            "{irradiance}"
        );
    }

    #[test]
    fn a_spot_is_full_inside_dark_outside_and_continuous_between() {
        let spot = still(SPOT);
        let factor = |degrees: f64| {
            let angle = degrees.to_radians();
            spot.spot_factor(DVec3::new(angle.sin(), -angle.cos(), 0.0))
        };
        assert_eq!(factor(19.9), 1.0);
        assert_eq!(factor(35.1), 0.0);
        let mut last = factor(0.0);
        for step in 1..=1800 {
            let next = factor(f64::from(step) * 0.1);
            assert!(
                next <= last && last - next < 0.015,
                "jump at {}°",
                f64::from(step) * 0.1
            );
            last = next;
        }
    }

    #[test]
    fn a_spot_with_a_hard_edge_stays_finite() {
        let kind = LampKind::Spot {
            direction: Vec3::NEG_Y,
            inner_deg: 30.0,
            outer_deg: 30.0,
        };
        let irradiance = still(kind).irradiance(DVec3::new(1.0, 0.0, -2.0), DVec3::Y);
        assert!(irradiance.is_finite() && irradiance.x > 0.0);
    }

    #[test]
    fn the_order_and_number_of_lamps_are_the_files() {
        let preset = LampPreset {
            name: "p".into(),
            lamps: vec![lamp(LampKind::Point, vec![]), lamp(SPOT, vec![])],
        };
        let lamps = evaluate(&preset, 3.0, 7);
        assert_eq!(lamps.len(), 2);
        assert_eq!(lamps[0].shape, LampShape::Point);
        assert_ne!(lamps[1].shape, LampShape::Point);
    }

    #[test]
    fn two_lamps_flicker_apart() {
        let flicker = vec![Motion::Flicker {
            amount: 0.5,
            rate: 3.0,
        }];
        let preset = LampPreset {
            name: "p".into(),
            lamps: vec![lamp(LampKind::Point, flicker); 2],
        };
        let lamps = evaluate(&preset, 3.3, 7);
        assert_ne!(lamps[0].intensity, lamps[1].intensity);
        assert_eq!(
            lamps,
            evaluate(&preset, 3.3, 7),
            "the same seed and time give the same lamps"
        );
        assert_ne!(lamps, evaluate(&preset, 3.3, 8));
    }

    proptest! {
        /// A second lamp adds exactly its own light.
        #[test]
        fn lamps_add_up(x in -20.0..20.0f64, y in -20.0..20.0f64, z in -20.0..20.0f64) {
            let point = DVec3::new(x, y, z);
            let both = LampPreset { name: "p".into(), lamps: vec![lamp(LampKind::Point, vec![]), lamp(SPOT, vec![])] };
            let sum = |lamps: &[LampState]| lamps.iter().map(|l| l.irradiance(point, DVec3::Y)).sum::<DVec3>();
            let lamps = evaluate(&both, 0.0, 0);
            let apart = sum(&lamps[..1]) + sum(&lamps[1..]);
            prop_assert!((sum(&lamps) - apart).length() <= 1e-12 * apart.length());
            prop_assert!(sum(&lamps).cmpge(sum(&lamps[..1])).all());
        }
    }
}
