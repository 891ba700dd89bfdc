//! Rigid bodies of voxels that move: a door that swings, a lift, a mill wheel. A body has its own small grid of voxels
//! (its model), which a pose carries into the world; rays march through it in its own space.

use glam::{Quat, UVec3, Vec3};

/// Most voxels along an edge of a model.
pub const MAX_BODY_EDGE: u32 = 64;

/// Most bodies in a world.
pub const MAX_BODIES: usize = 4096;

/// The voxels of a body, shared by all bodies of the same shape.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BodyModel {
    /// Extent in voxels, each 1 … [`MAX_BODY_EDGE`].
    pub size: UVec3,
    /// A material of the world (1-based) for each voxel, 0 for air; x runs fastest, then y, then z.
    pub materials: Vec<u8>,
}

/// A body as the world file gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    pub name: String,
    /// Index in [`Bodies::models`].
    pub model: usize,
    /// The point of the model (model space: voxels from its lowest corner) about which it turns.
    pub pivot: Vec3,
    /// Where the pivot is and how the body is turned before its motion.
    pub rest: Pose,
}

/// Where a body is at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The pivot in world space.
    pub position: Vec3,
    /// Turns model space into world space.
    pub rotation: Quat,
}

/// All bodies of a world; a pose of each, in the same order, says where they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bodies {
    pub models: Vec<BodyModel>,
    pub bodies: Vec<Body>,
}

impl Bodies {
    /// Where all bodies are at a world time (seconds).
    pub fn poses(&self, time: f64) -> Vec<Pose> {
        let _ = time;
        self.bodies.iter().map(|body| body.rest).collect()
    }
}
