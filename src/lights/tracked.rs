//! Which lamps the occlusion field keeps: the few that light the surroundings of the camera most.

use glam::DVec3;

use super::{LampShape, LampState, Lights};

/// A lamp without a place takes one from a lamp that has one only if it is this much more important, so that two lamps
/// of the same importance do not take turns.
const LEAD: f64 = 1.5;

/// A lamp whose visibility is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrackedLamp {
    /// Its number among the lamps.
    pub lamp: u32,
    /// Increases whenever the place goes to another lamp, from 1 on: what was stored for the one before is void.
    pub generation: u32,
}

/// The places for lamps. A lamp keeps its place as long as it is important enough.
#[derive(Clone, Debug)]
pub struct TrackedLamps {
    places: Vec<Option<TrackedLamp>>,
    last_generation: u32,
}

impl TrackedLamps {
    /// For at most `most` lamps.
    pub fn new(most: u32) -> Self {
        Self {
            places: vec![None; most as usize],
            last_generation: 0,
        }
    }

    /// Empties all places: what was stored is void.
    pub fn forget(&mut self) {
        self.places.fill(None);
    }

    /// The lamp of each place from now on, for a camera at `eye_ws`. The power of a lamp decides only which lamps have
    /// places; lamps without light have none.
    pub fn follow(&mut self, lights: &Lights, eye_ws: DVec3) -> &[Option<TrackedLamp>] {
        let has_place = |lamp: u32| {
            let mut taken = self.places.iter().flatten();
            taken.any(|place| place.lamp == lamp)
        };
        let mut ranked: Vec<(f64, u32)> = (lights.lamps.iter().zip(0..))
            .map(|(lamp, number)| {
                let lead = if has_place(number) { LEAD } else { 1.0 };
                (importance(lamp, eye_ws) * lead, number)
            })
            .filter(|(importance, _)| *importance > 0.0)
            .collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        ranked.truncate(self.places.len());
        let is_chosen = |lamp: u32| ranked.iter().any(|(_, chosen)| *chosen == lamp);
        for place in &mut self.places {
            if place.is_some_and(|place| !is_chosen(place.lamp)) {
                *place = None;
            }
        }
        for (_, lamp) in ranked {
            if self.places.iter().flatten().any(|place| place.lamp == lamp) {
                continue;
            }
            if let Some(free) = self.places.iter_mut().find(|place| place.is_none()) {
                self.last_generation += 1;
                *free = Some(TrackedLamp {
                    lamp,
                    generation: self.last_generation,
                });
            }
        }
        &self.places
    }
}

/// The irradiance at a point that faces the lamp, without shadows and whatever the direction of a spot.
fn importance(lamp: &LampState, eye_ws: DVec3) -> f64 {
    let brightness = f64::from(lamp.brightness());
    match lamp.shape {
        LampShape::Directional => brightness,
        LampShape::Point | LampShape::Spot { .. } => {
            let nearest = lamp.radius.max(lamp.soft_radius);
            brightness / lamp.position_ws.distance(eye_ws).max(nearest).powi(2)
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::world::Sky;

    fn lights(lamps: &[(f64, f64)]) -> Lights {
        let lamp = |&(x, power): &(f64, f64)| LampState {
            shape: LampShape::Point,
            position_ws: DVec3::X * x,
            direction_ws: DVec3::ZERO,
            intensity: DVec3::splat(power),
            radius: 0.1,
            soft_radius: 0.0,
            rhythm: None,
        };
        Lights {
            lamps: lamps.iter().map(lamp).collect(),
            sky: Sky {
                zenith: Vec3::ZERO,
                horizon: Vec3::ZERO,
                ground: Vec3::ZERO,
            },
        }
    }

    fn followed(tracked: &mut TrackedLamps, lamps: &[(f64, f64)], eye: f64) -> Vec<Option<u32>> {
        let places = tracked.follow(&lights(lamps), DVec3::X * eye);
        places
            .iter()
            .map(|place| place.map(|place| place.lamp))
            .collect()
    }

    #[test]
    fn the_brightest_at_the_camera_have_places_and_keep_them() {
        let mut tracked = TrackedLamps::new(2);
        let lamps = [(0.0, 1.0), (10.0, 1.0), (30.0, 1.0), (2.0, 0.0)];
        assert_eq!(followed(&mut tracked, &lamps, 1.0), [Some(0), Some(1)]);
        // Between the first and the third a small lead is not enough.
        assert_eq!(followed(&mut tracked, &lamps, 15.5), [Some(0), Some(1)]);
        let before = tracked.places.clone();
        assert_eq!(followed(&mut tracked, &lamps, 25.0), [Some(2), Some(1)]);
        assert_eq!(tracked.places[1], before[1]);
        assert!(tracked.places[0].map(|place| place.generation) > before[0].map(|p| p.generation));
    }

    #[test]
    fn power_as_a_whole_changes_nothing() {
        let lamps = [(0.0, 1.0), (10.0, 3.0), (30.0, 2.0)];
        let brighter = lamps.map(|(x, power)| (x, 1000.0 * power));
        for eye in [-5.0, 4.0, 12.0, 40.0] {
            let [one, other] =
                [lamps, brighter].map(|lamps| followed(&mut TrackedLamps::new(2), &lamps, eye));
            assert_eq!(one, other, "camera at {eye}");
        }
    }

    #[test]
    fn places_without_lamps_are_empty() {
        let mut tracked = TrackedLamps::new(2);
        assert_eq!(followed(&mut tracked, &[], 0.0), [None, None]);
        assert_eq!(followed(&mut tracked, &[(0.0, 0.0)], 0.0), [None, None]);
        assert_eq!(followed(&mut tracked, &[(0.0, 1.0)], 0.0), [Some(0), None]);
        assert_eq!(followed(&mut tracked, &[], 0.0), [None, None]);
        assert!(followed(&mut TrackedLamps::new(0), &[(0.0, 1.0)], 0.0).is_empty());
    }
}
