//! What the passes of the surface cache and their shaders both know.

crate::shared! {
    in surface_cache;

    /// What passes know of the table and of the frame.
    pub struct GpuSurfaceCacheInfo as FaceInfo {
        /// Corners of the box of voxels whose light an edit has changed most (grid space).
        pub edited_low_gs: [f32; 3],
        /// Since the table was made, from 1.
        pub frame: u32,
        pub edited_high_gs: [f32; 3],
        /// The frame of that edit; 0: none yet.
        pub edited_frame: u32,
        /// Places for faces that look the same way, less 1: a power of two less 1.
        pub bucket_mask: u32,
        /// Most batches of rays that faces send in a frame, and rows of workgroups of the passes over them.
        pub most_batches: u32,
        pub rays_rows: u32,
        pub blend_rows: u32,
        /// Rays that the light of a quadrant of a face is at most the mean of.
        pub most_samples: f32,
        /// Width of a pixel (voxels) from which faces are too small to be lit on their own.
        pub widest_pixel: f32,
        pub seed: u32,
        /// How sure it is that light changes now, from 0 to 1.
        pub alert: f32,
        /// How sure it is that light has not changed for long, from 0 to 1.
        pub stillness: f32,
        /// The last frame in which light was not still: what was known before it is out of date.
        pub changed_frame: u32,
        /// The frame of the edit before that of `edited_frame`; 0: none yet.
        pub edited_before: u32,
        pub _pad: u32,
    }

    /// Words of an entry of the table.
    pub(super) const ENTRY_WORDS: u32 = 20;

    /// Rays of a quadrant of a face in a batch; those of a batch lie one quadrant after the other.
    pub(super) const QUADRANT_RAYS: u32 = 8;

    /// Rays of a batch.
    pub(super) const FACE_RAYS: u32 = 4 * QUADRANT_RAYS;

    /// Threads of a workgroup of pass `surface_cache/trace`.
    pub(super) const RAYS_A_GROUP: u32 = 64;

    /// Faces of a workgroup of pass `surface_cache/resolve`.
    pub(super) const FACES_A_GROUP: u32 = 16;

    /// What is counted while faces are listed, and what follows from it for the next frame.
    pub(super) struct GpuFaceCounts as FaceCounts {
        /// Faces on the list.
        pub(super) listed: u32 => "atomic<u32>",
        /// Batches of rays that they ask for.
        pub(super) batches: u32 => "atomic<u32>",
        /// By how much the intervals between these are stretched, so that those of a frame fit their buffer; 0: not yet
        /// known.
        pub(super) stretch: u32 => "atomic<u32>",
        /// The interval of faces that have settled.
        pub(super) calm: u32 => "atomic<u32>",
    }

    /// Workgroups that the listed faces take.
    pub(super) struct GpuFaceDispatch as FaceDispatch {
        /// Of pass `surface_cache/trace`.
        pub(super) ray_groups: [u32; 3],
        pub(super) _pad0: u32,
        /// Of pass `surface_cache/resolve`.
        pub(super) resolve_groups: [u32; 3],
        pub(super) _pad1: u32,
    }

    /// Room for faces that rays ask for: twice as many as may, for they do so by chance.
    pub(super) const REQUEST_ROOM: u32 = 4096;

    /// Of those the faces of a workgroup.
    pub(super) const REQUESTS_A_GROUP: u32 = 64;

    /// A face of the list of a frame.
    pub(super) struct GpuListedFace as ListedFace {
        /// In the table.
        pub entry: u32,
        pub key: u32,
        /// Its batches of rays, which lie one after the other: none in most frames.
        pub first_batch: u32,
        pub batches: u32,
        /// What is known of its light counts as the mean of so many rays at most; 0 for a new face.
        pub known: f32,
        /// Whether a pixel sees it (1) or rays of other faces have asked for it (0).
        pub is_seen: u32,
    }

    /// Rays that a face sends side by side: `QUADRANT_RAYS` of each quadrant.
    pub(super) struct GpuFaceBatch as FaceBatch {
        pub entry: u32,
        pub key: u32,
        /// Number of the first of each quadrant.
        pub first_ray: u32,
    }

    /// A quadrant of a face.
    pub struct GpuFaceQuadrant as FaceQuadrant {
        /// Mean radiance, weighted by the cosine: irradiance over π (linear RGB).
        pub light: [f32; 3],
        /// Rays that it is the mean of.
        pub samples: f32,
        /// What the probes believed of it, as a mean over the same frames.
        pub by_probes: [f32; 3],
        /// Mean square of by how much their belief departs from that mean, relative to it: their noise.
        pub noise: f32,
    }

    /// What the rays of a face have found so far.
    pub struct GpuFaceHistory as FaceHistory {
        /// See package::surface_cache::quadrant.
        pub quadrants: [GpuFaceQuadrant; 4],
        pub key: u32,
        /// Rays that each quadrant has had in all.
        pub drawn: u32,
        /// The frame in which it last had any.
        pub updated: u32,
        /// Variance of what one ray finds, relative to the face's light.
        pub spread: f32,
    }

    /// A face that a ray has hit.
    pub(super) struct GpuRequestedFace as RequestedFace {
        pub key: u32,
        pub face: u32,
    }
}
