//! Distances that the GPU builds, compared word for word with those of the CPU.

use glam::{IVec3, UVec3};
use grotto::{
    gpu::Recorder,
    passes::scene::{GpuVoxels, distances::Distances},
    world::voxels::{NewCell, Voxels},
};

use crate::support;

#[test]
fn the_gpu_builds_the_distances_of_the_cpu() {
    let gpu = support::gpu();
    let voxels = Voxels::from_cells(UVec3::new(200, 100, 129), |cell| {
        let hash = (cell.x * 73 + cell.y * 179 + cell.z * 283).wrapping_mul(2_654_435_761) >> 24;
        match hash {
            0..4 => NewCell::Uniform(2),
            4..8 => {
                let mut content = Box::new([0; 512]);
                content[hash as usize * 31] = 1;
                NewCell::Voxels(content)
            }
            _ => NewCell::Empty,
        }
    });
    let (grid, masks, materials) = voxels.raw();
    let forgotten: Vec<u32> = grid
        .iter()
        .map(|word| if word >> 31 == 0 { 0 } else { *word })
        .collect();
    let blank = Voxels::from_raw(voxels.size(), forgotten, masks.to_vec(), materials.to_vec());
    let on_gpu = GpuVoxels::upload(&gpu, &blank, IVec3::ZERO).expect("fits");
    let distances = Distances::new(&gpu).expect("compiles");
    let mut recorder = Recorder::new(&gpu, None);
    distances.record(&gpu, &mut recorder, &on_gpu);
    recorder.submit(&gpu).expect("submits");
    let built = on_gpu.read_back(&gpu).expect("reads back");
    assert_ne!(blank.raw().0, grid, "the test forgot nothing");
    assert_eq!(built.raw().0, grid);
    assert_eq!(built.validate(), Ok(()));
}
