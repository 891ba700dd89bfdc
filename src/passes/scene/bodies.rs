//! Rigid bodies on the GPU: their models, whenever there are others, and where they are, whenever that changes.

use std::sync::{Arc, Mutex, MutexGuard};

use glam::{Mat3, UVec3, Vec3};

use super::{
    body_models::{Room, blocks_of, masks, materials, solid},
    hierarchy::{Bounds, Node, hierarchy},
};
use crate::{
    gpu::{Gpu, GpuError},
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
        _pad0: u32,
        pivot: [f32; 3],
        _pad1: u32,
    }

    use size_of::<GpuBodyNode>() / 16 => NODE_VECTORS: usize;
    use size_of::<GpuBody>() / 16 => BODY_VECTORS: usize;
}

const NO_BODY: u32 = u32::MAX;
/// Boxes are larger than their bodies by this many voxels, and by this share of their distance from the origin, so that
/// rounding does not cut off corners.
const MARGIN: f32 = 1e-3;
const MARGIN_SHARE: f32 = 1e-6;

/// Bodies that come or go change light as a way of this many voxels does.
const APPEARING: f32 = 8.0;

/// The binding of `shaders/scene/bodies.wesl`. A clone is another handle to the same bodies.
#[derive(Clone)]
pub struct GpuBodies {
    buffer: wgpu::Buffer,
    /// The bodies as the frame before showed them, without hierarchy and models.
    before: wgpu::Buffer,
    room: Room,
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
    placed: Vec<Placed>,
    /// Whether any body ever moves by itself.
    move_at_all: bool,
    /// World time of `now` (seconds).
    time_s: f64,
    now: Vec<Pose>,
    /// As the last frame showed them; `None` before the first frame.
    shown: Option<Vec<Pose>>,
    /// Whether `before` differs from the poses of the last frame.
    is_before_old: bool,
    /// Whether there are others than in the last frame.
    are_others: bool,
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
        Self::with(gpu, bodies, Room::of(bodies))
    }

    /// The same, with room for more of them, so that one more needs other buffers only now and then.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn with_room(gpu: &Gpu, bodies: &Bodies) -> Result<Self, GpuError> {
        let needed = Room::of(bodies);
        let ample = Room {
            bodies: needed.bodies * 3 / 2 + 16,
            models: needed.models * 3 / 2 + (1 << 14),
        };
        let fits = gpu.check_buffer("bodies", ample.bytes()).is_ok();
        let all = Self::with(gpu, bodies, if fits { ample } else { needed })?;
        all.poses().are_others = true;
        Ok(all)
    }

    fn with(gpu: &Gpu, bodies: &Bodies, room: Room) -> Result<Self, GpuError> {
        let (buffer, before) = gpu.making("the bodies", room.bytes(), || {
            let buffer = gpu.storage_buffer("bodies", room.bytes())?;
            let records = room.bodies.max(1) * size_of::<GpuBody>();
            let before = gpu.storage_buffer("bodies_before", records as u64)?;
            Ok::<_, GpuError>((buffer, before))
        })?;
        let all = Self {
            buffer,
            before,
            room,
            poses: Arc::new(Mutex::new(Poses {
                placed: Vec::new(),
                move_at_all: false,
                time_s: 0.0,
                shown: None,
                now: Vec::new(),
                is_before_old: true,
                are_others: false,
                version: 0,
            })),
        };
        all.fill(gpu, bodies);
        Ok(all)
    }

    /// Takes other bodies, where there is room for them, and returns whether there is. World time stays.
    pub fn take(&self, gpu: &Gpu, bodies: &Bodies) -> bool {
        let needed = Room::of(bodies);
        let fits = needed.bodies <= self.room.bodies && needed.models <= self.room.models;
        if fits {
            self.fill(gpu, bodies);
            self.poses().are_others = true;
        }
        fits
    }

    /// Writes all bodies and their models.
    fn fill(&self, gpu: &Gpu, bodies: &Bodies) {
        let first_model = moving_vectors(self.room.bodies);
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
        let at = (first_model * size_of::<[u32; 4]>()) as u64;
        gpu.queue
            .write_buffer(&self.buffer, at, bytemuck::cast_slice(&models));
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
        let mut poses = self.poses();
        poses.placed = placed.collect();
        poses.move_at_all = bodies.bodies.iter().any(|body| !body.is_still());
        poses.now = bodies.poses(poses.time_s);
        poses.shown = None;
        poses.is_before_old = true;
        poses.version += 1;
        self.write(gpu, &poses.placed, &poses.now);
    }

    /// The constant of kernels that are made for these bodies: whether there may be any.
    pub fn constants(&self) -> [(&'static str, f64); 1] {
        [("BODIES", f64::from(u8::from(self.room.bodies > 0)))]
    }

    /// Moves the bodies to where they are at a world time (seconds). Where nothing moves, this costs nothing.
    pub fn set_time(&self, gpu: &Gpu, time_s: f64) {
        let mut poses = self.poses();
        if !poses.move_at_all || poses.time_s == time_s {
            return;
        }
        poses.time_s = time_s;
        self.pose(gpu, &mut poses);
    }

    /// Moves the bodies to where these rest, which are the same bodies otherwise.
    ///
    /// # Panics
    /// If there are more or fewer.
    pub fn rest(&self, gpu: &Gpu, bodies: &Bodies) {
        let mut poses = self.poses();
        assert_eq!(poses.placed.len(), bodies.bodies.len(), "the same bodies");
        for (placed, body) in poses.placed.iter_mut().zip(&bodies.bodies) {
            placed.body.rest = body.rest;
        }
        self.pose(gpu, &mut poses);
    }

    fn pose(&self, gpu: &Gpu, poses: &mut Poses) {
        let placed = poses.placed.iter();
        let now: Vec<Pose> = placed
            .map(|placed| placed.body.pose(poses.time_s))
            .collect();
        if poses.now != now {
            self.write(gpu, &poses.placed, &now);
            poses.now = now;
            poses.version += 1;
        }
    }

    /// How often the bodies have been moved.
    pub fn version(&self) -> u64 {
        self.poses().version
    }

    /// Begins a frame with the poses as they are now, and returns the farthest way of any point of a body since the last
    /// frame (voxels). Bodies that come or go count as such a way.
    pub fn begin_frame(&self, gpu: &Gpu) -> f32 {
        let mut poses = self.poses();
        let shown = poses.shown.take().unwrap_or_else(|| poses.now.clone());
        let pairs = shown.iter().zip(&poses.now).zip(&poses.placed);
        let farthest = pairs
            .map(|((before, now), placed)| placed.way(before, now))
            .fold(0.0, f32::max);
        let farthest = match std::mem::take(&mut poses.are_others) {
            true => farthest.max(APPEARING),
            false => farthest,
        };
        if farthest > 0.0 || poses.is_before_old {
            let records = records(&poses.placed, &shown);
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

    /// Writes the part that changes when bodies move.
    fn write(&self, gpu: &Gpu, placed: &[Placed], poses: &[Pose]) {
        let boxes: Vec<Bounds> = placed
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
        bytes.extend_from_slice(bytemuck::cast_slice(&records(placed, poses)));
        gpu.queue.write_buffer(&self.buffer, 0, &bytes);
    }
}

impl Room {
    fn bytes(&self) -> u64 {
        ((moving_vectors(self.bodies) + self.models) * size_of::<[u32; 4]>()) as u64
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

fn records(placed: &[Placed], poses: &[Pose]) -> Vec<GpuBody> {
    let pairs = placed.iter().zip(poses);
    pairs.map(|(body, pose)| body.at(pose)).collect()
}

/// Vectors of the head, the nodes and the bodies.
fn moving_vectors(bodies: usize) -> usize {
    let nodes = (2 * bodies).saturating_sub(1);
    1 + (nodes * size_of::<GpuBodyNode>() + bodies * size_of::<GpuBody>()) / size_of::<[u32; 4]>()
}
