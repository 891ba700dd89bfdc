//! The outline of the voxel under the crosshair: its edges on the screen, as far as they can be seen.

use egui::{Color32, LayerId, Order, Pos2, Stroke as Line, Ui};
use glam::{DVec2, DVec3, IVec3};

use super::aim::Target;
use crate::{
    reference::march::{FACE_NORMALS, Outcome, Ray, march},
    world::{CameraBasis, voxels::Voxels},
};

/// Points closer than this to the plane of the eye (voxels, along the view) are not projected.
const NEAR: f64 = 0.02;
/// Parts of an edge that are hidden or seen as one.
const PARTS: u32 = 16;
/// How far (voxels) before its faces a point of an edge is looked for: rounding must not hide it in its own voxel.
const BEFORE_FACE: f64 = 1e-4;

/// Part of an edge, in normalised device coordinates: x to the right, y up, both in [−1, 1] on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    pub ends: [DVec2; 2],
    /// Whether it bounds the face aimed at.
    pub of_face: bool,
}

/// The visible edges of the target, seen through `camera` in a world with this origin: those of faces that are
/// turned to the eye and have air before them, where nothing stands in front.
pub fn of_target(
    voxels: &Voxels,
    origin: IVec3,
    camera: &CameraBasis,
    target: &Target,
) -> Vec<Segment> {
    let eye = camera.origin - origin.as_dvec3();
    let low = target.voxel.as_dvec3();
    let is_seen = |face: usize| {
        let axis = face / 2;
        let plane = low[axis] + (face % 2) as f64;
        let before_plane = (eye[axis] - plane) * f64::from(FACE_NORMALS[face][axis]);
        before_plane > 0.0 && voxels.material(target.voxel + FACE_NORMALS[face]) == 0
    };
    let mut segments = Vec::new();
    for axis in 0..3 {
        for corner in 0..4 {
            // The two faces that meet in this edge.
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let faces = [2 * u + corner % 2, 2 * v + corner / 2];
            let seen: Vec<usize> = faces.into_iter().filter(|face| is_seen(*face)).collect();
            if seen.is_empty() {
                continue;
            }
            let outwards: DVec3 = seen.iter().map(|f| FACE_NORMALS[*f].as_dvec3()).sum();
            let of_face = faces.iter().any(|face| target.face == Some(*face as u8));
            let at = |along: f64| {
                let mut point = low;
                point[axis] += along;
                point[u] += (corner % 2) as f64;
                point[v] += (corner / 2) as f64;
                point
            };
            let mut parts = Parts::default();
            for part in 0..PARTS {
                let middle = at((f64::from(part) + 0.5) / f64::from(PARTS));
                parts.add(
                    part,
                    !is_hidden(voxels, eye, middle + outwards * BEFORE_FACE),
                );
            }
            for (first, last) in parts.ended() {
                let ends = [first, last].map(|end| at(f64::from(end) / f64::from(PARTS)));
                let ends = project(camera, ends.map(|end| end + origin.as_dvec3()));
                segments.extend(ends.map(|ends| Segment { ends, of_face }));
            }
        }
    }
    segments
}

/// Joins the visible parts of an edge: (first, past the last).
#[derive(Default)]
struct Parts {
    joined: Vec<(u32, u32)>,
}

impl Parts {
    fn add(&mut self, part: u32, is_seen: bool) {
        match self.joined.last_mut() {
            _ if !is_seen => {}
            Some((_, end)) if *end == part => *end += 1,
            _ => self.joined.push((part, part + 1)),
        }
    }

    fn ended(self) -> Vec<(u32, u32)> {
        self.joined
    }
}

fn is_hidden(voxels: &Voxels, eye: DVec3, point: DVec3) -> bool {
    let ray = Ray {
        max_distance: 1.0,
        ..Ray::new(eye, point - eye)
    };
    march(voxels, &ray) != Outcome::Miss
}

/// Both ends of a line (world space) on the screen, without what lies behind the eye.
pub fn project(camera: &CameraBasis, ends: [DVec3; 2]) -> Option<[DVec2; 2]> {
    let [mut a, mut b] = ends.map(|end| end - camera.origin);
    let depth = |point: DVec3| point.dot(camera.forward);
    if depth(a) < NEAR && depth(b) < NEAR {
        return None;
    }
    let crossing = |behind: DVec3, before: DVec3| {
        let share = (NEAR - depth(behind)) / (depth(before) - depth(behind));
        behind.lerp(before, share)
    };
    if depth(a) < NEAR {
        a = crossing(a, b);
    } else if depth(b) < NEAR {
        b = crossing(b, a);
    }
    let flat = |point: DVec3| {
        let across = point.dot(camera.right) / camera.right.length_squared();
        let upwards = point.dot(camera.up) / camera.up.length_squared();
        DVec2::new(across, upwards) / depth(point)
    };
    Some([flat(a), flat(b)])
}

