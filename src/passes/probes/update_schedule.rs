//! When probes are updated, and what requests them: data that passes `probes/schedule`, `probes/classify`,
//! `probes/trace`, `probes/blend` and `probes/blend_distances` share.

use glam::Vec3;

use super::state::{GpuProbeState, ProbeClass};
use crate::{
    gpu::{Gpu, GpuError, rectangle},
    parameters::{ProbeParameters, ProbeStates},
    probes::{Changes, Layout as _, Volume, repeats::SETS_AT_A_TIME, sampling},
};

crate::shared! {
    in probes;

    /// When each probe is updated, and what requests it.
    pub struct GpuUpdateSchedule as UpdateSchedule {
        /// Box of voxels that changed since pass `probes/classify` last ran (grid space).
        pub changed_low_gs: [f32; 3],
        /// Frames since the probes were made.
        pub frame: u32,
        pub changed_high_gs: [f32; 3],
        /// One of the STATES_ constants.
        pub states: u32,
        /// Frames for which a request of a probe is remembered.
        pub alive_frames: u32,
        /// Frames from update to update of a probe that only the rays of other probes request.
        pub indirect_interval: u32,
        /// Frames from update to update of a probe without requests.
        pub asleep_interval: u32,
        /// Rows of workgroups of pass `probes/trace`, and of passes with a workgroup per probe.
        pub rays_rows: u32,
        pub probe_rows: u32,
        /// Variability from which a probe is updated in every frame, whatever requests it.
        pub least_variability: f32,
        /// Frames from update to update of a requested probe whose light is still.
        pub still_interval: u32,
        /// Most frames from update to update of a requested probe whose light changes: each cascade is updated half as
        /// often as the next finer one.
        pub far_interval: u32,
        /// Which set of kept hits the updates of this frame take.
        pub hit_set: u32,
        /// A probe repeats the rays of its last update if they were new at most so many frames ago; 0: none does.
        pub repeats_within: u32,
        /// New rays of probes have the directions of so many frames.
        pub sets_at_a_time: u32,
        /// Frames since light last changed greatly, or since the probes were made.
        pub since_great: u32,
        /// Frames since lamps or bodies have changed.
        pub steady_frames: u32,
        pub _pad: [u32; 3],
    }
}

/// How many probes are in each state, as pass `probes/schedule` last classified them: probes of the lattice and
/// back-side probes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StateCounts {
    /// Updated in every frame, or every few frames because only the rays of other probes request them.
    pub alive: u32,
    /// Without requests, updated rarely.
    pub sleeping: u32,
    /// In a solid voxel: neither updated nor gathered.
    pub dead: u32,
    /// Updated in the last frame.
    pub updated: u32,
    /// How many of the probes that are not dead are back-side probes, which the lattice does not count.
    pub back_side: u32,
}

impl StateCounts {
    /// All probes: each is in exactly one state.
    pub fn total(&self) -> u32 {
        self.alive + self.sleeping + self.dead
    }
}

/// Frames between updates of a probe that only the rays of other probes request.
const INDIRECT_INTERVAL: u32 = 4;
/// Frames between updates of a probe without requests.
const ASLEEP_INTERVAL: u32 = 10;
/// Factor of the intervals of requested probes when no lamp and no voxel has changed for long.
const STILL_INTERVAL: u32 = 2;
/// Most frames between updates of a requested probe of a far cascade.
const FAR_INTERVAL: u32 = 4;

crate::shared! {
    in probes;

    /// Threads of a workgroup of pass `probes/trace`.
    const RAY_GROUP: u32 = 64;

    /// What `active_list` begins with: the number of active probes.
    struct GpuActiveListHead as ActiveListHead {
        count: u32,
    }

    /// Workgroups for the active probes.
    pub(super) struct GpuProbeDispatch as ProbeDispatch {
        /// Of pass `probes/trace`.
        pub(super) ray_groups: [u32; 3],
        /// Counts while the list grows.
        pub(super) count: u32 => "atomic<u32>",
        /// Of passes with one workgroup per probe.
        pub(super) probe_groups: [u32; 3],
        /// Counts while the list of probes grows whose distances are measured.
        pub(super) measured: u32 => "atomic<u32>",
        /// Of pass `probes/blend_distances`.
        pub(super) distance_groups: [u32; 3],
        /// Workgroups of pass `probes/schedule` that have come to their end.
        pub(super) finished: u32 => "atomic<u32>",
    }

    /// A probe whose distances are measured in this frame, as it was before.
    pub(super) struct GpuMeasuredProbe as MeasuredProbe {
        /// Its slot and the set of directions of its rays, as in the list of active probes.
        pub(super) entry: u32,
        /// Its updates.
        pub(super) updates: u32,
        /// The last frame in which it was updated: a whole number.
        pub(super) updated_in: f32,
        /// The last frame in which a body was near; 0: none was.
        pub(super) near_bodies: f32,
    }

    /// Set in an entry of the list: the rays of the probe request other probes.
    const MAKES_REQUESTS: u32 = 1 << 31;

    /// And these: it repeats the rays of its last update; the rays that it has stored are pairs.
    const REPEATS: u32 = 1 << 30;
    const WERE_PAIRS: u32 = 1 << 29;

    /// Bits of an entry from this one on: which set of directions its rays have. Below it: the slot.
    const RAY_SET_SHIFT: u32 = 23;

    /// Probes outside solid voxels are updated in every frame.
    const STATES_OFF: u32 = 0;

    /// Probes without requests sleep.
    const STATES_ON: u32 = 1;
}

