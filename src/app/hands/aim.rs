//! What the crosshair points at.

use egui::{Align2, Color32, FontId, LayerId, Order, Stroke as Line, Ui, vec2};
use glam::{DVec3, IVec3};

use crate::{
    reference::march::{FACE_NORMALS, Outcome, Ray, march},
    world::{Camera, PlacedLamp, voxels::Voxels},
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

/// A solid voxel, or that of a lamp, under the crosshair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Target {
    /// Grid space.
    pub voxel: IVec3,
    /// Index into [`FACE_NORMALS`]; `None` where the camera is inside of the voxel.
    pub face: Option<u8>,
    /// 1-based index into the world's materials; 0 for a lamp's voxel.
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
    /// The first voxel that a stroke where `camera` looks would meet, in a world with this origin: a solid one, or that
    /// of a lamp, unless the camera is in it.
    pub fn aim(
        &self,
        voxels: &Voxels,
        lamps: &[PlacedLamp],
        origin: IVec3,
        camera: &Camera,
    ) -> Option<Target> {
        let basis = camera.basis(1.0);
        let ray = Ray {
            max_distance: self.distance,
            ..Ray::new(basis.origin - origin.as_dvec3(), basis.forward.normalize())
        };
        let (solid, reach) = match march(voxels, &ray) {
            Outcome::Hit(hit) => {
                let target = Target {
                    voxel: hit.voxel,
                    face: Some(hit.face),
                    material: hit.material,
                };
                (Some(target), hit.distance)
            }
            Outcome::Inside(material) => {
                let target = Target {
                    voxel: ray.start,
                    face: None,
                    material,
                };
                (Some(target), 0.0)
            }
            Outcome::Miss => (None, self.distance),
        };
        let met = lamps.iter().filter_map(|lamp| {
            let voxel = lamp.voxel - origin;
            let (distance, face) = entry(&ray, voxel)?;
            let target = Target {
                voxel,
                face: Some(face),
                material: 0,
            };
            (distance < reach).then_some((distance, target))
        });
        let nearest = met.min_by(|(a, _), (b, _)| a.total_cmp(b));
        nearest.map(|(_, target)| target).or(solid)
    }

    /// The voxels that stay free (grid space, both ends inclusive): those of the body, or of the camera.
    pub fn kept(&self, origin: IVec3, camera: &Camera) -> (IVec3, IVec3) {
        let eye = camera.position.as_dvec3().floor().as_ivec3();
        let (low, high) = self.body.unwrap_or((eye, eye));
        (low - origin, high - origin)
    }
}

/// Where a ray from outside enters a voxel: the distance, and the face. By slabs (Kay & Kajiya 1986).
fn entry(ray: &Ray, voxel: IVec3) -> Option<(f64, u8)> {
    let low = voxel.as_dvec3();
    // Of a ray along an axis that lies in a side, 0·∞ would make neither side its own.
    let along = ray.direction.cmpeq(DVec3::ZERO);
    let inverse = 1.0 / DVec3::select(along, DVec3::splat(f64::MIN_POSITIVE), ray.direction);
    let (a, b) = (
        (low - ray.origin) * inverse,
        (low + DVec3::ONE - ray.origin) * inverse,
    );
    let (enters, leaves) = (a.min(b), a.max(b));
    let (first, last) = (enters.max_element(), leaves.min_element());
    let axis = enters.max_position();
    let face = 2 * axis as u8 + u8::from(ray.direction[axis] < 0.0);
    (first > 0.0 && first <= last).then_some((first, face))
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

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};
    use proptest::prelude::*;

    use super::*;
    use crate::world::placed::tests::lamp;

    const ORIGIN: IVec3 = IVec3::new(-8, 3, -8);

    fn camera(position: Vec3, yaw_deg: f32, pitch_deg: f32) -> Camera {
        Camera {
            name: "test".into(),
            position,
            yaw_deg,
            pitch_deg,
            fov_deg: 70.0,
        }
    }

    proptest! {
        /// A lamp is met where a solid voxel in its place would be, at the same face.
        #[test]
        fn a_lamp_is_met_as_a_voxel_is(
            at in ((0..16i32, 0..16i32, 0..16i32), (0.0..16.0f32, 0.0..16.0f32, 0.0..16.0f32)),
            angles in (-180.0..180.0f32, -90.0..90.0f32),
            wall in 0..16i32,
        ) {
            let voxel = IVec3::from(at.0);
            let eye = Vec3::from(at.1);
            prop_assume!(eye.floor().as_ivec3() != voxel && eye.floor().as_ivec3().x != wall && voxel.x != wall);
            let camera = camera(eye + ORIGIN.as_vec3(), angles.0, angles.1);
            let mut voxels = Voxels::empty(UVec3::splat(16));
            voxels.fill_box(IVec3::new(wall, 0, 0), IVec3::new(wall, 15, 15), 1);
            let lamps = [lamp(voxel + ORIGIN)];
            let met = Reach::default().aim(&voxels, &lamps, ORIGIN, &camera);
            voxels.set(voxel, 2);
            let solid = Reach::default().aim(&voxels, &[], ORIGIN, &camera);
            let is_lamp = |target: &Target| target.voxel == voxel;
            prop_assert_eq!(met.filter(is_lamp).map(|met| met.material), solid.filter(is_lamp).map(|_| 0));
            prop_assert_eq!(met.map(|met| (met.voxel, met.face)), solid.map(|met| (met.voxel, met.face)));
        }
    }

    #[test]
    fn a_lamp_around_the_eye_or_beyond_reach_is_not_met() {
        let voxels = Voxels::empty(UVec3::splat(16));
        let lamps = [lamp(ORIGIN + 3), lamp(ORIGIN + IVec3::new(3, 3, 10))];
        let camera = camera((ORIGIN + 3).as_vec3() + 0.5, 180.0, 0.0);
        let aim = |distance| {
            let reach = Reach {
                distance,
                ..Reach::default()
            };
            reach.aim(&voxels, &lamps, ORIGIN, &camera)
        };
        assert_eq!(aim(6.4), None);
        let met = aim(6.6).expect("the other lamp");
        assert_eq!((met.voxel.z, met.face), (10, Some(4)));
    }

    #[test]
    fn a_ray_along_the_side_of_a_lamp_meets_it() {
        let lamp = lamp(ORIGIN + IVec3::new(3, 3, 10));
        let ray = Ray::new(DVec3::new(3.5, 3.0, 3.5), DVec3::Z);
        assert_eq!(entry(&ray, lamp.voxel - ORIGIN), Some((6.5, 4)));
        let above = Ray::new(DVec3::new(3.5, 4.0, 3.5), DVec3::Z);
        assert_eq!(entry(&above, lamp.voxel - ORIGIN), None);
    }
}
