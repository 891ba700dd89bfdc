//! Digging and building with voxels: how many of them a stroke changes.

use clap::ValueEnum;
use egui::{Slider, Ui};
use glam::IVec3;
use serde::{Deserialize, Serialize};

use super::history::Changes;
use crate::{
    app::{texts::hands as texts, views},
    world::voxels::{Edit, Voxels},
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
    pub shape: Shape,
    /// From the middle of a ball or box (voxels).
    pub radius: f32,
}

impl Default for Brush {
    fn default() -> Self {
        Self {
            shape: Shape::Voxel,
            radius: 2.0,
        }
    }
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
    /// Gives solid voxels the material in the hand, starting with the voxel under the crosshair.
    Replace,
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
    /// The radius that counts. A record can hold any number.
    fn radius(&self) -> f32 {
        match self.shape {
            Shape::Voxel => 0.0,
            Shape::Ball | Shape::Box if self.radius.is_nan() => 0.0,
            Shape::Ball | Shape::Box => self.radius.clamp(0.0, MOST_RADIUS),
        }
    }

    /// Whole voxels from the middle of the brush to its farthest voxel along an axis.
    pub fn reach(&self) -> i32 {
        self.radius() as i32
    }

    /// Whether the brush changes the voxel at this offset from its middle.
    pub fn covers(&self, offset: IVec3) -> bool {
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
            Shape::Voxel => texts::VOXEL.to_owned(),
            Shape::Ball => texts::ball(self.radius()),
            Shape::Box => texts::cube(2 * self.reach() + 1),
        }
    }

    /// Removes solid voxels around `at` (grid space).
    pub fn dig(&self, voxels: &mut Voxels, at: IVec3) -> Stroked {
        self.change(voxels, at, |_, _| 0)
    }

    /// Gives solid voxels around `at` a material (1-based).
    pub fn replace(&self, voxels: &mut Voxels, at: IVec3, material: u8) -> Stroked {
        self.change(voxels, at, |_, old| if old == 0 { 0 } else { material })
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

    /// Rows of a grid of two columns.
    pub fn rows(&mut self, ui: &mut Ui) {
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
    use glam::UVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::app::hands::Side;

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
        let brush = Brush {
            shape: Shape::Ball,
            radius: 2.0,
        };
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

    #[test]
    fn a_box_changes_a_cube_and_replacing_leaves_air() {
        let brush = Brush {
            shape: Shape::Box,
            radius: 2.9,
        };
        let (mut voxels, at) = (floor(), IVec3::new(16, 1, 16));
        brush.replace(&mut voxels, at, 3);
        // A cube of five voxels, of which two layers lie in the floor.
        assert_eq!((count(&voxels, 3), count(&voxels, 2)), (50, 2048 - 50));
        brush.dig(&mut voxels, at);
        assert_eq!((count(&voxels, 3), count(&voxels, 2)), (0, 2048 - 50));
        brush.place(&mut voxels, at, 4, |_| false);
        // At the edge of the world one layer of the cube lies outside.
        assert_eq!(count(&voxels, 4), 5 * 5 * 4);
        assert_eq!(voxels.validate(), Ok(()));
    }

    proptest! {
        /// A brush of any size, from a record too, changes what it is said to cover, and an undo gives it back.
        #[test]
        fn brushes_change_what_they_cover(
            shape in prop::sample::select(Shape::value_variants()),
            radius in prop_oneof![0.0..6.0f32, Just(f32::NAN), Just(-3.0), Just(f32::INFINITY)],
            at in (0..32i32, 0..32i32, 0..32i32),
        ) {
            let brush = Brush { shape, radius };
            let (mut voxels, at) = (floor(), IVec3::from(at));
            let before = voxels.crc32();
            let stroked = brush.place(&mut voxels, at, 3, |_| false);
            let reach = brush.reach();
            prop_assert!((0..=MOST_RADIUS as i32).contains(&reach));
            for x in 0..32 {
                for offset in [IVec3::X, IVec3::Y, IVec3::Z] {
                    // Along the axes both shapes reach as far.
                    let voxel = at * (1 - offset) + offset * x;
                    let is_near = (voxel - at).abs().max_element() <= reach;
                    prop_assert_eq!(voxels.material(voxel) == 3, is_near && voxel.y > 1);
                }
            }
            stroked.changes.put(&mut voxels, Side::Before);
            prop_assert_eq!(voxels.crc32(), before);
        }
    }

    #[test]
    fn sizes_go_by_whole_voxels_and_one_voxel_has_none() {
        let ball = Brush {
            shape: Shape::Ball,
            radius: 1.0,
        };
        assert_eq!(ball.resized(-1.0), ball);
        assert_eq!(ball.resized(1.0).text(), "ball of radius 2");
        assert_eq!(ball.resized(999.0).radius, MOST_RADIUS);
        let one = Brush::default();
        assert_eq!(one.resized(1.0), one);
        let cube = Brush {
            shape: Shape::Box,
            ..one
        };
        assert_eq!(cube.text(), "box of 5 × 5 × 5");
        let all = [one.shape, one.shape.next(), one.shape.next().next()];
        assert_eq!(all, *Shape::value_variants());
        assert_eq!(Shape::Box.next(), Shape::Voxel);
    }
}
