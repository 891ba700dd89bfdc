//! Places that lamps stay near while they move: what faces see of all that is near such a place holds until the lamp leaves it.

use glam::DVec3;

use super::{
    LampShape, Lights,
    table::{ANCHOR_REACH, GpuLampAnchor, NEVER},
};

/// A lamp that moves farther than this in a frame (voxels along an axis) leaves any place too soon.
const FASTEST: f64 = ANCHOR_REACH as f64 / 4.0;
/// How far ahead of a lamp its next place lies (voxels).
const LEAD: f64 = ANCHOR_REACH as f64 * 0.75;

/// Follows the lamps from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct LampAnchors {
    /// Where each lamp was, and its anchor.
    lamps: Vec<(DVec3, GpuLampAnchor)>,
}

impl LampAnchors {
    /// Forgets all lamps: frames are numbered from the start again.
    pub fn forget(&mut self) {
        self.lamps.clear();
    }

    /// The anchor of each lamp in frame `frame`, which is at least 1. Suns and spheres have none.
    pub fn follow(&mut self, lights: &Lights, frame: u32) -> Vec<GpuLampAnchor> {
        self.lamps.truncate(lights.lamps.len());
        for (number, lamp) in lights.lamps.iter().enumerate() {
            let place = lamp.position_ws;
            let has_none = lamp.shape == LampShape::Directional || lamp.is_soft();
            let anchor = match self.lamps.get(number) {
                _ if has_none => GpuLampAnchor::NONE,
                None => anchor_at(place, frame),
                Some((_, anchor)) if anchor.since != NEVER && is_near(place, anchor) => *anchor,
                Some((before, _)) => {
                    let way = place - *before;
                    if way.abs().max_element() > FASTEST {
                        GpuLampAnchor::NONE
                    } else {
                        anchor_at(place + way.normalize_or_zero() * LEAD, frame)
                    }
                }
            };
            match self.lamps.get_mut(number) {
                Some(known) => *known = (place, anchor),
                None => self.lamps.push((place, anchor)),
            }
        }
        self.lamps.iter().map(|(_, anchor)| *anchor).collect()
    }
}

fn anchor_at(place_ws: DVec3, since: u32) -> GpuLampAnchor {
    GpuLampAnchor {
        place_ws: place_ws.as_vec3().to_array(),
        since,
    }
}

fn is_near(place_ws: DVec3, anchor: &GpuLampAnchor) -> bool {
    let away = place_ws - DVec3::from_array(anchor.place_ws.map(f64::from));
    away.abs().max_element() <= f64::from(ANCHOR_REACH)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::{lights::LampState, world::Sky};

    fn lights(places: &[DVec3]) -> Lights {
        let lamp = |&position_ws: &DVec3| LampState {
            shape: LampShape::Point,
            position_ws,
            direction_ws: DVec3::ZERO,
            intensity: DVec3::ONE,
            radius: 0.1,
            soft_radius: 0.0,
        };
        Lights {
            lamps: places.iter().map(lamp).collect(),
            sky: Sky {
                zenith: Vec3::ZERO,
                horizon: Vec3::ZERO,
                ground: Vec3::ZERO,
            },
        }
    }

    #[test]
    fn an_anchor_holds_until_the_lamp_leaves_it_and_the_next_one_lies_ahead() {
        let mut anchors = LampAnchors::default();
        let mut changes = Vec::new();
        for frame in 1..200 {
            let place = DVec3::new(0.1 * f64::from(frame), 5.0, -3.0);
            let anchor = anchors.follow(&lights(&[place]), frame)[0];
            assert!(is_near(place, &anchor), "frame {frame}: {anchor:?}");
            assert!(anchor.since <= frame);
            if anchor.since == frame {
                changes.push(frame);
            }
        }
        // 2 voxels of the way, or 3.5 from the second on, at a tenth of a voxel per frame.
        let gaps: Vec<u32> = changes.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(gaps[0].abs_diff(20) <= 1, "{gaps:?}");
        assert!(
            gaps[1..].iter().all(|gap| gap.abs_diff(35) <= 1),
            "{gaps:?}"
        );
    }

    #[test]
    fn a_fast_lamp_has_no_anchor_until_it_slows_down() {
        let mut anchors = LampAnchors::default();
        let at = |x: f64| lights(&[DVec3::X * x]);
        anchors.follow(&at(0.0), 1);
        assert_eq!(anchors.follow(&at(3.0), 2)[0].since, NEVER);
        assert_eq!(anchors.follow(&at(3.7), 3)[0].since, NEVER);
        assert_eq!(anchors.follow(&at(3.8), 4)[0].since, 4);
        // Within reach of the place that it has.
        assert_eq!(anchors.follow(&at(5.0), 5)[0].since, 4);
    }

    #[test]
    fn suns_and_spheres_have_none() {
        let mut lamps = lights(&[DVec3::ZERO; 2]);
        lamps.lamps[0].shape = LampShape::Directional;
        lamps.lamps[1].soft_radius = 0.5;
        let found = LampAnchors::default().follow(&lamps, 1);
        assert!(
            found.iter().all(|anchor| anchor.since == NEVER),
            "{found:?}"
        );
    }
}
