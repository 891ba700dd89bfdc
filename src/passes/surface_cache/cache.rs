//! Faces of voxels that have light of their own: data that passes `surface_cache/lamps`, `surface_cache/allocate`,
//! `surface_cache/trace`, `surface_cache/estimate`, `surface_cache/resolve` and `view/shade` share.

use std::mem::offset_of;

use super::shared::{
    BODY_REQUESTS, ENTRY_WORDS, FACE_RAYS, FACES_A_GROUP, GpuFaceBatch, GpuFaceCounts,
    GpuFaceDispatch, GpuFaceEstimate, GpuFaceHistory, GpuFaceShares, GpuListedFace,
    GpuRequestedFace, GpuSurfaceCacheInfo, LAMP_FACES_A_GROUP, RAYS_A_GROUP, REACH, REQUEST_ROOM,
};
use crate::{
    gpu::{Gpu, GpuError, rectangle},
    lights::{RhythmsTold, emitters::FACINGS},
    parameters::{FinalGather, ProbeParameters},
    probes::Changes,
};

const LISTED_BYTES: u64 = size_of::<GpuListedFace>() as u64;
const ESTIMATE_BYTES: u64 = size_of::<GpuFaceEstimate>() as u64;
const BATCH_BYTES: u64 = size_of::<GpuFaceBatch>() as u64;
const HISTORY_BYTES: u64 = size_of::<GpuFaceHistory>() as u64;
const SHARES_BYTES: u64 = size_of::<GpuFaceShares>() as u64;
/// Three half floats.
const GAIN_BYTES: u64 = 8;
const REQUEST_BYTES: usize = size_of::<GpuRequestedFace>();
/// The list of requests: a count, the faces, their places in the table, and what bodies request.
const REQUEST_LIST_BYTES: u64 = 4
    + (REQUEST_ROOM as usize * (REQUEST_BYTES + size_of::<u32>())
        + BODY_REQUESTS as usize * REQUEST_BYTES) as u64;
/// Buckets in the table where faces of one direction are first looked for: 1.7 times as many as any picture of `cavern` takes
/// (28 000), those of faces that only rays request among them.
const BUCKETS: u32 = 3 << 14;
/// Most faces that a frame lists: twice as many as any picture of `cavern` has (53 000 at 1920×1080, 61 000 at 3840×2160). Where there
/// are more they are listed in turn.
const MOST_LISTED: u32 = 1 << 17;
/// Batches of rays that faces can send in a frame, whatever the size of the picture: where more faces want rays, as in wide
/// views, they take turns. Measured in docs/results/motion.md: with 32 768 a frame of `cavern` takes 0.28 ms longer.
const MOST_BATCHES: u32 = 20 << 10;
/// Bytes of a ray's result.
const RAY_BYTES: u64 = 8;
/// In software every ray costs time, so a small picture must not cost as much as a large one: pixels of the picture per
/// batch of a frame, and the least batches.
const PIXELS_A_BATCH: u32 = 8;
const LEAST_IN_SOFTWARE: u32 = 1 << 12;
/// Frames that probes take to settle after their warm-up.
const SETTLING_FRAMES: u32 = 24;
/// While lamps glide, rays take the light of a face that was lit at most this many frames ago: it is late by less than the
/// light of the probes, which they would take in its place.
const FRESH_FRAMES: u32 = 8;
/// The same soon after a great change, whose light goes on bouncing: a pixel lists its face once in four frames. Later
/// light may be as old as a quarter of the time since the change.
const FRESH_AT_FIRST: u32 = 4;
/// Most rays whose mean is a quadrant's light until the probes have settled.
const SAMPLES_WHILE_SETTLING: f32 = 64.0;
/// Frames after the last change of lamps or bodies for which rays are repeated: its bounces go on. For as many frames after
/// an edit they are not: few of a face's rays meet what has changed, and the probes have more.
const REPEATED_FRAMES: u32 = 16;
/// While light is still, the light that a face shows changes by at most this in a frame, relative to the brighter of the two: what
/// its rays go on finding, and what faces that come into view find, must not pop.
const STEP_WHILE_STILL: f32 = 0.01;
const ANY_STEP: f32 = 1.0;
/// Distance from an edit (voxels) within which light changes at once.
const EDIT_REACH: f32 = 3.0;

/// What the cache must know about a frame before the frame is recorded.
pub struct NextFrame<'a> {
    /// Width and height of the picture in pixels. In a small picture faces take turns.
    pub size: [u32; 2],
    pub seed: u32,
    /// Frames since the probes were made.
    pub age: u32,
    /// The camera has jumped lately: all that it sees is new.
    pub is_cut: bool,
    /// The more certain it is that light changes now, the less old light counts.
    pub changes: &'a Changes,
    /// See [`crate::lights::RecentLights::steadiness`].
    pub steadiness: f32,
}

