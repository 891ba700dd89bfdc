//! Rigid bodies on the GPU: their models, whenever there are others, and where they are, whenever that changes.

use std::sync::{Arc, Mutex, MutexGuard};

use glam::{UVec3, Vec3};

use super::{
    body_emitters::GpuGlowingBody,
    body_facts::BodyFacts,
    body_models::GpuModel,
    body_poses::Poses,
    body_records::{GpuBody, GpuBodyNode, Placed, records},
    body_room::{HEAD_VECTORS, NEAR_FACTS, NearCells, Room, bytes},
    hierarchy::{Bounds, OCTANTS, hierarchy, in_order},
};
use crate::{
    gpu::{Gpu, GpuError},
    lights::{Cells, emitters, lists},
    world::{
        Material,
        bodies::{Bodies, Pose},
    },
};

/// Name of the constant of kernels that says whether there may be bodies.
pub const BODIES: &str = "BODIES";

/// Bodies that come or go change light as a way of this many voxels does.
const APPEARING: f32 = 8.0;

/// The binding of `shaders/scene/bodies.wesl`. A clone is another handle to the same bodies.
#[derive(Clone)]
pub struct GpuBodies {
    buffer: wgpu::Buffer,
    /// The bodies as the frame before showed them, without hierarchy and models.
    before: wgpu::Buffer,
    facts: BodyFacts,
    cells: Cells,
    room: Room,
    /// Weight of an emissive face of each material.
    emission: Arc<[f64]>,
    poses: Arc<Mutex<Poses>>,
}

