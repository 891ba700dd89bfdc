//! Digging and building: changes the voxels that the crosshair points at.

use clap::ValueEnum;
use egui::{Slider, Ui};
use glam::IVec3;
use serde::{Deserialize, Serialize};

use super::{aim::Reach, history::Changes};
use crate::{
    app::{views, widgets},
    world::{
        Camera, World,
        voxels::{Edit, Voxels},
    },
};

/// Largest radius (voxels).
pub const MOST_RADIUS: f32 = 24.0;

/// What a stroke changes around the voxel that it meets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// That voxel alone.
    #[default]
    Voxel,
    /// All voxels whose centres lie within the radius.
    Ball,
    /// A cube whose edge is twice the whole radius, and one voxel.
    Box,
}

impl Shape {
    /// The shape after this one.
    pub fn next(self) -> Self {
        match self {
            Self::Voxel => Self::Ball,
            Self::Ball => Self::Box,
            Self::Box => Self::Voxel,
        }
    }
}

/// Settings of the strokes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Brush {
    /// Material to place: 1-based index into the world's materials.
    pub material: u8,
    pub shape: Shape,
    /// From the middle of a ball or box (voxels).
    pub radius: f32,
}

impl Default for Brush {
    fn default() -> Self {
        Self {
            material: 1,
            shape: Shape::Voxel,
            radius: 2.0,
        }
    }
}

/// What a stroke does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stroke {
    /// Removes solid voxels, starting with the voxel under the crosshair.
    Dig,
    /// Fills air with the brush's material, starting at the face under the crosshair.
    Place,
    /// Gives solid voxels the brush's material, starting with the voxel under the crosshair.
    Replace,
    /// Takes the material under the crosshair into the brush.
    Pick,
}

/// What a stroke changed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stroked {
    /// For the copy of the voxels on the GPU.
    pub edit: Edit,
    /// To be undone.
    pub changes: Changes,
}

impl Brush {
    /// The radius that counts. A record can hold any number.
    fn radius(&self) -> f32 {
        match self.shape {
            Shape::Voxel => 0.0,
            Shape::Ball | Shape::Box => self.radius.clamp(0.0, MOST_RADIUS),
        }
    }

    /// Whole voxels from the middle of the brush to its farthest voxel along an axis.
    pub fn reach(&self) -> i32 {
        self.radius() as i32
    }

    /// Whether the brush changes the voxel at this offset from its middle.
    fn covers(&self, offset: IVec3) -> bool {
        let radius = self.radius();
        match self.shape {
            Shape::Voxel => offset == IVec3::ZERO,
            Shape::Ball => offset.as_vec3().length_squared() <= radius * radius,
            Shape::Box => offset.abs().max_element() <= self.reach(),
        }
    }

    /// A larger or a smaller brush, by whole voxels. One voxel has no size.
    pub fn resized(self, by: f32) -> Self {
        match self.shape {
            Shape::Voxel => self,
            Shape::Ball | Shape::Box => Self {
                radius: (self.radius + by).clamp(1.0, MOST_RADIUS),
                ..self
            },
        }
    }

    /// The shape and its size, in words.
    pub fn text(&self) -> String {
        match self.shape {
            Shape::Voxel => "one voxel".to_owned(),
            Shape::Ball => format!("ball of radius {}", self.radius()),
            Shape::Box => format!("box of {0} × {0} × {0}", 2 * self.reach() + 1),
        }
    }

    /// Makes a stroke where `camera` looks, as far as `reach` allows.
    pub fn stroke(
        &mut self,
        voxels: &mut Voxels,
        world: &World,
        camera: &Camera,
        stroke: Stroke,
        reach: &Reach,
    ) -> Stroked {
        // An edited world file may have fewer materials.
        self.material = self.material.clamp(1, world.materials.len().max(1) as u8);
        let Some(target) = reach.aim(voxels, world.origin, camera) else {
            return Stroked::default();
        };
        match (stroke, target.before()) {
            (Stroke::Pick, _) => self.material = target.material,
            (Stroke::Dig, _) => return self.dig(voxels, target.voxel),
            (Stroke::Replace, _) => return self.replace(voxels, target.voxel),
            (Stroke::Place, Some(at)) => {
                return self.place(voxels, at, reach.kept(world.origin, camera));
            }
            (Stroke::Place, None) => {}
        }
        Stroked::default()
    }

