//! The bodies on the GPU as the CPU knows them: which there are, and where they are.

use super::{body_emitters::GpuGlowingBody, body_records::Placed, hierarchy::Bounds};
use crate::world::bodies::Pose;

/// All bodies, and where they are.
pub struct Poses {
    pub placed: Vec<Placed>,
    /// Faces with stored light of all bodies, and most of a body.
    pub lit_faces: u32,
    pub most_lit_faces: u32,
    /// Most cells around a body.
    pub most_near_cells: u32,
    /// The bodies that have emissive faces.
    pub glowing: Vec<GpuGlowingBody>,
    /// Whether any body ever moves by itself.
    pub move_at_all: bool,
    /// World time of `now` (seconds).
    pub time_s: f64,
    pub now: Vec<Pose>,
    /// The box around each body now, in world space.
    pub boxes: Vec<Bounds>,
    /// As the last frame showed them; `None` before the first frame.
    pub shown: Option<Vec<Pose>>,
    /// Whether the poses that kernels know as those before (`bodies_before`) are not those of the last frame.
    pub is_before_old: bool,
    /// Whether there are others than in the last frame.
    pub are_others: bool,
    /// How often they have changed.
    pub version: u64,
}

impl Poses {
    /// No bodies, at time 0.
    pub fn none() -> Self {
        Self {
            placed: Vec::new(),
            lit_faces: 0,
            most_lit_faces: 0,
            most_near_cells: 0,
            glowing: Vec::new(),
            move_at_all: false,
            time_s: 0.0,
            shown: None,
            now: Vec::new(),
            boxes: Vec::new(),
            is_before_old: true,
            are_others: false,
            version: 0,
        }
    }

    /// The farthest way of any point of a body from these poses to those of now (voxels).
    pub fn farthest_since(&self, before: &[Pose]) -> f32 {
        let pairs = before.iter().zip(&self.now).zip(&self.placed);
        pairs
            .map(|((before, now), placed)| placed.way(before, now))
            .fold(0.0, f32::max)
    }
}
