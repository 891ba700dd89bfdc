//! The conditions that must hold after a storm, each as a number with a bound.

use std::collections::BTreeMap;

use glam::{IVec3, UVec3};
use serde::Serialize;

use crate::{
    commands::Failure,
    frame::Frame,
    gpu::{Gpu, GpuError},
    lights::Emitters,
    measure::{
        comparison::Shown,
        flip::{PIXELS_PER_DEGREE, flip},
        metrics,
        picture::Picture,
    },
    world::{
        World,
        voxels::{BRICK, BRICK_VOXELS, Brick, CELL, Cell, NewCell, SOLID, Voxels, brick_index},
    },
};

/// A condition that must hold.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    pub name: String,
    /// `null` where the value varies from run to run: then it is in `measured` under the same name.
    pub value: Option<f64>,
    /// Largest allowed value; `null` where the value is only reported.
    pub bound: Option<f64>,
    pub passed: bool,
}

impl Check {
    /// Passes up to the bound.
    pub fn at_most(name: impl Into<String>, value: f64, bound: f64) -> Self {
        Self {
            name: name.into(),
            value: Some(value),
            bound: Some(bound),
            // False for NaN.
            passed: value <= bound,
        }
    }

    /// Passes if the count is 0.
    pub fn none(name: impl Into<String>, count: u64) -> Self {
        Self::at_most(name, count as f64, 0.0)
    }

    /// The same without a bound: the value is only reported.
    pub fn told(mut self) -> Self {
        (self.bound, self.passed) = (None, true);
        self
    }

    /// The same with the value moved to `measured`.
    pub fn measured(mut self, measured: &mut BTreeMap<String, f64>) -> Self {
        if let Some(value) = self.value.take() {
            measured.insert(self.name.clone(), value);
        }
        self
    }
}

/// Compares the voxels on the GPU with the CPU's copy, that copy with a fresh build of the same voxels, and the
/// lists of emissive faces on both sides.
pub fn voxels(
    gpu: &Gpu,
    frame: &Frame,
    world: &World,
    cpu: &Voxels,
) -> Result<Vec<Check>, Failure> {
    let read = frame.stage.read_back(gpu)?;
    let emitters = Emitters::find(cpu, &world.materials);
    Ok(vec![
        Check::none("voxels.gpu_differs", different_cells(&read, cpu, true)),
        Check::none("voxels.gpu_invariants", u64::from(read.validate().is_err())),
        Check::none(
            "voxels.fresh_build_differs",
            different_cells(cpu, &built_afresh(cpu), false),
        ),
        Check::none(
            "emitters.differ",
            different_emitters(gpu, frame, &emitters)?,
        ),
    ])
}

/// Number of cells that differ: in their content, in the distances of empty cells, and, if `places`, in the
/// place of their bricks.
fn different_cells(a: &Voxels, b: &Voxels, places: bool) -> u64 {
    let (words_a, masks_a, materials_a) = a.raw();
    let (words_b, masks_b, materials_b) = b.raw();
    if a.size() != b.size() || words_a.len() != words_b.len() {
        return words_a.len().max(words_b.len()) as u64;
    }
    let pairs = words_a.iter().zip(words_b);
    let same = |(&a, &b): (&u32, &u32)| {
        let brick = |word: u32| (word & !BRICK == SOLID).then_some((word & BRICK) as usize);
        match (brick(a), brick(b)) {
            (Some(at), Some(bt)) => {
                (!places || at == bt)
                    && masks_a.get(at) == masks_b.get(bt)
                    && materials_a.get(at) == materials_b.get(bt)
            }
            _ => a == b,
        }
    };
    pairs.filter(|pair| !same(*pair)).count() as u64
}

/// A fresh build of the same voxels, without edits.
fn built_afresh(voxels: &Voxels) -> Voxels {
    Voxels::from_cells(voxels.size(), |cell| match voxels.cell(cell) {
        Cell::Empty => NewCell::Empty,
        _ => NewCell::Voxels(content(voxels, cell)),
    })
}

/// The content of a cell, voxel by voxel.
fn content(voxels: &Voxels, cell: UVec3) -> Box<Brick> {
    let mut content = Box::new([0; BRICK_VOXELS]);
    for index in 0..BRICK_VOXELS as u32 {
        let local = UVec3::new(index % CELL, index / CELL % CELL, index / (CELL * CELL));
        let voxel: IVec3 = (cell * CELL + local).as_ivec3();
        content[brick_index(local)] = voxels.material(voxel);
    }
    content
}

