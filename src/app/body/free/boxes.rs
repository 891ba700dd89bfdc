//! The solid voxels of a model as few boxes, and where those are in the world.

use glam::{DVec3, I64Vec3, IVec3};

use super::super::sweep::{Aabb, to_units};
use crate::world::bodies::{Body, BodyModel};

/// The solid voxels of a body as boxes, in units from its pivot.
#[derive(Clone, Debug, PartialEq)]
pub struct Boxes {
    pub boxes: Vec<Aabb>,
    /// The box around all of them.
    pub bounds: Aabb,
}

impl Boxes {
    /// Those of a body whose axes lie along the world's; `None` for one that is turned in between. `parts` are those of
    /// its model.
    pub fn of(body: &Body, parts: &[[IVec3; 2]]) -> Option<Self> {
        let axes = body.axes()?.map(|axis| axis.as_dvec3());
        let pivot = body.pivot.as_dvec3();
        let place = |corner: IVec3| {
            let from_pivot = corner.as_dvec3() - pivot;
            let turned: DVec3 = (0..3).map(|axis| axes[axis] * from_pivot[axis]).sum();
            I64Vec3::from(turned.to_array().map(to_units))
        };
        let boxes = parts.iter().map(|[low, end]| {
            let (a, b) = (place(*low), place(*end));
            Aabb {
                min: a.min(b),
                max: a.max(b),
            }
        });
        let boxes: Vec<_> = boxes.collect();
        let bounds = boxes.iter().copied().reduce(|all, one| Aabb {
            min: all.min.min(one.min),
            max: all.max.max(one.max),
        })?;
        Some(Self { boxes, bounds })
    }
}

/// Boxes (lowest voxel, and the corner past the highest) that cover the solid voxels of a model, each once: from every
/// voxel that is not covered yet as far as possible along x, then y, then z.
pub fn parts(model: &BodyModel) -> Vec<[IVec3; 2]> {
    let size = model.size.as_ivec3();
    let index = |at: IVec3| (at.x + size.x * (at.y + size.y * at.z)) as usize;
    let mut open: Vec<bool> = model.materials.iter().map(|m| *m != 0).collect();
    let all_open = |open: &[bool], low: IVec3, end: IVec3| {
        end.cmple(size).all() && voxels(low, end).all(|at| open[index(at)])
    };
    let mut parts = Vec::new();
    for low in voxels(IVec3::ZERO, size) {
        if !open[index(low)] {
            continue;
        }
        let mut end = low + 1;
        for axis in 0..3 {
            loop {
                let (mut from, mut to) = (low, end);
                from[axis] = end[axis];
                to[axis] += 1;
                if !all_open(&open, from, to) {
                    break;
                }
                end = to;
            }
        }
        for at in voxels(low, end) {
            open[index(at)] = false;
        }
        parts.push([low, end]);
    }
    parts
}

/// All voxels of a box without its upper ends, x first.
fn voxels(low: IVec3, end: IVec3) -> impl Iterator<Item = IVec3> {
    let rows = (low.z..end.z).flat_map(move |z| (low.y..end.y).map(move |y| (y, z)));
    rows.flat_map(move |(y, z)| (low.x..end.x).map(move |x| IVec3::new(x, y, z)))
}

#[cfg(test)]
mod tests {
    use glam::UVec3;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn parts_cover_every_solid_voxel_once(
            size in (1..6u32, 1..6u32, 1..6u32), seed in prop::collection::vec(0..2u8, 216),
        ) {
            let size = UVec3::from(size);
            let materials = seed[..size.element_product() as usize].to_vec();
            let model = BodyModel { size, materials };
            let mut covered: Vec<[i32; 3]> = parts(&model)
                .into_iter()
                .flat_map(|[low, end]| voxels(low, end))
                .map(|at| at.to_array())
                .collect();
            covered.sort_unstable();
            let mut solid: Vec<[i32; 3]> = model.solid().map(|at| at.to_array()).collect();
            solid.sort_unstable();
            prop_assert_eq!(covered, solid);
        }
    }

    #[test]
    fn a_full_box_is_one_part() {
        let size = UVec3::new(7, 3, 5);
        let materials = vec![1; size.element_product() as usize];
        let model = BodyModel { size, materials };
        assert_eq!(parts(&model), [[IVec3::ZERO, size.as_ivec3()]]);
    }
}
