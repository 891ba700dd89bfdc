//! The masks of the block textures as functions of the plane, each periodic over a tile of whole
//! blocks, so that tiles repeat seamlessly.

use std::f64::consts::TAU;

use noise::{NoiseFn, Perlin};

use super::Pattern;
use super::bake::TEXELS;
use super::hash::{hash, unit};

/// A pattern ready for evaluation: its lattices are fitted to the tile.
pub struct Mask {
    extent: f64,
    kind: Kind,
    /// Samples along a texel's edge that its average needs: 1 for smooth patterns.
    pub samples: u32,
}

enum Kind {
    Plain,
    Stripes {
        pitch: f64,
        width: f64,
    },
    Dots {
        lattice: Lattice,
        radius: f64,
    },
    Checker {
        squares: f64,
    },
    Bricks {
        rows: u32,
        joint: f64,
        seed: u32,
        grain: TorusFbm,
    },
    Worley {
        points: FeaturePoints,
        radius: f64,
    },
    Fbm(TorusFbm),
    StripesFbm {
        streaks: TorusFbm,
        strength: TorusFbm,
    },
    Radial {
        rings: f64,
        seed: u32,
        wobble: TorusFbm,
    },
}

/// Texels that a cell of the finest octave needs along its edge.
const TEXELS_PER_CELL: u64 = 2;

/// Blocks along a tile's edge: as few as the pattern closes over, but several where repetition would be
/// visible.
pub fn extent_blocks(pattern: &Pattern) -> u32 {
    match *pattern {
        Pattern::Plain => 1,
        Pattern::Stripes { pitch, .. } => {
            closest_extent(|blocks| distance_to_whole(blocks / f64::from(pitch)))
        }
        Pattern::Dots {
            pitch, angle_deg, ..
        } => {
            let (sin, cos) = f64::from(angle_deg).to_radians().sin_cos();
            closest_extent(|blocks| {
                let along = blocks / f64::from(pitch);
                distance_to_whole(along * cos).max(distance_to_whole(along * sin))
            })
        }
        Pattern::Checker { squares } => 1 + squares % 2,
        Pattern::Bricks { .. } => 2,
        Pattern::Worley { .. } | Pattern::StripesFbm { .. } | Pattern::Radial { .. } => 4,
        // Where the finest octave leaves texels to spare, the tile can be larger and repeat later.
        Pattern::Fbm { cells, octaves } => {
            let finest = u64::from(cells.max(1)) << (octaves.clamp(1, 16) - 1);
            if finest * 8 * TEXELS_PER_CELL <= u64::from(TEXELS) {
                8
            } else {
                4
            }
        }
    }
}

/// The extent, up to four blocks, over which a lattice closes with the least stretching. A longer
/// extent must be better by a tenth of a period to justify its coarser texels.
fn closest_extent(misfit: impl Fn(f64) -> f64) -> u32 {
    let cost =
        |blocks: u32| misfit(f64::from(blocks)) / f64::from(blocks) + 0.1 * f64::from(blocks);
    (1..=4)
        .min_by(|&a, &b| cost(a).total_cmp(&cost(b)))
        .expect("the range is not empty")
}

fn distance_to_whole(value: f64) -> f64 {
    (value - value.round()).abs()
}

impl Mask {
    pub fn new(pattern: &Pattern, seed: u32) -> Self {
        let extent = f64::from(extent_blocks(pattern));
        let blocks = extent_blocks(pattern);
        let kind = match *pattern {
            Pattern::Plain => Kind::Plain,
            Pattern::Stripes { pitch, width } => Kind::Stripes {
                pitch: extent / (extent / f64::from(pitch)).round().max(1.0),
                width: f64::from(width),
            },
            Pattern::Dots {
                radius,
                pitch,
                angle_deg,
            } => Kind::Dots {
                lattice: Lattice::fitted(extent, f64::from(pitch), f64::from(angle_deg)),
                radius: f64::from(radius),
            },
            Pattern::Checker { squares } => Kind::Checker {
                squares: f64::from(squares),
            },
            Pattern::Bricks { rows, joint } => Kind::Bricks {
                rows: rows.max(1),
                joint: f64::from(joint),
                seed: hash(seed),
                grain: TorusFbm::new(extent, 7, 7, 1, seed),
            },
            Pattern::Worley { cells, radius } => Kind::Worley {
                points: FeaturePoints::new(extent, cells.max(1) * blocks, hash(seed)),
                radius: f64::from(radius),
            },
            Pattern::Fbm { cells, octaves } => {
                Kind::Fbm(TorusFbm::new(extent, cells, cells, octaves, seed))
            }
            Pattern::StripesFbm { cells, octaves } => Kind::StripesFbm {
                streaks: TorusFbm::new(extent, 3 * cells, cells.div_ceil(3), octaves, seed),
                strength: TorusFbm::new(extent, cells.div_ceil(2), cells.div_ceil(2), 2, seed ^ 1),
            },
            Pattern::Radial { rings } => Kind::Radial {
                rings: f64::from(rings),
                seed: hash(seed),
                wobble: TorusFbm::new(extent, 5, 5, 3, seed),
            },
        };
        let smooth = matches!(
            kind,
            Kind::Plain | Kind::Fbm(_) | Kind::StripesFbm { .. } | Kind::Radial { .. }
        );
        Self {
            extent,
            kind,
            samples: if smooth { 1 } else { 4 },
        }
    }

