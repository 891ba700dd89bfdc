//! What stands beside a face, and how much of its view that takes.

use std::f64::consts::PI;

use glam::{IVec3, UVec3};
use grotto::{
    passes::scene::GpuVoxels,
    world::voxels::{NewCell, Voxels},
};

use super::{evaluate, scattered};
use crate::support::gpu;

/// Edge of the world of [`pebbles`] in voxels: three cells.
const SIZE: u32 = 24;

/// A third of the voxels is stone, with one empty and one full cell among them.
fn is_pebble(voxel: UVec3) -> bool {
    match (voxel / 8).to_array() {
        [0, 1, 2] => false,
        [2, 1, 0] => true,
        _ => {
            (voxel.x * 7 + voxel.y * 13 + voxel.z * 29 + voxel.element_product()).is_multiple_of(3)
        }
    }
}

fn pebbles() -> Voxels {
    Voxels::from_cells(UVec3::splat(SIZE), |cell| {
        let mut brick = Box::new([0u8; 512]);
        for (i, material) in brick.iter_mut().enumerate() {
            let i = i as u32;
            *material = u8::from(is_pebble(cell * 8 + UVec3::new(i & 7, i >> 3 & 7, i >> 6)));
        }
        NewCell::Voxels(brick)
    })
}

/// Boxes of every size that fits a block, at every place beside and around the world.
#[test]
fn a_box_of_voxels_is_what_the_voxels_are() {
    let gpu = gpu();
    let voxels = GpuVoxels::upload(&gpu, &pebbles(), IVec3::ZERO).expect("fits");
    let boxes: Vec<(IVec3, IVec3)> = (0..4000)
        .map(|i| {
            let (point, _) = scattered(i);
            let low = (point + 10.0).floor().as_ivec3();
            (low, UVec3::new(i % 4, i / 4 % 4, i / 16 % 4).as_ivec3() + 1)
        })
        .collect();
    let inputs: Vec<[[f32; 4]; 2]> = boxes
        .iter()
        .map(|(low, size)| [low, size].map(|v| v.as_vec3().extend(0.0).to_array()))
        .collect();
    // Sixteen bits at a time are whole numbers in f32.
    let body = "
        let size = vec3i(at[1].xyz);
        let bits = stone_in_box(vec3i(at[0].xyz), size);
        return vec4f(vec4u(bits.x & 0xffffu, bits.x >> 16u, bits.y & 0xffffu, bits.y >> 16u));";
    let imports = "import package::scene::voxels::stone_in_box;";
    let found = evaluate(&gpu, imports, body, &inputs, &voxels.resources());
    let mut stones = 0;
    for ((low, size), found) in boxes.iter().zip(found) {
        for index in 0..64 {
            let at = IVec3::new(index & 3, index >> 2 & 3, index >> 4);
            // What lies beyond the box is nobody's concern.
            if at.cmpge(*size).any() {
                continue;
            }
            let voxel = *low + at;
            let inside = voxel.min_element() >= 0 && voxel.max_element() < SIZE as i32;
            let expected = inside && is_pebble(voxel.as_uvec3());
            let bit = found[index as usize / 16] as u32 >> (index % 16) & 1;
            assert_eq!(bit == 1, expected, "{low} {size}: {voxel}");
            stones += u32::from(expected);
        }
    }
    assert!(stones > 10_000, "{stones}");
}

/// The form factor of a rectangle that stands on the plane of a point at `distance`, from `along[0]` to
/// `along[1]` beside it and from `up[0]` to `up[1]` above it: the integral of its definition,
/// ∫ cosines / (π r²), by midpoints.
fn form_factor(distance: f64, along: [f64; 2], up: [f64; 2]) -> f64 {
    const STEPS: u32 = 400;
    let step = |range: [f64; 2]| (range[1] - range[0]) / f64::from(STEPS);
    let middle = |range: [f64; 2], i: u32| range[0] + (f64::from(i) + 0.5) * step(range);
    let mut sum = 0.0;
    for i in 0..STEPS {
        for j in 0..STEPS {
            let (a, h) = (middle(along, i), middle(up, j));
            let squared = distance * distance + a * a + h * h;
            sum += distance * h / (PI * squared * squared);
        }
    }
    sum * step(along) * step(up)
}

