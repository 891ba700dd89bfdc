//! Rigid bodies on the GPU: their models, once, and where they are, whenever that changes.

use std::sync::{Arc, Mutex, MutexGuard};

use glam::{Mat3, UVec3, Vec3};

use super::{
    body_models::{LIT_FACES, blocks_of, lit_voxels, masks, materials, solid},
    hierarchy::{Bounds, Node, hierarchy},
};
use crate::{
    gpu::{Gpu, GpuError},
    lights::lists,
    world::bodies::{Bodies, Body, Pose},
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
        /// Index of the vector with the first four of the model's voxels whose faces have stored light.
        lit_voxels_at: u32,
        pivot: [f32; 3],
        _pad0: u32,
    }

    use size_of::<GpuBodyNode>() / 16 => NODE_VECTORS: usize;
    use size_of::<GpuBody>() / 16 => BODY_VECTORS: usize;
    /// Vectors of the head.
    const HEAD_VECTORS as HEAD_VECTORS: usize = 2;
}

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
    /// What passes find out about the bodies: the light of their faces, then for each cell the ways to lamps that they
    /// may block. Copied into `buffer` at `facts_at` (bytes).
    facts: wgpu::Buffer,
    facts_at: u64,
    /// Cells of the world along each axis, and log2 of the voxels along a cell.
    cells: UVec3,
    shift: u32,
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
        Self::upload(gpu, &Bodies::default(), UVec3::ONE)
    }

    /// All bodies where they are at time 0, in a world of `size` voxels.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn upload(gpu: &Gpu, bodies: &Bodies, size: UVec3) -> Result<Self, GpuError> {
        let count = bodies.bodies.len();
        let (cells, shift) = (lists::cells(size), lists::cell_shift(size));
        let first_fact = moving_vectors(count);
        let facts = fact_vectors(count, cells);
        let first_model = first_fact + facts;
        let mut models = Vec::<[u32; 4]>::new();
        let places: Vec<_> = bodies
            .models
            .iter()
            .map(|model| {
                let masks_at = first_model + models.len();
                models.extend(masks(model));
                let materials_at = first_model + models.len();
                models.extend(materials(model));
                let lit_voxels_at = first_model + models.len();
                models.extend(lit_voxels(model));
                let at = [masks_at, materials_at, lit_voxels_at].map(|at| at as u32);
                (at, solid(model))
            })
            .collect();
        let bytes = |vectors: usize| (vectors * size_of::<[u32; 4]>()) as u64;
        let all = bytes(first_model + models.len());
        let (buffer, before, facts) = gpu.making("the bodies", all + bytes(facts), || {
            let buffer = gpu.storage_buffer("bodies", all)?;
            let records = count.max(1) * size_of::<GpuBody>();
            let before = gpu.storage_buffer("bodies_before", records as u64)?;
            let facts = gpu.storage_buffer("body_facts", bytes(facts))?;
            Ok::<_, GpuError>((buffer, before, facts))
        })?;
        let at = bytes(first_model);
        gpu.queue
            .write_buffer(&buffer, at, bytemuck::cast_slice(&models));
        let placed = bodies.bodies.iter().map(|body| {
            let ([masks_at, materials_at, lit_voxels_at], solid) = places[body.model];
            let blocks = blocks_of(bodies.models[body.model].size);
            Placed {
                record: GpuBody {
                    masks_at,
                    materials_at,
                    lit_voxels_at,
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
            facts,
            facts_at: bytes(first_fact),
            cells,
            shift,
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

    /// What the passes about bodies write.
    pub fn facts(&self) -> (&'static str, wgpu::BindingResource<'_>) {
        ("body_facts", self.facts.as_entire_binding())
    }

    /// Number of faces with stored light, of all bodies.
    pub fn lit_faces(&self) -> u32 {
        self.placed.len() as u32 * LIT_FACES
    }

    /// Number of cells with facts about the ways to lamps.
    pub fn cells(&self) -> u32 {
        self.cells.element_product()
    }

    /// Hands what passes have found out to those that follow.
    pub fn publish_facts(&self, encoder: &mut wgpu::CommandEncoder) {
        let bytes = self.facts.size();
        encoder.copy_buffer_to_buffer(&self.facts, 0, &self.buffer, self.facts_at, bytes);
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.buffer.size() + self.before.size() + self.facts.size()
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
        let first_body = HEAD_VECTORS + nodes.len() * (size_of::<GpuBodyNode>() / 16);
        let first_fact = self.facts_at / size_of::<[u32; 4]>() as u64;
        let count = self.placed.len() as u32;
        let [x, y, z] = self.cells.to_array();
        let head = [
            [
                nodes.len() as u32,
                first_body as u32,
                first_fact as u32,
                count,
            ],
            [x, y, z, self.shift],
        ];
        let mut bytes = bytemuck::cast_slice(&head).to_vec();
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
    let bytes = nodes * size_of::<GpuBodyNode>() + bodies * size_of::<GpuBody>();
    HEAD_VECTORS + bytes / size_of::<[u32; 4]>()
}

/// Vectors of what passes find out, eight bytes for each face and each cell; one where there are no bodies.
fn fact_vectors(bodies: usize, cells: UVec3) -> usize {
    let cells = cells.element_product() as usize * bodies.min(1);
    (bodies * LIT_FACES as usize + cells).div_ceil(2).max(1)
}
