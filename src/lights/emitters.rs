//! The exposed faces of emissive voxels, as a list from which shaders pick at random.

use glam::{IVec3, UVec3};
use rayon::prelude::*;

use crate::world::Material;
use crate::world::voxels::{BRICK_VOXELS, CELL, Cell, Voxels};

/// The normal of each facing: −x, +x, −y, +y, −z, +z.
const NORMALS: [IVec3; FACINGS] = [
    IVec3::NEG_X,
    IVec3::X,
    IVec3::NEG_Y,
    IVec3::Y,
    IVec3::NEG_Z,
    IVec3::Z,
];

crate::shared! {
    in lights;

    /// Directions in which faces can look, numbered −x, +x, −y, +y, −z, +z.
    pub const FACINGS: usize = 6;

    /// Faces that look in the same direction.
    pub struct GpuFacing as Facing {
        /// Sum over all faces that look in this direction.
        pub weight: f32,
        /// Range of its groups: the first, and one past the last.
        pub first: u32,
        pub end: u32,
    }

    /// Faces of one material that look in the same direction.
    pub struct GpuEmitterGroup as EmitterGroup {
        /// Index into [`Emitters::faces`].
        pub first: u32,
        pub count: u32,
        /// 1-based.
        pub material: u32,
        /// Sum over all faces of the group.
        pub weight: f32,
    }
}

/// Every face of an emissive voxel that borders on air, grouped by direction and material. The weight
/// of a face is the sum of the channels of the radiance that it emits; each face is one voxel edge
/// wide.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Emitters {
    pub facings: [GpuFacing; FACINGS],
    pub groups: Vec<GpuEmitterGroup>,
    /// Index of each face's voxel in the grid's extent (powers of two): x, then y, then z. Those of a group ascend.
    pub faces: Vec<u32>,
    /// Weight of a face of each material; empty if no material emits.
    weights: Vec<f64>,
}

/// Facing, material and voxel of a face in one number, so that sorting groups the faces.
type Face = u64;

/// Positions of the material and of the facing in a [`Face`], in bits.
const MATERIAL_BIT: u32 = 32;
const FACING_BIT: u32 = 40;

fn voxel_of(face: Face) -> u32 {
    face as u32
}

/// Facing and material of a face: what its group shares.
fn kind_of(face: Face) -> u64 {
    face >> MATERIAL_BIT
}

impl Emitters {
    /// Finds the exposed emissive faces, in parallel. The same voxels give the same list.
    pub fn find(voxels: &Voxels, materials: &[Material]) -> Self {
        let weights = weights(materials);
        if weights.iter().all(|&weight| weight <= 0.0) {
            return Self::default();
        }
        let used = voxels.size().map(|n| n.div_ceil(CELL));
        let mut sorted = found_in(voxels, &weights, UVec3::ZERO, used - 1);
        sorted.par_sort_unstable();
        let mut emitters = Self::none(weights);
        for group in sorted.chunk_by(|a, b| kind_of(*a) == kind_of(*b)) {
            emitters.faces.extend(group.iter().copied().map(voxel_of));
            emitters.end_group(kind_of(group[0]));
        }
        emitters
    }

    /// The list after an edit that may have changed the voxels of a box (both ends inclusive); `None`
    /// if the list did not change.
    pub fn after(&self, voxels: &Voxels, (low, high): (UVec3, UVec3)) -> Option<Self> {
        if self.weights.is_empty() {
            return None;
        }
        // A neighbour's face may have been uncovered.
        let low = low.saturating_sub(UVec3::ONE) / CELL;
        let high = (high + 1).min(voxels.size() - 1) / CELL;
        let mut found = found_in(voxels, &self.weights, low, high);
        found.sort_unstable();
        let mut both = self.within(voxels, low, high);
        both.extend(found);
        // Two ascending runs, which a stable sort merges. What went or came is there once.
        both.sort();
        let once = both.chunk_by(|a, b| a == b).filter(|same| same.len() == 1);
        let changed: Vec<Face> = once.flatten().copied().collect();
        if changed.is_empty() {
            return None;
        }
        let groups = (0..self.groups.len()).map(|group| self.kind(group));
        let mut kinds: Vec<u64> = groups.chain(changed.iter().copied().map(kind_of)).collect();
        kinds.sort_unstable();
        kinds.dedup();
        let mut next = Self::none(self.weights.clone());
        next.faces.reserve(self.faces.len() + changed.len());
        let (mut group, mut changed) = (0, &changed[..]);
        for kind in kinds {
            let mut rest = &[][..];
            if group < self.groups.len() && self.kind(group) == kind {
                rest = self.group(group);
                group += 1;
            }
            let of_kind;
            (of_kind, changed) =
                changed.split_at(changed.partition_point(|face| kind_of(*face) == kind));
            for voxel in of_kind.iter().copied().map(voxel_of) {
                let (before, after) = rest.split_at(rest.partition_point(|other| *other < voxel));
                next.faces.extend_from_slice(before);
                rest = match after.split_first() {
                    Some((first, after)) if *first == voxel => after,
                    _ => {
                        next.faces.push(voxel);
                        after
                    }
                };
            }
            next.faces.extend_from_slice(rest);
            next.end_group(kind);
        }
        Some(next)
    }

