//! Lists of the lamps that matter in each part of the world.
//!
//! With many lamps nothing may look at all of them for each ray. The world is divided into cells, and each cell has a
//! list of the [`LISTED`] lamps that are brightest there if nothing is in the way (pass `scene/lamp_lists`). Pixels look
//! at the lamps of the list one by one; the light of all others is sampled. Up to [`KNOWN_LAMPS`] lamps there are no
//! lists: every lamp counts everywhere.
//!
//! Lists depend on where lamps are and on the greatest power that each has had, so a lamp that flickers changes no list.

use glam::UVec3;

use super::{
    Cells, Lights,
    table::{GpuLampSlot, KNOWN_LAMPS, LISTED},
};

/// A lamp that is brighter than its rank by this factor ranks higher from then on.
const BRIGHTER: f32 = 1.5;
/// Smallest cells, and most cells along an axis.
const LEAST_SHIFT: u32 = 4;
const MOST_CELLS: u32 = 32;

/// The cells of a world of `size` voxels that have lists.
pub fn cells(size: UVec3) -> Cells {
    let wanted = size.max_element().div_ceil(MOST_CELLS).max(1);
    let shift = wanted.next_power_of_two().ilog2().max(LEAST_SHIFT);
    Cells::covering(size, shift)
}

/// Bytes of the lists of all cells.
pub fn bytes(cells: Cells) -> u64 {
    cells.number() * u64::from(LISTED) * size_of::<GpuLampSlot>() as u64
}

/// How bright each lamp counts in the lists, and when the lists must be made again.
#[derive(Clone, Debug, Default)]
pub struct LampRanks {
    brightest: Vec<f32>,
    known: bool,
    made_in: u32,
}

/// What [`LampRanks`] says about a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranked {
    /// Of each lamp, the sum of the channels of its greatest intensity.
    pub brightest: Vec<f32>,
    /// Lists must be made in this frame.
    pub is_new: bool,
    /// Lists of earlier frames exist, whose slots stay.
    pub keeps_slots: bool,
    /// The frame in which the lists were last made: no lamp has moved since.
    pub made_in: u32,
}

impl LampRanks {
    /// Forgets all lists: frames are numbered from the start again.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// Ranks the lamps of frame `frame`; `still_since`: see [`super::RestingLamps`].
    pub fn follow(&mut self, lights: &Lights, still_since: &[u32], frame: u32) -> Ranked {
        let is_same = self.brightest.len() == lights.lamps.len();
        if !is_same {
            self.brightest = vec![0.0; lights.lamps.len()];
        }
        let mut has_risen = false;
        for (brightest, lamp) in self.brightest.iter_mut().zip(&lights.lamps) {
            let now = lamp.brightness();
            if now > BRIGHTER * *brightest {
                *brightest = now;
                has_risen = true;
            }
        }
        let has_lists = lights.lamps.len() > KNOWN_LAMPS as usize;
        let has_moved = still_since.contains(&frame);
        let keeps_slots = self.known;
        self.known = has_lists;
        let is_new = has_lists && (has_moved || has_risen || !is_same || !keeps_slots);
        if is_new {
            self.made_in = frame;
        }
        Ranked {
            brightest: self.brightest.clone(),
            is_new,
            keeps_slots,
            made_in: self.made_in,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;
    use crate::{
        lights::{LampShape, LampState},
        world::Sky,
    };

    fn lights(powers: &[f64]) -> Lights {
        let lamp = |&power: &f64| LampState {
            shape: LampShape::Point,
            position_ws: DVec3::ZERO,
            direction_ws: DVec3::ZERO,
            intensity: DVec3::splat(power / 3.0),
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
    fn cells_cover_the_world_and_are_few() {
        for size in [1, 16, 17, 100, 512, 513, 4096] {
            let size = UVec3::new(size, 1, size);
            let cells = cells(size);
            assert!(cells.count.max_element() <= MOST_CELLS, "{size}");
            assert!((cells.count << UVec3::splat(cells.shift)).cmpge(size).all());
        }
        assert_eq!(bytes(cells(UVec3::splat(512))), 8 << 20);
    }

    #[test]
    fn only_moves_and_greater_brightness_make_new_lists() {
        let many = |power: f64| lights(&vec![power; KNOWN_LAMPS as usize + 1]);
        let still = vec![0; KNOWN_LAMPS as usize + 1];
        let mut ranks = LampRanks::default();
        let mut is_new =
            |power, since: &[u32], frame| ranks.follow(&many(power), since, frame).is_new;
        assert!(is_new(3.0, &still, 1), "the first frame");
        assert!(!is_new(3.0, &still, 2));
        assert!(!is_new(0.1, &still, 3), "darker");
        assert!(!is_new(4.0, &still, 4), "hardly brighter");
        assert!(is_new(5.0, &still, 5), "brighter");
        let mut moved = still;
        moved[7] = 6;
        assert!(is_new(3.0, &moved, 6), "moved");
        assert!(!is_new(3.0, &moved, 7));
    }

    #[test]
    fn few_lamps_have_no_lists_and_lists_end_when_frames_begin_again() {
        let mut ranks = LampRanks::default();
        let few = lights(&vec![1.0; KNOWN_LAMPS as usize]);
        assert!(!ranks.follow(&few, &[], 1).is_new);
        let many = lights(&vec![1.0; KNOWN_LAMPS as usize + 1]);
        let first = ranks.follow(&many, &[], 2);
        assert!(first.is_new && !first.keeps_slots);
        assert!(ranks.follow(&many, &[], 3).keeps_slots);
        ranks.forget();
        let again = ranks.follow(&many, &[], 1);
        assert!(again.is_new && !again.keeps_slots);
    }
}