/// 0 where the frame's list and the GPU's list equal the list `found`, which a scan of all voxels gives.
fn different_emitters(gpu: &Gpu, frame: &Frame, found: &Emitters) -> Result<u64, GpuError> {
    let list = &frame.stage.emitters;
    // A list that the adapter cannot hold is left empty, which is reported when it is made.
    if !list.holds(found) {
        return Ok(u64::from(!list.known.faces.is_empty()));
    }
    let mut different = u64::from(list.known != *found);
    let expected = [
        found.to_bytes(),
        bytemuck::cast_slice(&found.faces).to_vec(),
    ];
    for ((_, resource), expected) in list.resources().into_iter().zip(expected) {
        if let (wgpu::BindingResource::Buffer(binding), false) = (resource, expected.is_empty()) {
            let bytes = (expected.len() as u64).next_multiple_of(4);
            let read: Vec<u8> = gpu.read_buffer_range(binding.buffer, 0, bytes)?;
            different += u64::from(read[..expected.len()] != expected);
        }
    }
    Ok(different)
}

/// Number of values in the picture and in the results of probes that are not finite.
pub fn not_finite(gpu: &Gpu, frame: &Frame) -> Result<u64, GpuError> {
    let picture = frame.read_radiance(gpu)?;
    let rays = frame.field().new_rays(gpu)?;
    let cubes = frame.field().light_along_axes(gpu)?;
    let bad = picture
        .rgb
        .iter()
        .flatten()
        .filter(|value| !value.is_finite());
    let count = bad.count()
        + rays.iter().filter(|value| !value.is_finite()).count()
        + cubes.iter().filter(|value| !value.is_finite()).count();
    Ok(count as u64)
}

/// Edge in pixels of the blocks whose light is compared.
const BLOCK: usize = 8;
/// Share of the mean of a picture below which the light of a block counts as dark.
const DARK: f64 = 0.05;

/// How much two pictures of the same scene differ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// Mean over the pixels, as a display shows them.
    pub flip: f64,
    /// Relative difference of the light of blocks of pixels: mean, and the largest.
    pub mean_block: f64,
    pub worst_block: f64,
}