impl GpuBodies {
    /// For a world without bodies.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn none(gpu: &Gpu) -> Result<Self, GpuError> {
        Self::upload(gpu, &Bodies::default(), &[], UVec3::ONE)
    }

    /// All bodies where they are at time 0, in a world of `size` voxels with these materials.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn upload(
        gpu: &Gpu,
        bodies: &Bodies,
        materials: &[Material],
        size: UVec3,
    ) -> Result<Self, GpuError> {
        let emission: Arc<[f64]> = emitters::weights(materials).into();
        let models = gpu_models(bodies, &emission);
        let room = Room::of(bodies, &models);
        Self::with(gpu, bodies, &models, room, lists::cells(size), emission)
    }

    /// Others in the same world, with room for more of them, so that one more needs other buffers only now and then.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn with_room(&self, gpu: &Gpu, bodies: &Bodies) -> Result<Self, GpuError> {
        let models = gpu_models(bodies, &self.emission);
        let needed = Room::of(bodies, &models);
        let ample = needed.ample();
        let fits = gpu.check_buffer("bodies", ample.bytes(self.cells)).is_ok();
        let room = if fits { ample } else { needed };
        let emission = self.emission.clone();
        let all = Self::with(gpu, bodies, &models, room, self.cells, emission)?;
        all.poses().are_others = true;
        Ok(all)
    }

    fn with(
        gpu: &Gpu,
        bodies: &Bodies,
        models: &[GpuModel],
        room: Room,
        cells: Cells,
        emission: Arc<[f64]>,
    ) -> Result<Self, GpuError> {
        let all = room.bytes(cells);
        let needed = all + BodyFacts::bytes_for(&room, cells);
        let (buffer, before, facts) = gpu.making("the bodies", needed, || {
            let buffer = gpu.storage_buffer("bodies", all)?;
            let facts = BodyFacts::new(gpu, &room, cells)?;
            let records = room.bodies.max(1) * size_of::<GpuBody>();
            let before = gpu.storage_buffer("bodies_before", records as u64)?;
            Ok::<_, GpuError>((buffer, before, facts))
        })?;
        let all = Self {
            buffer,
            before,
            facts,
            cells,
            room,
            emission,
            poses: Arc::new(Mutex::new(Poses::none())),
        };
        all.fill(gpu, bodies, models);
        Ok(all)
    }

    /// Takes other bodies, where there is room for them, and returns whether there is. World time stays.
    pub fn take(&self, gpu: &Gpu, bodies: &Bodies) -> bool {
        let models = gpu_models(bodies, &self.emission);
        let fits = self.room.holds(Room::of(bodies, &models));
        if fits {
            self.fill(gpu, bodies, &models);
            self.poses().are_others = true;
        }
        fits
    }

    /// Writes all bodies and their models, and forgets all facts.
    fn fill(&self, gpu: &Gpu, bodies: &Bodies, models: &[GpuModel]) {
        let first_model = self.room.first_model(self.cells);
        let mut vectors = Vec::<[u32; 4]>::new();
        let mut masks_at = Vec::new();
        for model in models {
            masks_at.push((first_model + vectors.len()) as u32);
            vectors.extend(&model.vectors);
        }
        let at = bytes(first_model);
        gpu.queue
            .write_buffer(&self.buffer, at, bytemuck::cast_slice(&vectors));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.facts.clear(&mut encoder);
        let first_fact = bytes(self.room.first_fact());
        encoder.clear_buffer(&self.buffer, first_fact, Some(at - first_fact));
        gpu.queue.submit([encoder.finish()]);
        self.forget_shafts(gpu);
        let mut poses = self.poses();
        poses.placed.clear();
        (poses.lit_faces, poses.most_lit_faces, poses.most_near_cells) = (0, 0, 0);
        let mut first_near = self.room.first_near_fact();
        for body in &bodies.bodies {
            let model = &models[body.model];
            let near = NearCells::of(&model.solid, bodies.bodies.len());
            let [x, y, z] = model.blocks.to_array();
            let first_lit = poses.lit_faces;
            poses.placed.push(Placed {
                record: GpuBody {
                    masks_at: masks_at[body.model],
                    blocks: x | y << 8 | z << 16 | near.bits << 24 | near.shift << 28,
                    first_lit,
                    first_near: first_near as u32,
                    pivot: body.pivot.to_array(),
                    ..GpuBody::default()
                },
                body: body.clone(),
                solid: model.solid,
                supports: model.supports.clone(),
            });
            poses.lit_faces += model.lit_faces as u32;
            poses.most_lit_faces = poses.most_lit_faces.max(model.lit_faces as u32);
            poses.most_near_cells = poses.most_near_cells.max(near.count() as u32);
            first_near += near.count() * NEAR_FACTS;
        }
        poses.glowing = GpuGlowingBody::of_all(bodies, models, &masks_at);
        poses.move_at_all = bodies.bodies.iter().any(|body| !body.is_still());
        poses.now = bodies.poses(poses.time_s);
        poses.shown = None;
        poses.is_before_old = true;
        poses.version += 1;
        poses.boxes = self.write(gpu, &poses, &poses.now);
    }

    /// Until pass `surface_cache/body_shafts` has run again, any body may hide any lamp. What it found is wrong once lamps or
    /// bodies have jumped, and the rays that light bodies are sent beside it.
    pub fn forget_shafts(&self, gpu: &Gpu) {
        if !self.exist() {
            return;
        }
        let [lit, near, shaded] = self.room.facts(self.cells);
        let first = bytes(self.room.first_fact() + lit + near);
        let any = vec![u8::MAX; bytes(shaded) as usize];
        gpu.queue.write_buffer(&self.buffer, first, &any);
    }

    /// The constant of kernels that are made for these bodies: whether there may be any.
    pub fn constants(&self) -> [(&'static str, f64); 1] {
        [(BODIES, f64::from(u8::from(self.exist())))]
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
            poses.boxes = self.write(gpu, poses, &now);
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
        let farthest = poses.farthest_since(&shown);
        let farthest = match std::mem::take(&mut poses.are_others) {
            true => farthest.max(APPEARING),
            false => farthest,
        };
        if farthest > 0.0 || poses.is_before_old {
            let records = records(&poses.placed, &shown, &[]);
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
    pub fn resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 6] {
        let [lit, near, shaded, touched] = self.facts.resources();
        [
            ("bodies", self.buffer.as_entire_binding()),
            ("bodies_before", self.before.as_entire_binding()),
            lit,
            near,
            shaded,
            touched,
        ]
    }

    /// Whether there may be any.
    pub fn exist(&self) -> bool {
        self.room.bodies > 0
    }

    /// Whether any body has emissive faces.
    pub fn glow(&self) -> bool {
        !self.poses().glowing.is_empty()
    }

    /// The lowest and the highest corner of the box around each body, in world space.
    pub fn boxes(&self) -> Vec<[Vec3; 2]> {
        let poses = self.poses();
        poses
            .boxes
            .iter()
            .map(|around| [around.low, around.high])
            .collect()
    }

    /// Number of bodies, faces with stored light of all of them, and most such faces of one.
    pub fn lit_faces(&self) -> [u32; 3] {
        let poses = self.poses();
        let bodies = poses.placed.len() as u32;
        [bodies, poses.lit_faces, poses.most_lit_faces]
    }

    /// Most cells around a body, and number of bodies.
    pub fn near_cells(&self) -> [u32; 2] {
        let poses = self.poses();
        [poses.most_near_cells, poses.placed.len() as u32]
    }

    /// The cells that bodies may touch: most workgroups of the pass over their list, and the list. `None` without bodies: then no
    /// list was made.
    pub fn touched_cells(&self) -> Option<([u32; 2], &wgpu::Buffer)> {
        (!self.poses().placed.is_empty()).then(|| self.facts.touched())
    }

    /// Number of cells and bodies, from which bodies may hide lamps.
    pub fn shaded_places(&self) -> u32 {
        self.cells.count.element_product() + self.poses().placed.len() as u32
    }

    /// What pass `scene/publish_facts` binds.
    pub(super) fn resources_to_publish(&self) -> [(&'static str, wgpu::BindingResource<'_>); 4] {
        let [lit, near, shaded, _] = self.facts.resources();
        [
            ("bodies_out", self.buffer.as_entire_binding()),
            lit,
            near,
            shaded,
        ]
    }

    /// Vectors of two facts in all.
    pub(super) fn fact_vectors(&self) -> u32 {
        self.facts.vectors()
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.buffer.size() + self.before.size() + self.facts.bytes()
    }

    fn poses(&self) -> MutexGuard<'_, Poses> {
        self.poses.lock().expect("nobody panics holding it")
    }

    /// Writes the part that changes when bodies move, and returns the box around each body.
    fn write(&self, gpu: &Gpu, all: &Poses, poses: &[Pose]) -> Vec<Bounds> {
        let placed = &all.placed;
        let boxes: Vec<Bounds> = placed
            .iter()
            .zip(poses)
            .map(|(body, pose)| body.bounds(pose))
            .collect();
        let nodes = hierarchy(&boxes);
        let records = records(placed, poses, &nodes);
        let count = nodes.len();
        let nodes: Vec<GpuBodyNode> = (0..OCTANTS)
            .flat_map(|octant| in_order(&nodes, octant))
            .map(GpuBodyNode::from)
            .collect();
        let first_body = HEAD_VECTORS + nodes.len() * (size_of::<GpuBodyNode>() / 16);
        let first_fact = self.room.first_fact();
        let [first_near, first_cell] = [self.room.first_near_fact(), self.room.first_cell_fact()];
        let [x, y, z] = self.cells.count.to_array();
        let head = [
            [count, first_body, first_fact, placed.len()].map(|number| number as u32),
            [x, y, z, self.cells.shift],
            [
                first_cell as u32,
                all.lit_faces,
                first_near as u32,
                all.glowing.len() as u32,
            ],
        ];
        let mut bytes = bytemuck::cast_slice(&head).to_vec();
        bytes.extend_from_slice(bytemuck::cast_slice(&nodes));
        bytes.extend_from_slice(bytemuck::cast_slice(&records));
        bytes.extend_from_slice(bytemuck::cast_slice(&all.glowing));
        gpu.queue.write_buffer(&self.buffer, 0, &bytes);
        boxes
    }
}

fn gpu_models(bodies: &Bodies, emission: &[f64]) -> Vec<GpuModel> {
    let models = bodies.models.iter();
    models.map(|model| GpuModel::of(model, emission)).collect()
}
