//! Bodies as records on the GPU, and where they are in a pose.

use glam::{Mat3, UVec3, Vec3};

use super::{
    body_supports::Supports,
    hierarchy::{Bounds, Node},
};
use crate::world::bodies::{Body, Pose};

crate::shared! {
    in scene;

    /// A node of the hierarchy of boxes around the bodies.
    pub struct GpuBodyNode as BodyNode {
        /// The box (world space).
        pub low_ws: [f32; 3],
        /// The node that comes next for rays that miss the box.
        pub skip: u32,
        pub high_ws: [f32; 3],
        /// The body in the box; NO_BODY where there are several.
        pub body: u32,
    }

    /// A body: where it is, and where its model lies in the buffer.
    pub struct GpuBody as Body {
        /// The axes of the model in world space: unit vectors.
        pub axis_x: [f32; 3],
        /// Index of the vector with the masks of the first two blocks of the model.
        pub masks_at: u32,
        pub axis_y: [f32; 3],
        /// Its number in the hierarchy.
        pub node: u32,
        pub axis_z: [f32; 3],
        /// Blocks of 4³ voxels along each axis, 8 bits each; then log2 of the cells along each axis around the body, and of
        /// the voxels along such a cell, 4 bits each.
        pub blocks: u32,
        /// The pivot, in world space and in model space.
        pub position_ws: [f32; 3],
        /// Number of the first fact about the light of its faces.
        pub first_lit: u32,
        pub pivot: [f32; 3],
        /// Number of the first fact about the cells around it.
        pub first_near: u32,
    }

    use size_of::<GpuBodyNode>() / 16 => NODE_VECTORS: usize;
    use size_of::<GpuBody>() / 16 => BODY_VECTORS: usize;
}

const NO_BODY: u32 = u32::MAX;
/// Boxes are larger than their bodies by this many voxels, and by this share of their distance from the origin, so that
/// rounding does not cut off corners.
const MARGIN: f32 = 1e-3;
const MARGIN_SHARE: f32 = 1e-6;

/// What does not change of a body.
pub struct Placed {
    /// With the pose at rest.
    pub record: GpuBody,
    pub body: Body,
    /// Around the solid voxels (model space).
    pub solid: Bounds,
    pub supports: Supports,
}

impl Placed {
    fn at(&self, pose: &Pose) -> GpuBody {
        let [axis_x, axis_y, axis_z] =
            Mat3::from_quat(pose.rotation.normalize()).to_cols_array_2d();
        GpuBody {
            axis_x,
            axis_y,
            axis_z,
            position_ws: pose.position.to_array(),
            ..self.record
        }
    }

    /// The box around the body in world space.
    pub fn bounds(&self, pose: &Pose) -> Bounds {
        let turn = Mat3::from_quat(pose.rotation.normalize());
        let Bounds { low, high } = self.supports.bounds(turn, self.body.pivot);
        let away = pose.position.abs() + self.body.pivot.length();
        let margin = MARGIN + MARGIN_SHARE * away;
        Bounds {
            low: pose.position + low - margin,
            high: pose.position + high + margin,
        }
    }

    /// The farthest that a corner of the body has moved from one pose to another (voxels).
    pub fn way(&self, before: &Pose, now: &Pose) -> f32 {
        if before == now {
            return 0.0;
        }
        let place =
            |pose: &Pose, corner: Vec3| pose.position + pose.rotation * (corner - self.body.pivot);
        (0..8)
            .map(|number| {
                let far = UVec3::new(number, number >> 1, number >> 2) & 1;
                let corner = Vec3::select(far.cmpeq(UVec3::ONE), self.solid.high, self.solid.low);
                place(before, corner).distance(place(now, corner))
            })
            .fold(0.0, f32::max)
    }
}

impl From<Node> for GpuBodyNode {
    fn from(node: Node) -> Self {
        Self {
            low_ws: node.bounds.low.to_array(),
            skip: node.skip,
            high_ws: node.bounds.high.to_array(),
            body: node.item().unwrap_or(NO_BODY),
        }
    }
}

/// Every body in its pose. `nodes` is the hierarchy around them; without one, no ray looks for a body alone.
pub fn records(placed: &[Placed], poses: &[Pose], nodes: &[Node]) -> Vec<GpuBody> {
    let pairs = placed.iter().zip(poses);
    let mut all: Vec<GpuBody> = pairs.map(|(body, pose)| body.at(pose)).collect();
    for (number, node) in nodes.iter().enumerate() {
        if let Some(body) = node.item() {
            all[body as usize].node = number as u32;
        }
    }
    all
}
