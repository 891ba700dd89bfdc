//! Undo and redo: what each stroke changed, and what was there before.

use std::collections::VecDeque;

use glam::{IVec3, UVec3};

use super::{lamps::LampChange, lift::BodyChange};
use crate::world::{
    PlacedLamp,
    bodies::WholeBody,
    voxels::{Edit, Voxels},
};

/// Memory that the strokes which can be undone or redone may take (bytes); the oldest are forgotten first. A
/// stroke of one voxel takes less than 100, a ball of radius 24 about 20 thousand.
pub const MOST_BYTES: usize = 64 << 20;

/// Voxels in a row along x that a stroke changed from one material to another; 0 is air.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Run {
    /// Of its first voxel: x + size.x · (y + size.y · z), in grid space.
    start: u32,
    voxels: u16,
    old: u8,
    new: u8,
}

/// The voxels that one stroke changed, the lamp, or the body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    /// In ascending order, disjoint.
    runs: Vec<Run>,
    /// All changes lie between these voxels (grid space, both ends inclusive).
    low: IVec3,
    high: IVec3,
    lamp: Option<Box<LampChange>>,
    body: Option<Box<BodyChange>>,
}

/// Which side of a change is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Before,
    After,
}

impl Side {
    pub fn other(self) -> Self {
        match self {
            Self::Before => Self::After,
            Self::After => Self::Before,
        }
    }
}

impl Changes {
    /// Rewrites the voxels of a box (both ends inclusive) as `change(voxel, old material)`, like [`Voxels::edit`],
    /// and notes what has changed.
    pub fn make(
        voxels: &mut Voxels,
        low: IVec3,
        high: IVec3,
        mut change: impl FnMut(IVec3, u8) -> u8,
    ) -> (Edit, Self) {
        let size = voxels.size().as_ivec3();
        let mut changed: Vec<(u32, u8, u8)> = Vec::new();
        let (mut least, mut most) = (IVec3::MAX, IVec3::MIN);
        let edit = voxels.edit(low, high, |voxel, old| {
            let new = change(voxel, old);
            if new != old {
                changed.push((index(size, voxel), old, new));
                (least, most) = (least.min(voxel), most.max(voxel));
            }
            new
        });
        if changed.is_empty() {
            return (Edit::default(), Self::default());
        }
        changed.sort_unstable_by_key(|(index, ..)| *index);
        let width = size.x as u32;
        let mut runs: Vec<Run> = Vec::new();
        for (start, old, new) in changed {
            match runs.last_mut() {
                // A row ends where the next begins, and has at most 4096 voxels.
                Some(run)
                    if run.start + u32::from(run.voxels) == start
                        && start % width != 0
                        && (run.old, run.new) == (old, new) =>
                {
                    run.voxels += 1;
                }
                _ => runs.push(Run {
                    start,
                    voxels: 1,
                    old,
                    new,
                }),
            }
        }
        runs.shrink_to_fit();
        let changes = Self {
            runs,
            low: least,
            high: most,
            lamp: None,
            body: None,
        };
        (edit, changes)
    }

    /// Those of a stroke that placed, dug or switched a lamp.
    pub fn of_lamp(change: LampChange) -> Self {
        Self {
            lamp: Some(Box::new(change)),
            ..Self::default()
        }
    }

    /// The same with a body that was placed or set into the world.
    pub fn with_body(self, change: BodyChange) -> Self {
        Self {
            body: Some(Box::new(change)),
            ..self
        }
    }

    pub fn is_empty(&self) -> bool {
        self.runs.is_empty() && self.lamp.is_none() && self.body.is_none()
    }

    /// The name of the body that was placed or set into the world, and the body before or after the stroke.
    pub fn body(&self, side: Side) -> Option<(&str, Option<&WholeBody>)> {
        let change = self.body.as_deref()?;
        let body = match side {
            Side::Before => &change.before,
            Side::After => &change.after,
        };
        Some((&change.name, body.as_ref()))
    }

