//! Rigid bodies on the GPU: their models, once, and where they are, whenever that changes.

use std::sync::{Arc, Mutex, MutexGuard};

use glam::{Mat3, UVec3, Vec3};

use super::hierarchy::{Bounds, Node, hierarchy};
use crate::{
    gpu::{Gpu, GpuError},
    world::bodies::{Bodies, Body, BodyModel, Pose},
};

crate::shared! {
    in scene;

    /// A node of the hierarchy of boxes around the bodies.
    struct GpuBodyNode as BodyNode {
        /// The box (world space).
        low_ws: [f32; 3],
        /// The node that comes next for rays that miss the box.
        skip: u32,
        high_ws: [f32; 3],
        /// The body in the box; NO_BODY where there are several.
        body: u32,
    }

    /// A body: where it is, and where its model lies in the buffer.
    struct GpuBody as Body {
        /// The axes of the model in world space: unit vectors.
        axis_x: [f32; 3],
        /// Index of the vector with the masks of the first two blocks of the model.
        masks_at: u32,
        axis_y: [f32; 3],
        /// Index of the vector with the materials of the first 16 voxels.
        materials_at: u32,
        axis_z: [f32; 3],
        /// Blocks of 4³ voxels along each axis, 8 bits each.
        blocks: u32,
        /// The pivot, in world space and in model space.
        position_ws: [f32; 3],
        _pad0: u32,
        pivot: [f32; 3],
        _pad1: u32,
    }

    use size_of::<GpuBodyNode>() / 16 => NODE_VECTORS: usize;
    use size_of::<GpuBody>() / 16 => BODY_VECTORS: usize;
}

/// Edge of a block in voxels.
const BLOCK: u32 = 4;
const NO_BODY: u32 = u32::MAX;
/// Boxes are larger than their bodies by this many voxels, and by this share of their distance from the origin, so that
/// rounding does not cut off corners.
const MARGIN: f32 = 1e-3;
const MARGIN_SHARE: f32 = 1e-6;

/// The binding of `shaders/scene/bodies.wesl`. A clone is another handle to the same bodies.
#[derive(Clone)]
pub struct GpuBodies {
    buffer: wgpu::Buffer,
    /// The bodies as the frame before showed them, without hierarchy and models.
    before: wgpu::Buffer,
    placed: Arc<[Placed]>,
    /// Whether any body ever moves.
    move_at_all: bool,
    poses: Arc<Mutex<Poses>>,
}

/// What does not change of a body.
struct Placed {
    /// With the pose at rest.
    record: GpuBody,
    body: Body,
    /// Around the solid voxels (model space).
    solid: Bounds,
}

struct Poses {
    /// World time of `now` (seconds).
    time_s: f64,
    now: Vec<Pose>,
    /// As the last frame showed them; `None` before the first frame.
    shown: Option<Vec<Pose>>,
    /// Whether `before` differs from the poses of the last frame.
    is_before_old: bool,
    /// How often they have changed.
    version: u64,
}

