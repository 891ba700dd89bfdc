//! How much geometry there is in the cells of an octree: what decides whether they are divided.

use glam::{DVec3, IVec3, UVec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::cells::Lattice;
use crate::probes::sampling::fibonacci;
use crate::world::scenery::{OctreeSpec, Split};
use crate::world::voxels::{CELL, Cell, Voxels, brick_index};

/// Rays from the middle of a cell, as in the published octree of probes with its surfels.
const RAYS: u32 = 64;

/// Fewest cells that an edit hands to another thread.
const CELLS_A_TASK: usize = 64;

/// The surfaces in the cells of one world.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Geometry {
    split: Split,
    divide_at: f32,
    free_below: f32,
    depth: u32,
    roots: UVec3,
    step: IVec3,
    /// Voxel of the lattice's first point in grid space.
    first: IVec3,
    /// By level, the surface voxels of each cell of the whole lattice. A surface voxel is air beside a solid voxel.
    surface: Vec<Vec<u32>>,
    /// Hit fractions that are known.
    hits: FxHashMap<(u32, IVec3), f32>,
}

impl Geometry {
    pub fn new(
        spec: &OctreeSpec,
        roots: UVec3,
        step: IVec3,
        first: IVec3,
        voxels: &Voxels,
    ) -> Self {
        let mut geometry = Self {
            split: spec.split,
            divide_at: spec.divide_at,
            free_below: spec.free_below,
            depth: spec.depth,
            roots,
            step,
            first,
            surface: Vec::new(),
            hits: FxHashMap::default(),
        };
        let lattice = Lattice(geometry.counts(0));
        let numbers = (0..lattice.count()).into_par_iter();
        let finest = numbers.map(|number| geometry.count(voxels, lattice.place(number)));
        let finest = finest.collect();
        geometry.surface.push(finest);
        for level in 1..=spec.depth {
            let n = geometry.counts(level).element_product();
            geometry.surface.push(vec![0; n as usize]);
            geometry.sum(level, IVec3::ZERO, geometry.counts(level).as_ivec3() - 1);
        }
        geometry
    }

    /// Brings up to date what voxels that have changed (grid space, both ends inclusive) make different.
    pub fn edit(&mut self, voxels: &Voxels, first: IVec3, last: IVec3) {
        // Cells share their outermost voxels, and a voxel makes its neighbours surfaces.
        let low = (first - 2 - self.first)
            .div_euclid(self.step)
            .max(IVec3::ZERO);
        let high = (last + 2 - self.first)
            .div_euclid(self.step)
            .min(self.counts(0).as_ivec3() - 1);
        if low.cmpgt(high).any() {
            return;
        }
        let cells: Vec<IVec3> = places(low, high).collect();
        let counts = cells.par_iter().with_min_len(CELLS_A_TASK);
        let counts: Vec<u32> = counts.map(|cell| self.count(voxels, *cell)).collect();
        for (cell, count) in cells.into_iter().zip(counts) {
            let index = self.index(0, cell);
            self.surface[0][index] = count;
        }
        for level in 1..=self.depth {
            self.sum(level, low >> level, high >> level);
        }
        self.hits.retain(|(level, cell), _| {
            let (from, to) = (*cell << *level, ((*cell + 1) << *level) - 1);
            to.cmplt(low).any() || from.cmpgt(high).any()
        });
    }

    /// Which cells of a level are divided.
    pub fn divided(&mut self, voxels: &Voxels, level: u32, cells: &[IVec3]) -> Vec<bool> {
        let surfaces = |cell: &IVec3| self.surface[level as usize][self.index(level, *cell)];
        if self.split == Split::Surface {
            let size = (self.step << level).as_vec3();
            // The mean of a cell's faces.
            let face = (size.x * size.y + size.y * size.z + size.z * size.x) / 3.0;
            let is_divided = |cell: &IVec3| surfaces(cell) as f32 > self.divide_at * face;
            return cells.iter().map(is_divided).collect();
        }
        let is_unknown =
            |cell: &&IVec3| surfaces(cell) > 0 && !self.hits.contains_key(&(level, **cell));
        let unknown: Vec<IVec3> = cells.iter().filter(is_unknown).copied().collect();
        let found: Vec<f32> = unknown
            .par_iter()
            .map(|cell| self.hit_fraction(voxels, level, *cell))
            .collect();
        self.hits
            .extend(unknown.iter().map(|cell| (level, *cell)).zip(found));
        let hits = |cell: &IVec3| self.hits.get(&(level, *cell)).copied().unwrap_or(0.0);
        cells
            .iter()
            .map(|cell| hits(cell) >= self.divide_at)
            .collect()
    }

    /// Whether a leaf with one probe in its middle keeps it.
    pub fn is_kept(&self, voxels: &Voxels, level: u32, cell: IVec3) -> bool {
        let has_surface = self.surface[level as usize][self.index(level, cell)] > 0;
        let fraction = || match self.hits.get(&(level, cell)) {
            Some(known) => *known,
            None => self.hit_fraction(voxels, level, cell),
        };
        has_surface && fraction() >= self.free_below
    }

    /// Cells of a level along each axis.
    fn counts(&self, level: u32) -> UVec3 {
        self.roots << (self.depth - level)
    }

    fn index(&self, level: u32, cell: IVec3) -> usize {
        Lattice(self.counts(level)).number(cell)
    }