    /// The voxel (world space) of the lamp that was changed, and the lamp before or after the stroke.
    pub fn lamp(&self, side: Side) -> Option<(IVec3, Option<PlacedLamp>)> {
        let change = self.lamp.as_deref()?;
        let lamp = match side {
            Side::Before => change.before,
            Side::After => change.after,
        };
        Some((change.voxel, lamp))
    }

    /// The voxels (grid space) of a world of this size that are air now, and what they were.
    pub fn removed(&self, size: IVec3) -> impl Iterator<Item = (IVec3, u8)> {
        let size = size.as_uvec3();
        let dug = self.runs.iter().filter(|run| run.new == 0);
        dug.flat_map(move |run| {
            (run.start..run.start + u32::from(run.voxels)).map(move |index| {
                let row = index / size.x;
                let at = UVec3::new(index % size.x, row % size.y, row / size.y);
                (at.as_ivec3(), run.old)
            })
        })
    }

    /// Number of voxels that changed.
    pub fn voxels(&self) -> u32 {
        self.runs.iter().map(|run| u32::from(run.voxels)).sum()
    }

    /// The material that most of the voxels had before or after the stroke; 0 if most were air, or none changed.
    pub fn most(&self, side: Side) -> u8 {
        let mut counts = [0_u32; 256];
        for run in &self.runs {
            let material = match side {
                Side::Before => run.old,
                Side::After => run.new,
            };
            counts[usize::from(material)] += u32::from(run.voxels);
        }
        // The last of several that are equal counts: air.
        (0..=u8::MAX)
            .rev()
            .max_by_key(|material| counts[usize::from(*material)])
            .expect("there are 256 materials")
    }

    /// Gives the voxels the materials that they had before the stroke, or after it.
    pub fn put(&self, voxels: &mut Voxels, side: Side) -> Edit {
        if self.runs.is_empty() {
            return Edit::default();
        }
        let size = voxels.size().as_ivec3();
        voxels.edit(self.low, self.high, |voxel, now| {
            self.material(size, voxel, side).unwrap_or(now)
        })
    }

    /// The material of a voxel (grid space) before the stroke or after it, in a world of this size; `None` if the stroke
    /// did not change it.
    pub fn material(&self, size: IVec3, voxel: IVec3, side: Side) -> Option<u8> {
        if voxel.cmplt(self.low).any() || voxel.cmpgt(self.high).any() {
            return None;
        }
        let index = index(size, voxel);
        let after = self.runs.partition_point(|run| run.start <= index);
        let run = self.runs[after.checked_sub(1)?];
        (index - run.start < u32::from(run.voxels)).then_some(match side {
            Side::Before => run.old,
            Side::After => run.new,
        })
    }

    /// The box of all voxels that the stroke changed (grid space, both ends inclusive); `None` if it changed none.
    pub fn bounds(&self) -> Option<[IVec3; 2]> {
        (!self.runs.is_empty()).then_some([self.low, self.high])
    }

    fn bytes(&self) -> usize {
        let lamp = self.lamp.as_ref().map_or(0, |_| size_of::<LampChange>());
        let bodies = self.body.as_ref().map_or(0, |body| body.bytes());
        size_of::<Self>() + self.runs.capacity() * size_of::<Run>() + lamp + bodies
    }
}

/// Worlds have at most 2³² voxels.
fn index(size: IVec3, voxel: IVec3) -> u32 {
    let (size, at) = (size.as_uvec3(), voxel.as_uvec3());
    at.x + size.x * (at.y + size.y * at.z)
}

/// The strokes of a run, in their order.
#[derive(Clone, Debug)]
pub struct History {
    done: VecDeque<Changes>,
    /// The last one undone is the first to be redone.
    undone: Vec<Changes>,
    bytes: usize,
    most_bytes: usize,
}

impl Default for History {
    fn default() -> Self {
        Self {
            done: VecDeque::new(),
            undone: Vec::new(),
            bytes: 0,
            most_bytes: MOST_BYTES,
        }
    }
}