impl GpuBodies {
    /// For a world without bodies.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn none(gpu: &Gpu) -> Result<Self, GpuError> {
        Self::upload(gpu, &Bodies::default())
    }

    /// All bodies where they are at time 0.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn upload(gpu: &Gpu, bodies: &Bodies) -> Result<Self, GpuError> {
        let count = bodies.bodies.len();
        let first_model = moving_vectors(count);
        let mut models = Vec::<[u32; 4]>::new();
        let places: Vec<_> = bodies
            .models
            .iter()
            .map(|model| {
                let masks_at = first_model + models.len();
                models.extend(masks(model));
                let materials_at = first_model + models.len();
                models.extend(materials(model));
                (masks_at as u32, materials_at as u32, solid(model))
            })
            .collect();
        let bytes = (first_model + models.len()) * size_of::<[u32; 4]>();
        let (buffer, before) = gpu.making("the bodies", bytes as u64, || {
            let buffer = gpu.storage_buffer("bodies", bytes as u64)?;
            let records = count.max(1) * size_of::<GpuBody>();
            let before = gpu.storage_buffer("bodies_before", records as u64)?;
            Ok::<_, GpuError>((buffer, before))
        })?;
        let at = (first_model * size_of::<[u32; 4]>()) as u64;
        gpu.queue
            .write_buffer(&buffer, at, bytemuck::cast_slice(&models));
        let placed = bodies.bodies.iter().map(|body| {
            let (masks_at, materials_at, solid) = places[body.model];
            let blocks = blocks_of(bodies.models[body.model].size);
            Placed {
                record: GpuBody {
                    masks_at,
                    materials_at,
                    blocks: blocks.x | blocks.y << 8 | blocks.z << 16,
                    pivot: body.pivot.to_array(),
                    ..GpuBody::default()
                },
                body: body.clone(),
                solid,
            }
        });
        let now = bodies.poses(0.0);
        let all = Self {
            buffer,
            before,
            placed: placed.collect(),
            move_at_all: bodies.bodies.iter().any(|body| !body.is_still()),
            poses: Arc::new(Mutex::new(Poses {
                time_s: 0.0,
                shown: None,
                now,
                is_before_old: true,
                version: 0,
            })),
        };
        all.write(gpu, &all.poses().now);
        Ok(all)
    }

    /// Whether there are any.
    pub fn exist(&self) -> bool {
        !self.placed.is_empty()
    }

    /// The constant of kernels that are made for these bodies.
    pub fn constants(&self) -> [(&'static str, f64); 1] {
        [("BODIES", f64::from(u8::from(self.exist())))]
    }

    /// Moves the bodies to where they are at a world time (seconds). Where nothing moves, this costs nothing.
    pub fn set_time(&self, gpu: &Gpu, time_s: f64) {
        let mut poses = self.poses();
        if !self.move_at_all || poses.time_s == time_s {
            return;
        }
        poses.time_s = time_s;
        let now: Vec<Pose> = self
            .placed
            .iter()
            .map(|placed| placed.body.pose(time_s))
            .collect();
        if poses.now != now {
            self.write(gpu, &now);
            poses.now = now;
            poses.version += 1;
        }
    }

    /// How often the bodies have been moved.
    pub fn version(&self) -> u64 {
        self.poses().version
    }

    /// Begins a frame with the poses as they are now, and returns the farthest way of any point of a body since the last
    /// frame (voxels).
    pub fn begin_frame(&self, gpu: &Gpu) -> f32 {
        let mut poses = self.poses();
        let shown = poses.shown.take().unwrap_or_else(|| poses.now.clone());
        let pairs = shown.iter().zip(&poses.now).zip(self.placed.iter());
        let farthest = pairs
            .map(|((before, now), placed)| placed.way(before, now))
            .fold(0.0, f32::max);
        if farthest > 0.0 || poses.is_before_old {
            let records = self.records(&shown);
            gpu.queue
                .write_buffer(&self.before, 0, bytemuck::cast_slice(&records));
            poses.is_before_old = farthest > 0.0;
            poses.shown = Some(poses.now.clone());
        } else {
            poses.shown = Some(shown);
        }
        farthest
    }

    /// What the shaders bind by name.
    pub fn resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 2] {
        [
            ("bodies", self.buffer.as_entire_binding()),
            ("bodies_before", self.before.as_entire_binding()),
        ]
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.buffer.size() + self.before.size()
    }

    fn poses(&self) -> MutexGuard<'_, Poses> {
        self.poses.lock().expect("nobody panics holding it")
    }

    fn records(&self, poses: &[Pose]) -> Vec<GpuBody> {
        let pairs = self.placed.iter().zip(poses);
        pairs.map(|(body, pose)| body.at(pose)).collect()
    }

    /// Writes the part that changes when bodies move.
    fn write(&self, gpu: &Gpu, poses: &[Pose]) {
        let boxes: Vec<Bounds> = self
            .placed
            .iter()
            .zip(poses)
            .map(|(body, pose)| body.bounds(pose))
            .collect();
        let nodes: Vec<GpuBodyNode> = hierarchy(&boxes)
            .into_iter()
            .map(GpuBodyNode::from)
            .collect();
        let first_body = 1 + nodes.len() * (size_of::<GpuBodyNode>() / 16);
        let head = [nodes.len() as u32, first_body as u32, 0, 0];
        let mut bytes = bytemuck::bytes_of(&head).to_vec();
        bytes.extend_from_slice(bytemuck::cast_slice(&nodes));
        bytes.extend_from_slice(bytemuck::cast_slice(&self.records(poses)));
        gpu.queue.write_buffer(&self.buffer, 0, &bytes);
    }
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
    fn bounds(&self, pose: &Pose) -> Bounds {
        let turn = Mat3::from_quat(pose.rotation.normalize());
        let middle =
            pose.position + turn * ((self.solid.low + self.solid.high) / 2.0 - self.body.pivot);
        let half = (self.solid.high - self.solid.low) / 2.0;
        let reach =
            turn.x_axis.abs() * half.x + turn.y_axis.abs() * half.y + turn.z_axis.abs() * half.z;
        let reach = reach + MARGIN + MARGIN_SHARE * middle.abs();
        Bounds {
            low: middle - reach,
            high: middle + reach,
        }
    }

    /// The farthest that a corner of the body has moved from one pose to another (voxels).
    fn way(&self, before: &Pose, now: &Pose) -> f32 {
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
            body: node.item.unwrap_or(NO_BODY),
        }
    }
}