/// The table, the list of a frame's faces, and what the rays of each face have found.
pub struct SurfaceCache {
    is_used: bool,
    /// Whether lamps that have rhythms are told apart.
    tells_lamps: bool,
    entries: u32,
    most_listed: u32,
    least_batches: u32,
    most_batches: u32,
    info: wgpu::Buffer,
    table: wgpu::Buffer,
    counts: wgpu::Buffer,
    list: wgpu::Buffer,
    batches: wgpu::Buffer,
    rays: wgpu::Buffer,
    estimates: wgpu::Buffer,
    requested: wgpu::Buffer,
    histories: wgpu::Buffer,
    shares: wgpu::Buffer,
    gains: wgpu::Buffer,
    dispatch: wgpu::Buffer,
}

impl SurfaceCache {
    /// Bytes of an entry of the table.
    pub const ENTRY_BYTES: u64 = 4 * ENTRY_WORDS as u64;
    /// Byte in [`Self::dispatch`] of the workgroups of pass `surface_cache/trace`.
    pub const RAYS_OFFSET: u64 = offset_of!(GpuFaceDispatch, ray_groups) as u64;
    /// Byte in [`Self::dispatch`] of the workgroups of passes `surface_cache/estimate` and `surface_cache/resolve`.
    pub const RESOLVE_OFFSET: u64 = offset_of!(GpuFaceDispatch, resolve_groups) as u64;
    /// Byte in [`Self::dispatch`] of the workgroups of pass `surface_cache/lamps` in the next frame.
    pub const LAMPS_OFFSET: u64 = offset_of!(GpuFaceDispatch, lamp_groups) as u64;

    /// An empty table. Without final gather, it takes next to no memory. `told`: how kernels tell lamps apart whose power goes up and
    /// down.
    ///
    /// # Errors
    /// [`GpuError`] when the adapter cannot hold it.
    pub fn new(
        gpu: &Gpu,
        parameters: &ProbeParameters,
        told: RhythmsTold,
    ) -> Result<Self, GpuError> {
        let is_used = parameters.effective().final_gather == FinalGather::On;
        let buckets = if is_used { BUCKETS } else { 1 };
        let entries = FACINGS as u32 * (buckets + REACH - 1);
        let all = u64::from(entries);
        let most_listed = entries.min(MOST_LISTED);
        let listed = u64::from(most_listed);
        let most_batches = entries.min(MOST_BATCHES);
        let batches = u64::from(most_batches);
        let tells_lamps = told != RhythmsTold::None;
        let of_lamps = if tells_lamps { all } else { 1 };
        let bytes = all * (Self::ENTRY_BYTES + HISTORY_BYTES)
            + of_lamps * (SHARES_BYTES + GAIN_BYTES)
            + listed * (LISTED_BYTES + ESTIMATE_BYTES)
            + batches * (BATCH_BYTES + u64::from(FACE_RAYS) * RAY_BYTES)
            + REQUEST_LIST_BYTES;
        let what = "the faces of the final gather (probes.final_gather)";
        gpu.making(what, bytes, || {
            Ok(Self {
                is_used,
                tells_lamps,
                entries,
                most_listed,
                least_batches: if gpu.summary.is_software() {
                    LEAST_IN_SOFTWARE
                } else {
                    MOST_BATCHES
                },
                most_batches,
                info: gpu.uniform_buffer("face_info", &GpuSurfaceCacheInfo::default()),
                table: gpu.storage_buffer("face_table", all * Self::ENTRY_BYTES)?,
                counts: gpu.storage_buffer("face_counts", size_of::<GpuFaceCounts>() as u64)?,
                // Lists begin with a count.
                list: gpu.storage_buffer("face_list", (1 + listed) * LISTED_BYTES)?,
                batches: gpu.storage_buffer("face_batches", (1 + batches) * BATCH_BYTES)?,
                rays: gpu
                    .storage_buffer("face_rays", batches * u64::from(FACE_RAYS) * RAY_BYTES)?,
                estimates: gpu.storage_buffer("face_estimates", listed * ESTIMATE_BYTES)?,
                requested: gpu.storage_buffer("requested_faces", REQUEST_LIST_BYTES)?,
                histories: gpu.storage_buffer("face_histories", all * HISTORY_BYTES)?,
                shares: gpu.storage_buffer("face_shares", of_lamps * SHARES_BYTES)?,
                gains: gpu.storage_buffer("face_gains", of_lamps * GAIN_BYTES)?,
                dispatch: gpu
                    .storage_buffer("face_dispatch", size_of::<GpuFaceDispatch>() as u64)?,
            })
        })
    }

