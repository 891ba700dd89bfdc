//! When probes trace the same rays again, so that what changes between two updates is light and not the sample:
//! `shaders/probes/repeated_rays.wesl`.

crate::shared! {
    in probes;

    /// Sets of directions that are kept: those of the last frames.
    pub const RAY_SETS: u32 = 64;
}

/// Probes take their new rays from the sets of so many frames: neighbours with different rays have different noise.
pub const SETS_AT_A_TIME: u32 = 16;

/// Frames for which rays are repeated after a great change, while its light goes on bouncing.
const AFTER_GREAT: u32 = 8;
/// And at most, if more great changes follow.
const LONGEST: u32 = 2 * AFTER_GREAT;
/// How often probes are updated again in the first of these frames, one number for each: light makes as many bounces more.
const MORE_BOUNCES_OF_LIGHT: [u32; 6] = [2, 2, 1, 1, 1, 1];
/// After an edit no frame may take half as long again as others, for a player who digs makes many. The first one has the
/// edit itself to follow.
const MORE_BOUNCES_OF_EDIT: [u32; 5] = [0, 1, 1, 1, 1];
/// Rays of so many frames before a great change are repeated: no probe waits longer for its next update.
const BEFORE_GREAT: u32 = 11;

/// Rays are kept for as long as they may be repeated.
const _: () = assert!(BEFORE_GREAT + LONGEST + SETS_AT_A_TIME <= RAY_SETS);

/// What changes light greatly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GreatChange {
    /// An edit of voxels.
    Edit,
    /// Lamps or bodies.
    Light,
}

impl GreatChange {
    /// How often probes are updated again, in the frame that first shows the change and in those after it.
    fn more_bounces(self) -> &'static [u32] {
        match self {
            Self::Edit => &MORE_BOUNCES_OF_EDIT,
            Self::Light => &MORE_BOUNCES_OF_LIGHT,
        }
    }
}

/// The frames after a great change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Window {
    first: u32,
    /// The first frame that takes new rays again.
    end: u32,
    /// What probes are updated again for, and since which frame: the first change, or the first of light.
    change: GreatChange,
    changed: u32,
}

/// Says in each frame which rays are repeated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repeats {
    window: Option<Window>,
    within: u32,
    more_bounces: u32,
}

impl Repeats {
    /// Begins a frame. `great`: the great change of light that it is the first to show.
    pub fn begin_frame(&mut self, great: Option<GreatChange>, frame: u32) {
        self.window = self.window.filter(|window| frame < window.end);
        if let Some(change) = great {
            let window = self.window.get_or_insert(Window {
                first: frame,
                end: 0,
                change,
                changed: frame,
            });
            window.end = (frame + AFTER_GREAT).min(window.first + LONGEST);
            if change == GreatChange::Light && window.change == GreatChange::Edit {
                window.change = change;
                window.changed = frame;
            }
        }
        self.within = self
            .window
            .map_or(0, |window| (frame - window.first + BEFORE_GREAT).min(frame));
        self.more_bounces = self.window.map_or(0, |window| {
            let of_frames = window.change.more_bounces();
            let since = (frame - window.changed) as usize;
            of_frames.get(since).copied().unwrap_or(0)
        });
    }

    /// A probe repeats the rays of its last update if their set was new at most this many frames ago; 0: no probe does.
    pub fn within(&self) -> u32 {
        self.within
    }

    /// How often probes are updated in this frame, at least once.
    pub fn bounces(&self) -> u32 {
        1 + self.more_bounces
    }

    /// Whether light makes several bounces in this frame because lamps or bodies have changed. After an edit most of the light stays,
    /// and faces know it better than probes.
    pub fn is_light_ahead(&self) -> bool {
        let of_light = |window: &Window| window.change == GreatChange::Light;
        self.more_bounces > 0 && self.window.as_ref().is_some_and(of_light)
    }

    /// The first frame of the great change after which rays are repeated now.
    pub fn great_since(&self) -> Option<u32> {
        self.window.map(|window| window.first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(frames: std::ops::Range<u32>, great: &[u32]) -> Vec<u32> {
        let mut repeats = Repeats::default();
        frames
            .map(|frame| {
                let change = great.contains(&frame).then_some(GreatChange::Light);
                repeats.begin_frame(change, frame);
                repeats.within()
            })
            .collect()
    }

    /// Updates in each frame from 100 on.
    fn bounces<const N: usize>(great: impl Fn(u32) -> Option<GreatChange>) -> [u32; N] {
        let mut repeats = Repeats::default();
        std::array::from_fn(|index| {
            let frame = 100 + index as u32;
            repeats.begin_frame(great(frame), frame);
            repeats.bounces()
        })
    }

    #[test]
    fn light_is_ahead_of_faces_after_lamps_and_not_after_edits() {
        let ahead = |change: GreatChange| {
            let mut repeats = Repeats::default();
            let frames = 100..110;
            let each = frames.filter(|&frame| {
                repeats.begin_frame((frame == 101).then_some(change), frame);
                repeats.is_light_ahead()
            });
            each.collect::<Vec<u32>>()
        };
        assert_eq!(ahead(GreatChange::Light), [101, 102, 103, 104, 105, 106]);
        assert!(ahead(GreatChange::Edit).is_empty());
    }

    #[test]
    fn light_makes_several_bounces_in_the_frames_after_a_great_change() {
        use GreatChange::{Edit, Light};
        assert_eq!(bounces(|_| None), [1; 9]);
        let light = bounces(|frame| (frame == 101).then_some(Light));
        assert_eq!(light, [1, 3, 3, 2, 2, 2, 2, 1, 1, 1]);
        let edit = bounces(|frame| (frame == 101).then_some(Edit));
        assert_eq!(edit, [1, 1, 2, 2, 2, 2, 1, 1, 1, 1]);
        let both = bounces(|frame| match frame {
            100 => Some(Edit),
            103 => Some(Light),
            _ => None,
        });
        assert_eq!(both, [1, 2, 2, 3, 3, 2, 2, 2, 2, 1]);
    }

    #[test]
    fn changes_without_end_do_not_make_every_frame_long() {
        for change in [GreatChange::Edit, GreatChange::Light] {
            let all: [u32; 64] = bounces(|_| Some(change));
            let long = all.iter().filter(|&&bounces| bounces > 1).count();
            assert!(long <= 24, "{all:?}");
        }
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