impl Difference {
    const NAMES: [&'static str; 3] = ["flip", "mean_block", "worst_block"];

    /// # Errors
    /// For pictures of different sizes, and for values that are not finite.
    pub fn of(a: &Picture, b: &Picture, exposure_ev: f32) -> Result<Self, Failure> {
        let shown = |picture: &Picture| Shown::from_linear(picture.clone(), exposure_ev).display;
        metrics::energy_ratio(a, b).map_err(Failure::fault)?;
        let map = flip(&shown(a), &shown(b), PIXELS_PER_DEGREE).map_err(Failure::fault)?;
        let (blocks_a, blocks_b) = (blocks(a), blocks(b));
        let mean = |blocks: &[f64]| blocks.iter().sum::<f64>() / blocks.len() as f64;
        let dark = DARK * mean(&blocks_a).max(mean(&blocks_b));
        let relative: Vec<f64> = blocks_a
            .iter()
            .zip(&blocks_b)
            .map(|(a, b)| {
                if a == b {
                    0.0
                } else {
                    (a - b).abs() / a.max(*b).max(dark)
                }
            })
            .collect();
        Ok(Self {
            flip: map.iter().copied().map(f64::from).sum::<f64>() / map.len() as f64,
            mean_block: mean(&relative),
            worst_block: relative.iter().copied().fold(0.0, f64::max),
        })
    }

    fn all(self) -> [f64; 3] {
        [self.flip, self.mean_block, self.worst_block]
    }
}

/// Mean of the channels over each block of pixels; blocks at the edges are smaller.
fn blocks(picture: &Picture) -> Vec<f64> {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let columns = width.div_ceil(BLOCK);
    let mut sums = vec![(0.0, 0.0); columns * height.div_ceil(BLOCK)];
    for (index, rgb) in picture.rgb.iter().enumerate() {
        let block = index / width / BLOCK * columns + index % width / BLOCK;
        let light: f64 = rgb.iter().copied().map(f64::from).sum();
        sums[block].0 += light;
        sums[block].1 += 3.0;
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

/// The allowed difference of a picture, from the differences among fresh pictures with other seeds: a factor,
/// and an absolute term.
const FACTORS: [(f64, f64); 3] = [(1.5, 0.01), (1.5, 0.01), (2.0, 0.15)];

/// Compares the light of a picture after a storm with pictures that started with the same voxels, lights and
/// size, and differ by their seeds. The differences among these pictures measure the noise.
pub fn light(
    name: &str,
    picture: &Picture,
    fresh: &[Picture],
    exposure_ev: f32,
) -> Result<Vec<Check>, Failure> {
    let mut noise = [0.0f64; 3];
    for (index, a) in fresh.iter().enumerate() {
        for b in &fresh[index + 1..] {
            let between = Difference::of(a, b, exposure_ev)?.all();
            noise = std::array::from_fn(|i| noise[i].max(between[i]));
        }
    }
    let mut found = [0.0; 3];
    for picture_of_another_seed in fresh {
        let between = Difference::of(picture, picture_of_another_seed, exposure_ev)?.all();
        found = std::array::from_fn(|i| found[i] + between[i] / fresh.len() as f64);
    }
    let checks = Difference::NAMES
        .into_iter()
        .enumerate()
        .map(|(i, metric)| {
            let (factor, more) = FACTORS[i];
            Check::at_most(
                format!("{name}.{metric}"),
                found[i],
                factor * noise[i] + more,
            )
        });
    Ok(checks.collect())
}

/// Number of pixels whose light differs in any bit.
pub fn different_pixels(a: &Picture, b: &Picture) -> u64 {
    if [a.width, a.height] != [b.width, b.height] {
        return a.rgb.len().max(b.rgb.len()) as u64;
    }
    let bits = |rgb: &[f32; 3]| rgb.map(f32::to_bits);
    let pairs = a.rgb.iter().zip(&b.rgb);
    pairs.filter(|(a, b)| bits(a) != bits(b)).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checks_refuse_what_is_above_the_bound_and_what_is_no_number() {
        assert!(Check::at_most("a", 1.0, 1.0).passed);
        assert!(!Check::at_most("a", 1.1, 1.0).passed);
        assert!(!Check::at_most("a", f64::NAN, 1.0).passed);
        assert!(Check::none("a", 0).passed && !Check::none("a", 1).passed);
        let mut measured = BTreeMap::new();
        let check = Check::at_most("a", 3.0, 2.0).measured(&mut measured);
        assert_eq!(
            (check.value, check.passed, measured["a"]),
            (None, false, 3.0)
        );
    }

    #[test]
    fn a_cell_that_differs_is_counted() {
        let mut voxels = Voxels::empty(UVec3::new(40, 24, 33));
        voxels.fill_box(IVec3::ZERO, IVec3::new(39, 9, 32), 1);
        voxels.fill_sphere(glam::Vec3::new(20.0, 9.0, 16.0), 5.0, 2);
        let fresh = built_afresh(&voxels);
        assert_eq!(different_cells(&voxels, &voxels.clone(), true), 0);
        assert_eq!(different_cells(&voxels, &fresh, false), 0);
        let mut other = voxels.clone();
        // A voxel of another material, in a cell that is a brick before and after.
        other.set(IVec3::new(20, 9, 16), 1);
        assert_eq!(different_cells(&voxels, &other, true), 1);
        // A new brick changes the distances around it too.
        other.set(IVec3::new(3, 22, 3), 1);
        assert!(different_cells(&voxels, &other, true) > 2);
    }

    fn picture(light: impl Fn(usize, usize) -> f32) -> Picture {
        let rgb = (0..32 * 24).map(|i| [light(i % 32, i / 32); 3]).collect();
        Picture {
            width: 32,
            height: 24,
            rgb,
        }
    }

    /// A gradient with some grain.
    fn noisy(seed: usize) -> Picture {
        picture(|x, y| {
            let grain = ((x * 7 + y * 13 + seed * 31) % 17) as f32 / 17.0 - 0.5;
            (0.1 + 0.02 * x as f32) * (1.0 + 0.05 * grain)
        })
    }

    #[test]
    fn light_is_judged_by_the_noise_of_fresh_pictures() {
        let fresh = [noisy(1), noisy(2), noisy(3)];
        let judged = |picture: &Picture| light("light", picture, &fresh, 0.0).expect("finite");
        assert!(judged(&noisy(4)).iter().all(|check| check.passed));
        let mut stale = noisy(4);
        stale
            .rgb
            .iter_mut()
            .flatten()
            .for_each(|value| *value *= 0.7);
        assert!(judged(&stale).iter().all(|check| !check.passed));
        // One corner that stayed dark shows only in the worst block.
        let mut corner = noisy(4);
        for y in 0..8 {
            for x in 0..8 {
                corner.rgb[y * 32 + x] = [0.0; 3];
            }
        }
        let failed: Vec<String> = judged(&corner)
            .into_iter()
            .filter_map(|check| (!check.passed).then_some(check.name))
            .collect();
        assert!(
            failed.contains(&"light.worst_block".to_owned()),
            "{failed:?}"
        );
        let mut broken = noisy(4);
        broken.rgb[5][1] = f32::NAN;
        assert!(light("light", &broken, &fresh, 0.0).is_err());
    }

    #[test]
    fn every_bit_of_a_pixel_counts() {
        let (a, mut b) = (noisy(1), noisy(1));
        assert_eq!(different_pixels(&a, &b), 0);
        b.rgb[3][0] = f32::from_bits(b.rgb[3][0].to_bits() + 1);
        assert_eq!(different_pixels(&a, &b), 1);
        assert!(different_pixels(&a, &Picture::new(2, 2)) > 0);
    }
}
