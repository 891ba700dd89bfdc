//! The probe field on the GPU: what the passes that trace, blend and gather probes share.

mod bindings;
mod places;
mod read_back;

use std::mem::offset_of;

use super::{
    GpuChanges, GpuProbeInfo, GpuProbePlace, GpuProbeState,
    kept_hits::KeptHits,
    occlusion::OcclusionField,
    octree::GpuOctree,
    source::Source,
    update_schedule::{GpuProbeDispatch, StateCounts, UpdateSchedule},
};
use crate::{
    gpu::{Gpu, GpuError},
    lights::RhythmsTold,
    parameters::{ProbeHits, ProbeParameters, Visibility},
    probes::{
        AtlasLayout, Changes, Layout as _, Motion, OcclusionLayout, ProbeError, VisibilityBits,
        Volume, atlas::ProbeMemory, repeats::RAY_SETS, sampling,
    },
};

/// Why a probe field cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum ProbeFieldError {
    #[error(transparent)]
    Layout(#[from] ProbeError),
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// Of a direction in `ray_directions`.
const DIRECTION_BYTES: u64 = 16;

/// The name of the visibility bits in messages about memory.
const VISIBILITY_BITS: &str = "the visibility bits of all probes (probes.visibility=exact)";

/// The name of kept hits, and what makes them smaller.
const KEPT_HITS: &str = "the kept hits of all probes (probes.hits=kept; fewer probes.rays or probes.hit_sets take less, \
                         probes.hits=traced keeps none)";

/// Maps and rays of the probes of one volume. All zero at first: no light.
pub struct ProbeField {
    /// The changes that its probes respond to.
    pub changes: Changes,
    volume: Volume,
    tree: GpuOctree,
    /// Whether a frame has shown the new probes of the octree.
    shows_growth: bool,
    visibility_bits: Option<VisibilityBits>,
    motion: Motion,
    atlas: AtlasLayout,
    memory: ProbeMemory,
    update_schedule: UpdateSchedule,
    rays_per_probe: u32,
    source: Option<Source>,
    kept_hits: Option<KeptHits>,
    occlusion: OcclusionField,
    info: wgpu::Buffer,
    ray_directions: wgpu::Buffer,
    rays: wgpu::Buffer,
    irradiance_maps: wgpu::Buffer,
    states: wgpu::Buffer,
    variability: wgpu::Buffer,
    changes_info: wgpu::Buffer,
    places: wgpu::Buffer,
    visibility_buffer: wgpu::Buffer,
    ambient_cubes: wgpu::Buffer,
    /// How kernels tell apart lamps that have rhythms, and what pass `probes/rhythms` keeps of each probe.
    told: RhythmsTold,
    rhythms: Option<wgpu::Buffer>,
    distance_atlas: wgpu::Texture,
    distance_view: wgpu::TextureView,
}

impl ProbeField {
    /// # Errors
    /// [`ProbeFieldError`] when the adapter cannot hold it; nothing is allocated then.
    pub fn new(
        gpu: &Gpu,
        volume: Volume,
        parameters: &ProbeParameters,
    ) -> Result<Self, ProbeFieldError> {
        Self::with_rhythms(gpu, volume, parameters, RhythmsTold::None)
    }

    /// The same; `told`: how kernels tell apart lamps that have rhythms.
    ///
    /// # Errors
    /// As [`ProbeField::new`].
    pub fn with_rhythms(
        gpu: &Gpu,
        volume: Volume,
        parameters: &ProbeParameters,
        told: RhythmsTold,
    ) -> Result<Self, ProbeFieldError> {
        let parameters = &*parameters.effective();
        // Bits that do not fit are an error only under `exact`. Otherwise visibility is estimated from distances.
        let visibility_bits = VisibilityBits::new(&volume, parameters).filter(|visibility_bits| {
            parameters.visibility == Visibility::Exact
                || gpu
                    .check_buffer(VISIBILITY_BITS, visibility_bits.bytes())
                    .is_ok()
        });
        let back_side = visibility_bits
            .as_ref()
            .is_some_and(VisibilityBits::back_side);
        let slots = volume.slots() * if back_side { 2 } else { 1 };
        let atlas = AtlasLayout::new(
            slots,
            parameters,
            visibility_bits.is_none(),
            gpu.limits.max_texture_dimension_2d,
            gpu.limits.max_texture_array_layers,
        )?;
        let rays = parameters.rays;
        let occlusion = OcclusionLayout::new(&parameters.occlusion);
        OcclusionField::check(gpu, occlusion, slots, rays)?;
        let memory = ProbeMemory {
            occlusion: occlusion.map_bytes(slots) + occlusion.ray_bytes(slots, rays),
            visibility_bits: visibility_bits.as_ref().map_or(0, VisibilityBits::bytes),
            octree: GpuOctree::bytes(&volume),
            ..atlas.memory(parameters)
        };
        let memory = if told != RhythmsTold::None {
            memory.with_rhythms(&atlas)
        } else {
            memory
        };
        let rays = match parameters.hits {
            ProbeHits::Traced => "the rays of all probes (probes.rays)",
            ProbeHits::Kept => KEPT_HITS,
        };
        let parts = [
            (VISIBILITY_BITS, memory.visibility_bits),
            (rays, memory.ray_buffer()),
            ("the irradiance maps of all probes", memory.irradiance_maps),
        ];
        for (what, bytes) in parts {
            gpu.check_buffer(what, bytes)?;
        }
        let what = format!("a layout of {} probes", volume.probes());
        gpu.making(&what, memory.total(), || {
            let made = Self::make(gpu, volume, visibility_bits, atlas, memory, parameters)?;
            Ok(Self { told, ..made })
        })
    }

    fn make(
        gpu: &Gpu,
        volume: Volume,
        visibility_bits: Option<VisibilityBits>,
        atlas: AtlasLayout,
        memory: ProbeMemory,
        parameters: &ProbeParameters,
    ) -> Result<Self, ProbeFieldError> {
        let distance_atlas = gpu.texture(
            "distance_atlas",
            atlas.layer_extent(atlas.distance_texels),
            wgpu::TextureFormat::R32Uint,
        )?;
        let places = gpu.storage_buffer("probe_places", memory.places)?;
        // Until pass `probes/classify` runs, all probes are on the lattice and count as alive.
        let lattice: Vec<GpuProbePlace> = (0..volume.slots())
            .map(|slot| GpuProbePlace {
                position_ws: volume.position(slot).to_array(),
                alive: 1.0,
            })
            .collect();
        gpu.queue
            .write_buffer(&places, 0, bytemuck::cast_slice(&lattice));
        Ok(Self {
            tree: GpuOctree::new(gpu, &volume)?,
            shows_growth: false,
            visibility_bits,
            visibility_buffer: gpu.storage_buffer("probe_visibility", memory.visibility_bits)?,
            ambient_cubes: gpu.storage_buffer("ambient_cubes", memory.ambient_cubes)?,
            told: RhythmsTold::None,
            rhythms: (memory.rhythms > 0)
                .then(|| gpu.storage_buffer("probe_rhythms", memory.rhythms))
                .transpose()?,
            changes: Changes::default(),
            update_schedule: UpdateSchedule::new(
                gpu,
                atlas.slots,
                parameters.rays,
                volume.octree().is_none() && volume.levels().len() > 1,
                atlas.distance_texels > 0,
            )?,
            places,
            info: gpu.uniform_buffer("probe_info", &GpuProbeInfo::default()),
            ray_directions: gpu.storage_buffer(
                "ray_directions",
                u64::from(RAY_SETS * parameters.rays) * DIRECTION_BYTES,
            )?,
            rays: gpu.storage_buffer("probe_rays", memory.ray_buffer())?,
            irradiance_maps: gpu.storage_buffer("irradiance_maps", memory.irradiance_maps)?,
            states: gpu.storage_buffer("probe_states", memory.states)?,
            variability: gpu.storage_buffer("probe_variability", memory.variability)?,
            changes_info: gpu.uniform_buffer("changes", &GpuChanges::default()),
            distance_view: layers_of(&distance_atlas),
            distance_atlas,
            rays_per_probe: parameters.rays,
            source: Source::new(gpu, volume.slots(), parameters)?,
            kept_hits: KeptHits::new(gpu, memory.hit_places, parameters)?,
            occlusion: OcclusionField::new(
                gpu,
                OcclusionLayout::new(&parameters.occlusion),
                atlas.slots,
                parameters.rays,
            )?,
            motion: Motion::new(&volume),
            volume,
            atlas,
            memory,
        })
    }

    /// Writes the uniform and rotates the rays for a frame. Must be called once before each submission that updates
    /// the probes: the writes take effect at the start of the submission.
    ///
    /// Parameters for which [`crate::parameters::Remake`] requires a new field (rays, texels) keep the
    /// values with which this field was made.
    pub fn begin_frame(&self, gpu: &Gpu, parameters: &ProbeParameters, seed: u64, frame: u64) {
        let parameters = &*parameters.effective();
        let repeats = self.may_repeat();
        let changes = GpuChanges::new(&self.changes, parameters, repeats, frame as u32);
        gpu.queue
            .write_buffer(&self.changes_info, 0, bytemuck::bytes_of(&changes));
        let info = GpuProbeInfo::new(self, parameters, frame);
        gpu.queue
            .write_buffer(&self.info, 0, bytemuck::bytes_of(&info));
        let rays = parameters.rays_per_update().min(self.rays_per_probe);
        // f32 holds such numbers exactly.
        let number = (frame % (1 << 24)) as f32;
        let set = frame % u64::from(RAY_SETS) * u64::from(self.rays_per_probe);
        let directions = sampling::directions_of_frame(parameters, rays, seed, frame);
        let directions: Vec<[f32; 4]> = directions
            .into_iter()
            .map(|direction| direction.as_vec3().extend(number).to_array())
            .collect();
        gpu.queue.write_buffer(
            &self.ray_directions,
            set * DIRECTION_BYTES,
            bytemuck::cast_slice(&directions),
        );
        self.update_schedule
            .begin_frame(gpu, parameters, &self.changes, repeats, frame);
    }

    /// Whether probes may repeat their rays. Kept hits do so in their own way, and classic DDGI does not.
    fn may_repeat(&self) -> bool {
        self.source.is_none() && self.kept_hits.is_none()
    }

    /// Whether visibility bits, found by marching, tell which surfaces each probe sees: see [`VisibilityBits::new`].
    pub fn exact(&self) -> bool {
        self.visibility_bits.is_some()
    }

    /// The constant of kernels that sum the rays of a probe: how many threads share those of the same texels. A CPU runs the threads of a
    /// workgroup one after the other.
    pub(super) fn parts(gpu: &Gpu) -> (&'static str, f64) {
        ("PARTS", if gpu.summary.is_software() { 1.0 } else { 4.0 })
    }

    /// The constants of the kernel that sums the light of a probe's rays: [`Self::parts`], and among how many lanes of threads the
    /// texels of its map are divided. A CPU waits longer for what threads read than for what they compute, so there few threads sum
    /// many texels each.
    pub(super) fn parts_and_lanes(gpu: &Gpu) -> [(&'static str, f64); 2] {
        let lanes = if gpu.summary.is_software() { 8.0 } else { 32.0 };
        [Self::parts(gpu), ("LANES", lanes)]
    }

    /// The constant of kernels that measure distances: whether probes stay where they are until an edit.
    pub(super) fn stands(&self) -> (&'static str, f64) {
        ("PROBES_STAND", f64::from(u8::from(self.source.is_none())))
    }

    /// What the field has in addition when the algorithm is not grotto's own.
    pub(super) fn source(&self) -> Option<&Source> {
        self.source.as_ref()
    }

    /// What the field has in addition when probes keep their hits.
    pub(super) fn kept_hits(&self) -> Option<&KeptHits> {
        self.kept_hits.as_ref()
    }

    /// What the probes keep of the visibility of lamps.
    pub fn occlusion(&self) -> &OcclusionField {
        &self.occlusion
    }

    /// To be updated once before each frame.
    pub fn occlusion_mut(&mut self) -> &mut OcclusionField {
        &mut self.occlusion
    }

    /// Whether probes store distances. Exact visibility does not read distances.
    pub fn keeps_distances(&self) -> bool {
        self.atlas.distance_texels > 0
    }

    /// Which of their visibility results the probes store.
    pub fn visibility_bits(&self) -> Option<&VisibilityBits> {
        self.visibility_bits.as_ref()
    }

    /// The bits of [`Self::visibility_bits`], in words of 32.
    pub fn visibility_buffer(&self) -> &wgpu::Buffer {
        &self.visibility_buffer
    }

    /// Workgroups for the active probes, as pass `probes/schedule` writes them: those of pass `probes/trace` at
    /// [`Self::RAYS_OFFSET`], those of passes with a workgroup per probe at [`Self::PROBES_OFFSET`], those of pass
    /// `probes/blend_distances` at [`Self::DISTANCES_OFFSET`].
    pub fn dispatch(&self) -> &wgpu::Buffer {
        self.update_schedule.dispatch()
    }

    /// Byte offsets in [`Self::dispatch`].
    pub const RAYS_OFFSET: u64 = offset_of!(GpuProbeDispatch, ray_groups) as u64;
    pub const PROBES_OFFSET: u64 = offset_of!(GpuProbeDispatch, probe_groups) as u64;
    pub const DISTANCES_OFFSET: u64 = offset_of!(GpuProbeDispatch, distance_groups) as u64;

    /// The place of each probe, back-side probes after the others: [`GpuProbePlace`].
    pub fn places(&self) -> &wgpu::Buffer {
        &self.places
    }

    pub fn volume(&self) -> &Volume {
        &self.volume
    }

    pub(super) fn motion(&self) -> &Motion {
        &self.motion
    }

    pub fn atlas(&self) -> &AtlasLayout {
        &self.atlas
    }

    /// Rays of each probe that the buffers hold; an update traces them all, or `probes.ray_share` of them.
    pub fn rays_per_probe(&self) -> u32 {
        self.rays_per_probe
    }

    /// Radiance (linear RGB) and length (voxels; negative where the ray began in a solid voxel) of every ray of each
    /// probe's last update, probe by probe: four half floats per ray, 0 before the first update. Where rays were repeated,
    /// pairs of radiance then and now: `shaders/probes/repeated_rays.wesl`. Under
    /// `probes.hits=kept` the kept hits of all sets follow: `shaders/probes/kept_hits.wesl`.
    pub fn rays(&self) -> &wgpu::Buffer {
        &self.rays
    }

    /// The means behind the variability of probes: f32.
    pub fn variability(&self) -> &wgpu::Buffer {
        &self.variability
    }

    /// What pass `probes/rhythms` keeps; `None` where lamps are not told apart.
    pub(super) fn rhythms(&self) -> Option<&wgpu::Buffer> {
        self.rhythms.as_ref()
    }

    /// Distances: r32uint, which [`distances_of`](crate::probes::packed::distances_of) unpacks; one texel where
    /// [`Self::keeps_distances`] says no.
    pub fn distance_atlas(&self) -> &wgpu::Texture {
        &self.distance_atlas
    }

    /// Bytes of GPU memory.
    pub fn memory(&self) -> ProbeMemory {
        self.memory
    }
}

fn layers_of(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}
