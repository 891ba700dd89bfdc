//! How a volume that follows the camera changes from frame to frame.

use glam::Vec3;

use super::{Layout as _, Volume};

/// Where a volume was, which probes its last move made new, and how long each level has held light.
#[derive(Clone, Debug)]
pub struct Motion {
    before: Volume,
    fresh: u32,
    /// By level, the last frame in which most of its probes were new.
    births: Vec<u64>,
}

impl Motion {
    /// The motion of a volume that has not moved yet.
    pub fn new(volume: &Volume) -> Self {
        Self {
            before: volume.clone(),
            fresh: 0,
            births: vec![0; volume.levels().len()],
        }
    }

    /// Moves the volume before frame `frame`. Returns whether all its probes became new: the next frame
    /// then counts as the first one.
    pub fn follow(&mut self, volume: &mut Volume, eye_ws: Vec3, frame: u64) -> bool {
        self.before.clone_from(volume);
        volume.follow(eye_ws);
        self.fresh = volume.fresh_since(&self.before);
        let all_new = self.fresh == volume.slots();
        let levels = volume.levels().iter().zip(self.before.levels());
        for (birth, (now, before)) in self.births.iter_mut().zip(levels) {
            // The few remaining probes cannot light the rest.
            if all_new {
                *birth = 0;
            } else if 2 * now.fresh_since(before) > volume.level_slots() {
                *birth = frame;
            }
        }
        all_new
    }

    /// Where the volume was before its last move.
    pub fn before(&self) -> &Volume {
        &self.before
    }

    /// Number of probes that the last move made new.
    pub fn fresh(&self) -> u32 {
        self.fresh
    }

    /// Frames since most of a level's probes were new.
    pub fn age(&self, level: usize, frame: u64) -> u32 {
        let age = frame.saturating_sub(self.births[level]);
        u32::try_from(age).unwrap_or(u32::MAX)
    }
}