impl History {
    /// A stroke was made: what was undone before it can no longer be redone.
    pub fn push(&mut self, changes: Changes) {
        if changes.is_empty() {
            return;
        }
        let forgotten: usize = self.undone.drain(..).map(|undone| undone.bytes()).sum();
        self.bytes = self.bytes + changes.bytes() - forgotten;
        self.done.push_back(changes);
        // The newest stroke can be undone, however large it is.
        while self.bytes > self.most_bytes && self.done.len() > 1 {
            let oldest = self.done.pop_front();
            self.bytes -= oldest.map_or(0, |oldest| oldest.bytes());
        }
    }

    /// What the last stroke changed.
    pub fn last(&self) -> Option<&Changes> {
        self.done.back()
    }

    /// Undoes the last stroke by `apply`. Returns false when there is none.
    ///
    /// # Errors
    /// Those of `apply`; the stroke can then still be undone.
    pub fn undo<E>(&mut self, apply: impl FnOnce(&Changes) -> Result<(), E>) -> Result<bool, E> {
        let Some(last) = self.done.back() else {
            return Ok(false);
        };
        apply(last)?;
        self.undone.extend(self.done.pop_back());
        Ok(true)
    }

    /// Makes the stroke that was undone last again by `apply`. Returns false when there is none.
    ///
    /// # Errors
    /// Those of `apply`; the stroke can then still be redone.
    pub fn redo<E>(&mut self, apply: impl FnOnce(&Changes) -> Result<(), E>) -> Result<bool, E> {
        let Some(last) = self.undone.last() else {
            return Ok(false);
        };
        apply(last)?;
        self.done.extend(self.undone.pop());
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::world::placed::tests::lamp;

    const SIZE: i32 = 20;

    fn all(voxels: &Voxels) -> u32 {
        assert_eq!(voxels.validate(), Ok(()));
        voxels.crc32()
    }

    fn boxed(voxels: &mut Voxels, at: IVec3, edge: i32, material: u8) -> Changes {
        let (edit, changes) = Changes::make(voxels, at, at + edge, |voxel, old| {
            // Holes, so that runs begin and end within rows.
            if voxel.element_sum() % 5 == 0 {
                old
            } else {
                material
            }
        });
        assert_eq!(edit == Edit::default(), changes.is_empty());
        changes
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn strokes_undone_give_the_voxels_of_before_and_redone_those_of_after(
            strokes in prop::collection::vec(
                ((-3..SIZE, -3..SIZE, -3..SIZE), 0..6i32, 0..4u8),
                1..12,
            ),
        ) {
            let mut voxels = Voxels::empty(UVec3::splat(SIZE as u32));
            voxels.fill_box(IVec3::ZERO, IVec3::new(SIZE, 7, SIZE), 2);
            let mut history = History::default();
            let mut states = vec![all(&voxels)];
            for ((x, y, z), edge, material) in strokes {
                let changes = boxed(&mut voxels, IVec3::new(x, y, z), edge, material);
                if !changes.is_empty() {
                    states.push(all(&voxels));
                }
                history.push(changes);
            }
            for state in states.iter().rev().skip(1) {
                let put = |changes: &Changes| -> Result<(), ()> {
                    changes.put(&mut voxels, Side::Before);
                    Ok(())
                };
                prop_assert_eq!(history.undo(put), Ok(true));
                prop_assert_eq!(all(&voxels), *state);
            }
            prop_assert_eq!(history.undo(|_| Err(())), Ok(false));
            for state in &states[1..] {
                let put = |changes: &Changes| -> Result<(), ()> {
                    changes.put(&mut voxels, Side::After);
                    Ok(())
                };
                prop_assert_eq!(history.redo(put), Ok(true));
                prop_assert_eq!(all(&voxels), *state);
            }
            prop_assert_eq!(history.redo(|_| Err(())), Ok(false));
        }
    }

    #[test]
    fn a_stroke_knows_its_voxels_and_what_most_of_them_were() {
        let mut voxels = Voxels::empty(UVec3::splat(SIZE as u32));
        voxels.fill_box(IVec3::ZERO, IVec3::new(5, 5, 5), 7);
        voxels.fill_box(IVec3::ZERO, IVec3::new(5, 0, 5), 9);
        let dig = |voxels: &mut Voxels, high| Changes::make(voxels, IVec3::ZERO, high, |_, _| 0).1;
        let changes = dig(&mut voxels, IVec3::new(1, 2, 1));
        assert_eq!(changes.voxels(), 12);
        assert_eq!(
            (changes.most(Side::Before), changes.most(Side::After)),
            (7, 0)
        );
        let floor = dig(&mut voxels, IVec3::new(5, 0, 5));
        assert_eq!((floor.voxels(), floor.most(Side::Before)), (32, 9));
        assert_eq!(Changes::default().most(Side::Before), 0);
    }

    #[test]
    fn a_new_stroke_ends_redoing_and_a_failed_undo_changes_nothing() {
        let mut voxels = Voxels::empty(UVec3::splat(SIZE as u32));
        let mut history = History::default();
        for x in 0..3 {
            history.push(boxed(&mut voxels, IVec3::new(6 * x, 1, 0), 2, 1));
        }
        assert_eq!(history.undo(|_| Err("lost")), Err("lost"));
        assert_eq!(history.undo(|_| Ok::<_, ()>(())), Ok(true));
        assert_eq!(history.redo(|_| Err("lost")), Err("lost"));
        history.push(boxed(&mut voxels, IVec3::new(1, 12, 1), 2, 3));
        assert_eq!(history.redo(|_| Ok::<_, ()>(())), Ok(false));
        let kept: usize = history.done.iter().map(Changes::bytes).sum();
        assert_eq!((history.done.len(), history.bytes), (3, kept));
    }

    #[test]
    fn a_stroke_with_a_lamp_is_undone_between_those_with_voxels() {
        let mut voxels = Voxels::empty(UVec3::splat(SIZE as u32));
        let mut history = History::default();
        let lamp = lamp(IVec3::ONE);
        let change = LampChange {
            voxel: lamp.voxel,
            before: None,
            after: Some(lamp),
        };
        history.push(boxed(&mut voxels, IVec3::ONE, 2, 1));
        history.push(Changes::of_lamp(change));
        let mut undone = Vec::new();
        for _ in 0..2 {
            let note = |changes: &Changes| -> Result<(), ()> {
                undone.push(changes.lamp(Side::Before));
                assert_eq!(
                    changes.put(&mut voxels, Side::Before) == Edit::default(),
                    changes.lamp.is_some()
                );
                Ok(())
            };
            assert_eq!(history.undo(note), Ok(true));
        }
        assert_eq!(undone, [Some((lamp.voxel, None)), None]);
        assert_eq!(
            Changes::of_lamp(change).lamp(Side::After),
            Some((lamp.voxel, Some(lamp)))
        );
    }

    #[test]
    fn the_oldest_strokes_are_forgotten_where_memory_ends() {
        let mut voxels = Voxels::empty(UVec3::splat(SIZE as u32));
        let one = boxed(&mut voxels.clone(), IVec3::ONE, 0, 1).bytes();
        let mut history = History {
            most_bytes: 3 * one,
            ..History::default()
        };
        for x in 0..9 {
            history.push(boxed(&mut voxels, IVec3::new(2 * x, 1, 1), 0, 1));
            assert!(history.bytes <= 3 * one);
        }
        assert!((1..=3).contains(&history.done.len()));
        // A stroke that alone is too large can be undone nevertheless.
        history.push(boxed(&mut voxels, IVec3::ZERO, SIZE, 3));
        assert_eq!(history.done.len(), 1);
        assert_eq!(history.undo(|_| Ok::<_, ()>(())), Ok(true));
    }
}