    /// The mask at (u, v), in blocks from the tile's corner; before [`levels`](Self::levels).
    pub fn at(&self, u: f64, v: f64) -> f64 {
        match &self.kind {
            Kind::Plain => 0.0,
            Kind::Stripes { pitch, width } => step(distance_to_half(u / pitch) < 0.5 * *width),
            Kind::Dots { lattice, radius } => step(lattice.distance(u, v) < *radius),
            Kind::Checker { squares } => {
                ((u * squares).floor() + (v * squares).floor()).rem_euclid(2.0)
            }
            Kind::Bricks {
                rows,
                joint,
                seed,
                grain,
            } => bricks(u, v, *rows, *joint, *seed, grain),
            Kind::Worley { points, radius } => step(points.distance(u, v) < *radius),
            Kind::Fbm(field) => field.at(u, v),
            Kind::StripesFbm { streaks, strength } => streaks.at(u, v) * (1.0 + strength.at(u, v)),
            Kind::Radial {
                rings,
                seed,
                wobble,
            } => radial(u, v, *rings, self.extent, *seed, wobble),
        }
    }

    /// Spreads the raw values of noises, which stay near the middle, over [0, 1] (2¼ standard
    /// deviations either way); leaves other patterns unchanged.
    pub fn levels(&self, raw: &mut [f32]) {
        if self.samples > 1 || matches!(self.kind, Kind::Plain) {
            return;
        }
        let count = raw.len() as f64;
        let mean = raw.iter().map(|&value| f64::from(value)).sum::<f64>() / count;
        let square = |&value: &f32| (f64::from(value) - mean).powi(2);
        let deviation = (raw.iter().map(square).sum::<f64>() / count).sqrt();
        for value in raw {
            let spread = (f64::from(*value) - mean) / (4.5 * deviation.max(1e-6));
            let t = (0.5 + spread).clamp(0.0, 1.0);
            *value = (t * t * (3.0 - 2.0 * t)) as f32;
        }
    }
}

fn step(condition: bool) -> f64 {
    f64::from(u8::from(condition))
}

/// A square lattice that closes over the tile: rotated and stretched slightly from the given one.
struct Lattice {
    /// Lattice coordinates of a point are dot products with (x, y) and (−y, x).
    axis: (f64, f64),
}

impl Lattice {
    /// With m = extent·cos/pitch and n = extent·sin/pitch rounded to whole numbers, the tile's edges
    /// are the lattice vectors (m, −n) and (n, m).
    fn fitted(extent: f64, pitch: f64, angle_deg: f64) -> Self {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let (m, n) = (
            (extent * cos / pitch).round(),
            (extent * sin / pitch).round(),
        );
        let m = if m == 0.0 && n == 0.0 { 1.0 } else { m };
        Self {
            axis: (m / extent, n / extent),
        }
    }

    /// Distance from (u, v) to the nearest lattice point, in blocks.
    fn distance(&self, u: f64, v: f64) -> f64 {
        let (x, y) = self.axis;
        let along = distance_to_half(u * x + v * y);
        let across = distance_to_half(v * x - u * y);
        along.hypot(across) / x.hypot(y)
    }
}

/// Distance to the nearest half: keeps stripes and dots, which lie in the middle of their cells, away
/// from the tile's edges.
fn distance_to_half(value: f64) -> f64 {
    (value.rem_euclid(1.0) - 0.5).abs()
}

/// Running bond, two bricks high by one long; every brick has its own tone and grain.
fn bricks(u: f64, v: f64, rows: u32, joint: f64, seed: u32, grain: &TorusFbm) -> f64 {
    let height = 1.0 / f64::from(rows);
    let row = (v / height).floor();
    let shift = 0.5 * row.rem_euclid(2.0);
    let along = u / (2.0 * height) + shift;
    let column = along.floor();
    let from_bed = distance_to_edge(v / height) * height;
    let from_head = distance_to_edge(along) * 2.0 * height;
    if from_bed.min(from_head) < 0.5 * joint {
        return 1.0;
    }
    // Over the two blocks of a tile there are 2·rows rows of `rows` bricks.
    let column = column.rem_euclid(f64::from(rows)) as u32;
    let row = row.rem_euclid(2.0 * f64::from(rows)) as u32;
    let tone = unit(hash(seed ^ hash(row ^ hash(column))));
    (0.3 * f64::from(tone) + 0.12 * grain.at(u, v)).clamp(0.0, 0.45)
}

