//! Models of bodies as the shaders read them (`shaders/scene/bodies.wesl`).

use glam::{IVec3, UVec3};

use super::hierarchy::Bounds;
use crate::world::bodies::BodyModel;

crate::shared! {
    in scene;

    /// Cells along each axis of a body whose faces have stored light. As many as a block has voxels: then a cell has as many
    /// voxels along an axis as the model has blocks.
    const CELLS as LIT_CELLS: u32 = BLOCK;
    /// Faces with stored light of a body: six for each cell.
    pub const LIT_FACES as LIT_FACES: u32 = CELLS * CELLS * CELLS * 6;
}

/// Edge of a block in voxels.
const BLOCK: u32 = 4;
/// In place of a voxel: the cell has no face of this direction.
const NO_VOXEL: u32 = u32::MAX;
const FACES: [IVec3; 6] = [
    IVec3::NEG_X,
    IVec3::X,
    IVec3::NEG_Y,
    IVec3::Y,
    IVec3::NEG_Z,
    IVec3::Z,
];

pub fn blocks_of(size: UVec3) -> UVec3 {
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
pub fn masks(model: &BodyModel) -> Vec<[u32; 4]> {
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
pub fn materials(model: &BodyModel) -> Vec<[u32; 4]> {
    let extent = blocks_of(model.size) * BLOCK;
    let bytes: Vec<u8> = places(extent).map(|at| material(model, at)).collect();
    // The extent is a multiple of 64 voxels.
    bytes.chunks(16).map(bytemuck::pod_read_unaligned).collect()
}

/// The box around the solid voxels; around the first corner where there are none.
pub fn solid(model: &BodyModel) -> Bounds {
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

/// For each face of each cell, the voxel at whose face its light is found: of the cell's faces of this direction that
/// are exposed to air, the one nearest to their middle. x, y and z in eight bits each, or `NO_VOXEL`.
pub fn lit_voxels(model: &BodyModel) -> Vec<[u32; 4]> {
    let blocks = blocks_of(model.size).as_ivec3();
    let exposed = || {
        model.solid().flat_map(move |voxel| {
            let cell = voxel / blocks;
            let cells = CELLS as i32;
            let first = 6 * (cell.x + cells * (cell.y + cells * cell.z));
            let faces = FACES.iter().enumerate();
            let free = faces.filter(move |(_, facing)| model.material(voxel + **facing) == 0);
            free.map(move |(face, _)| (first as usize + face, voxel))
        })
    };
    let mut sums = vec![(IVec3::ZERO, 0); LIT_FACES as usize];
    for (place, voxel) in exposed() {
        sums[place].0 += voxel;
        sums[place].1 += 1;
    }
    let mut nearest = vec![(i64::MAX, NO_VOXEL); LIT_FACES as usize];
    for (place, voxel) in exposed() {
        let (sum, count) = sums[place];
        // In units of 1/count: whole numbers choose the same voxel on every machine.
        let distance = (voxel * count - sum).as_i64vec3().length_squared();
        if distance < nearest[place].0 {
            let packed = (voxel.x | voxel.y << 8 | voxel.z << 16) as u32;
            nearest[place] = (distance, packed);
        }
    }
    let voxels: Vec<u32> = nearest.into_iter().map(|(_, voxel)| voxel).collect();
    voxels
        .chunks(4)
        .map(bytemuck::cast_slice)
        .map(bytemuck::pod_read_unaligned)
        .collect()
}

/// Vectors of the masks, the materials and the lit voxels of a model.
pub fn vectors_of(model: &BodyModel) -> usize {
    let blocks = blocks_of(model.size).element_product() as usize;
    let materials = blocks * (BLOCK * BLOCK * BLOCK) as usize / 16;
    blocks.div_ceil(2) + materials + LIT_FACES as usize / 4
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model(size: UVec3, is_solid: impl Fn(UVec3) -> bool) -> BodyModel {
        BodyModel {
            size,
            materials: places(size).map(|at| u8::from(is_solid(at))).collect(),
        }
    }

    fn voxel_of(model: &BodyModel, cell: UVec3, face: usize) -> Option<UVec3> {
        let all = lit_voxels(model).concat();
        let number = (cell.x + CELLS * (cell.y + CELLS * cell.z)) as usize * 6 + face;
        let packed = all[number];
        let part = |shift: u32| packed >> shift & 0xff;
        (packed != NO_VOXEL).then(|| UVec3::new(part(0), part(8), part(16)))
    }

    #[test]
    fn light_is_found_at_the_middle_of_the_exposed_faces_of_a_cell() {
        let cube = model(UVec3::splat(16), |_| true);
        let top = voxel_of(&cube, UVec3::new(1, 3, 2), 3).expect("the top is exposed");
        assert_eq!(top.y, 15);
        assert!((5..7).contains(&top.x) && (9..11).contains(&top.z), "{top}");
        assert_eq!(
            voxel_of(&cube, UVec3::new(1, 3, 2), 2),
            None,
            "its lower side is not"
        );
        assert_eq!(
            voxel_of(&cube, UVec3::splat(1), 0),
            None,
            "nor is anything inside"
        );
    }

    #[test]
    fn every_exposed_face_has_light() {
        for size in [
            UVec3::new(1, 1, 1),
            UVec3::new(7, 1, 7),
            UVec3::new(13, 30, 5),
        ] {
            let porous = model(size, |at| (at.x * 7 + at.y * 3 + at.z * 5) % 4 != 0);
            let blocks = blocks_of(size);
            for voxel in porous.solid() {
                for (face, facing) in FACES.iter().enumerate() {
                    if porous.material(voxel + *facing) == 0 {
                        let cell = voxel.as_uvec3() / blocks;
                        let lit = voxel_of(&porous, cell, face).expect("it is exposed");
                        assert_eq!(lit / blocks, cell, "{voxel} {face}");
                        assert_eq!(porous.material(lit.as_ivec3() + *facing), 0);
                    }
                }
            }
        }
    }
}