    /// Sums the surfaces of children for the cells from `low` to `high`.
    fn sum(&mut self, level: u32, low: IVec3, high: IVec3) {
        for cell in places(low, high) {
            let children = places(cell * 2, cell * 2 + 1);
            let sum = children
                .map(|child| self.surface[level as usize - 1][self.index(level - 1, child)])
                .sum();
            let index = self.index(level, cell);
            self.surface[level as usize][index] = sum;
        }
    }

    /// Surface voxels of a cell of the finest lattice. Its last voxels along an axis are its neighbours' first.
    fn count(&self, voxels: &Voxels, cell: IVec3) -> u32 {
        let low = self.first + cell * self.step;
        let high = low + self.step - 1;
        if is_plain(voxels, low - 1, high + 1) {
            return 0;
        }
        // Also the voxels around the cell, so that each is looked up once.
        let around = Lattice((self.step + 2).as_uvec3());
        let is_solid = solid_in(voxels, low - 1, high + 1);
        let [row, layer] = [IVec3::Y, IVec3::Z].map(|step| around.number(step));
        let is_surface = |place: &IVec3| {
            let at = around.number(*place);
            let beside = [1, row, layer];
            let beside = beside.iter().flat_map(|way| [at - way, at + way]);
            !is_solid[at] && beside.into_iter().any(|at| is_solid[at])
        };
        places(IVec3::ONE, self.step).filter(is_surface).count() as u32
    }

    /// Share of the rays from a cell's middle that find a surface in the cell. From a solid middle: that find air.
    fn hit_fraction(&self, voxels: &Voxels, level: u32, cell: IVec3) -> f32 {
        let size = self.step << level;
        let low = self.first + cell * size;
        let middle = low + size / 2;
        let is_solid = voxels.material(middle) != 0;
        let finds = |ray: &u32| {
            let mut walk = Walk::new(middle, fibonacci(*ray, RAYS));
            loop {
                let voxel = walk.next();
                if voxel.cmplt(low).any() || voxel.cmpgt(low + size).any() {
                    return false;
                }
                if (voxels.material(voxel) != 0) != is_solid {
                    return true;
                }
            }
        };
        (0..RAYS).filter(finds).count() as f32 / RAYS as f32
    }
}

/// Which voxels of a box are solid (both ends inclusive), by x, then y, then z.
pub(super) fn solid_in(voxels: &Voxels, low: IVec3, high: IVec3) -> Vec<bool> {
    let extent = high - low + 1;
    let mut solid = vec![false; extent.element_product() as usize];
    let last = (voxels.size().as_ivec3() - 1).min(high);
    let cell = CELL as i32;
    for (row, start) in
        places(low.with_x(0), high.with_x(0)).zip(solid.chunks_mut(extent.x as usize))
    {
        if row.cmplt(IVec3::ZERO).any() || row.cmpgt(last).any() {
            continue;
        }
        // From one cell of the grid to the next.
        let mut x = low.x.max(0);
        while x <= last.x {
            let end = (x / cell * cell + cell - 1).min(last.x);
            let part = &mut start[(x - low.x) as usize..=(end - low.x) as usize];
            match voxels.cell(row.with_x(x).as_uvec3() / CELL) {
                Cell::Empty => {}
                Cell::Uniform(_) => part.fill(true),
                Cell::Brick(materials) => {
                    let first = brick_index(row.with_x(x).as_uvec3() % CELL);
                    for (is_solid, material) in part.iter_mut().zip(&materials[first..]) {
                        *is_solid = *material != 0;
                    }
                }
            }
            x = end + 1;
        }
    }
    solid
}

/// Whether the grid's cells around these voxels are all air or all solid.
fn is_plain(voxels: &Voxels, low: IVec3, high: IVec3) -> bool {
    let size = voxels.size().as_ivec3();
    if low.cmpge(size).any() || high.cmplt(IVec3::ZERO).any() {
        return true;
    }
    let reaches_out = low.cmplt(IVec3::ZERO).any() || high.cmpge(size).any();
    let cell = CELL as i32;
    let (first, last) = (low.max(IVec3::ZERO) / cell, high.min(size - 1) / cell);
    let (mut air, mut solid) = (reaches_out, false);
    for place in places(first, last) {
        match voxels.cell(place.as_uvec3()) {
            Cell::Empty => air = true,
            Cell::Uniform(_) => solid = true,
            Cell::Brick(_) => return false,
        }
    }
    !(air && solid)
}

pub(super) fn places(low: IVec3, high: IVec3) -> impl Iterator<Item = IVec3> {
    let row = move |z, y| (low.x..=high.x).map(move |x| IVec3::new(x, y, z));
    let layer = move |z| (low.y..=high.y).flat_map(move |y| row(z, y));
    (low.z..=high.z).flat_map(layer)
}

/// Amanatides & Woo 1987, from the middle of a voxel.
struct Walk {
    voxel: IVec3,
    step: IVec3,
    /// Along the ray, to the next border on each axis, and between borders.
    ahead: DVec3,
    apart: DVec3,
}

impl Walk {
    fn new(voxel: IVec3, direction: DVec3) -> Self {
        let apart = direction.abs().recip();
        Self {
            voxel,
            step: direction.signum().as_ivec3(),
            ahead: apart * 0.5,
            apart,
        }
    }

    /// The next voxel on the ray.
    fn next(&mut self) -> IVec3 {
        let axis = self.ahead.min_position();
        self.ahead[axis] += self.apart[axis];
        self.voxel[axis] += self.step[axis];
        self.voxel
    }
}