fn distance_to_edge(value: f64) -> f64 {
    0.5 - distance_to_half(value)
}

/// Feature points in a jittered grid that repeats with the tile (Worley 1996).
struct FeaturePoints {
    /// Cells along the tile's edge, and the edge of one cell in blocks.
    cells: i64,
    edge: f64,
    /// The point of each cell, in cells from the tile's corner.
    points: Vec<(f64, f64)>,
}

impl FeaturePoints {
    fn new(extent: f64, cells: u32, seed: u32) -> Self {
        let point = |index: u32| {
            let (x, y) = (index % cells, index / cells);
            let random = hash(seed ^ hash(x ^ hash(y)));
            (
                f64::from(x) + jitter(random),
                f64::from(y) + jitter(hash(random)),
            )
        };
        Self {
            cells: i64::from(cells),
            edge: extent / f64::from(cells),
            points: (0..cells * cells).map(point).collect(),
        }
    }

    /// Distance (blocks) from a place in the tile to the nearest point.
    fn distance(&self, u: f64, v: f64) -> f64 {
        let (x, y) = (u / self.edge, v / self.edge);
        let (cx, cy) = (x.floor() as i64, y.floor() as i64);
        // The point of a cell beyond the tile's edge is the point of the cell at the opposite side,
        // shifted.
        let wrap = |cell: i64| {
            let inside = cell.rem_euclid(self.cells);
            (inside, (cell - inside) as f64)
        };
        let mut nearest = f64::INFINITY;
        for (row, up) in (cy - 1..=cy + 1).map(wrap) {
            for (column, right) in (cx - 1..=cx + 1).map(wrap) {
                let (px, py) = self.points[(row * self.cells + column) as usize];
                nearest = nearest.min((px + right - x).powi(2) + (py + up - y).powi(2));
            }
        }
        nearest.sqrt() * self.edge
    }
}

/// Feature points stay away from the edges of their cells, so that spots rarely touch.
fn jitter(random: u32) -> f64 {
    0.15 + 0.7 * f64::from(unit(random))
}

/// Rings of noise about a block's centre, different in each block of the tile; towards the edges all
/// blocks fade to the same rings, which meet there by symmetry.
fn radial(u: f64, v: f64, rings: f64, extent: f64, seed: u32, wobble: &TorusFbm) -> f64 {
    let (du, dv) = (u.rem_euclid(1.0) - 0.5, v.rem_euclid(1.0) - 0.5);
    let distance = du.hypot(dv) + 0.12 * wobble.at(u, v);
    let ring = |seed: u32| value_noise(4.0 * rings * distance + 16.0, seed);
    let block = |c: f64| c.rem_euclid(extent).floor() as u32;
    let own = hash(seed ^ hash(block(u) ^ hash(block(v))));
    let to_edge = ((0.5 - du.abs().max(dv.abs())) / 0.15).clamp(0.0, 1.0);
    ring(seed) * (1.0 - to_edge) + ring(own) * to_edge
}

fn value_noise(t: f64, seed: u32) -> f64 {
    let cell = t.floor();
    let f = t - cell;
    let value = |cell: f64| f64::from(unit(hash(seed ^ hash(cell as i64 as u32))));
    let fade = f * f * (3.0 - 2.0 * f);
    value(cell) * (1.0 - fade) + value(cell + 1.0) * fade
}

/// Fractal noise that closes over a tile: both coordinates go around circles in four dimensions whose
/// circumferences are the tile's edges.
struct TorusFbm {
    octaves: Vec<Perlin>,
    /// The tile has 2π times as many noise cells along u and v.
    radius_u: f64,
    radius_v: f64,
    /// Radians per block.
    turn: f64,
}

impl TorusFbm {
    /// `cells_*`: noise cells per block in the first octave.
    fn new(extent: f64, cells_u: u32, cells_v: u32, octaves: u32, seed: u32) -> Self {
        let radius = |cells: u32| f64::from(cells.max(1)) * extent / TAU;
        Self {
            octaves: (0..octaves.max(1))
                .map(|octave| Perlin::new(hash(seed ^ octave)))
                .collect(),
            radius_u: radius(cells_u),
            radius_v: radius(cells_v),
            turn: TAU / extent,
        }
    }

    /// About [−1, 1]; mostly near 0.
    fn at(&self, u: f64, v: f64) -> f64 {
        let (sin_u, cos_u) = (u * self.turn).sin_cos();
        let (sin_v, cos_v) = (v * self.turn).sin_cos();
        let mut scale = 1.0;
        let mut sum = 0.0;
        for octave in &self.octaves {
            let (ru, rv) = (self.radius_u * scale, self.radius_v * scale);
            sum += octave.get([ru * cos_u, ru * sin_u, rv * cos_v, rv * sin_v]) / scale;
            scale *= 2.0;
        }
        sum
    }
}
