//! Structs and constants that the passes of the surface cache share with their shaders.

crate::shared! {
    in surface_cache;

    /// What passes know about the table and the frame.
    pub struct GpuSurfaceCacheInfo as FaceInfo {
        /// Low corner of the box around the latest edit whose light changed most (grid space); `edited_high_gs` is the
        /// high corner.
        pub edited_low_gs: [f32; 3],
        /// Frames since the table was made, from 1.
        pub frame: u32,
        pub edited_high_gs: [f32; 3],
        /// The frame of the latest edit; 0: none yet.
        pub edited_frame: u32,
        /// Buckets where faces of one direction are first looked for, at most 65 536: those behind the last have room for REACH − 1
        /// more.
        pub buckets: u32,
        /// Most batches of rays that faces send in a frame. `rays_rows` and `resolve_rows` are the rows of workgroups
        /// of the passes over rays and over faces.
        pub most_batches: u32,
        pub rays_rows: u32,
        pub resolve_rows: u32,
        /// Most rays whose mean is the light of a quadrant of a face.
        pub most_samples: f32,
        /// Width of a pixel (voxels) from which faces are too small to be lit on their own.
        pub widest_pixel: f32,
        pub seed: u32,
        /// 1: light changes greatly now, as after a switch or an edit.
        pub changes_greatly: u32,
        /// Certainty that light has not changed for long, 0 to 1.
        pub stillness: f32,
        /// The last frame in which light was not still: light found before that frame is out of date.
        pub changed_frame: u32,
        /// The frame of the edit before that of `edited_frame`; 0: none yet.
        pub edited_before: u32,
        /// Light of faces that is at most this many frames old is up to date, even if light changes.
        pub fresh_frames: u32,
        /// 1: lamps or bodies move or have changed, so rays are repeated.
        pub repeats: u32,
        /// 0: the probes are new, and their light still rises from frame to frame.
        pub settled: u32,
        /// Most by which the light that a face shows changes in a frame, relative to the brighter of the two; from 1 on by any
        /// amount.
        pub most_step: f32,
        /// How steadily the power of lamps rises or falls, 0 to 1.
        pub steadiness: f32,
        /// Most faces that a frame lists.
        pub most_listed: u32,
        pub _pad: [u32; 3],
    }

    /// A face is in one of so many consecutive buckets.
    pub(super) const REACH: u32 = 8;

    /// Words of an entry of the table.
    pub(super) const ENTRY_WORDS: u32 = 48;

    /// Rays of a quadrant of a face in a batch. The rays of a batch are stored quadrant by quadrant.
    pub(super) const QUADRANT_RAYS: u32 = 8;

    /// Rays of a batch.
    pub(super) const FACE_RAYS: u32 = 4 * QUADRANT_RAYS;

    /// Threads of a workgroup of pass `surface_cache/trace`.
    pub(super) const RAYS_A_GROUP: u32 = 64;

    /// Faces per workgroup of passes `surface_cache/estimate` and `surface_cache/resolve`.
    pub(super) const FACES_A_GROUP: u32 = 16;

    /// Faces per workgroup of pass `surface_cache/lamps`, and the crews of four threads that each face has.
    pub(super) const LAMP_FACES_A_GROUP: u32 = 2;
    pub(super) const LAMP_CREWS: u32 = 8;

    /// Which shares of a face's light come from lamps that have rhythms: see package::surface_cache::shares.
    pub(super) struct GpuFaceShares as FaceShares {
        /// See package::light::rhythms::packed_shares.
        pub packed: [u32; 3] => "array<u32, 3>",
    }

    /// Cells among which a workgroup of pass `surface_cache/cell_shadows` looks for those that are seen.
    pub(super) const CELLS_A_GROUP: u32 = 16;

    /// Counts of the listed faces, and what follows from the counts for the next frame.
    pub(super) struct GpuFaceCounts as FaceCounts {
        /// Faces on the list.
        pub(super) listed: u32 => "atomic<u32>",
        /// Batches of rays that the listed faces request.
        pub(super) batches: u32 => "atomic<u32>",
        /// Crews of workgroups of pass `surface_cache/allocate` that have come to their end.
        pub(super) finished_crews: u32 => "atomic<u32>",
        /// Factor by which the intervals between batches of a face are stretched, so that the batches of a frame
        /// fit their buffer; 0: not yet known.
        pub(super) stretch: u32 => "atomic<u32>",
        /// Frames from batch to batch of faces that take turns.
        pub(super) turn_interval: u32 => "atomic<u32>",
        /// 1: the list had no room for all faces.
        pub(super) overflowed: u32 => "atomic<u32>",
    }

    /// Crews into which the workgroups of pass `surface_cache/allocate` are divided, and words of a crew's counter: a cache line.
    pub(super) const CREWS: u32 = 64;
    pub(super) const CREW_WORDS: u32 = 32;

    /// Workgroups for the listed faces.
    pub(super) struct GpuFaceDispatch as FaceDispatch {
        /// Of pass `surface_cache/trace`.
        pub(super) ray_groups: [u32; 3],
        pub(super) _pad0: u32,
        /// Of passes `surface_cache/estimate` and `surface_cache/resolve`.
        pub(super) resolve_groups: [u32; 3],
        pub(super) _pad1: u32,
        /// Of pass `surface_cache/lamps` in the next frame.
        pub(super) lamp_groups: [u32; 3],
        pub(super) _pad2: u32,
    }

    /// Room for the faces that rays request: twice the expected number of requests, because rays request at random.
    pub(super) const REQUEST_ROOM: u32 = 4096;

    /// Most faces that rays of bodies request in a frame.
    pub(super) const BODY_REQUESTS: u32 = 512;

    /// A face of the list of a frame.
    pub(super) struct GpuListedFace as ListedFace {
        /// Index in the table.
        pub entry: u32,
        pub key: u32,
        /// The face's batches of rays, which are contiguous; `batches` is 0 in most frames.
        pub first_batch: u32,
        pub batches: u32,
        /// Most rays that the known light of the face counts as the mean of; 0 for a new face.
        pub known: f32,
        /// Whether a pixel sees the face (1) or rays of other faces have requested it (0).
        pub is_seen: u32,
        /// How many of the batches, the first ones, the face has sent before, in its last update.
        pub repeated: u32,
    }

    /// The probes' estimate of the light of a listed face.
    pub(super) struct GpuFaceEstimate as FaceEstimate {
        /// Of each quadrant: three half floats.
        pub quadrants: [[u32; 2]; 4],
    }

    /// Rays that a face sends together: `QUADRANT_RAYS` of each quadrant.
    pub(super) struct GpuFaceBatch as FaceBatch {
        pub entry: u32,
        pub key: u32,
        /// Number of the first ray of each quadrant.
        pub first_ray: u32,
    }

    /// A quadrant of a face.
    pub struct GpuFaceQuadrant as FaceQuadrant {
        /// Mean radiance, weighted by the cosine: irradiance over π (linear RGB).
        pub light: [f32; 3],
        /// Rays whose mean `light` is.
        pub samples: f32,
        /// The probes' estimate of `light`: as a mean over the same frames, or where rays were repeated that of the last update.
        pub by_probes: [f32; 3],
        /// Mean of the rays that the next update may repeat, over the change of the probes' estimate from `by_probes` to when
        /// they were sent: see package::light::packed_radiance.
        pub last_found: u32,
    }

    /// What the rays of a face have found so far.
    pub struct GpuFaceHistory as FaceHistory {
        /// See package::surface_cache::quadrant.
        pub quadrants: [GpuFaceQuadrant; 4],
        pub key: u32,
        /// Rays that each quadrant has sent in all.
        pub drawn: u32,
        /// The last frame in which the face sent rays.
        pub updated: u32,
        /// Variance of the radiance of a single ray, relative to the face's light.
        pub spread: f32,
        /// Variance of how much the mean of repeated rays has changed, relative to the face's light.
        pub change_spread: f32,
        /// Batches of rays that the next update may repeat.
        pub last_batches: u32,
        /// By how much its light changes in a frame: see package::surface_cache::trend.
        pub trend: [u32; 2],
    }

    /// A face that a ray has hit.
    pub(super) struct GpuRequestedFace as RequestedFace {
        pub key: u32,
        pub face: u32,
    }
}
