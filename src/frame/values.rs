//! What goes from pass to pass in a frame.

use super::antialias::Smoothing;
use crate::passes::view::Inspection;

/// Which of the passes that are made only when they are requested.
#[derive(Clone, Copy, Default)]
pub(super) struct Wanted {
    pub inspection: Inspection,
    pub smoothing: Smoothing,
    pub bits: bool,
}

/// What must be brought up to date in a frame.
#[derive(Clone, Copy)]
pub(super) struct Update {
    /// Lamps have moved: pass `scene/lamp_lists` must run.
    pub lists_lamps: bool,
    /// Lamps have moved, voxels were edited, or it is the turn of new cells: pass `surface_cache/cell_shadows` must run.
    pub examines_shadows: bool,
    /// Pass `probes/classify` and the passes after it must run.
    pub places_probes: bool,
    /// Visibility bits tell which surfaces each probe sees.
    pub marks_visibility: bool,
    /// Bodies have moved: pass `probes/cover` must run.
    pub moves_bodies: bool,
    /// The same, or nothing is known of them yet: pass `surface_cache/body_cells` must run.
    pub finds_body_cells: bool,
    /// Bodies may hide other lamps than before: pass `surface_cache/body_shafts` must run.
    pub finds_shafts: bool,
    /// A volume that follows the camera has probes that are new.
    pub has_fresh: bool,
    /// Faces may not know which lamps they see: pass `surface_cache/lamps` must run.
    pub asks_faces: bool,
    /// Light changes greatly and probes have settled: faces wait for the light of probes in this frame.
    pub follows_change: bool,
    /// Faces compare their light with that of the probes in the frame before, while the rays of this frame are traced.
    pub estimates_early: bool,
    /// The same, and the picture is lit by the light of the frame before, while the rays of this frame are traced.
    pub shades_early: bool,
    /// Where faces wait: updates of probes in this frame, at least one. So many bounces does light make.
    pub bounces: u32,
}

/// How a picture is drawn.
#[derive(Clone, Copy)]
pub(super) struct Drawn {
    /// Width and height in pixels of what is rendered.
    pub size: [u32; 2],
    /// First column and row of the tiles that may show bodies, and how many of each.
    pub body_tiles: [u32; 4],
    /// Index of the anti-aliased picture, of the frame's size, that is written and shown; `None` shows the picture as it
    /// is shaded.
    pub smoothed: Option<usize>,
    /// Pass `view/shade` shows the picture: nothing is drawn over it, nor is it anti-aliased or shaded early.
    pub is_finished: bool,
}

// Values of a frame. Their data lies in the buffers and textures that the passes bind by name.

/// Which probes are alive, and where they are.
pub(super) struct ClassifiedProbes;
/// Which surfaces each probe sees.
pub(super) struct SightedProbes;
pub(super) struct PlacedProbes;
pub(super) struct ActiveList;
pub(super) struct ProbeRays;
/// Maps and ambient cubes of the probes.
pub(super) struct ProbeLight;
/// Voxel, face and distance of each pixel.
pub(super) struct Surfaces;
pub(super) struct ListedFaces;
pub(super) struct FaceRays;
/// The light of the listed faces, as the probes tell it.
pub(super) struct FaceEstimates;
/// For each listed face, the irradiance of each quadrant.
pub(super) struct FaceLight;
/// Linear HDR radiance of each pixel.
pub(super) struct Radiance;
