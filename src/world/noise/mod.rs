//! Noise fields: a base noise of the `noise` crate under an optional fractal.

mod basis;
mod bounds;

use glam::DVec3;
use noise::permutationtable::{NoiseHasher, PermutationTable};
use noise::{Billow, Fbm, MultiFractal, NoiseFn, RidgedMulti};

use self::basis::Octave;
use super::sdf::NoiseId;

/// A named scalar field over space. The GPU evaluates the same field from the same permutation
/// tables (`shaders/sdf/noise.wesl`).
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseField {
    pub name: String,
    pub basis: Basis,
    pub fractal: Fractal,
    /// Multiplies the coordinates, per axis (0 makes the field constant along that axis).
    pub frequency: DVec3,
    /// Added to the coordinates after the frequency.
    pub offset: DVec3,
    pub seed: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    Perlin,
    OpenSimplex,
    /// Euclidean distance to the nearest feature point, from −1 (at it) to 1 (a cell away or farther).
    Worley,
    Value,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fractal {
    None,
    Fbm {
        octaves: u32,
        lacunarity: f64,
        persistence: f64,
    },
    Ridged {
        octaves: u32,
        lacunarity: f64,
        persistence: f64,
    },
    Billow {
        octaves: u32,
        lacunarity: f64,
        persistence: f64,
    },
}

/// Fields prepared for evaluation: permutation tables are built once, then shared by all threads.
#[derive(Clone, Debug)]
pub struct NoiseBank {
    fields: Vec<Prepared>,
    /// Seeds of the permutation tables, in the order of [`Self::packed_tables`].
    seeds: Vec<u32>,
}

#[derive(Clone, Debug)]
struct Prepared {
    field: NoiseField,
    generator: Generator,
    first_table: usize,
}

#[derive(Clone, Debug)]
enum Generator {
    Plain(Octave),
    Fbm(Fbm<Octave>),
    Ridged(RidgedMulti<Octave>),
    Billow(Billow<Octave>),
}

impl NoiseBank {
    /// Further octaves are left out: they lie below the rounding of an f32.
    pub const MAX_OCTAVES: u32 = 24;

    /// Prepares the fields; [`NoiseId`] indexes them in this order.
    pub fn new(fields: &[NoiseField]) -> Self {
        let mut seeds = Vec::new();
        let fields = fields
            .iter()
            .map(|field| {
                let wanted: Vec<u32> = (0..field.octaves())
                    .map(|octave| field.seed.wrapping_add(octave))
                    .collect();
                let first_table = seeds.windows(wanted.len()).position(|run| run == wanted);
                let first_table = first_table.unwrap_or_else(|| {
                    seeds.extend_from_slice(&wanted);
                    seeds.len() - wanted.len()
                });
                Prepared {
                    field: field.clone(),
                    generator: Generator::new(field, &wanted),
                    first_table,
                }
            })
            .collect();
        Self { fields, seeds }
    }

    /// The field's value at a point of world space.
    ///
    /// Perlin, value and Worley fields lie in [−1, 1], plain, fBm or billow; OpenSimplex in ±0.54, its
    /// billow in [−1, 0.08]. Ridges begin at −1 and may exceed 1: see [`NoiseField::amplitude`].
    pub fn value(&self, id: NoiseId, p_ws: DVec3) -> f64 {
        let prepared = &self.fields[id];
        let p = (p_ws * prepared.field.frequency + prepared.field.offset).to_array();
        match &prepared.generator {
            Generator::Plain(octave) => octave.get(p),
            Generator::Fbm(fractal) => fractal.get(p),
            Generator::Ridged(fractal) => fractal.get(p),
            Generator::Billow(fractal) => fractal.get(p),
        }
    }

    /// The field's definition.
    pub fn field(&self, id: NoiseId) -> &NoiseField {
        &self.fields[id].field
    }

    /// Index of the permutation table of the field's first octave; the others follow it.
    pub fn first_table(&self, id: NoiseId) -> usize {
        self.fields[id].first_table
    }

    /// The permutation tables, 256 entries each, as the GPU reads them: entry i of table t at
    /// 256·t + i. Never empty, because a binding must not be.
    pub fn packed_tables(&self) -> Vec<u32> {
        let tables = self.seeds.iter().map(|&seed| PermutationTable::new(seed));
        let packed: Vec<u32> = tables
            .flat_map(|table| (0..256).map(move |i| table.hash(&[i]) as u32))
            .collect();
        if packed.is_empty() { vec![0] } else { packed }
    }
}

impl Generator {
    fn new(field: &NoiseField, seeds: &[u32]) -> Self {
        let octaves: Vec<Octave> = seeds
            .iter()
            .map(|&seed| Octave::new(field.basis, seed))
            .collect();
        let count = octaves.len();
        match field.fractal {
            Fractal::None => Self::Plain(Octave::new(field.basis, field.seed)),
            Fractal::Fbm {
                lacunarity,
                persistence,
                ..
            } => Self::Fbm(
                Fbm::new(0)
                    .set_octaves(count)
                    .set_lacunarity(lacunarity)
                    .set_persistence(persistence)
                    .set_sources(octaves),
            ),
            Fractal::Ridged {
                lacunarity,
                persistence,
                ..
            } => Self::Ridged(
                RidgedMulti::new(0)
                    .set_octaves(count)
                    .set_lacunarity(lacunarity)
                    .set_persistence(persistence)
                    .set_attenuation(RIDGE_ATTENUATION)
                    .set_sources(octaves),
            ),
            Fractal::Billow {
                lacunarity,
                persistence,
                ..
            } => Self::Billow(
                Billow::new(0)
                    .set_octaves(count)
                    .set_lacunarity(lacunarity)
                    .set_persistence(persistence)
                    .set_sources(octaves),
            ),
        }
    }
}

/// Factor by which a ridge weakens the next octave.
pub(in crate::world) const RIDGE_ATTENUATION: f64 = 2.0;

#[cfg(test)]
mod tests {
    use super::*;

    fn fields() -> Vec<NoiseField> {
        let mut fields = Vec::new();
        for basis in [
            Basis::Perlin,
            Basis::OpenSimplex,
            Basis::Worley,
            Basis::Value,
        ] {
            for fractal in [
                Fractal::None,
                Fractal::Fbm {
                    octaves: 5,
                    lacunarity: 2.0,
                    persistence: 0.5,
                },
                Fractal::Ridged {
                    octaves: 4,
                    lacunarity: 2.1,
                    persistence: 0.7,
                },
                Fractal::Billow {
                    octaves: 3,
                    lacunarity: 1.9,
                    persistence: 0.6,
                },
            ] {
                fields.push(NoiseField {
                    name: format!("{basis:?} {fractal:?}"),
                    basis,
                    fractal,
                    frequency: DVec3::new(0.05, 0.02, 0.08),
                    offset: DVec3::new(0.3, -4.0, 11.0),
                    seed: 7,
                });
            }
        }
        fields
    }

    fn points(count: usize) -> impl Iterator<Item = DVec3> {
        (0..count).map(|i| {
            let i = i as f64;
            DVec3::new(i * 8.191_725_134, i * 6.710_436_067, i * 5.497_004_779) % 400.0 - 200.0
        })
    }

    #[test]
    fn fields_keep_their_range_and_variation() {
        let fields = fields();
        let bank = NoiseBank::new(&fields);
        for (id, field) in fields.iter().enumerate() {
            for (i, p) in points(4_000).enumerate() {
                let radius = [1e-3, 0.2, 2.6, 6.1][i % 4];
                let direction =
                    DVec3::new((i % 3) as f64 - 1.0, (i % 5) as f64 - 2.0, 0.5).normalize();
                let (a, b) = (bank.value(id, p), bank.value(id, p + radius * direction));
                assert!(
                    a.abs() <= field.amplitude() + 1e-9,
                    "{} at {p}: {a}",
                    field.name
                );
                let bound = field.variation(radius);
                assert!(
                    (a - b).abs() <= bound,
                    "{} at {p}: {} > {bound}",
                    field.name,
                    (a - b).abs()
                );
                assert!(bound <= field.lipschitz() * radius * (1.0 + 1e-9));
            }
        }
    }

    #[test]
    fn a_constant_axis_stays_constant() {
        let mut field = fields().swap_remove(1);
        field.frequency.y = 0.0;
        let bank = NoiseBank::new(&[field]);
        for p in points(50) {
            assert_eq!(bank.value(0, p), bank.value(0, p.with_y(-3.0)));
        }
    }

    #[test]
    fn fields_of_equal_seeds_share_their_tables() {
        let fields = fields();
        let bank = NoiseBank::new(&fields);
        // Fields of 1, 5, 4 and 3 octaves: the one octave came first, and the later runs share the
        // table of the five.
        assert_eq!(bank.packed_tables().len(), (1 + 5) * 256);
        let table = PermutationTable::new(7 + 2);
        let first = bank.first_table(1);
        assert_eq!(
            bank.packed_tables()[(first + 2) * 256 + 9],
            table.hash(&[9]) as u32
        );
    }

    #[test]
    fn the_bank_goes_to_any_thread() {
        fn any_thread<T: Send + Sync>() {}
        any_thread::<NoiseBank>();
    }
}