    /// The faces of a box of cells (both ends inclusive), ascending.
    fn within(&self, voxels: &Voxels, low: UVec3, high: UVec3) -> Vec<Face> {
        let shifts = shifts(voxels);
        // The faces of a group ascend by their voxels: those of the box lie between its lowest and its highest plane of z.
        let plane = |z: u32| u64::from(z * CELL) << (shifts.x + shifts.y);
        let (first, end) = (plane(low.z), plane(high.z + 1));
        let mut faces = Vec::new();
        for group in 0..self.groups.len() {
            let kind = self.kind(group) << MATERIAL_BIT;
            let voxels_of_group = self.group(group);
            let below =
                |limit: u64| voxels_of_group.partition_point(|voxel| u64::from(*voxel) < limit);
            let of_planes = &voxels_of_group[below(first)..below(end)];
            let in_box = of_planes.iter().filter(|voxel| {
                let cell = voxel_at(voxels, **voxel) / CELL;
                cell.cmpge(low).all() && cell.cmple(high).all()
            });
            faces.extend(in_box.map(|voxel| kind | u64::from(*voxel)));
        }
        faces
    }

    fn none(weights: Vec<f64>) -> Self {
        Self {
            weights,
            ..Self::default()
        }
    }

    /// The faces of a group.
    fn group(&self, group: usize) -> &[u32] {
        let GpuEmitterGroup { first, count, .. } = self.groups[group];
        &self.faces[first as usize..(first + count) as usize]
    }

    /// [`kind_of`] the faces of a group.
    fn kind(&self, group: usize) -> u64 {
        let ends = self.facings.iter().map(|facing| facing.end as usize);
        // Facings that no face has end at 0.
        let facing = ends.take_while(|end| *end <= group).count() as u64;
        facing << (FACING_BIT - MATERIAL_BIT) | u64::from(self.groups[group].material)
    }

    /// Makes a group of the faces behind the last group, if there are any.
    fn end_group(&mut self, kind: u64) {
        let first = self
            .groups
            .last()
            .map_or(0, |group| group.first + group.count);
        let count = self.faces.len() as u32 - first;
        if count == 0 {
            return;
        }
        let material = kind as u8;
        let weight = (self.weights[usize::from(material) - 1] * f64::from(count)) as f32;
        let group = self.groups.len() as u32;
        let facing = &mut self.facings[(kind >> (FACING_BIT - MATERIAL_BIT)) as usize];
        if facing.end == 0 {
            facing.first = group;
        }
        facing.end = group + 1;
        facing.weight += weight;
        self.groups.push(GpuEmitterGroup {
            first,
            count,
            material: u32::from(material),
            weight,
        });
    }

    /// Whether any material emits, so that edits may lengthen the list.
    pub fn may_grow(&self) -> bool {
        !self.weights.is_empty()
    }

    /// Size of the storage buffer `emitters` with room for `groups` groups.
    pub fn bytes(groups: usize) -> u64 {
        (6 * size_of::<GpuFacing>() + groups * size_of::<GpuEmitterGroup>()) as u64
    }

    /// The storage buffer `emitters`: the facings, then the groups (room for at least one).
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = bytemuck::cast_slice(&self.facings).to_vec();
        if self.groups.is_empty() {
            bytes.extend_from_slice(bytemuck::bytes_of(&GpuEmitterGroup::default()));
        }
        bytes.extend_from_slice(bytemuck::cast_slice(&self.groups));
        bytes
    }
}

/// The weight of a face of each material: the sum of the channels of its radiance.
pub fn weights(materials: &[Material]) -> Vec<f64> {
    let weight = |material: &Material| f64::from(material.emission.element_sum());
    materials.iter().map(weight).collect()
}

