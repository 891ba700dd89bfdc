//! Models of bodies as the shaders read them (`shaders/scene/bodies.wesl`).

use glam::{IVec3, UVec3};

use super::{body_emitters::EmissiveFaces, body_supports::Supports, hierarchy::Bounds};
use crate::world::bodies::BodyModel;

/// Edge of a block in voxels.
const BLOCK: u32 = 4;
pub const FACES: [IVec3; 6] = [
    IVec3::NEG_X,
    IVec3::X,
    IVec3::NEG_Y,
    IVec3::Y,
    IVec3::NEG_Z,
    IVec3::Z,
];

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
pub fn places(extent: UVec3) -> impl Iterator<Item = UVec3> {
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

/// The faces of the blocks that have stored light: those of which any voxel's face is exposed to air.
struct LitFaces {
    /// For each block the number of its first face, and in the low six bits which faces it has.
    blocks: Vec<u32>,
    /// For each face the voxel that stands for its middle: of the exposed ones, the nearest to their middle.
    /// Packed.
    voxels: Vec<u32>,
}

impl LitFaces {
    fn of(model: &BodyModel) -> Self {
        let extent = blocks_of(model.size);
        let mut all = Self {
            blocks: Vec::new(),
            voxels: Vec::new(),
        };
        for block in places(extent) {
            let first = all.voxels.len() as u32;
            let mut found = 0;
            for (face, facing) in FACES.iter().enumerate() {
                if let Some(voxel) = lit_voxel(model, block, *facing) {
                    found |= 1 << face;
                    all.voxels.push(packed_face(voxel, face));
                }
            }
            all.blocks.push(first << 6 | found);
        }
        all
    }

    fn count(&self) -> usize {
        self.voxels.len()
    }

    /// Four blocks in a vector; then the number of faces and their voxels, four words in a vector.
    fn vectors(&self) -> Vec<[u32; 4]> {
        let count = [self.count() as u32];
        let lists = [&self.blocks[..], &[&count[..], &self.voxels].concat()];
        lists.iter().flat_map(|words| in_fours(words)).collect()
    }
}

/// A face of a voxel in a word: x, y and z in six bits each, then the face.
pub fn packed_face(voxel: UVec3, face: usize) -> u32 {
    voxel.x | voxel.y << 6 | voxel.z << 12 | (face as u32) << 18
}

/// Of a block's faces of one direction that are exposed to air, the voxel nearest to their middle.
fn lit_voxel(model: &BodyModel, block: UVec3, facing: IVec3) -> Option<UVec3> {
    let exposed: Vec<IVec3> = places(UVec3::splat(BLOCK))
        .map(|at| (block * BLOCK + at).as_ivec3())
        .filter(|at| model.material(*at) != 0 && model.material(*at + facing) == 0)
        .collect();
    let count = exposed.len() as i32;
    let sum: IVec3 = exposed.iter().sum();
    // In units of 1/count: whole numbers choose the same voxel on every machine.
    let nearest = exposed
        .iter()
        .min_by_key(|at| (**at * count - sum).length_squared());
    nearest.map(|at| at.as_uvec3())
}

fn in_fours(words: &[u32]) -> Vec<[u32; 4]> {
    let four = |words: &[u32]| std::array::from_fn(|i| words.get(i).copied().unwrap_or(0));
    words.chunks(4).map(four).collect()
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

/// A model as it lies in the buffer.
pub struct GpuModel {
    /// Masks, materials, the faces with stored light, and the emissive faces.
    pub vectors: Vec<[u32; 4]>,
    /// The first of the vectors with emissive faces.
    pub first_emissive: usize,
    pub emissive: EmissiveFaces,
    /// Number of faces with stored light.
    pub lit_faces: usize,
    /// Around the solid voxels (model space).
    pub solid: Bounds,
    pub supports: Supports,
    /// Blocks along each axis.
    pub blocks: UVec3,
}

impl GpuModel {
    /// `weights` are those of [`crate::lights::emitters::weights`].
    pub fn of(model: &BodyModel, weights: &[f64]) -> Self {
        let lit = LitFaces::of(model);
        let emissive = EmissiveFaces::of(model, weights);
        let mut vectors = masks(model);
        vectors.extend(materials(model));
        vectors.extend(lit.vectors());
        let first_emissive = vectors.len();
        vectors.extend(emissive.vectors());
        Self {
            vectors,
            first_emissive,
            emissive,
            lit_faces: lit.count(),
            solid: solid(model),
            supports: Supports::of(model),
            blocks: blocks_of(model.size),
        }
    }
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

    fn voxel_of(lit: &LitFaces, model: &BodyModel, block: UVec3, face: usize) -> Option<UVec3> {
        let blocks = blocks_of(model.size);
        let word = lit.blocks[(block.x + blocks.x * (block.y + blocks.y * block.z)) as usize];
        let before = (word & ((1 << face) - 1)).count_ones();
        let packed = lit.voxels[((word >> 6) + before) as usize % lit.count()];
        let part = |shift: u32| packed >> shift & 0x3f;
        (word >> face & 1 != 0).then(|| {
            assert_eq!(packed >> 18, face as u32);
            UVec3::new(part(0), part(6), part(12))
        })
    }

    #[test]
    fn middles_are_those_of_the_exposed_faces_of_a_block() {
        let cube = model(UVec3::splat(16), |_| true);
        let lit = LitFaces::of(&cube);
        let top = voxel_of(&lit, &cube, UVec3::new(1, 3, 2), 3).expect("the top is exposed");
        assert_eq!(top.y, 15);
        assert!((5..7).contains(&top.x) && (9..11).contains(&top.z), "{top}");
        assert_eq!(
            voxel_of(&lit, &cube, UVec3::new(1, 3, 2), 2),
            None,
            "its lower side is not"
        );
        assert_eq!(lit.count(), 6 * 16, "nor is anything inside");
    }

    #[test]
    fn every_exposed_face_has_light() {
        for size in [
            UVec3::new(1, 1, 1),
            UVec3::new(7, 1, 7),
            UVec3::new(13, 30, 5),
        ] {
            let porous = model(size, |at| (at.x * 7 + at.y * 3 + at.z * 5) % 4 != 0);
            let all = LitFaces::of(&porous);
            for voxel in porous.solid() {
                for (face, facing) in FACES.iter().enumerate() {
                    if porous.material(voxel + *facing) == 0 {
                        let block = voxel.as_uvec3() / BLOCK;
                        let lit = voxel_of(&all, &porous, block, face).expect("it is exposed");
                        assert_eq!(lit / BLOCK, block, "{voxel} {face}");
                        assert_eq!(porous.material(lit.as_ivec3() + *facing), 0);
                    }
                }
            }
        }
    }
}