const HEAD_BYTES: u64 = size_of::<GpuActiveListHead>() as u64;
/// Alerts above this come from a switched lamp or an edit, not from a lamp that moves.
const SUDDEN: f32 = 0.5;
/// Farther than any world reaches (voxels).
const EVERYWHERE: f32 = 1e9;

/// Buffers of the update schedule of one probe field.
pub(super) struct UpdateSchedule {
    slots: u32,
    rays_rows: u32,
    probe_rows: u32,
    /// Whether pass `probes/classify` has run.
    is_placed: bool,
    /// Whether levels surround each other.
    has_cascades: bool,
    uniform: wgpu::Buffer,
    work: wgpu::Buffer,
    face_requests: wgpu::Buffer,
    quadrant_requests: wgpu::Buffer,
    pixel_requests: wgpu::Buffer,
    distance_list: wgpu::Buffer,
    dispatch: wgpu::Buffer,
}

impl UpdateSchedule {
    /// `measures`: the probes keep distances.
    pub fn new(
        gpu: &Gpu,
        slots: u32,
        rays: u32,
        has_cascades: bool,
        measures: bool,
    ) -> Result<Self, GpuError> {
        let all = u64::from(slots);
        let measured = if measures { all } else { 1 };
        Ok(Self {
            slots,
            // The buffer of the rays fits a binding, so the number of rays fits a u32.
            rays_rows: rectangle((slots * rays).div_ceil(RAY_GROUP))[1],
            probe_rows: rectangle(slots)[1],
            is_placed: false,
            has_cascades,
            uniform: gpu.uniform_buffer("update_schedule", &GpuUpdateSchedule::default()),
            // Requests of rays, and the list.
            work: gpu.storage_buffer("active_list", HEAD_BYTES + 2 * all * 4)?,
            face_requests: gpu.storage_buffer("face_requests", HEAD_BYTES + all * 4)?,
            // Of rays and of pixels.
            quadrant_requests: gpu.storage_buffer("quadrant_requests", HEAD_BYTES + 2 * all * 4)?,
            pixel_requests: gpu.storage_buffer("pixel_requests", HEAD_BYTES + all * 4)?,
            distance_list: gpu.storage_buffer(
                "distance_list",
                HEAD_BYTES + measured * size_of::<GpuMeasuredProbe>() as u64,
            )?,
            dispatch: gpu.storage_buffer("probe_dispatch", size_of::<GpuProbeDispatch>() as u64)?,
        })
    }

    /// Writes the schedule of the next frame. `repeats`: probes may repeat their rays.
    pub fn begin_frame(
        &self,
        gpu: &Gpu,
        parameters: &ProbeParameters,
        changes: &Changes,
        repeats: bool,
        frame: u64,
    ) {
        let is_still = changes.stillness() == 1.0 && parameters.states == ProbeStates::On;
        let still_interval = if is_still { STILL_INTERVAL } else { 1 };
        // One volume has few probes. Of the many of cascades, a small edit wakes those around it (pass `probes/classify`).
        let alert = if self.has_cascades {
            changes.wide_alert()
        } else {
            changes.alert()
        };
        let is_sudden = alert > SUDDEN;
        let may_wait = self.has_cascades && !is_sudden && parameters.states == ProbeStates::On;
        let (low, high) = match changes.shown_first() {
            _ if !self.is_placed => (Vec3::splat(-EVERYWHERE), Vec3::splat(EVERYWHERE)),
            Some(edit) => (edit.low_gs, edit.high_gs),
            None => (Vec3::INFINITY, Vec3::NEG_INFINITY),
        };
        let update_schedule = GpuUpdateSchedule {
            changed_low_gs: low.to_array(),
            frame: frame as u32,
            changed_high_gs: high.to_array(),
            states: match parameters.states {
                ProbeStates::Off => STATES_OFF,
                ProbeStates::On => STATES_ON,
            },
            alive_frames: parameters.alive_frames,
            // After a sudden change, indirect-only probes must follow at once.
            indirect_interval: if is_sudden {
                1
            } else {
                INDIRECT_INTERVAL * still_interval
            },
            asleep_interval: ASLEEP_INTERVAL,
            rays_rows: self.rays_rows,
            probe_rows: self.probe_rows,
            least_variability: parameters.variability,
            still_interval,
            far_interval: if may_wait { FAR_INTERVAL } else { 1 },
            hit_set: sampling::set_of_frame(frame, parameters.hit_sets),
            sets_at_a_time: if repeats { SETS_AT_A_TIME } else { 1 },
            repeats_within: if repeats {
                changes.repeats().within()
            } else {
                0
            },
            since_great: changes
                .frames_since_great(frame as u32)
                .unwrap_or(frame as u32),
            steady_frames: changes.steady_frames(),
            ..Default::default()
        };
        gpu.queue
            .write_buffer(&self.uniform, 0, bytemuck::bytes_of(&update_schedule));
        if frame == 0 {
            // The probes start again, without requests.
            let none = vec![0; self.work.size() as usize];
            for requests in [
                &self.work,
                &self.face_requests,
                &self.quadrant_requests,
                &self.pixel_requests,
            ] {
                gpu.queue
                    .write_buffer(requests, 0, &none[..requests.size() as usize]);
            }
        }
    }