    /// Whether faces are lit on their own at all.
    pub fn is_used(&self) -> bool {
        self.is_used
    }

    /// Whether the light of faces is multiplied by gains, because lamps go up and down.
    pub fn has_gains(&self) -> bool {
        self.is_used && self.tells_lamps
    }

    /// Workgroups of this many threads, one thread per entry of the table.
    pub fn groups_of_entries(&self, threads: u32) -> [u32; 2] {
        rectangle(self.entries.div_ceil(threads))
    }

    /// Forgets all faces, as if the table were new.
    pub fn forget(&self, encoder: &mut wgpu::CommandEncoder) {
        for buffer in [&self.table, &self.histories, &self.counts, &self.requested] {
            encoder.clear_buffer(buffer, 0, None);
        }
    }

    /// Whether probes that were made `age` frames ago have settled after their warm-up.
    pub fn is_settled(parameters: &ProbeParameters, age: u32) -> bool {
        age >= parameters.warmup_frames + SETTLING_FRAMES
    }

    /// Writes the uniform of the next frame and empties the list. Must be called once before each submission that
    /// updates the faces: the writes take effect at the start of the submission.
    pub fn begin_frame(&self, gpu: &Gpu, parameters: &ProbeParameters, next: &NextFrame<'_>) {
        let NextFrame {
            size, age, changes, ..
        } = *next;
        let settled = Self::is_settled(parameters, age);
        let mut most_samples = parameters.face_samples as f32;
        if !settled {
            most_samples = most_samples.min(SAMPLES_WHILE_SETTLING);
        }
        // Frames of the table are numbered from 1.
        let frame = age + 1;
        // Until the probes have settled, light is not still.
        let still_frames = if settled { changes.still_frames() } else { 0 };
        let changed_frame = frame.saturating_sub(still_frames);
        let latest_edit = changes.latest_edit();
        let (low, high, edited_frame) = match latest_edit {
            Some((edit, shown_in)) => (
                edit.low_gs - EDIT_REACH,
                edit.high_gs + EDIT_REACH,
                shown_in + 1,
            ),
            None => Default::default(),
        };
        let is_edit_new = latest_edit.is_some_and(|(_, shown_in)| age < shown_in + REPEATED_FRAMES);
        let lamps_change = settled && changes.steady_frames() < REPEATED_FRAMES;
        // From face to face light makes one bounce in a frame, while from probe to probe it makes several.
        let by_probes = !settled || changes.repeats().is_light_ahead();
        let info = GpuSurfaceCacheInfo {
            edited_low_gs: low.to_array(),
            frame,
            edited_high_gs: high.to_array(),
            edited_frame,
            buckets: self.entries / FACINGS as u32 - (REACH - 1),
            most_batches: (self.batches_of(size) as f32 * parameters.face_share).ceil() as u32,
            rays_rows: self.rays_most(size)[1],
            resolve_rows: self.resolve_most(size)[1],
            most_samples,
            widest_pixel: parameters.face_pixels.recip(),
            seed: next.seed,
            changes_greatly: u32::from(changes.are_great(age)),
            stillness: changes.stillness(),
            changed_frame,
            edited_before: changes.edit_before().map_or(0, |shown_in| shown_in + 1),
            fresh_frames: if by_probes {
                0
            } else {
                fresh_frames(changes.frames_since_great(age))
            },
            repeats: u32::from(lamps_change && !is_edit_new),
            settled: u32::from(settled),
            most_step: if settled && !next.is_cut && changes.stillness() == 1.0 {
                STEP_WHILE_STILL
            } else {
                ANY_STEP
            },
            steadiness: next.steadiness,
            most_listed: self.most_listed,
            ..Default::default()
        };
        gpu.queue
            .write_buffer(&self.info, 0, bytemuck::bytes_of(&info));
        // Empties both lists.
        let none = [0; offset_of!(GpuFaceCounts, stretch)];
        gpu.queue.write_buffer(&self.counts, 0, &none);
    }

    /// Most batches of rays in a frame of `size` pixels.
    fn batches_of(&self, [width, height]: [u32; 2]) -> u32 {
        let share = width * height / PIXELS_A_BATCH;
        self.most_batches.min(share.max(self.least_batches))
    }

    /// Most workgroups of pass `surface_cache/trace` for pictures of `size` pixels.
    pub fn rays_most(&self, size: [u32; 2]) -> [u32; 2] {
        rectangle((self.batches_of(size) * FACE_RAYS).div_ceil(RAYS_A_GROUP))
    }

