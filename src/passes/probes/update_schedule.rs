//! When probes are updated and who asks for them: what passes `probes/schedule`, `probes/classify`,
//! `probes/trace` and `probes/blend` share.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::{
    gpu::{Gpu, GpuError, rectangle},
    parameters::{ProbeParameters, ProbeStates},
    probes::Changes,
};

/// `UpdateSchedule` of `shaders/probes/update_schedule.wesl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GpuUpdateSchedule {
    pub changed_low_gs: [f32; 3],
    pub frame: u32,
    pub changed_high_gs: [f32; 3],
    pub states: u32,
    pub alive_frames: u32,
    pub fed_interval: u32,
    pub asleep_interval: u32,
    pub rays_rows: u32,
    pub probe_rows: u32,
    pub restless: f32,
    pub still_interval: u32,
    pub padding: u32,
}

/// How many probes are in each state, as pass `probes/schedule` last judged them: those of the lattice and their twins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StateCounts {
    /// Updated in every frame, or now and then because the rays of others need them.
    pub alive: u32,
    /// Refreshed now and then.
    pub sleeping: u32,
    /// In stone: neither updated nor gathered.
    pub dead: u32,
    /// Updated in the last frame.
    pub due: u32,
    /// How many of those that are not dead are twins: beyond the probes of the lattice.
    pub twins: u32,
}

impl StateCounts {
    /// Each probe is in one state.
    pub fn total(&self) -> u32 {
        self.alive + self.sleeping + self.dead
    }
}

/// Frames between updates of a probe that only the rays of other probes ask for.
const FED_INTERVAL: u32 = 4;
/// Frames between updates of a probe that nobody asks for.
const ASLEEP_INTERVAL: u32 = 10;
/// By how much the times between other updates grow when no lamp and no voxel has changed for long.
const STILL_INTERVAL: u32 = 2;
/// Threads of a workgroup of pass `probes/trace`.
const RAY_GROUP: u32 = 64;
/// Words in front of the list, as `LIST` of `shaders/probes/update_schedule.wesl`.
const LIST: u64 = 4;
/// Alerts above this are of a lamp that is switched, or of an edit, and not of one that wanders.
const SUDDEN: f32 = 0.5;
/// Farther than any world reaches (voxels).
const EVERYWHERE: f32 = 1e9;

/// Buffers of the plan of one probe field.
pub(super) struct UpdateSchedule {
    slots: u32,
    rays_rows: u32,
    probe_rows: u32,
    /// Voxels (grid space) that pass `probes/classify` has not looked at yet.
    changed: Option<(Vec3, Vec3)>,
    uniform: wgpu::Buffer,
    work: wgpu::Buffer,
    face_requests: wgpu::Buffer,
    dispatch: wgpu::Buffer,
}

impl UpdateSchedule {
    pub fn new(gpu: &Gpu, slots: u32, rays: u32) -> Result<Self, GpuError> {
        let all = u64::from(slots);
        Ok(Self {
            slots,
            // The buffer of the rays fits a binding, so that their number fits an u32.
            rays_rows: rectangle((slots * rays).div_ceil(RAY_GROUP))[1],
            probe_rows: rectangle(slots)[1],
            changed: Some((Vec3::splat(-EVERYWHERE), Vec3::splat(EVERYWHERE))),
            uniform: gpu.uniform_buffer("probe_plan", &GpuUpdateSchedule::default()),
            work: gpu.storage_buffer("probe_work", (LIST + 3 * all) * 4)?,
            face_requests: gpu.storage_buffer("face_requests", (LIST + 3 * all) * 4)?,
            dispatch: gpu.storage_buffer("probe_dispatch", 48)?,
        })
    }

