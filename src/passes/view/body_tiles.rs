//! Which tiles of the picture may show bodies.

use std::{array, ops::Range};

use glam::Vec3;

use super::shot::{GpuShot, SHADE_TILE};

impl GpuShot {
    /// The tiles of a rectangle around all boxes, each a lowest and a highest corner in world space: first column and row, and how
    /// many of each. All are 0 where no box is in view.
    pub fn tiles_around(&self, boxes: &[[Vec3; 2]]) -> [u32; 4] {
        let size = [self.width, self.height];
        let seen = boxes.iter().filter_map(|corners| self.seen_around(corners));
        let pixels = seen.map(|seen| {
            array::from_fn(|axis| {
                // Whole pixels, and one more on each side, against rounding.
                let [low, high] = seen[axis];
                let first = (low - 1.0).floor().max(0.0) as u32;
                let end = (high + 1.0).ceil().max(0.0) as u32;
                first..end.min(size[axis])
            })
        });
        let in_view = pixels.filter(|ranges: &[Range<u32>; 2]| !ranges.iter().any(Range::is_empty));
        let all = in_view.reduce(|[x, y], [of_x, of_y]| [joined(x, of_x), joined(y, of_y)]);
        let Some(all) = all else {
            return [0; 4];
        };
        let first = all.each_ref().map(|range| range.start / SHADE_TILE);
        let end = all.map(|range| range.end.div_ceil(SHADE_TILE));
        [first[0], first[1], end[0] - first[0], end[1] - first[1]]
    }

    /// From where to where a box reaches across and down the picture (pixels from its corner), as far as it lies before the camera;
    /// `None` where it lies behind it.
    fn seen_around(&self, corners: &[Vec3; 2]) -> Option<[[f32; 2]; 2]> {
        let [forward, right, up] = [self.forward_ws, self.right_ws, self.up_ws].map(Vec3::from);
        // Jitter tilts `forward` by less than a pixel.
        let straight = right.cross(up).normalize_or_zero();
        let straight = straight * straight.dot(forward).signum();
        let depth_of = |way: Vec3| way.dot(straight);
        let ways: [Vec3; 8] = array::from_fn(|corner| {
            let on = |axis: usize| corners[corner >> axis & 1][axis];
            Vec3::new(on(0), on(1), on(2)) - Vec3::from(self.position_ws)
        });
        let before = ways.into_iter().filter(|&way| depth_of(way) >= LEAST_DEPTH);
        // Where edges of the box cross the plane at the least depth.
        let edges = (0..8).flat_map(|corner| [1, 2, 4].map(|axis| (corner, corner | axis)));
        let crossings = edges.filter_map(|(from, to)| {
            let [from, to] = [ways[from], ways[to]];
            let [near, far] = [depth_of(from), depth_of(to)];
            let crosses = (near < LEAST_DEPTH) != (far < LEAST_DEPTH);
            crosses.then(|| from.lerp(to, (LEAST_DEPTH - near) / (far - near)))
        });
        let [width, height] = [self.width as f32, self.height as f32];
        let places = before.chain(crossings).map(|way| {
            let on_plane = way * (depth_of(forward) / depth_of(way).max(LEAST_DEPTH)) - forward;
            let across = on_plane.dot(right) / right.length_squared();
            let upwards = on_plane.dot(up) / up.length_squared();
            [(across + 1.0) / 2.0 * width, (1.0 - upwards) / 2.0 * height]
        });
        places.fold(None, |seen, [x, y]| {
            let [of_x, of_y] = seen.unwrap_or([[x; 2], [y; 2]]);
            Some([
                [of_x[0].min(x), of_x[1].max(x)],
                [of_y[0].min(y), of_y[1].max(y)],
            ])
        })
    }
}

fn joined(a: Range<u32>, b: Range<u32>) -> Range<u32> {
    a.start.min(b.start)..a.end.max(b.end)
}

/// What is nearer to the plane of the camera (voxels) counts as behind it.
const LEAST_DEPTH: f32 = 1e-3;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{
        passes::view::Shot,
        world::{Camera, View},
    };

    const SIZE: [u32; 2] = [200, 120];

    fn shot(yaw_deg: f32, pitch_deg: f32) -> Shot {
        Shot {
            camera: Camera {
                name: "test".into(),
                position: Vec3::new(3.0, -2.0, 5.0),
                yaw_deg,
                pitch_deg,
                fov_deg: 70.0,
            },
            size: SIZE,
            frame: 0,
            seed: 0,
            exposure_ev: 0.0,
            view: View::Full,
            time_s: 0.0,
            textures: true,
            soft_rays: 1,
            shadows: Default::default(),
        }
    }

    fn box_at(middle: Vec3, half: f32) -> [Vec3; 2] {
        [middle - half, middle + half]
    }

    #[test]
    fn boxes_out_of_view_have_no_tile_and_small_ones_few() {
        let seen = shot(0.0, 0.0).to_gpu();
        let eye = Vec3::from(seen.position_ws);
        assert_eq!(seen.tiles_around(&[]), [0; 4]);
        // Yaw 0 looks along −z.
        let behind = box_at(eye + Vec3::Z * 9.0, 2.0);
        let beside = box_at(eye + Vec3::new(90.0, 0.0, -9.0), 2.0);
        assert_eq!(seen.tiles_around(&[behind, beside]), [0; 4]);
        // Beside the camera, half behind it.
        let abreast = box_at(eye + Vec3::X * 50.0, 3.0);
        assert_eq!(seen.tiles_around(&[abreast]), [0; 4]);
        let ahead = box_at(eye - Vec3::Z * 40.0, 0.5);
        let [column, row, columns, rows] = seen.tiles_around(&[behind, ahead]);
        assert!(column <= 12 && 12 < column + columns && columns <= 2);
        assert!(row <= 7 && 7 < row + rows && rows <= 2);
        let around = box_at(eye, 1.0);
        assert_eq!(seen.tiles_around(&[around]), [0, 0, 25, 15]);
    }

    proptest! {
        #[test]
        fn no_point_of_a_box_is_seen_outside_of_its_tiles(
            angles in (-180.0f32..180.0, -89.0f32..89.0),
            pixel in prop::array::uniform2(0.0f32..1.0).prop_map(|share| [0, 1].map(|axis| share[axis] * SIZE[axis] as f32)),
            depth in 0.01f32..60.0,
            half in 0.1f32..12.0,
            within in prop::array::uniform3(-0.99f32..0.99),
            jitter in prop::array::uniform2(-0.5f64..0.5),
        ) {
            let seen = shot(angles.0, angles.1).to_gpu_jittered(SIZE, jitter, 1.0, 1);
            let [forward, right, up] = [seen.forward_ws, seen.right_ws, seen.up_ws].map(Vec3::from);
            // As in shaders/frame/view.wesl.
            let across = 2.0 * pixel[0] / SIZE[0] as f32 - 1.0;
            let upwards = 1.0 - 2.0 * pixel[1] / SIZE[1] as f32;
            let point = Vec3::from(seen.position_ws) + depth * (forward + across * right + upwards * up);
            // Lies in the box, which may reach behind the camera.
            let around = box_at(point + Vec3::from(within) * half, half);
            let [first_column, first_row, columns, rows] = seen.tiles_around(&[around]);
            let [column, row] = pixel.map(|place| place as u32 / SHADE_TILE);
            prop_assert!(column >= first_column && column < first_column + columns);
            prop_assert!(row >= first_row && row < first_row + rows);
        }
    }
}