/// The exposed emissive faces of a box of cells (both ends inclusive), unordered. In parallel where there are many.
fn found_in(voxels: &Voxels, weights: &[f64], low: UVec3, high: UVec3) -> Vec<Face> {
    /// To wake other threads takes longer than to look through so many rows of cells.
    const FEW: u32 = 64;
    let materials = (1..=255).zip(weights);
    let emitting: Vec<u8> = materials
        .filter(|(_, weight)| **weight > 0.0)
        .map(|(material, _)| material)
        .collect();
    let cells = high + 1 - low;
    let of_row = |mut faces: Vec<Face>, row: u32| {
        for x in 0..cells.x {
            let cell = low + UVec3::new(x, row % cells.y, row / cells.y);
            push_exposed(voxels, cell, &emitting, &mut faces);
        }
        faces
    };
    let rows = 0..cells.y * cells.z;
    if rows.end <= FEW {
        rows.fold(Vec::new(), of_row)
    } else {
        rows.into_par_iter()
            .fold(Vec::new, of_row)
            .flatten_iter()
            .collect()
    }
}

/// Numbers of bits that x, y and z take in the index of a voxel.
fn shifts(voxels: &Voxels) -> UVec3 {
    voxels.cells().map(|n| (n * CELL).trailing_zeros())
}

/// The voxel with this index in the grid's extent.
fn voxel_at(voxels: &Voxels, index: u32) -> UVec3 {
    let shifts = shifts(voxels);
    let low_bits = |bits: u32| (1 << bits) - 1;
    UVec3::new(
        index & low_bits(shifts.x),
        (index >> shifts.x) & low_bits(shifts.y),
        index >> (shifts.x + shifts.y),
    )
}

/// Adds the exposed faces of the emissive voxels of one cell.
fn push_exposed(voxels: &Voxels, cell: UVec3, emitting: &[u8], faces: &mut Vec<Face>) {
    let of_all;
    let materials = match voxels.cell(cell) {
        Cell::Brick(materials) if emitting.iter().any(|emits| materials.contains(emits)) => {
            materials
        }
        Cell::Uniform(material) if emitting.contains(&material) && !is_buried(voxels, cell) => {
            of_all = [material; BRICK_VOXELS];
            &of_all
        }
        Cell::Empty | Cell::Uniform(_) | Cell::Brick(_) => return,
    };
    let shifts = shifts(voxels);
    for (index, material) in materials.iter().enumerate() {
        if !emitting.contains(material) {
            continue;
        }
        let index = index as u32;
        let voxel = cell * CELL + UVec3::new(index & 7, index >> 3 & 7, index >> 6);
        let place = voxel.x | voxel.y << shifts.x | voxel.z << (shifts.x + shifts.y);
        for (facing, normal) in NORMALS.iter().enumerate() {
            if voxels.material(voxel.as_ivec3() + normal) == 0 {
                let (facing, material) = (facing as u64, u64::from(*material));
                faces.push(facing << FACING_BIT | material << MATERIAL_BIT | u64::from(place));
            }
        }
    }
}