    fn dig(&self, voxels: &mut Voxels, at: IVec3) -> Stroked {
        self.change(voxels, at, |_, _| 0)
    }

    fn replace(&self, voxels: &mut Voxels, at: IVec3) -> Stroked {
        self.change(
            voxels,
            at,
            |_, old| if old == 0 { 0 } else { self.material },
        )
    }

    /// The voxels from `low` to `high` stay as they are, so that nobody is walled in.
    fn place(&self, voxels: &mut Voxels, at: IVec3, (low, high): (IVec3, IVec3)) -> Stroked {
        self.change(voxels, at, |voxel, old| {
            let is_kept = voxel.cmpge(low).all() && voxel.cmple(high).all();
            if old == 0 && !is_kept {
                self.material
            } else {
                old
            }
        })
    }

    /// Rewrites the voxels of the brush around `at`.
    fn change(&self, voxels: &mut Voxels, at: IVec3, new: impl Fn(IVec3, u8) -> u8) -> Stroked {
        let reach = IVec3::splat(self.reach());
        let (edit, changes) = Changes::make(voxels, at - reach, at + reach, |voxel, old| {
            if self.covers(voxel - at) {
                new(voxel, old)
            } else {
                old
            }
        });
        Stroked { edit, changes }
    }

    /// Rows of a grid of two columns: the material, the shape and the radius.
    pub fn rows(&mut self, ui: &mut Ui, world: &World) {
        ui.label("material").on_hover_text(
            "What a right click places; a middle click takes the material under the crosshair",
        );
        let names: Vec<&str> = world.materials.iter().map(|m| &*m.name).collect();
        let index = usize::from(self.material).saturating_sub(1);
        let mut chosen = names.get(index).or(names.last()).copied().unwrap_or("none");
        if widgets::choose(ui, "brush material", &mut chosen, &names) {
            let index = names.iter().position(|name| *name == chosen);
            self.material = index.map_or(1, |index| index as u8 + 1);
        }
        ui.end_row();
        ui.label("brush")
            .on_hover_text("What a stroke changes around the voxel that it meets");
        ui.horizontal(|ui| {
            for shape in Shape::value_variants() {
                ui.selectable_value(&mut self.shape, *shape, views::name(shape));
            }
        });
        ui.end_row();
        ui.label("radius")
            .on_hover_text("Radius of a ball (voxels); a box has an edge of twice that, and one");
        ui.add_enabled(
            self.shape != Shape::Voxel,
            Slider::new(&mut self.radius, 1.0..=MOST_RADIUS).max_decimals(1),
        );
        ui.end_row();
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::{UVec3, Vec3};

    use super::*;
    use crate::world::file;

    /// A world of air with a floor of two voxels, and a camera above its middle.
    fn scene() -> (World, Voxels, Camera) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/cave.ron");
        let mut world = file::load(&path, &file::Overrides::default()).expect("it loads");
        world.size = UVec3::splat(32);
        world.origin = IVec3::new(-16, 4, -16);
        let mut voxels = Voxels::empty(world.size);
        voxels.fill_box(IVec3::ZERO, IVec3::new(31, 1, 31), 2);
        let camera = Camera {
            name: "above".into(),
            position: Vec3::new(0.5, 14.5, 0.5),
            yaw_deg: 0.0,
            pitch_deg: -89.9,
            fov_deg: 70.0,
        };
        (world, voxels, camera)
    }

    /// Voxels of each material, in the order of [`scene`]'s changes.
    fn count(voxels: &Voxels, material: u8) -> usize {
        let all = (0..32 * 32 * 32).map(|i| IVec3::new(i % 32, i / 32 % 32, i / 1024));
        all.filter(|at| voxels.material(*at) == material).count()
    }