#[test]
fn what_a_side_takes_is_its_form_factor() {
    let gpu = gpu();
    let cases: Vec<(u32, u32, [f64; 2])> = (0..96)
        .map(|i| {
            let (point, _) = scattered(i + 7);
            let at = ((point + 12.0) / 24.0).truncate();
            // Not so near that the sum over midpoints is too coarse.
            (i * 5 % 64, i % 4, (at * 0.8 + 0.1).to_array())
        })
        .collect();
    let inputs: Vec<[[f32; 4]; 1]> = cases
        .iter()
        .map(|(rows, side, at)| [[*rows as f32, *side as f32, at[0] as f32, at[1] as f32]])
        .collect();
    let imports = "import package::probes::incident_light::form_factor;";
    let body = "return vec4f(form_factor(u32(at[0].x), u32(at[0].y), at[0].zw));";
    let found = evaluate(&gpu, imports, body, &inputs, &[]);
    let mut most = 0.0f64;
    for ((rows, side, at), found) in cases.iter().zip(found) {
        let [across, along] = if *side < 2 { *at } else { [at[1], at[0]] };
        let distance = if side % 2 == 1 { 1.0 - across } else { across };
        let mut expected = 0.0;
        for row in 0..3 {
            // The voxel's edges along the face from the point on, and no farther than a voxel.
            let low = (f64::from(row) - 1.0 - along).max(-1.0);
            let high = (f64::from(row) - along).min(1.0);
            for layer in 0..2u32 {
                if rows >> (row as u32 + 3 * layer) & 1 == 1 {
                    let up = [f64::from(layer), f64::from(layer) + 1.0];
                    expected += form_factor(distance, [low, high], up);
                }
            }
        }
        expected *= 1.0 - distance.powi(4);
        let found = f64::from(found[0]);
        assert!(
            (found - expected).abs() < 1e-4,
            "rows {rows:b}, side {side}, {at:?}: {found}, not {expected}"
        );
        most = most.max(expected);
    }
    assert!(most > 0.3, "{most}");
}

/// A side is what stands there and has air before it.
#[test]
fn stone_behind_stone_is_no_side() {
    let gpu = gpu();
    let patterns: Vec<(u32, u32)> = (0..2000u32)
        .map(|i| (i.wrapping_mul(2_654_435_761) >> 14, i % 4))
        .collect();
    let inputs: Vec<[[f32; 4]; 1]> = patterns
        .iter()
        .map(|(stone, side)| [[*stone as f32, *side as f32, 0.0, 0.0]])
        .collect();
    let imports = "import package::probes::incident_light::rows_of;";
    let body = "return vec4f(f32(rows_of(u32(at[0].x), u32(at[0].y))));";
    let found = evaluate(&gpu, imports, body, &inputs, &[]);
    let mut sides = 0;
    for ((stone, side), found) in patterns.iter().zip(found) {
        let is_stone = |i: u32, j: u32, h: u32| stone >> (i + 3 * j + 9 * h) & 1 == 1;
        let mut expected = 0;
        for row in 0..3 {
            for h in 0..2 {
                let end = 2 * (side % 2);
                let (wall, before) = match side {
                    0 | 1 => (is_stone(end, row, h), is_stone(1, row, h)),
                    _ => (is_stone(row, end, h), is_stone(row, 1, h)),
                };
                expected |= u32::from(wall && !before) << (row + 3 * h);
            }
        }
        assert_eq!(found[0] as u32, expected, "{stone:b}, side {side}");
        sides += expected.count_ones();
    }
    assert!(sides > 1000, "{sides}");
}

/// All six faces: the stone beside each, counted in the world's own axes.
#[test]
fn the_stone_beside_a_face_stands_on_its_plane() {
    let gpu = gpu();
    let voxels = GpuVoxels::upload(&gpu, &pebbles(), IVec3::ZERO).expect("fits");
    let cases: Vec<(IVec3, u32)> = (0..600)
        .map(|i| {
            let (point, _) = scattered(i);
            ((point + 12.0).floor().as_ivec3(), i % 6)
        })
        .collect();
    let inputs: Vec<[[f32; 4]; 1]> = cases
        .iter()
        .map(|(before, face)| [before.as_vec3().extend(*face as f32).to_array()])
        .collect();
    let imports = "import package::probes::incident_light::{plane_of, stone_beside};";
    let body = "
        let before = vec3u(at[0].xyz);
        let plane = plane_of(vec3f(before), before, u32(at[0].w));
        return vec4f(f32(stone_beside(plane, before)));";
    let found = evaluate(&gpu, imports, body, &inputs, &voxels.resources());
    for ((before, face), found) in cases.iter().zip(found) {
        let axis = |n: u32| IVec3::AXES[(n % 3) as usize];
        let up = axis(face / 2) * if face % 2 == 1 { 1 } else { -1 };
        let mut expected = 0;
        for bit in 0..18 {
            let (i, j, h) = (bit % 3 - 1, bit / 3 % 3 - 1, bit / 9);
            let voxel = before + axis(face / 2 + 1) * i + axis(face / 2 + 2) * j + up * h;
            let inside = voxel.min_element() >= 0 && voxel.max_element() < SIZE as i32;
            expected |= u32::from(inside && is_pebble(voxel.as_uvec3())) << bit;
        }
        assert_eq!(found[0] as u32, expected, "{before}, face {face}");
    }
}
