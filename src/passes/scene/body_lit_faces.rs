//! The faces of models with stored light, as the shaders read them (`shaders/probes/body_faces.wesl`).

use glam::{IVec3, UVec3};

use super::body_models::{BLOCK, FACES, blocks_of, in_fours, places};
use crate::world::bodies::BodyModel;

/// Columns of voxels of a block.
const COLUMNS: usize = 16;
/// How many lit faces a block has on a side at most.
const RANKS: usize = 2;

/// The lit faces of a model: for each block of 4³ voxels and each of its sides on which any voxel's face is exposed to air, one
/// that has a place for an exposed voxel of each column. Where columns have two such voxels, there are two lit faces: one for the
/// lower two of the four layers along the side's axis, one for the upper two. Of two voxels that are neighbours in a column, only
/// one can be exposed on a side.
pub struct LitFaces {
    /// For each block the number of its first face, and in the low twelve bits, two for each side, which it has.
    blocks: Vec<u32>,
    faces: Vec<[u32; 2]>,
}

impl LitFaces {
    pub fn of(model: &BodyModel) -> Self {
        let mut all = Self {
            blocks: Vec::new(),
            faces: Vec::new(),
        };
        for block in places(blocks_of(model.size)) {
            let first = all.faces.len() as u32;
            let mut found = 0;
            for side in 0..FACES.len() {
                for (rank, layers) in by_rank(exposed(model, block, side)).enumerate() {
                    found |= 1 << (side * RANKS + rank);
                    all.faces.push(packed(block, side, layers));
                }
            }
            all.blocks.push(first << (FACES.len() * RANKS) | found);
        }
        all
    }

    pub fn count(&self) -> usize {
        self.faces.len()
    }

    /// Four blocks in a vector; then the number of faces and, from the next vector on, the faces, two in a vector.
    pub fn vectors(&self) -> Vec<[u32; 4]> {
        let count = [self.count() as u32];
        let lists = [&self.blocks[..], &count, self.faces.as_flattened()];
        lists.iter().flat_map(|words| in_fours(words)).collect()
    }
}

/// For each column one bit for each layer in which a voxel's face is exposed.
fn exposed(model: &BodyModel, block: UVec3, side: usize) -> [u32; COLUMNS] {
    let is_exposed = |column, layer| {
        let voxel = (block * BLOCK + place(side, column, layer)).as_ivec3();
        model.material(voxel) != 0 && model.material(voxel + FACES[side]) == 0
    };
    std::array::from_fn(|column| {
        let layers = (0..BLOCK).filter(|layer| is_exposed(column, *layer));
        layers.fold(0, |found, layer| found | 1 << layer)
    })
}

/// The layers of the lit faces of a side: none, one or two.
fn by_rank(exposed: [u32; COLUMNS]) -> impl Iterator<Item = [Option<u32>; COLUMNS]> {
    let has_two = exposed.iter().any(|layers| layers.count_ones() > 1);
    let masks = if has_two {
        [0b0011, 0b1100]
    } else {
        [0b1111, 0]
    };
    let of_mask = move |mask: u32| {
        exposed.map(|layers| (layers & mask != 0).then(|| (layers & mask).trailing_zeros()))
    };
    let all = masks.into_iter().map(of_mask);
    all.filter(|layers| layers.iter().any(Option::is_some))
}

/// Of the two axes of a side's plane the lower one varies faster from column to column.
fn place(side: usize, column: usize, layer: u32) -> UVec3 {
    let (low, high) = (column as u32 & 3, column as u32 >> 2);
    match side / 2 {
        0 => UVec3::new(layer, low, high),
        1 => UVec3::new(low, layer, high),
        _ => UVec3::new(low, high, layer),
    }
}