/// Vectors of the head, the nodes and the bodies.
fn moving_vectors(bodies: usize) -> usize {
    let nodes = (2 * bodies).saturating_sub(1);
    1 + (nodes * size_of::<GpuBodyNode>() + bodies * size_of::<GpuBody>()) / size_of::<[u32; 4]>()
}

fn blocks_of(size: UVec3) -> UVec3 {
    size.map(|edge| edge.div_ceil(BLOCK))
}

/// The material of a voxel, 0 beyond the model's end.
fn material(model: &BodyModel, at: UVec3) -> u8 {
    if at.cmpge(model.size).any() {
        return 0;
    }
    model.materials[(at.x + model.size.x * (at.y + model.size.y * at.z)) as usize]
}

/// All places of a box of this extent, x first.
fn places(extent: UVec3) -> impl Iterator<Item = UVec3> {
    let rows = (0..extent.z).flat_map(move |z| (0..extent.y).map(move |y| (y, z)));
    rows.flat_map(move |(y, z)| (0..extent.x).map(move |x| UVec3::new(x, y, z)))
}

/// 64 bits for each block, two blocks in a vector.
fn masks(model: &BodyModel) -> Vec<[u32; 4]> {
    let mask = |block: UVec3| {
        let bits = places(UVec3::splat(BLOCK)).enumerate();
        bits.fold(0u64, |mask, (bit, at)| {
            let is_solid = material(model, block * BLOCK + at) != 0;
            mask | u64::from(is_solid) << bit
        })
    };
    let all: Vec<u64> = places(blocks_of(model.size)).map(mask).collect();
    let words = |mask: u64| [mask as u32, (mask >> 32) as u32];
    all.chunks(2)
        .map(|pair| {
            let [low, high] = words(pair[0]);
            let [next_low, next_high] = words(pair.get(1).copied().unwrap_or(0));
            [low, high, next_low, next_high]
        })
        .collect()
}

/// A byte for each voxel of the blocks' extent.
fn materials(model: &BodyModel) -> Vec<[u32; 4]> {
    let extent = blocks_of(model.size) * BLOCK;
    let bytes: Vec<u8> = places(extent).map(|at| material(model, at)).collect();
    // The extent is a multiple of 64 voxels.
    bytes.chunks(16).map(bytemuck::pod_read_unaligned).collect()
}

/// The box around the solid voxels; around the first corner where there are none.
fn solid(model: &BodyModel) -> Bounds {
    let solid = places(model.size).filter(|at| material(model, *at) != 0);
    let found = solid.fold(None, |found: Option<(UVec3, UVec3)>, at| {
        let (low, high) = found.unwrap_or((at, at));
        Some((low.min(at), high.max(at)))
    });
    let (low, high) = found.map_or((UVec3::ZERO, UVec3::ZERO), |(low, high)| (low, high + 1));
    Bounds {
        low: low.as_vec3(),
        high: high.as_vec3(),
    }
}
