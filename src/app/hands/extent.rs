//! Outlines of what a stroke or a paste will change: boxes and balls. What voxels hide of them is drawn faintly.

use std::f64::consts::TAU;

use glam::{DVec3, IVec3};

use super::{
    brush::{Brush, Shape},
    outline::{BEFORE_FACE, Segment, is_hidden, project},
};
use crate::world::{CameraBasis, voxels::Voxels};

/// Fewest and most parts of an edge: each part is hidden or seen as a whole.
const PARTS: [i32; 2] = [8, 32];
/// Sides of the polygons that show a ball's great circles.
const SIDES: u32 = 48;

/// Where outlines are seen from, in a world with this origin.
pub struct Eye<'a> {
    pub voxels: &'a Voxels,
    pub origin: IVec3,
    pub camera: &'a CameraBasis,
}

impl Eye<'_> {
    /// What a brush covers around a voxel (grid space). A single voxel has no outline of its own here.
    pub fn of_brush(&self, brush: &Brush, at: IVec3) -> Vec<Segment> {
        let reach = IVec3::splat(brush.reach());
        match brush.shape {
            Shape::Voxel => Vec::new(),
            Shape::Box => self.of_box(at - reach, at + reach),
            Shape::Ball => self.of_ball(at.as_dvec3() + 0.5, f64::from(brush.reach()) + 0.5),
        }
    }

    /// The edges of a box of voxels (grid space, both ends inclusive).
    pub fn of_box(&self, low: IVec3, high: IVec3) -> Vec<Segment> {
        self.of_bounds([low.as_dvec3(), (high + 1).as_dvec3()])
    }

    /// The edges of a box between two corners (grid space).
    pub fn of_bounds(&self, [low, high]: [DVec3; 2]) -> Vec<Segment> {
        let mut segments = Vec::new();
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for corner in 0..4 {
                let mut outwards = DVec3::ZERO;
                let mut end = low;
                for (side, of) in [(corner % 2, u), (corner / 2, v)] {
                    end[of] = if side == 1 { high[of] } else { low[of] };
                    outwards[of] = if side == 1 { 1.0 } else { -1.0 };
                }
                let length = high[axis] - low[axis];
                let parts = (length as i32).clamp(PARTS[0], PARTS[1]);
                let at = |part: i32| {
                    let mut point = end;
                    point[axis] += length * f64::from(part) / f64::from(parts);
                    point
                };
                for part in 0..parts {
                    self.line([at(part), at(part + 1)], outwards, &mut segments);
                }
            }
        }
        segments
    }

    /// Three great circles.
    fn of_ball(&self, centre: DVec3, radius: f64) -> Vec<Segment> {
        let mut segments = Vec::new();
        for axis in 0..3 {
            let towards = |side: u32| {
                let (sine, cosine) = (TAU * f64::from(side) / f64::from(SIDES)).sin_cos();
                let mut towards = DVec3::ZERO;
                towards[(axis + 1) % 3] = cosine;
                towards[(axis + 2) % 3] = sine;
                towards
            };
            for side in 0..SIDES {
                let ends = [side, side + 1].map(|side| centre + radius * towards(side));
                self.line(ends, towards(side), &mut segments);
            }
        }
        segments
    }

    /// A line (grid space), seen or hidden as its middle is. Where the line lies on a voxel's face, it is seen from the
    /// side of the air: outwards or inwards.
    fn line(&self, ends: [DVec3; 2], outwards: DVec3, segments: &mut Vec<Segment>) {
        let eye = self.camera.origin - self.origin.as_dvec3();
        let middle = ends[0].midpoint(ends[1]);
        let is_hidden = [outwards, -outwards]
            .into_iter()
            .all(|aside| is_hidden(self.voxels, eye, middle + BEFORE_FACE * aside));
        let ends = project(self.camera, ends.map(|end| end + self.origin.as_dvec3()));
        segments.extend(ends.map(|ends| Segment {
            ends,
            of_face: false,
            is_hidden,
        }));
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};

    use super::*;
    use crate::world::Camera;

    const ORIGIN: IVec3 = IVec3::new(-8, 3, -8);

    /// Seen from above, over a floor with its top at y = 4 (world space).
    fn segments(draw: impl Fn(&Eye<'_>) -> Vec<Segment>) -> Vec<Segment> {
        let mut voxels = Voxels::empty(UVec3::splat(16));
        voxels.fill_box(IVec3::ZERO, IVec3::new(15, 0, 15), 1);
        let camera = Camera {
            name: "above".into(),
            position: Vec3::new(0.5, 12.0, 0.5),
            yaw_deg: 0.0,
            pitch_deg: -89.0,
            fov_deg: 90.0,
        };
        draw(&Eye {
            voxels: &voxels,
            origin: ORIGIN,
            camera: &camera.basis(1.0),
        })
    }

    fn hidden(segments: &[Segment]) -> usize {
        segments.iter().filter(|segment| segment.is_hidden).count()
    }

    #[test]
    fn of_a_box_in_the_floor_the_part_above_it_is_seen() {
        let brush = |shape, radius| Brush { shape, radius };
        let at = IVec3::new(8, 0, 8);
        let parts = PARTS[0] as usize;
        let cube = segments(|eye| eye.of_brush(&brush(Shape::Box, 1.9), at));
        // An edge of three voxels has eight parts. Of the upright edges the third above the floor is seen, with the
        // part across it; of the edges in the floor none.
        assert_eq!(cube.len(), 12 * parts);
        let below = 4 * parts + 4 * (parts * 2 / 3);
        assert!(
            hidden(&cube).abs_diff(below) <= 4,
            "{} of {below}",
            hidden(&cube)
        );
        // The middle of a ball lies half a voxel below the floor's top.
        let ball = segments(|eye| eye.of_brush(&brush(Shape::Ball, 3.0), at));
        let half = (3 * SIDES / 2) as usize;
        assert_eq!(ball.len(), 2 * half);
        assert!(
            (half..2 * half).contains(&hidden(&ball)),
            "{}",
            hidden(&ball)
        );
        assert!(segments(|eye| eye.of_brush(&brush(Shape::Voxel, 9.0), at)).is_empty());
    }

    #[test]
    fn a_box_is_drawn_around_its_voxels() {
        let (low, high) = (IVec3::new(6, 1, 6), IVec3::new(10, 3, 9));
        let drawn = segments(|eye| eye.of_box(low, high));
        assert_eq!(hidden(&drawn), 0);
        // At 90° the top, 5 voxels below the eye, is seen from −2.5 to 2.5 voxels to the right of the middle.
        let right = drawn
            .iter()
            .flat_map(|segment| segment.ends.map(|end| end.x));
        let [least, most] = right.fold([0.0, 0.0], |[a, b]: [f64; 2], x| [a.min(x), b.max(x)]);
        assert!(
            (least + 0.5).abs() < 0.05 && (most - 0.5).abs() < 0.05,
            "{least} {most}"
        );
    }
}
