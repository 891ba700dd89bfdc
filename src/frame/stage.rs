//! A world's voxels and materials on the GPU: what a frame is of.

use super::FrameError;
use crate::{
    gpu::{Gpu, GpuError, Recorder, Timing},
    passes::{
        GpuMaterials, GpuVoxels,
        distances::Distances,
        voxelise::{Voxelise, VoxeliseReport},
    },
    world::{World, materials::MaterialSet, voxels::Voxels},
};

/// A world on the GPU, before anyone looks at it: its voxels and what they are made of.
pub struct Stage {
    pub voxels: GpuVoxels,
    pub materials: GpuMaterials,
    /// What building it took; `None` for voxels that came from the CPU.
    pub built: Option<BuildReport>,
}

/// What it took to build a world's voxels on the GPU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildReport {
    pub voxelise: VoxeliseReport,
    /// GPU milliseconds of the distances; `None` where the adapter cannot time them.
    pub distances_ms: Option<f64>,
}

impl Stage {
    /// Voxelises the world and bakes its textures.
    ///
    /// # Errors
    /// [`FrameError::Gpu`] when the adapter cannot hold it.
    pub fn build(gpu: &Gpu, world: &World) -> Result<Self, FrameError> {
        let (voxels, voxelise) = Voxelise::new(gpu, world)?.run(gpu, world)?;
        let distances = Distances::new(gpu)?;
        let mut timing = Timing::new(gpu)?;
        let mut recorder = Recorder::new(gpu, Some(&mut timing));
        distances.record(gpu, &mut recorder, &voxels);
        recorder.submit(gpu)?;
        gpu.wait()?;
        let timed = timing.next_frame().filter(|_| timing.supported());
        Ok(Self {
            voxels,
            materials: bake(gpu, world)?,
            built: Some(BuildReport {
                voxelise,
                distances_ms: timed.map(|times| times.frame_ms),
            }),
        })
    }

    /// From voxels that are already on the CPU; `world` gives the materials and the place.
    ///
    /// # Errors
    /// [`FrameError::Gpu`] when the adapter cannot hold it.
    pub fn upload(gpu: &Gpu, world: &World, voxels: &Voxels) -> Result<Self, FrameError> {
        Ok(Self {
            voxels: GpuVoxels::upload(gpu, voxels, world.origin)?,
            materials: bake(gpu, world)?,
            built: None,
        })
    }

    /// Reads the voxels back, once, for collision, picking and edits.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read_back(&self, gpu: &Gpu) -> Result<Voxels, GpuError> {
        self.voxels.read_back(gpu)
    }
}

fn bake(gpu: &Gpu, world: &World) -> Result<GpuMaterials, GpuError> {
    GpuMaterials::upload(gpu, &MaterialSet::bake(&world.materials, world.seed))
}