    /// Whether pass `probes/classify` has not run yet. Its first run places every probe.
    pub fn places_all(&self) -> bool {
        !self.is_placed
    }

    pub fn set_placed(&mut self) {
        self.is_placed = true;
    }

    pub fn resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 2] {
        [
            ("update_schedule", self.uniform.as_entire_binding()),
            ("active_list", self.work.as_entire_binding()),
        ]
    }

    /// The requests that pass `probes/schedule` reads from passes `surface_cache/trace`, `surface_cache/estimate` and `view/shade`.
    /// Pass `probes/classify` adds to the last.
    pub fn requests(&self) -> [(&'static str, wgpu::BindingResource<'_>); 3] {
        [
            ("face_requests", self.face_requests.as_entire_binding()),
            (
                "quadrant_requests",
                self.quadrant_requests.as_entire_binding(),
            ),
            ("pixel_requests", self.pixel_requests.as_entire_binding()),
        ]
    }

    /// The buffer that pass `surface_cache/trace` binds as `active_list`.
    pub fn requests_of_faces(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        ("active_list", self.face_requests.as_entire_binding())
    }

    /// The buffer that pass `surface_cache/estimate` binds as `active_list`.
    pub fn requests_of_quadrants(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        ("active_list", self.quadrant_requests.as_entire_binding())
    }

    /// The buffer that pass `view/shade` binds as `active_list`.
    pub fn requests_of_pixels(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        ("active_list", self.pixel_requests.as_entire_binding())
    }

    /// The probes whose distances are measured.
    pub fn distance_list(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        ("distance_list", self.distance_list.as_entire_binding())
    }

    pub fn dispatch(&self) -> &wgpu::Buffer {
        &self.dispatch
    }

    /// Slots of the probes that were active, in no particular order.
    pub fn active_slots(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let count = self.head(gpu)?.count as usize;
        let bytes = u64::from(self.slots) * 4;
        let list: Vec<u32> = gpu.read_buffer_range(&self.work, HEAD_BYTES + bytes, bytes)?;
        Ok(list[..count]
            .iter()
            .map(|word| word & ((1 << RAY_SET_SHIFT) - 1))
            .collect())
    }

    fn head(&self, gpu: &Gpu) -> Result<GpuActiveListHead, GpuError> {
        Ok(gpu.read_buffer_range(&self.work, 0, HEAD_BYTES)?[0])
    }

    /// Counts the probes with these `probe_states`.
    pub fn count(
        &self,
        gpu: &Gpu,
        states: &wgpu::Buffer,
        volume: &Volume,
    ) -> Result<StateCounts, GpuError> {
        let mut counts = StateCounts {
            updated: self.head(gpu)?.count,
            ..Default::default()
        };
        let states: Vec<GpuProbeState> = gpu.read_buffer(states)?;
        for (slot, state) in (0..self.slots).zip(&states) {
            // Spare slots of an octree are no probes.
            if volume
                .octree()
                .is_some_and(|octree| !octree.has_probe(slot % octree.slots()))
            {
                continue;
            }
            let is_back_side = slot >= volume.slots();
            match state.class() {
                ProbeClass::Alive | ProbeClass::IndirectOnly => counts.alive += 1,
                ProbeClass::Asleep => counts.sleeping += 1,
                // A slot without a back-side probe counts as no probe.
                ProbeClass::Dead => counts.dead += u32::from(!is_back_side),
            }
            counts.back_side += u32::from(is_back_side && state.class() != ProbeClass::Dead);
        }
        Ok(counts)
    }
}
