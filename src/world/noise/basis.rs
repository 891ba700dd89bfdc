//! The four base noises, each over one permutation table of the `noise` crate.
//!
//! Perlin and value noise are the crate's own functions. OpenSimplex and Worley are summed here over
//! the crate's tables and gradients, because the crate omits lattice points in both: its 3D OpenSimplex
//! drops points outside the current simplex although their kernels reach into it, and its Worley
//! searches only eight cells, so both jump at cell borders. A field with jumps has no Lipschitz
//! constant, and the blocks of a world are culled by that constant.

use noise::core::perlin::perlin_3d;
use noise::core::value::value_3d;
use noise::permutationtable::{NoiseHasher, PermutationTable};
use noise::{NoiseFn, Seedable};

use super::Basis;

impl Basis {
    /// Upper bound of |∇|, per unit of the basis' own lattice.
    ///
    /// For the lattice noises: the supremum over points, directions and every choice of gradients
    /// (values) at the lattice points around, found numerically and rounded up (4.3302 at the middle
    /// of a cell, 1.7620, 3.7500). Worley is twice a distance.
    pub fn lipschitz(self) -> f64 {
        match self {
            Basis::Perlin => 4.331,
            Basis::OpenSimplex => 1.763,
            Basis::Worley => 2.0,
            Basis::Value => 3.751,
        }
    }

    /// Upper bound of the absolute value.
    pub fn amplitude(self) -> f64 {
        match self {
            Basis::OpenSimplex => 0.538,
            Basis::Perlin | Basis::Worley | Basis::Value => 1.0,
        }
    }
}

/// One octave: a basis over the permutation table of one seed.
#[derive(Clone, Debug)]
pub(super) struct Octave {
    basis: Basis,
    table: PermutationTable,
    seed: u32,
}

impl Octave {
    pub(super) fn new(basis: Basis, seed: u32) -> Self {
        Self {
            basis,
            table: PermutationTable::new(seed),
            seed,
        }
    }
}

/// Beyond this, lattice points are more than one apart in f64, and no noise is left; the crate's
/// functions panic if a lattice point does not fit a 64-bit integer.
const FARTHEST: f64 = (1u64 << 52) as f64;

impl NoiseFn<f64, 3> for Octave {
    fn get(&self, point: [f64; 3]) -> f64 {
        // Unlike `clamp`, these also turn NaN into a number.
        #[allow(clippy::manual_clamp)]
        let point = point.map(|v| v.max(-FARTHEST).min(FARTHEST));
        match self.basis {
            Basis::Perlin => perlin_3d(point.into(), &self.table),
            Basis::Value => value_3d(point.into(), &self.table),
            Basis::OpenSimplex => open_simplex(point, &self.table),
            Basis::Worley => worley(point, &self.table),
        }
    }
}

// The crate's fractals require these two traits, but the fields pass them finished sources.
impl Default for Octave {
    fn default() -> Self {
        Self::new(Basis::Perlin, 0)
    }
}

impl Seedable for Octave {
    fn set_seed(self, seed: u32) -> Self {
        Self::new(self.basis, seed)
    }

    fn seed(&self) -> u32 {
        self.seed
    }
}

/// The lattice points, relative to the floor of a stretched point, whose kernel can reach it.
#[rustfmt::skip]
const OPEN_SIMPLEX_REACH: [[i32; 3]; 26] = [
    [0, 0, 0], [1, -1, 0], [1, 0, -1], [-1, 1, 0], [0, 1, -1], [-1, 0, 1], [0, -1, 1],
    [1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 1, 1], [1, -1, 1], [1, 1, -1],
    [0, 1, 1], [1, 0, 1], [1, 1, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2],
    [1, 1, 1], [0, 1, 2], [0, 2, 1], [1, 0, 2], [2, 0, 1], [1, 2, 0], [2, 1, 0],
];

/// OpenSimplex (Spencer 2014): kernels (2 − d²)⁴ times a gradient at every point of the face-centred
/// lattice within √2. The crate's gradients, hashing and scale; deviation: no point is left out.
fn open_simplex(point: [f64; 3], table: &PermutationTable) -> f64 {
    let stretch = -(point[0] + point[1] + point[2]) / 6.0;
    let floor = point.map(|v| (v + stretch).floor());
    let squish = (floor[0] + floor[1] + floor[2]) / 3.0;
    let relative: [f64; 3] = std::array::from_fn(|axis| point[axis] - floor[axis] - squish);
    let mut sum = 0.0;
    for offset in OPEN_SIMPLEX_REACH {
        let squish = f64::from(offset[0] + offset[1] + offset[2]) / 3.0;
        let delta: [f64; 3] =
            std::array::from_fn(|axis| relative[axis] - f64::from(offset[axis]) - squish);
        let t = 2.0 - dot(delta, delta);
        if t > 0.0 {
            let vertex: [isize; 3] =
                std::array::from_fn(|axis| floor[axis] as isize + offset[axis] as isize);
            sum += t.powi(4) * dot(delta, open_simplex_gradient(table.hash(&vertex)));
        }
    }
    sum / 14.0
}

/// The crate's 32 unit gradients: the edges of a cube twice, then its corners.
fn open_simplex_gradient(hash: usize) -> [f64; 3] {
    let index = hash % 32;
    let sign = |bit: usize| if index >> bit & 1 == 0 { 1.0 } else { -1.0 };
    let diagonal = std::f64::consts::FRAC_1_SQRT_2;
    let corner = 1.0 / 3.0_f64.sqrt();
    match index {
        24.. => [sign(0) * corner, sign(1) * corner, sign(2) * corner],
        _ => match index % 12 / 4 {
            0 => [sign(0) * diagonal, sign(1) * diagonal, 0.0],
            1 => [sign(0) * diagonal, 0.0, sign(1) * diagonal],
            _ => [0.0, sign(0) * diagonal, sign(1) * diagonal],
        },
    }
}