    #[test]
    fn a_click_digs_the_voxel_aimed_at_and_another_fills_it_again() {
        let (world, mut voxels, camera) = scene();
        let top = IVec3::new(16, 1, 16);
        let mut brush = Brush::default();
        let edit = brush.stroke(&mut voxels, &world, &camera, Stroke::Dig, &Reach::default());
        assert_eq!(edit.edit.region, Some((top.as_uvec3(), top.as_uvec3())));
        assert_eq!((voxels.material(top), count(&voxels, 2)), (0, 2047));
        brush.stroke(
            &mut voxels,
            &world,
            &camera,
            Stroke::Place,
            &Reach::default(),
        );
        assert_eq!((voxels.material(top), count(&voxels, 1)), (1, 1));
        // On top of it, with the material that lies there.
        brush.material = 3;
        brush.stroke(
            &mut voxels,
            &world,
            &camera,
            Stroke::Pick,
            &Reach::default(),
        );
        assert_eq!(brush.material, 1);
        brush.stroke(
            &mut voxels,
            &world,
            &camera,
            Stroke::Place,
            &Reach::default(),
        );
        assert_eq!(voxels.material(top + IVec3::Y), 1);
        assert_eq!(voxels.validate(), Ok(()));
    }

    #[test]
    fn a_radius_changes_a_sphere_and_building_leaves_solid_voxels_and_the_camera_alone() {
        let (world, mut voxels, mut camera) = scene();
        let mut brush = Brush {
            material: 3,
            shape: Shape::Ball,
            radius: 2.0,
        };
        brush.stroke(&mut voxels, &world, &camera, Stroke::Dig, &Reach::default());
        // Discs of radius 2 and √3 of the sphere around the voxel hit lie in the floor.
        assert_eq!(count(&voxels, 2), 2048 - 13 - 9);
        camera.position.y = 6.5;
        let (mut voxels, at) = (scene().1, IVec3::new(16, 2, 16));
        brush.stroke(
            &mut voxels,
            &world,
            &camera,
            Stroke::Place,
            &Reach::default(),
        );
        assert_eq!(count(&voxels, 2), 2048, "solid voxels stay as they are");
        assert_eq!(voxels.material(at), 0, "the camera stays free");
        assert_eq!(count(&voxels, 3), 13 - 1 + 9 + 1);
    }

    #[test]
    fn strokes_into_the_void_change_nothing_and_solid_voxels_around_the_camera_are_dug() {
        let (world, mut voxels, mut camera) = scene();
        let mut brush = Brush::default();
        camera.pitch_deg = 45.0;
        for stroke in [Stroke::Dig, Stroke::Place, Stroke::Pick] {
            let edit = brush.stroke(&mut voxels, &world, &camera, stroke, &Reach::default());
            assert_eq!(edit, Stroked::default());
        }
        camera.position.y = 5.5;
        let edit = brush.stroke(
            &mut voxels,
            &world,
            &camera,
            Stroke::Place,
            &Reach::default(),
        );
        assert_eq!(edit, Stroked::default());
        brush.stroke(&mut voxels, &world, &camera, Stroke::Dig, &Reach::default());
        assert_eq!(voxels.material(IVec3::new(16, 1, 16)), 0);
    }

    #[test]
    fn a_material_that_the_world_no_longer_has_is_replaced() {
        let (world, mut voxels, camera) = scene();
        let mut brush = Brush {
            material: 255,
            ..Brush::default()
        };
        brush.stroke(
            &mut voxels,
            &world,
            &camera,
            Stroke::Place,
            &Reach::default(),
        );
        assert_eq!(usize::from(brush.material), world.materials.len());
    }

    #[test]
    fn strokes_end_at_the_reach_and_leave_the_body_free() {
        let (world, mut voxels, mut camera) = scene();
        let mut brush = Brush {
            material: 1,
            shape: Shape::Ball,
            radius: 2.0,
        };
        camera.position.y = 6.0 + 5.5;
        let body = (IVec3::new(0, 6, 0), IVec3::new(0, 7, 0));
        let mut reach = Reach {
            distance: 5.0,
            body: Some(body),
        };
        assert_eq!(reach.aim(&voxels, world.origin, &camera), None);
        for stroke in [Stroke::Dig, Stroke::Place] {
            let edit = brush.stroke(&mut voxels, &world, &camera, stroke, &reach);
            assert_eq!(edit, Stroked::default());
        }
        reach.distance = 5.6;
        assert!(reach.aim(&voxels, world.origin, &camera).is_some());
        brush.stroke(&mut voxels, &world, &camera, Stroke::Place, &reach);
        let at = |voxel: IVec3| voxels.material(voxel - world.origin);
        assert_eq!((at(body.0), at(body.1)), (0, 0), "the body stays free");
        assert_eq!((at(body.0 + IVec3::X), at(body.1 + IVec3::X)), (1, 1));
    }
}