/// Whether solid voxels fill every neighbour of a cell, so that none of its voxels borders on air.
fn is_buried(voxels: &Voxels, cell: UVec3) -> bool {
    NORMALS.iter().all(|facing| {
        let neighbour = cell.as_ivec3() + facing;
        let inside = neighbour.cmpge(IVec3::ZERO).all()
            && (neighbour * CELL as i32)
                .cmplt(voxels.size().as_ivec3())
                .all();
        inside && matches!(voxels.cell(neighbour.as_uvec3()), Cell::Uniform(_))
    })
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::world::voxels::{NewCell, brick_index};
    use crate::world::{Colour, MaterialSound, Pattern};

    fn material(emission: Vec3) -> Material {
        let colour = Colour::Flat(Vec3::splat(0.5));
        Material {
            name: "m".into(),
            a: colour.clone(),
            b: colour,
            pattern: Pattern::Plain,
            emission,
            sound: MaterialSound::Stone,
        }
    }

    /// Solid voxels in an irregular pattern, whole cells of one material, and air.
    fn scattered(voxel: UVec3) -> u8 {
        if voxel.cmplt(UVec3::splat(24)).all() && voxel.x >= 8 {
            return 2;
        }
        let hash = (voxel.x * 7919 + voxel.y * 104_729 + voxel.z * 1299 + 17) % 11;
        if hash < 4 { hash as u8 } else { 0 }
    }

    fn voxels(size: UVec3) -> Voxels {
        Voxels::from_cells(size, |cell| {
            let mut brick = Box::new([0; BRICK_VOXELS]);
            for index in 0..BRICK_VOXELS as u32 {
                let local = UVec3::new(index % 8, index / 8 % 8, index / 64);
                let voxel = cell * CELL + local;
                if voxel.cmplt(size).all() {
                    brick[brick_index(local)] = scattered(voxel);
                }
            }
            NewCell::Voxels(brick)
        })
    }

    #[test]
    fn the_list_holds_each_face_of_a_scan_of_all_voxels_once() {
        let size = UVec3::new(30, 37, 26);
        let voxels = voxels(size);
        let materials = [Vec3::ZERO, Vec3::new(1.0, 0.5, 0.0), Vec3::splat(0.25)].map(material);
        let emitters = Emitters::find(&voxels, &materials);
        let mut expected = Vec::new();
        for index in 0..size.element_product() {
            let voxel = UVec3::new(
                index % size.x,
                index / size.x % size.y,
                index / (size.x * size.y),
            );
            let material = scattered(voxel);
            for (facing, normal) in NORMALS.iter().enumerate().filter(|_| material >= 2) {
                if voxels.material(voxel.as_ivec3() + normal) == 0 {
                    // The extent is 32 × 64 × 32.
                    let place = voxel.x | voxel.y << 5 | voxel.z << 11;
                    expected.push((facing, u32::from(material), place));
                }
            }
        }
        expected.sort_unstable();
        let mut listed = Vec::new();
        for (facing, of) in emitters.facings.iter().enumerate() {
            let mut weight = 0.0;
            for group in &emitters.groups[of.first as usize..of.end as usize] {
                weight += group.weight;
                let emission = [0.0, 1.5, 0.75][group.material as usize - 1];
                assert_eq!(group.weight, emission * group.count as f32);
                let range = group.first as usize..(group.first + group.count) as usize;
                let faces = emitters.faces[range].iter();
                listed.extend(faces.map(|&face| (facing, group.material, face)));
            }
            assert_eq!(of.weight, weight);
        }
        assert!(expected.len() > 1000);
        assert_eq!(listed, expected);
    }

    #[test]
    fn an_edited_list_equals_a_new_list() {
        let mut voxels = voxels(UVec3::new(30, 37, 26));
        let materials = [Vec3::ZERO, Vec3::new(1.0, 0.5, 0.0), Vec3::splat(0.25)].map(material);
        let mut emitters = Emitters::find(&voxels, &materials);
        let mut same = 0;
        assert!(emitters.faces.len() > 1000);
        // Holes, solid boxes that hide emitters, boxes that emit, at the edge of the world and across
        // cells.
        for (low, high, material) in [
            ([3, 4, 5], [3, 4, 5], 0),
            ([6, 6, 6], [17, 9, 8], 1),
            ([0, 0, 0], [2, 3, 1], 2),
            ([20, 30, 20], [29, 36, 25], 3),
            ([12, 12, 12], [12, 12, 12], 3),
            ([12, 12, 12], [12, 12, 12], 3),
            ([0, 0, 0], [29, 36, 25], 0),
        ] {
            let edit = voxels.fill_box(IVec3::from(low), IVec3::from(high), material);
            let truth = Emitters::find(&voxels, &materials);
            let region = edit.region.unwrap_or_default();
            let after = emitters.after(&voxels, region);
            assert_eq!(after.is_none(), truth == emitters, "{low:?} {high:?}");
            same += u32::from(after.is_none());
            emitters = after.unwrap_or(emitters);
            assert_eq!(emitters, truth, "{low:?} {high:?}");
        }
        assert!(same > 0, "a voxel that is set twice changes nothing");
        assert!(emitters.faces.is_empty());
    }

    #[test]
    fn a_list_without_faces_follows_edits_too() {
        let mut voxels = Voxels::empty(UVec3::splat(24));
        let materials = [material(Vec3::ONE)];
        let empty = Emitters::find(&voxels, &materials);
        let built = voxels.fill_box(IVec3::splat(5), IVec3::splat(9), 1);
        let lit = empty.after(&voxels, built.region.expect("in the world"));
        let lit = lit.expect("its faces are exposed");
        assert_eq!(lit, Emitters::find(&voxels, &materials));
        let dug = voxels.fill_box(IVec3::splat(5), IVec3::splat(9), 0);
        let dark = lit.after(&voxels, dug.region.expect("in the world"));
        assert_eq!(dark, Some(empty));
    }

    #[test]
    fn a_dark_world_has_no_emitters() {
        let emitters = Emitters::find(&voxels(UVec3::splat(20)), &[Vec3::ZERO; 3].map(material));
        assert_eq!(emitters, Emitters::default());
        assert_eq!(
            emitters.to_bytes().len(),
            6 * size_of::<GpuFacing>() + size_of::<GpuEmitterGroup>()
        );
    }
}
