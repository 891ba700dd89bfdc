//! What the crosshair points at.

use egui::{Align2, Color32, FontId, LayerId, Order, Stroke as Line, Ui, vec2};
use glam::IVec3;

use crate::{
    reference::march::{FACE_NORMALS, Outcome, Ray, march},
    world::{Camera, voxels::Voxels},
};

/// From the crosshair's middle to its ends (egui's points).
const CROSSHAIR: f32 = 7.0;

/// Where strokes may go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Voxels from the camera to the face aimed at.
    pub distance: f64,
    /// The lowest and the highest voxel (world space) of the body that holds the brush: they stay free.
    pub body: Option<(IVec3, IVec3)>,
}

impl Default for Reach {
    fn default() -> Self {
        Self {
            distance: f64::INFINITY,
            body: None,
        }
    }
}

/// A solid voxel under the crosshair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Target {
    /// Grid space.
    pub voxel: IVec3,
    /// Index into [`FACE_NORMALS`]; `None` where the camera is inside of the voxel.
    pub face: Option<u8>,
    /// 1-based index into the world's materials.
    pub material: u8,
}

impl Target {
    /// The voxel before the face aimed at (grid space).
    pub fn before(&self) -> Option<IVec3> {
        let face = usize::from(self.face?);
        Some(self.voxel + FACE_NORMALS[face])
    }
}

impl Reach {
    /// The first voxel that a stroke where `camera` looks would meet, in a world with this origin.
    pub fn aim(&self, voxels: &Voxels, origin: IVec3, camera: &Camera) -> Option<Target> {
        let basis = camera.basis(1.0);
        let ray = Ray {
            max_distance: self.distance,
            ..Ray::new(basis.origin - origin.as_dvec3(), basis.forward.normalize())
        };
        match march(voxels, &ray) {
            Outcome::Hit(hit) => Some(Target {
                voxel: hit.voxel,
                face: Some(hit.face),
                material: hit.material,
            }),
            Outcome::Inside(material) => Some(Target {
                voxel: ray.start,
                face: None,
                material,
            }),
            Outcome::Miss => None,
        }
    }

    /// The voxels that stay free (grid space, both ends inclusive): those of the body, or of the camera.
    pub fn kept(&self, origin: IVec3, camera: &Camera) -> (IVec3, IVec3) {
        let eye = camera.position.as_dvec3().floor().as_ivec3();
        let (low, high) = self.body.unwrap_or((eye, eye));
        (low - origin, high - origin)
    }
}

/// Draws a cross where strokes go: light on dark backgrounds, dark on light ones, and faint where they reach
/// nothing.
pub fn crosshair(ui: &Ui, reaches: bool) {
    let layer = LayerId::new(Order::Middle, egui::Id::unique("crosshair"));
    let painter = ui.ctx().layer_painter(layer);
    let centre = ui.ctx().content_rect().center();
    let strength = if reaches { 1.0 } else { 0.4 };
    for (width, colour) in [(3.0, Color32::from_black_alpha(140)), (1.0, Color32::WHITE)] {
        let colour = colour.gamma_multiply(strength);
        let ends = CROSSHAIR + 0.5 * (width - 1.0);
        let across = centre.x - ends..=centre.x + ends;
        let down = centre.y - ends..=centre.y + ends;
        painter.hline(across, centre.y, Line::new(width, colour));
        painter.vline(centre.x, down, Line::new(width, colour));
    }
}

/// Says beside the crosshair what the hands hold.
pub fn caption(ui: &Ui, text: &str) {
    let layer = LayerId::new(Order::Middle, egui::Id::unique("caption"));
    let painter = ui.ctx().layer_painter(layer);
    let at = ui.ctx().content_rect().center() + vec2(CROSSHAIR + 7.0, CROSSHAIR + 3.0);
    let font = FontId::proportional(13.0);
    for (offset, colour) in [(1.0, Color32::from_black_alpha(200)), (0.0, Color32::WHITE)] {
        let at = at + vec2(offset, offset);
        painter.text(at, Align2::LEFT_TOP, text, font.clone(), colour);
    }
}
