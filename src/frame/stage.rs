//! A world's voxels and materials on the GPU: what a frame shows.

use std::{mem, thread};

use super::FrameError;
use crate::{
    gpu::{Gpu, GpuError, Offer, Recorder, Timing, made},
    lights::{Emitters, LampKinds},
    passes::scene::{
        GpuBodies, GpuEmitters, GpuLights, GpuMaterials, GpuVoxels,
        distances::Distances,
        voxelise::{Voxelise, VoxeliseReport},
    },
    probes::Volume,
    world::{
        LayoutSpec, World,
        materials::MaterialSet,
        voxels::{SolidVoxels, Voxels},
    },
};

/// A world on the GPU, without a camera: its voxels and materials.
pub struct Stage {
    pub voxels: GpuVoxels,
    /// Which of them are solid, on the CPU.
    pub(super) solid: SolidVoxels,
    pub materials: GpuMaterials,
    /// The faces of its emissive voxels.
    pub emitters: GpuEmitters,
    /// The cost of building the voxels; `None` for voxels from the CPU.
    pub built: Option<BuildReport>,
    /// The kinds of lamps that the kernels of a frame know: at first those of any preset, and those that a player has placed. More
    /// can come while a frame shows them: [`Frame::allow_lamps`](super::Frame::allow_lamps).
    pub lamp_kinds: LampKinds,
}

/// Buffers that larger ones have replaced.
pub(super) struct Replaced {
    voxels: Option<GpuVoxels>,
    emitters: Option<GpuEmitters>,
}

/// The cost of building a world's voxels on the GPU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildReport {
    pub voxelise: VoxeliseReport,
    /// GPU milliseconds of the distances; `None` where the adapter cannot time them.
    pub distances_ms: Option<f64>,
}

impl Stage {
    /// Voxelises the world, bakes its textures, and finds its emissive faces. What a save changed about the
    /// world is applied on the CPU.
    ///
    /// # Errors
    /// [`FrameError::Gpu`] when the adapter cannot hold it.
    pub fn build(gpu: &Gpu, world: &World) -> Result<Self, FrameError> {
        let (voxelised, distances, materials) = thread::scope(|threads| {
            let distances = threads.spawn(|| Distances::new(gpu));
            let materials = threads.spawn(|| bake(gpu, world));
            let voxelised = Voxelise::new(gpu, world).and_then(|pass| pass.run(gpu, world));
            (voxelised, made(distances), made(materials))
        });
        let (voxels, voxelise) = voxelised?;
        let (distances, materials) = (distances?, materials?);
        let mut timing = Timing::new(gpu)?;
        let mut recorder = Recorder::new(gpu, Some(&mut timing));
        distances.record(gpu, &mut recorder, &voxels);
        recorder.submit(gpu)?;
        gpu.wait()?;
        let timed = timing.next_frame().filter(|_| timing.supported());
        let built = BuildReport {
            voxelise,
            distances_ms: timed.map(|times| times.frame_ms),
        };
        if !world.restored.overlay.is_empty() {
            let mut changed = voxels.read_back(gpu)?;
            changed.apply(&world.restored.overlay);
            return Ok(Self {
                built: Some(built),
                ..Self::of_voxels(gpu, world, &changed, materials)?
            });
        }
        let read = voxels.read_back(gpu)?;
        let emitters = Emitters::find(&read, &world.materials);
        Ok(Self {
            voxels,
            solid: SolidVoxels::of(&read),
            materials,
            emitters: GpuEmitters::upload(gpu, emitters)?,
            built: Some(built),
            lamp_kinds: LampKinds::of_world(world),
        })
    }

    /// Makes a stage from voxels that are already on the CPU; `world` gives the materials and the place.
    ///
    /// # Errors
    /// [`FrameError::Gpu`] when the adapter cannot hold it.
    pub fn upload(gpu: &Gpu, world: &World, voxels: &Voxels) -> Result<Self, FrameError> {
        Self::of_voxels(gpu, world, voxels, bake(gpu, world)?)
    }

    fn of_voxels(
        gpu: &Gpu,
        world: &World,
        voxels: &Voxels,
        materials: GpuMaterials,
    ) -> Result<Self, FrameError> {
        Ok(Self {
            voxels: GpuVoxels {
                bodies: GpuBodies::upload(gpu, &world.bodies, &world.materials, world.size)?,
                ..GpuVoxels::upload(gpu, voxels, world.origin)?
            },
            materials,
            solid: SolidVoxels::of(voxels),
            emitters: GpuEmitters::upload(gpu, Emitters::find(voxels, &world.materials))?,
            built: None,
            lamp_kinds: LampKinds::of_world(world),
        })
    }

    /// Whether voxels emit light, those of the grid or of bodies.
    pub(super) fn emits(&self) -> bool {
        !self.emitters.known.groups.is_empty() || self.voxels.bodies.glow()
    }

    /// Replaces the buffers that are too small for edited voxels and for `emitters`, a changed list. Returns the replaced
    /// buffers, if any; passes must then be bound again.
    ///
    /// # Errors
    /// [`GpuError`] when the adapter cannot hold them; the stage is then unchanged.
    pub(super) fn make_room(
        &mut self,
        gpu: &Gpu,
        voxels: &Voxels,
        emitters: Option<&Emitters>,
    ) -> Result<Option<Replaced>, GpuError> {
        let larger_voxels = self.voxels.with_room_for(gpu, voxels)?;
        let larger_list = emitters
            .filter(|emitters| !self.emitters.holds(emitters))
            .map(|emitters| GpuEmitters::upload(gpu, emitters.clone()))
            .transpose()?;
        if larger_voxels.is_none() && larger_list.is_none() {
            return Ok(None);
        }
        Ok(Some(Replaced {
            voxels: larger_voxels.map(|larger| mem::replace(&mut self.voxels, larger)),
            emitters: larger_list.map(|larger| mem::replace(&mut self.emitters, larger)),
        }))
    }

    /// Undoes [`make_room`](Self::make_room).
    pub(super) fn put_back(&mut self, before: Replaced) {
        if let Some(voxels) = before.voxels {
            self.voxels = voxels;
        }
        if let Some(emitters) = before.emitters {
            self.emitters = emitters;
        }
    }

    /// Reads the voxels back, once, for collision, picking and edits.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read_back(&self, gpu: &Gpu) -> Result<Voxels, GpuError> {
        self.voxels.read_back(gpu)
    }

    /// The probes of a layout. An octree needs the voxels.
    pub(super) fn volume(&self, gpu: &Gpu, layout: &LayoutSpec) -> Result<Volume, FrameError> {
        if layout.octree.is_none() {
            return Ok(Volume::new(layout)?);
        }
        let voxels = self.read_back(gpu)?;
        Ok(Volume::octree_of(layout, &voxels, self.voxels.origin)?)
    }
}

/// What every pass may take by name.
pub fn scene<'a>(stage: &'a Stage, view: &'a wgpu::Buffer, lights: &'a GpuLights) -> Offer<'a> {
    let mut all = stage.voxels.resources().to_vec();
    all.extend(stage.materials.resources());
    all.extend(stage.emitters.resources());
    all.extend(lights.resources());
    all.push(("view", view.as_entire_binding()));
    let mut constants = lights.constants().to_vec();
    constants.extend(stage.voxels.bodies.constants());
    Offer {
        resources: all,
        constants,
    }
}

fn bake(gpu: &Gpu, world: &World) -> Result<GpuMaterials, GpuError> {
    GpuMaterials::upload(gpu, &MaterialSet::bake(&world.materials, world.seed))
}