/// Worley 1996: 2d − 1, where d is the distance to the nearest feature point, at most 1. One feature
/// point lies within ½ of each lattice point, as in the crate. Deviation: all 27 lattice points around
/// are searched, and d ends at 1, beyond which a farther cell could hold the nearest point.
fn worley(point: [f64; 3], table: &PermutationTable) -> f64 {
    let near = point.map(f64::round);
    let mut nearest_squared: f64 = 1.0;
    for x in -1..=1 {
        for y in -1..=1 {
            for z in -1..=1 {
                let lattice = [
                    near[0] + f64::from(x),
                    near[1] + f64::from(y),
                    near[2] + f64::from(z),
                ];
                let jitter = worley_jitter(table.hash(&lattice.map(|v| v as isize)));
                let delta: [f64; 3] =
                    std::array::from_fn(|axis| point[axis] - lattice[axis] - jitter[axis]);
                nearest_squared = nearest_squared.min(dot(delta, delta));
            }
        }
    }
    2.0 * nearest_squared.sqrt() - 1.0
}

/// The crate's feature points: eight lengths up to ½ in 18 directions.
fn worley_jitter(hash: usize) -> [f64; 3] {
    let length = (hash >> 5 & 7) as f64 * 0.5 / 7.0;
    let diagonal = length * std::f64::consts::FRAC_1_SQRT_2;
    let direction = hash % 18;
    let sign = |bit: usize| {
        if direction >> bit & 1 == 0 {
            diagonal
        } else {
            -diagonal
        }
    };
    match direction {
        // Bit 1 negates the first axis named, bit 0 the second.
        0..4 => [sign(1), sign(0), 0.0],
        4..8 => [sign(1), 0.0, sign(0)],
        8..12 => [0.0, sign(1), sign(0)],
        12 => [length, 0.0, 0.0],
        13 => [0.0, length, 0.0],
        14 => [0.0, 0.0, length],
        15 => [-length, 0.0, 0.0],
        16 => [0.0, -length, 0.0],
        _ => [0.0, 0.0, -length],
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random_points(count: usize) -> impl Iterator<Item = [f64; 3]> {
        // Golden-ratio lattice: even, and the same in every run.
        (0..count).map(|i| {
            let i = i as f64;
            [
                i * 0.819_172_513_4,
                i * 0.671_043_606_7,
                i * 0.549_700_477_9,
            ]
            .map(|v| v % 40.0 - 20.0)
        })
    }

    #[test]
    fn points_of_any_size_have_a_value() {
        for basis in [
            Basis::Perlin,
            Basis::OpenSimplex,
            Basis::Worley,
            Basis::Value,
        ] {
            for far in [1e9, 1e19, 1e38, -1e300, f64::INFINITY, f64::NAN] {
                let value = Octave::new(basis, 1).get([far, 0.3, -far]);
                assert!(value.is_finite(), "{basis:?} at {far}: {value}");
            }
        }
    }

    #[test]
    fn open_simplex_differs_from_the_crate_only_by_the_points_it_drops() {
        let ours = Octave::new(Basis::OpenSimplex, 5);
        let crates = noise::OpenSimplex::new(5);
        let mut equal = 0;
        for p in random_points(20_000) {
            let difference = (ours.get(p) - crates.get(p)).abs();
            // The farthest dropped kernel still has t ≤ 2 − 4/3 at its own face.
            assert!(difference < 0.06, "{p:?}: {difference}");
            equal += usize::from(difference < 1e-9);
        }
        assert!(equal > 4_000, "only {equal} of 20000 points agree");
    }

    #[test]
    fn worley_agrees_with_the_crate_where_the_crate_finds_the_nearest_point() {
        let ours = Octave::new(Basis::Worley, 9);
        let crates =
            noise::Worley::new(9).set_return_type(noise::core::worley::ReturnType::Distance);
        let mut equal = 0;
        for p in random_points(20_000) {
            let (a, b) = (ours.get(p), crates.get(p));
            assert!(a <= b + 1e-12, "{p:?}: {a} > {b}");
            equal += usize::from((a - b).abs() < 1e-12);
        }
        assert!(equal > 18_000, "only {equal} of 20000 points agree");
    }

    #[test]
    fn every_basis_keeps_its_range_and_lipschitz_constant() {
        for basis in [
            Basis::Perlin,
            Basis::OpenSimplex,
            Basis::Worley,
            Basis::Value,
        ] {
            let octave = Octave::new(basis, 3);
            let mut steepest: f64 = 0.0;
            for (i, p) in random_points(40_000).enumerate() {
                let step = [1e-4, 1e-2, 0.3][i % 3];
                let q = [
                    p[0] + step,
                    p[1] - step * (i % 5) as f64,
                    p[2] + step * (i % 7) as f64,
                ];
                let delta = [q[0] - p[0], q[1] - p[1], q[2] - p[2]];
                let (a, b) = (octave.get(p), octave.get(q));
                assert!(
                    a.abs() <= basis.amplitude() + 1e-12,
                    "{basis:?} at {p:?}: {a}"
                );
                steepest = steepest.max((a - b).abs() / dot(delta, delta).sqrt());
            }
            assert!(steepest <= basis.lipschitz(), "{basis:?}: {steepest}");
            // The bound is useful only if it is close to the truth.
            assert!(steepest > 0.4 * basis.lipschitz(), "{basis:?}: {steepest}");
        }
    }
}