/// Draws lines over the picture: light ones on dark ones, to be seen on any ground.
pub fn draw(ui: &Ui, segments: &[Segment]) {
    let layer = LayerId::new(Order::Background, egui::Id::unique("outline"));
    let painter = ui.ctx().layer_painter(layer);
    let rect = ui.ctx().content_rect();
    let at = |point: DVec2| {
        let share = egui::vec2(point.x as f32 + 1.0, 1.0 - point.y as f32) / 2.0;
        Pos2::ZERO + rect.min.to_vec2() + share * rect.size()
    };
    for is_light in [false, true] {
        for segment in segments {
            let (width, colour) = match (is_light, segment.of_face) {
                (false, _) => (3.0, Color32::from_black_alpha(150)),
                (true, true) => (1.5, Color32::WHITE),
                (true, false) => (1.0, Color32::from_white_alpha(150)),
            };
            painter.line_segment(segment.ends.map(at), Line::new(width, colour));
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};

    use super::*;
    use crate::{app::hands::aim::Reach, world::Camera};

    fn camera(position: Vec3, yaw_deg: f32, pitch_deg: f32) -> Camera {
        Camera {
            name: "test".into(),
            position,
            yaw_deg,
            pitch_deg,
            fov_deg: 70.0,
        }
    }

    const ORIGIN: IVec3 = IVec3::new(-8, 3, -8);

    /// A floor with its top at y = 4 (world space), and one voxel on it.
    fn scene() -> Voxels {
        let mut voxels = Voxels::empty(UVec3::splat(16));
        voxels.fill_box(IVec3::ZERO, IVec3::new(15, 0, 15), 1);
        voxels.set(IVec3::new(8, 1, 8), 2);
        voxels
    }

    fn outline(voxels: &Voxels, camera: &Camera) -> Vec<Segment> {
        let target = Reach::default().aim(voxels, &[], ORIGIN, camera);
        let target = target.expect("it meets something");
        of_target(voxels, ORIGIN, &camera.basis(1.5), &target)
    }

    #[test]
    fn a_point_is_drawn_where_its_ray_goes_through_the_picture() {
        let basis = camera(Vec3::new(0.3, 9.0, 4.0), 25.0, -40.0).basis(1.5);
        let size = DVec2::new(300.0, 200.0);
        for pixel in [DVec2::new(150.0, 100.0), DVec2::new(3.0, 180.0)] {
            let point = basis.origin + 7.0 * basis.direction_ws(pixel, size);
            let [flat, _] = project(&basis, [point, point]).expect("it is before the eye");
            let shown = (DVec2::new(flat.x, -flat.y) + 1.0) / 2.0 * size;
            assert!(shown.distance(pixel) < 1e-9, "{shown} for {pixel}");
        }
    }

    #[test]
    fn of_a_voxel_in_the_floor_its_upper_face_is_outlined() {
        let camera = camera(Vec3::new(4.4, 9.0, 4.6), 0.0, -80.0);
        let segments = outline(&scene(), &camera);
        assert_eq!(segments.len(), 4);
        assert!(segments.iter().all(|segment| segment.of_face));
    }

    #[test]
    fn of_a_free_voxel_three_faces_are_outlined_and_a_hidden_edge_is_not() {
        // From above, to its +x and +z side.
        let camera = camera(Vec3::new(4.4, 8.5, 4.5), 45.0, -39.0);
        let mut voxels = scene();
        let segments = outline(&voxels, &camera);
        let of_face = segments.iter().filter(|segment| segment.of_face).count();
        assert_eq!((segments.len(), of_face), (9, 4));
        // What stands before it to the right hides the edge there.
        voxels.fill_box(IVec3::new(10, 2, 9), IVec3::new(10, 3, 9), 1);
        let fewer: f64 = length(&outline(&voxels, &camera));
        let all = length(&segments);
        assert!(fewer > 0.5 * all && fewer < 0.99 * all, "{fewer} of {all}");
    }

    fn length(segments: &[Segment]) -> f64 {
        let lengths = segments
            .iter()
            .map(|line| line.ends[0].distance(line.ends[1]));
        lengths.sum()
    }

    #[test]
    fn lines_through_the_plane_of_the_eye_are_cut_there() {
        let basis = camera(Vec3::ZERO, 0.0, 0.0).basis(1.0);
        let ends = [DVec3::new(0.5, -1.0, -3.0), DVec3::new(0.5, -1.0, 3.0)];
        let [a, b] = project(&basis, ends).expect("half of it is seen");
        assert!(a.is_finite() && b.is_finite() && b.y < a.y && a.y < 0.0);
        assert_eq!(project(&basis, ends.map(|end| end + DVec3::Z * 9.0)), None);
    }
}
