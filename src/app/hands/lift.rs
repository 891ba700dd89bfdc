//! Voxels that become a body, and a body that becomes voxels again.

use glam::{IVec3, Vec3};

use crate::world::{
    bodies::{BodyModel, WholeBody},
    voxels::Voxels,
};

/// A body before and after a stroke; `None` where there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyChange {
    pub name: String,
    pub before: Option<WholeBody>,
    pub after: Option<WholeBody>,
}

impl BodyChange {
    /// Both have one name.
    pub fn of(before: Option<WholeBody>, after: Option<WholeBody>) -> Self {
        let either = before.as_ref().or(after.as_ref());
        Self {
            name: either.map_or_else(String::new, |whole| whole.body.name.clone()),
            before,
            after,
        }
    }

    /// Memory that it takes.
    pub fn bytes(&self) -> usize {
        let bodies = [&self.before, &self.after].into_iter().flatten();
        let models = bodies.map(|body| body.model.materials.len());
        size_of::<Self>() + models.sum::<usize>()
    }
}

/// The solid voxels of a box (grid space, both ends inclusive) that are wanted, as small a model as holds them, and where
/// its lowest voxel lies (grid space). `None` where there are none.
pub fn model_of(
    voxels: &Voxels,
    [low, high]: [IVec3; 2],
    is_wanted: impl Fn(IVec3) -> bool,
) -> Option<(BodyModel, IVec3)> {
    let low = low.max(IVec3::ZERO);
    let high = high.min(voxels.size().as_ivec3() - 1);
    let material = |at: IVec3| {
        if is_wanted(at) {
            voxels.material(at)
        } else {
            0
        }
    };
    let mut bounds: Option<(IVec3, IVec3)> = None;
    for at in all(low, high).filter(|at| material(*at) != 0) {
        let (first, last) = bounds.unwrap_or((at, at));
        bounds = Some((first.min(at), last.max(at)));
    }
    let (first, last) = bounds?;
    let model = BodyModel {
        size: (last - first + 1).as_uvec3(),
        materials: all(first, last).map(material).collect(),
    };
    Some((model, first))
}

/// Whether every voxel of a model has room where its lowest voxel lies at `low` (grid space): in air, and where
/// `is_kept` (grid space) says no.
pub fn has_room(
    voxels: &Voxels,
    model: &BodyModel,
    low: IVec3,
    is_kept: impl Fn(IVec3) -> bool,
) -> bool {
    let size = voxels.size().as_ivec3();
    model.solid().all(|voxel| {
        let at = low + voxel;
        let is_inside = at.cmpge(IVec3::ZERO).all() && at.cmplt(size).all();
        is_inside && voxels.material(at) == 0 && !is_kept(at)
    })
}

/// The whole places around a body's corner, the nearest first: up to eight.
pub fn whole_places(corner: Vec3) -> Vec<IVec3> {
    let (low, high) = (corner.floor().as_ivec3(), corner.ceil().as_ivec3());
    let mut places: Vec<IVec3> = all(low, high).collect();
    places.sort_by(|a, b| {
        let far = |at: &IVec3| at.as_vec3().distance_squared(corner);
        far(a).total_cmp(&far(b))
    });
    places
}

/// All voxels of a box, both ends inclusive, x first.
fn all(low: IVec3, high: IVec3) -> impl Iterator<Item = IVec3> {
    let rows = (low.z..=high.z).flat_map(move |z| (low.y..=high.y).map(move |y| (y, z)));
    rows.flat_map(move |(y, z)| (low.x..=high.x).map(move |x| IVec3::new(x, y, z)))
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;

    #[test]
    fn a_model_is_cut_to_its_voxels_and_fits_where_it_was_once_they_are_gone() {
        let mut voxels = Voxels::empty(UVec3::splat(16));
        voxels.fill_box(IVec3::new(4, 5, 6), IVec3::new(6, 5, 9), 2);
        voxels.set(IVec3::new(5, 6, 7), 3);
        let wide = [IVec3::splat(-5), IVec3::splat(40)];
        let (model, low) = model_of(&voxels, wide, |_| true).expect("voxels");
        assert_eq!(
            (model.size, low),
            (UVec3::new(3, 2, 4), IVec3::new(4, 5, 6))
        );
        assert_eq!(model.material(IVec3::new(1, 1, 1)), 3);
        assert_eq!(model.solid().count(), 13);
        assert!(!has_room(&voxels, &model, low, |_| false));
        let empty = Voxels::empty(UVec3::splat(16));
        assert!(has_room(&empty, &model, low, |_| false));
        assert!(!has_room(&empty, &model, low, |at| at == low));
        assert!(!has_room(&empty, &model, IVec3::new(14, 5, 6), |_| false));
        let upper = model_of(&voxels, wide, |at| at.y == 6).expect("one voxel");
        assert_eq!(upper.0.size, UVec3::ONE);
        assert_eq!(model_of(&voxels, wide, |_| false), None);
    }

    #[test]
    fn whole_places_begin_with_the_nearest() {
        let at = IVec3::new(3, -4, 5);
        assert_eq!(whole_places(at.as_vec3()), [at]);
        let places = whole_places(Vec3::new(3.25, -4.0, 5.75));
        assert_eq!(places.len(), 4);
        assert_eq!(places[0], IVec3::new(3, -4, 6));
    }
}
