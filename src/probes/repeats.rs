//! When probes trace the same rays again, so that what changes between two updates is light and not the sample:
//! `shaders/probes/repeated_rays.wesl`.

crate::shared! {
    in probes;

    /// Sets of directions that are kept: those of the last frames.
    pub const RAY_SETS: u32 = 64;
}

/// Probes take their new rays from the sets of so many frames: neighbours with different rays have different noise.
pub const SETS_AT_A_TIME: u32 = 16;

/// Frames for which rays are repeated after a great change: light makes so many bounces.
const AFTER_GREAT: u32 = 8;
/// And at most, if more great changes follow.
const LONGEST: u32 = 2 * AFTER_GREAT;
/// Rays of so many frames before a great change are repeated: no probe waits longer for its next update.
const BEFORE_GREAT: u32 = 11;

/// Rays are kept for as long as they may be repeated.
const _: () = assert!(BEFORE_GREAT + LONGEST + SETS_AT_A_TIME <= RAY_SETS);

/// Says in each frame which rays are repeated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repeats {
    /// The first frame after a great change, and the first that takes new rays again.
    great: Option<(u32, u32)>,
    within: u32,
}

impl Repeats {
    /// Begins a frame. `is_great`: it is the first that shows a great change of light.
    pub fn begin_frame(&mut self, is_great: bool, frame: u32) {
        if self.great.is_some_and(|(_, end)| frame >= end) {
            self.great = None;
        }
        if is_great {
            let first = self.great.map_or(frame, |(first, _)| first);
            self.great = Some((first, (frame + AFTER_GREAT).min(first + LONGEST)));
        }
        self.within = match self.great {
            Some((first, _)) => (frame - first + BEFORE_GREAT).min(frame),
            None => 0,
        };
    }

    /// A probe repeats the rays of its last update if their set was new at most this many frames ago; 0: no probe does.
    pub fn within(&self) -> u32 {
        self.within
    }

    /// The first frame of the great change after which rays are repeated now.
    pub fn great_since(&self) -> Option<u32> {
        self.great.map(|(first, _)| first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(frames: std::ops::Range<u32>, great: &[u32]) -> Vec<u32> {
        let mut repeats = Repeats::default();
        frames
            .map(|frame| {
                repeats.begin_frame(great.contains(&frame), frame);
                repeats.within()
            })
            .collect()
    }

    #[test]
    fn still_light_never_repeats_rays() {
        assert_eq!(run(0..50, &[]), [0; 50]);
    }

    #[test]
    fn a_great_change_repeats_the_rays_of_before_for_eight_frames() {
        let within = run(98..110, &[100]);
        assert_eq!(within, [0, 0, 11, 12, 13, 14, 15, 16, 17, 18, 0, 0]);
    }

    #[test]
    fn changes_without_end_still_bring_new_rays() {
        let all: Vec<u32> = (100..200).collect();
        let within = run(100..200, &all);
        assert!(within.iter().all(|&age| age < RAY_SETS));
        let first = |window: u32| within[(window * LONGEST) as usize];
        assert!(
            (0..6).all(|window| first(window) == BEFORE_GREAT),
            "{within:?}"
        );
    }

    #[test]
    fn the_first_frames_have_no_rays_before_them() {
        assert_eq!(run(0..4, &[0]), [0, 1, 2, 3]);
    }
}
