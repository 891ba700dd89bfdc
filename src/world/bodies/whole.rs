//! A body that is taken out of a world as a whole, and put back.

use std::sync::Arc;

use glam::{IVec3, Quat, Vec3};

use super::{Bodies, Body, BodyModel, PlacedBody, Pose, PutBy};

/// A body with its model. [`Body::model`] is of no use here.
#[derive(Clone, Debug, PartialEq)]
pub struct WholeBody {
    pub body: Body,
    pub model: Arc<BodyModel>,
}

impl WholeBody {
    /// A body that a player places.
    pub fn placed(placed: &PlacedBody) -> Self {
        Self {
            body: Body {
                name: placed.name.clone(),
                model: 0,
                pivot: Vec3::ZERO,
                rest: Pose {
                    position: placed.corner,
                    rotation: Quat::IDENTITY,
                },
                motion: Vec::new(),
                put_by: PutBy::Placed,
            },
            model: placed.model.clone(),
        }
    }

    /// The model turned as the body is, and where the lowest corner of that lies (world space). `None` for a body that
    /// moves by itself, or whose axes lie between those of the world.
    pub fn upright(&self) -> Option<(BodyModel, Vec3)> {
        let axes = self.body.axes().filter(|_| self.body.is_still())?;
        let turn = |v: IVec3| axes[0] * v.x + axes[1] * v.y + axes[2] * v.z;
        let end = turn(self.model.size.as_ivec3());
        let low = end.min(IVec3::ZERO);
        let size = end.abs().as_uvec3();
        let mut materials = vec![0; self.model.materials.len()];
        for voxel in self.model.solid() {
            // Twice the middle of the voxel, which is whole.
            let at = ((turn(2 * voxel + 1) - 1) / 2 - low).as_uvec3();
            let index = at.x + size.x * (at.y + size.y * at.z);
            materials[index as usize] = self.model.material(voxel);
        }
        let [x, y, z] = axes.map(|axis| axis.as_dvec3());
        let pivot = self.body.pivot.as_dvec3();
        let from_pivot = low.as_dvec3() - (x * pivot.x + y * pivot.y + z * pivot.z);
        let corner = self.body.rest.position.as_dvec3() + from_pivot;
        Some((BodyModel { size, materials }, corner.as_vec3()))
    }
}

impl Bodies {
    /// A body with its model.
    pub fn whole(&self, index: usize) -> WholeBody {
        let body = self.bodies[index].clone();
        let model = Arc::new(self.models[body.model].clone());
        WholeBody { body, model }
    }

    /// Adds a body. It comes last.
    pub fn put(&mut self, whole: &WholeBody) {
        let known = self.models.iter().position(|model| *model == *whole.model);
        let model = known.unwrap_or_else(|| {
            self.models.push((*whole.model).clone());
            self.models.len() - 1
        });
        self.gone.retain(|name| *name != whole.body.name);
        let body = whole.body.clone();
        self.bodies.push(Body { model, ..body });
    }

    /// Removes a body, and its model if no other body has it.
    pub fn remove(&mut self, index: usize) {
        let Body {
            model,
            name,
            put_by,
            ..
        } = self.bodies.remove(index);
        if put_by != PutBy::Placed {
            self.gone.push(name);
        }
        if self.bodies.iter().any(|body| body.model == model) {
            return;
        }
        self.models.remove(model);
        for body in &mut self.bodies {
            body.model -= usize::from(body.model > model);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;

    /// Three voxels in an L, of different materials, about a pivot in the middle of the first.
    fn hook(rotation: Quat) -> WholeBody {
        WholeBody {
            body: Body {
                name: "hook".into(),
                model: 0,
                pivot: Vec3::splat(0.5),
                rest: Pose {
                    position: Vec3::new(10.5, 20.5, 30.75),
                    rotation,
                },
                motion: Vec::new(),
                put_by: PutBy::WorldFile,
            },
            model: Arc::new(BodyModel {
                size: UVec3::new(2, 3, 1),
                materials: vec![1, 0, 2, 0, 3, 4],
            }),
        }
    }

    #[test]
    fn a_turned_body_is_upright_where_its_voxels_are() {
        let quarter = std::f32::consts::FRAC_PI_2;
        for rotation in [
            Quat::IDENTITY,
            Quat::from_rotation_y(quarter),
            Quat::from_rotation_z(-quarter),
            Quat::from_rotation_x(2.0 * quarter),
            Quat::from_rotation_z(quarter) * Quat::from_rotation_y(quarter),
        ] {
            let whole = hook(rotation);
            let (model, corner) = whole.upright().expect("it lies along the axes");
            assert_eq!(model.solid().count(), 4);
            for voxel in whole.model.solid() {
                let middle = voxel.as_vec3() + 0.5 - whole.body.pivot;
                let middle = rotation * middle + whole.body.rest.position;
                let at = (middle - corner).floor().as_ivec3();
                assert_eq!(
                    model.material(at),
                    whole.model.material(voxel),
                    "{rotation}"
                );
            }
        }
        assert_eq!(hook(Quat::from_rotation_y(0.3)).upright(), None);
    }

    #[test]
    fn a_body_of_the_world_file_that_is_removed_is_known_as_gone_until_it_is_back() {
        let mut bodies = Bodies::default();
        bodies.put(&hook(Quat::IDENTITY));
        let before = bodies.clone();
        let whole = bodies.whole(0);
        bodies.remove(0);
        assert_eq!(
            (&bodies.gone[..], bodies.models.len()),
            (&["hook".to_owned()][..], 0)
        );
        bodies.put(&whole);
        assert_eq!(bodies, before);
    }
}
