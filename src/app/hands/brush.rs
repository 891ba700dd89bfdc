//! Digging and building with voxels: how many of them a stroke changes.

use egui::{Slider, Ui};
use glam::IVec3;
use serde::{Deserialize, Serialize};

use super::history::Changes;
use crate::world::voxels::{Edit, Voxels};

/// Largest radius that the panel offers (voxels).
const MOST_RADIUS: f32 = 24.0;

/// Settings of the strokes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Brush {
    /// Radius of the sphere that a stroke changes (voxels); 0 for a single voxel.
    pub radius: f32,
}

/// What a stroke does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stroke {
    /// Removes solid voxels, starting with the voxel under the crosshair; or the lamp there.
    Dig,
    /// Fills air with the material in the hand, starting at the face under the crosshair; or hangs the lamp in the hand
    /// there. Switches a lamp under the crosshair.
    Place,
    /// Takes the material or the lamp under the crosshair into the hand.
    Pick,
}

/// What a stroke changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stroked {
    /// For the copy of the voxels on the GPU.
    pub edit: Edit,
    /// To be undone.
    pub changes: Changes,
}

impl Brush {
    /// Removes solid voxels around `at` (grid space).
    pub fn dig(&self, voxels: &mut Voxels, at: IVec3) -> Stroked {
        self.change(voxels, at, |_, _| 0)
    }

    /// Fills air around `at` with a material (1-based). Voxels that are kept stay as they are, so that nobody is walled
    /// in.
    pub fn place(
        &self,
        voxels: &mut Voxels,
        at: IVec3,
        material: u8,
        is_kept: impl Fn(IVec3) -> bool,
    ) -> Stroked {
        self.change(voxels, at, |voxel, old| {
            if old == 0 && !is_kept(voxel) {
                material
            } else {
                old
            }
        })
    }

    /// Rewrites the voxels whose centres lie within the radius of the centre of `at`.
    fn change(&self, voxels: &mut Voxels, at: IVec3, new: impl Fn(IVec3, u8) -> u8) -> Stroked {
        let radius = self.radius.clamp(0.0, MOST_RADIUS);
        let reach = IVec3::splat(radius as i32);
        let (edit, changes) = Changes::make(voxels, at - reach, at + reach, |voxel, old| {
            if (voxel - at).as_vec3().length_squared() <= radius * radius {
                new(voxel, old)
            } else {
                old
            }
        });
        Stroked { edit, changes }
    }

    /// Rows of a grid of two columns.
    pub fn rows(&mut self, ui: &mut Ui) {
        ui.label("radius").on_hover_text(
            "Radius of the sphere that a click changes (voxels); 0 for a single voxel",
        );
        ui.add(Slider::new(&mut self.radius, 0.0..=MOST_RADIUS).max_decimals(1));
        ui.end_row();
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;

    /// A floor of two voxels.
    fn floor() -> Voxels {
        let mut voxels = Voxels::empty(UVec3::splat(32));
        voxels.fill_box(IVec3::ZERO, IVec3::new(31, 1, 31), 2);
        voxels
    }

    fn count(voxels: &Voxels, material: u8) -> usize {
        let all = (0..32 * 32 * 32).map(|i| IVec3::new(i % 32, i / 32 % 32, i / 1024));
        all.filter(|at| voxels.material(*at) == material).count()
    }

    #[test]
    fn a_single_voxel_is_dug_and_placed() {
        let (mut voxels, top) = (floor(), IVec3::new(16, 1, 16));
        let brush = Brush::default();
        let dug = brush.dig(&mut voxels, top);
        assert_eq!(dug.edit.region, Some((top.as_uvec3(), top.as_uvec3())));
        assert_eq!((voxels.material(top), count(&voxels, 2)), (0, 2047));
        brush.place(&mut voxels, top, 1, |_| false);
        assert_eq!((voxels.material(top), count(&voxels, 1)), (1, 1));
        let none = brush.place(&mut voxels, top, 3, |_| false);
        assert_eq!(none, Stroked::default(), "solid voxels stay");
        assert_eq!(voxels.validate(), Ok(()));
    }

    #[test]
    fn a_radius_changes_a_sphere_and_building_leaves_kept_voxels_alone() {
        let brush = Brush { radius: 2.0 };
        let mut voxels = floor();
        brush.dig(&mut voxels, IVec3::new(16, 1, 16));
        // Discs of radius 2 and √3 of the sphere lie in the floor.
        assert_eq!(count(&voxels, 2), 2048 - 13 - 9);
        let (mut voxels, at) = (floor(), IVec3::new(16, 2, 16));
        brush.place(&mut voxels, at, 3, |voxel| voxel == at);
        assert_eq!(count(&voxels, 2), 2048, "solid voxels stay as they are");
        assert_eq!(voxels.material(at), 0, "what is kept stays free");
        assert_eq!(count(&voxels, 3), 13 - 1 + 9 + 1);
    }
}