/// In the first word the block's coordinates, the side, and a bit for each column with an exposed voxel; in the second two bits for
/// the layer of each: of those without such a voxel that of the nearest column which has one.
fn packed(block: UVec3, side: usize, layers: [Option<u32>; COLUMNS]) -> [u32; 2] {
    let way = |from: usize, to: usize| {
        let way = place(2, from, 0).as_ivec3() - place(2, to, 0).as_ivec3();
        IVec3::length_squared(way)
    };
    let nearest = |column: usize| {
        let exposed = (0..COLUMNS).filter(|other| layers[*other].is_some());
        let nearest = exposed.min_by_key(|other| way(column, *other));
        nearest.and_then(|other| layers[other]).unwrap_or(0)
    };
    let mut words = [
        block.x | block.y << 4 | block.z << 8 | (side as u32) << 12,
        0,
    ];
    for (column, layer) in layers.iter().enumerate() {
        words[0] |= u32::from(layer.is_some()) << (16 + column);
        words[1] |= layer.unwrap_or_else(|| nearest(column)) << (2 * column);
    }
    words
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

    /// The voxels that the faces of a block stand for on a side.
    fn voxels(lit: &LitFaces, model: &BodyModel, block: UVec3, side: usize) -> Vec<UVec3> {
        let blocks = blocks_of(model.size);
        let word = lit.blocks[(block.x + blocks.x * (block.y + blocks.y * block.z)) as usize];
        let has = |rank: usize| word >> (2 * side + rank) & 1 != 0;
        let ranks = (0..RANKS).filter(|rank| has(*rank));
        let faces = ranks.map(|rank| {
            let before = (word & ((1 << (2 * side + rank)) - 1)).count_ones();
            (rank, lit.faces[((word >> 12) + before) as usize])
        });
        let of_face = |(rank, face): (usize, [u32; 2])| {
            let part = |shift: u32| face[0] >> shift & 15;
            assert_eq!(UVec3::new(part(0), part(4), part(8)), block);
            assert_eq!(face[0] >> 12 & 7, side as u32);
            let exposed = (0..COLUMNS).filter(move |column| face[0] >> (16 + column) & 1 != 0);
            exposed.map(move |column| {
                let layer = face[1] >> (2 * column) & 3;
                assert!(!has(1) || layer >> 1 == rank as u32, "shaders find it so");
                block * BLOCK + place(side, column, layer)
            })
        };
        faces.flat_map(of_face).collect()
    }

    #[test]
    fn a_cube_has_faces_on_its_sides_alone() {
        let cube = model(UVec3::splat(16), |_| true);
        let lit = LitFaces::of(&cube);
        let block = UVec3::new(1, 3, 2);
        let top = voxels(&lit, &cube, block, 3);
        assert_eq!(top.len(), COLUMNS);
        assert!(top.iter().all(|voxel| voxel.y == 15), "{top:?}");
        assert!(voxels(&lit, &cube, block, 2).is_empty());
        assert_eq!(lit.count(), 6 * 16, "nor is anything inside");
    }

    #[test]
    fn columns_without_an_exposed_voxel_have_the_layer_of_a_neighbour() {
        let step = model(UVec3::splat(4), |at| at.x == 0 && at.y < 2);
        let lit = LitFaces::of(&step);
        let top = lit.faces.iter().find(|face| face[0] >> 12 & 7 == 3);
        let [_, layers] = top.expect("the top is exposed");
        assert_eq!(*layers, 0x5555_5555, "the top voxels are in layer 1");
    }

    #[test]
    fn every_exposed_face_of_a_voxel_has_light_once() {
        for size in [
            UVec3::new(1, 1, 1),
            UVec3::new(7, 1, 7),
            UVec3::new(13, 30, 5),
        ] {
            let porous = model(size, |at| (at.x * 7 + at.y * 3 + at.z * 5) % 4 != 0);
            let all = LitFaces::of(&porous);
            for (side, facing) in FACES.iter().enumerate() {
                let lit = places(blocks_of(size)).flat_map(|at| voxels(&all, &porous, at, side));
                let mut lit: Vec<[i32; 3]> = lit.map(|voxel| voxel.as_ivec3().into()).collect();
                let exposed = porous
                    .solid()
                    .filter(|voxel| porous.material(*voxel + *facing) == 0);
                let mut exposed: Vec<[i32; 3]> = exposed.map(Into::into).collect();
                lit.sort_unstable();
                exposed.sort_unstable();
                assert_eq!(lit, exposed, "{size} {facing}");
            }
        }
    }
}