    /// Most workgroups of passes `surface_cache/estimate` and `surface_cache/resolve` for pictures of `size` pixels. One pixel of four lists its face in
    /// a frame, and rays request further faces. As if the list had room for all: with half the rows, workgroups of neighbouring faces
    /// run farther apart, and pass `surface_cache/lamps` takes 10 to 20 % longer.
    pub fn resolve_most(&self, [width, height]: [u32; 2]) -> [u32; 2] {
        let seen = width.div_ceil(2) * height.div_ceil(2);
        let listed = self.entries.min(seen + REQUEST_ROOM);
        rectangle(listed.div_ceil(FACES_A_GROUP))
    }

    /// Most workgroups of pass `surface_cache/lamps`: in as many rows.
    pub fn lamps_most(&self, size: [u32; 2]) -> [u32; 2] {
        let [columns, rows] = self.resolve_most(size);
        [columns * FACES_A_GROUP / LAMP_FACES_A_GROUP, rows]
    }

    /// Workgroups for the listed faces, as pass `surface_cache/allocate` writes them.
    pub fn dispatch(&self) -> &wgpu::Buffer {
        &self.dispatch
    }

    /// The constant of kernels that shade what the camera sees.
    pub fn constants(&self) -> [(&'static str, f64); 1] {
        [("FINAL_GATHER", f64::from(u8::from(self.is_used)))]
    }

    /// The bindings of `shaders/surface_cache/table.wesl`: what kernels that look up a face's light read.
    pub fn resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 3] {
        [
            ("face_info", self.info.as_entire_binding()),
            ("face_table", self.table.as_entire_binding()),
            ("face_gains", self.gains.as_entire_binding()),
        ]
    }

    /// All that the passes that light faces read and write.
    pub fn update_resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 18] {
        let of = wgpu::Buffer::as_entire_binding;
        [
            ("face_info", of(&self.info)),
            // One buffer: read, read and written by many threads at once, and written by the owner of an entry.
            ("face_table", of(&self.table)),
            ("face_table_atomic", of(&self.table)),
            ("face_table_out", of(&self.table)),
            ("face_counts", of(&self.counts)),
            ("face_list_out", of(&self.list)),
            ("face_list", of(&self.list)),
            ("face_batches_out", of(&self.batches)),
            ("face_batches", of(&self.batches)),
            ("face_histories", of(&self.histories)),
            ("face_dispatch", of(&self.dispatch)),
            // Passes `surface_cache/trace` and `surface_cache/body_light` write these.
            ("face_rays", of(&self.rays)),
            ("requested_faces", of(&self.requested)),
            ("face_estimates_out", of(&self.estimates)),
            ("face_estimates", of(&self.estimates)),
            ("face_shares", of(&self.shares)),
            ("face_shares_out", of(&self.shares)),
            ("face_gains_out", of(&self.gains)),
        ]
    }

    /// Where pass `surface_cache/trace` writes.
    pub fn rays(&self) -> &wgpu::Buffer {
        &self.rays
    }

    /// How many faces the last frame listed.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn listed(&self, gpu: &Gpu) -> Result<u32, GpuError> {
        let counts: Vec<GpuFaceCounts> = gpu.read_buffer(&self.counts)?;
        Ok(counts[0].listed.min(self.most_listed))
    }

    /// How many rays faces sent in the last frame.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn rays_sent(&self, gpu: &Gpu) -> Result<u64, GpuError> {
        let count: Vec<u32> = gpu.read_buffer_range(&self.batches, 0, 4)?;
        Ok(u64::from(count[0]) * u64::from(FACE_RAYS))
    }

    /// The [`GpuFaceHistory`] of every entry.
    pub fn histories(&self) -> &wgpu::Buffer {
        &self.histories
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        let buffers = [
            &self.table,
            &self.list,
            &self.batches,
            &self.rays,
            &self.estimates,
            &self.requested,
            &self.histories,
            &self.shares,
            &self.gains,
        ];
        buffers.iter().map(|buffer| buffer.size()).sum()
    }
}

/// How old the light of a face may be that rays take while light changes. `since_great`: frames since the last great change;
/// what a face found before it tells nothing of the light after it.
fn fresh_frames(since_great: Option<u32>) -> u32 {
    since_great.map_or(FRESH_FRAMES, |since| {
        (since / 4).clamp(FRESH_AT_FIRST.min(since), FRESH_FRAMES)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_from_before_a_great_change_is_never_fresh() {
        assert_eq!(fresh_frames(None), 8, "lamps that glide");
        let ages = [0, 1, 4, 15, 24, 32, 1000].map(|since| fresh_frames(Some(since)));
        assert_eq!(ages, [0, 1, 4, 4, 6, 8, 8]);
        assert!((0..100).all(|since| fresh_frames(Some(since)) <= since));
    }
}
