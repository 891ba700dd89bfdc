//! What passes find out about bodies.

use super::body_room::{Room, bytes};
use crate::{
    gpu::{Gpu, GpuError, rectangle},
    lights::Cells,
};

/// The bindings of what passes `surface_cache/body_light`, `surface_cache/body_lamps` and `surface_cache/body_shafts` find out.
const FACTS: [&str; 3] = ["body_lit_facts", "body_near_facts", "body_shaft_facts"];
/// The binding of the list that pass `surface_cache/body_cells` makes.
const TOUCHED: &str = "touched_cells";
/// Words before the list's entries (`shaders/surface_cache/touched_cells.wesl`): workgroups of pass `surface_cache/body_lamps`,
/// of which the rows are fixed, and counters.
const LIST_HEAD_WORDS: u64 = 6;

/// A buffer for each pass, so that none waits for another. A clone is another handle to the same facts.
#[derive(Clone)]
pub struct BodyFacts {
    /// The light of the faces of bodies; of the cells around each, which lamps they see; of the cells of the world and of
    /// bodies, which lamps other bodies may hide.
    facts: [wgpu::Buffer; 3],
    /// The cells that bodies may touch.
    touched: wgpu::Buffer,
    /// Most workgroups of the pass over that list: columns and rows.
    most_groups: [u32; 2],
}

impl BodyFacts {
    /// Bytes of GPU memory that facts about so many bodies take.
    pub fn bytes_for(room: &Room, cells: Cells) -> u64 {
        room.facts(cells).map(bytes).iter().sum::<u64>() + list_bytes(room)
    }

    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn new(gpu: &Gpu, room: &Room, cells: Cells) -> Result<Self, GpuError> {
        let [lit, near, shaded] = room.facts(cells).map(bytes);
        let facts = [
            gpu.storage_buffer(FACTS[0], lit)?,
            gpu.storage_buffer(FACTS[1], near)?,
            gpu.storage_buffer(FACTS[2], shaded)?,
        ];
        let touched = gpu.storage_buffer(TOUCHED, list_bytes(room))?;
        let most_groups = rectangle(room.near_cells as u32);
        let groups = [0, most_groups[1], 1];
        gpu.queue
            .write_buffer(&touched, 0, bytemuck::cast_slice(&groups));
        Ok(Self {
            facts,
            touched,
            most_groups,
        })
    }

    /// Forgets all that was found.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        for facts in &self.facts {
            encoder.clear_buffer(facts, 0, None);
        }
    }

    /// Most workgroups of the pass over the list of touched cells, and the list, which begins with how many they are now.
    pub fn touched(&self) -> ([u32; 2], &wgpu::Buffer) {
        (self.most_groups, &self.touched)
    }

    /// What the shaders bind by name. The first three are what pass `scene/publish_facts` hands over.
    pub fn resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 4] {
        let [lit, near, shaded] = &self.facts;
        [
            (FACTS[0], lit.as_entire_binding()),
            (FACTS[1], near.as_entire_binding()),
            (FACTS[2], shaded.as_entire_binding()),
            (TOUCHED, self.touched.as_entire_binding()),
        ]
    }

    /// Vectors of two facts in all.
    pub fn vectors(&self) -> u32 {
        let facts: u64 = self.facts.iter().map(wgpu::Buffer::size).sum();
        (facts / size_of::<[u32; 4]>() as u64) as u32
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        let facts: u64 = self.facts.iter().map(wgpu::Buffer::size).sum();
        facts + self.touched.size()
    }
}

fn list_bytes(room: &Room) -> u64 {
    (LIST_HEAD_WORDS + room.near_cells as u64) * size_of::<u32>() as u64
}