    /// Writes the plan of the next frame.
    pub fn begin_frame(
        &self,
        gpu: &Gpu,
        parameters: &ProbeParameters,
        changes: &Changes,
        frame: u64,
    ) {
        let is_still = changes.stillness() == 1.0 && parameters.states == ProbeStates::On;
        let still_interval = if is_still { STILL_INTERVAL } else { 1 };
        let (low, high) = self.changed.unwrap_or((Vec3::INFINITY, Vec3::NEG_INFINITY));
        let plan = GpuUpdateSchedule {
            changed_low_gs: low.to_array(),
            frame: frame as u32,
            changed_high_gs: high.to_array(),
            states: match parameters.states {
                ProbeStates::Off => 0,
                ProbeStates::On => 1,
            },
            alive_frames: parameters.alive_frames,
            // Where light changes at once, what feeds the picture is wanted at once.
            fed_interval: if changes.alert() > SUDDEN {
                1
            } else {
                FED_INTERVAL * still_interval
            },
            asleep_interval: ASLEEP_INTERVAL,
            rays_rows: self.rays_rows,
            probe_rows: self.probe_rows,
            restless: parameters.restless,
            still_interval,
            padding: 0,
        };
        gpu.queue
            .write_buffer(&self.uniform, 0, bytemuck::bytes_of(&plan));
        if frame == 0 {
            // The probes begin anew, and nobody has asked for them yet.
            let none = vec![0u32; LIST as usize + 3 * self.slots as usize];
            for requests in [&self.work, &self.face_requests] {
                gpu.queue
                    .write_buffer(requests, 0, bytemuck::cast_slice(&none));
            }
        }
    }

    /// Adds a box of voxels (grid space, from low to high corner) to what has changed.
    pub fn change(&mut self, low: Vec3, high: Vec3) {
        let (known_low, known_high) = self.changed.unwrap_or((low, high));
        self.changed = Some((known_low.min(low), known_high.max(high)));
    }

    /// Whether there is something that pass `probes/classify` has not looked at.
    pub fn has_changed(&self) -> bool {
        self.changed.is_some()
    }

    pub fn forget_changes(&mut self) {
        self.changed = None;
    }

    pub fn resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 2] {
        [
            ("probe_plan", self.uniform.as_entire_binding()),
            ("probe_work", self.work.as_entire_binding()),
        ]
    }

    /// What pass `probes/schedule` reads of pass `surface_cache/trace`.
    pub fn face_requests(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        ("face_requests", self.face_requests.as_entire_binding())
    }

    /// `probe_work` of pass `surface_cache/trace`.
    pub fn requests_of_faces(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        ("probe_work", self.face_requests.as_entire_binding())
    }

    pub fn dispatch(&self) -> &wgpu::Buffer {
        &self.dispatch
    }

    /// Slots of the probes that were due, in no particular order.
    pub fn due(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let words: Vec<u32> = gpu.read_buffer(&self.work)?;
        let list = words[LIST as usize..].iter().take(words[0] as usize);
        // The highest bit says whether its rays ask.
        Ok(list.map(|word| word & (u32::MAX >> 1)).collect())
    }

    /// Of the probes with these `probe_states`.
    pub fn count(
        &self,
        gpu: &Gpu,
        states: &wgpu::Buffer,
        lattice: u32,
    ) -> Result<StateCounts, GpuError> {
        let due: Vec<u32> = gpu.read_buffer_range(&self.work, 0, 4)?;
        let mut counts = StateCounts {
            due: due[0],
            ..Default::default()
        };
        let states: Vec<[u32; 4]> = gpu.read_buffer(states)?;
        for (slot, [.., flags]) in (0..self.slots).zip(&states) {
            // As `CLASS_BITS` and the classes of `shaders/probes/update_schedule.wesl`.
            let class = flags & 3;
            let is_twin = slot >= lattice;
            match class {
                0 | 1 => counts.alive += 1,
                2 => counts.sleeping += 1,
                // A slot that no twin has taken is no probe.
                _ => counts.dead += u32::from(!is_twin),
            }
            counts.twins += u32::from(is_twin && class != 3);
        }
        Ok(counts)
    }
}
