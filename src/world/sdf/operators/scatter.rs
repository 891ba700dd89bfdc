//! Copies of a sub-tree, scattered over cells. An integer hash, the same on the CPU and on the GPU
//! (`shaders/sdf/scatter.wesl`), decides which cells hold a copy, where and how large.

use std::sync::Arc;

use glam::{DVec3, IVec3, UVec3, Vec3};

use crate::world::file::{Leaf, Read, Reader, Vector, or};
use crate::world::noise::{NoiseBank, NoiseField};
use crate::world::sdf::hash::{pcg3d, unit};
use crate::world::sdf::keys::{Key, Or, Point, Positive, Share, SubTree, keys, require};
use crate::world::sdf::primitives::cuboid::BOX_DISTANCE;
use crate::world::sdf::wgsl::{Body, number, single, vector};
use crate::world::sdf::{Bounds, Fault, Form, Node, Side, Tree};

keys! {
    /// Copies of a sub-tree, at most one per cubic cell of edge `cell` inside the box [min, max] (as
    /// many whole cells as fit best along each axis, at least one, centred in the box). A cell holds a
    /// copy with this probability; the copy is moved by up to `jitter` cells along each axis and scaled
    /// by a factor from `scale`. The sub-tree must lie within `reach` of its own origin, and reach ·
    /// scale.1 + jitter · cell must not exceed `cell`, so that the search is limited to 27 cells.
    pub struct Scatter {
        /// Lowest corner of the box, voxels.
        pub min: LowCorner,
        /// Highest corner of the box, voxels.
        pub max: HighCorner,
        /// Edge of a cell, voxels.
        pub cell: Positive,
        /// Probability that a cell holds a copy.
        pub probability: Or<Share, 1>,
        /// Greatest move along each axis, in cells.
        pub jitter: Or<Share, 0>,
        /// Smallest and greatest factor.
        pub scale: ScaleRange,
        /// Greatest distance of the sub-tree's solid from its origin in voxels, before scaling.
        pub reach: Positive,
        pub seed: Seed,
        pub of: SubTree,
    }
}

/// A corner of a box; if omitted, the lowest corner of the world.
pub struct LowCorner;

impl Key for LowCorner {
    type Written = Option<Vector>;
    type Value = DVec3;

    fn read(written: &Self::Written, key: &str, reader: &mut Reader<'_>) -> Read<DVec3> {
        let (low, _) = reader.world_box();
        or(written, low.as_dvec3(), |v| Point::read(v, key, reader))
    }

    fn check(value: &DVec3, noises: &[NoiseField]) -> Result<(), String> {
        Point::check(value, noises)
    }
}

/// A corner of a box; if omitted, the highest corner of the world.
pub struct HighCorner;

impl Key for HighCorner {
    type Written = Option<Vector>;
    type Value = DVec3;

    fn read(written: &Self::Written, key: &str, reader: &mut Reader<'_>) -> Read<DVec3> {
        let (_, high) = reader.world_box();
        or(written, high.as_dvec3(), |v| Point::read(v, key, reader))
    }

    fn check(value: &DVec3, noises: &[NoiseField]) -> Result<(), String> {
        Point::check(value, noises)
    }
}

/// `(least, greatest)`; if omitted, (1, 1).
pub struct ScaleRange;

impl Key for ScaleRange {
    type Written = Option<(Leaf, Leaf)>;
    type Value = (f64, f64);

    fn read(written: &Self::Written, key: &str, reader: &mut Reader<'_>) -> Read<(f64, f64)> {
        let Some((low, high)) = written else {
            return Ok((1.0, 1.0));
        };
        let smallest = reader.source.scale(low, key)?;
        let greatest = reader.source.scale(high, key)?;
        if greatest < smallest {
            return Err(reader.source.at(
                high,
                format!("`{key}` goes from {smallest} down to {greatest}"),
                "write the smaller factor first",
            ));
        }
        Ok((smallest.into(), greatest.into()))
    }

    fn check(&(low, high): &(f64, f64), _noises: &[NoiseField]) -> Result<(), String> {
        let holds = low > 0.0 && high.is_finite() && high >= low;
        let found = format_args!("({low}, {high})");
        require(holds, "an increasing pair of finite numbers above 0", found)
    }
}

/// If omitted, a seed derived from the world's, different for each scatter.
pub struct Seed;

impl Key for Seed {
    type Written = Option<Leaf>;
    type Value = u32;

    fn read(written: &Self::Written, _key: &str, reader: &mut Reader<'_>) -> Read<u32> {
        // Taken even if the file gives a seed, so that adding one changes no other scatter.
        let own_seed = reader.next_seed();
        or(written, own_seed, |leaf| reader.source.seed(leaf))
    }

    fn check(_value: &u32, _noises: &[NoiseField]) -> Result<(), String> {
        Ok(())
    }
}

impl Form for Scatter {
    fn check(&self, _noises: &[NoiseField]) -> Result<(), Fault> {
        let fault = |keys, message, remedy: &str| Fault {
            keys,
            message,
            remedy: remedy.to_owned(),
        };
        if self.min.cmpgt(self.max).any() {
            return Err(fault(
                &["max", "min"],
                format!(
                    "this box is empty: `min` is {} and `max` is {}",
                    self.min, self.max
                ),
                "`min` must be at most `max` on every axis; left out, they are the world's box",
            ));
        }
        if ((self.max - self.min) / self.cell).max_element() >= 1e6 {
            return Err(fault(
                &["cell"],
                format!(
                    "the cell of {} is less than a millionth of the box",
                    self.cell as f32
                ),
                "make the cell larger or the box smaller",
            ));
        }
        let found = self.reach * self.scale.1 + self.jitter * self.cell;
        if found > self.cell * (1.0 + 1e-6) {
            return Err(fault(
                &["reach"],
                format!(
                    "reach × greatest scale + jitter × cell is {}, more than the cell of {}",
                    found as f32, self.cell as f32
                ),
                "make the cell larger or the copies smaller",
            ));
        }
        Ok(())
    }

    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree {
        Arc::new(self.cells(bank))
    }
}

impl Scatter {
    /// In f32, as the GPU computes: both must place exactly the same copies.
    fn cells(&self, bank: &Arc<NoiseBank>) -> Cells {
        let (min, max, cell) = (self.min.as_vec3(), self.max.as_vec3(), self.cell as f32);
        let cells = ((max - min) / cell).round().max(Vec3::ONE);
        let (scale_low, scale_high) = (self.scale.0 as f32, self.scale.1 as f32);
        Cells {
            start: (min + max) / 2.0 - cells * cell / 2.0,
            cells: cells.as_uvec3(),
            cell,
            threshold: (self.probability * 16_777_216.0).round() as u32,
            jitter: self.jitter as f32 * cell,
            scale_low,
            scale_span: scale_high - scale_low,
            reach: self.reach as f32,
            seed_bits: self.seed.wrapping_mul(0x9e37_79b9),
            of: self.of.prepare(bank),
        }
    }
}

/// A block of whole cubes, centred in the box of the description.
#[derive(Debug)]
struct Cells {
    /// Lowest corner of cell (0, 0, 0).
    start: Vec3,
    cells: UVec3,
    cell: f32,
    /// A cell holds a copy if the top 24 bits of its hash are below this.
    threshold: u32,
    /// Greatest move from the cell's centre along each axis, voxels.
    jitter: f32,
    scale_low: f32,
    scale_span: f32,
    reach: f32,
    /// The seed, spread over all bits, which is xored into the cell's x before hashing.
    seed_bits: u32,
    of: Tree,
}

/// One copy of the sub-tree.
struct Placed {
    centre: Vec3,
    scale: f32,
}

impl Cells {
    /// The copy in a cell, if it holds one.
    fn placed(&self, cell: UVec3) -> Option<Placed> {
        let presence = pcg3d(UVec3::new(cell.x ^ self.seed_bits, cell.y, cell.z));
        if presence.x >> 8 >= self.threshold {
            return None;
        }
        let place = pcg3d(presence);
        let jitter = Vec3::new(unit(place.x), unit(place.y), unit(place.z)) * 2.0 - 1.0;
        Some(Placed {
            centre: self.start + (cell.as_vec3() + 0.5) * self.cell + jitter * self.jitter,
            scale: self.scale_low + unit(presence.y) * self.scale_span,
        })
    }

    /// Greatest distance of a copy's solid from its centre.
    fn greatest_reach(&self) -> f64 {
        f64::from(self.reach) * f64::from(self.scale_low + self.scale_span)
    }

    /// No copy outside the 27 cells around a point is closer than this.
    fn clearance(&self) -> f64 {
        1.5 * f64::from(self.cell) - f64::from(self.jitter) - self.greatest_reach()
    }

    /// Centre and half extent of the box that contains all copies.
    fn content(&self) -> (DVec3, DVec3) {
        let half_cells = self.cells.as_dvec3() * f64::from(self.cell) / 2.0;
        let margin = f64::from(self.jitter) + self.greatest_reach() - f64::from(self.cell) / 2.0;
        (self.start.as_dvec3() + half_cells, half_cells + margin)
    }

    /// A WGSL expression of `ScatterGrid`.
    fn emit_grid(&self) -> String {
        let (centre, half) = self.content();
        let last = self.cells - 1;
        let fields = [
            vector(self.start.as_dvec3()),
            single(self.cell),
            format!("vec3i({}, {}, {})", last.x, last.y, last.z),
            single(self.jitter),
            vector(centre),
            number(self.clearance()),
            vector(half),
            single(self.reach),
            single(self.scale_low),
            single(self.scale_span),
            format!("{}u", self.threshold),
            format!("{}u", self.seed_bits),
        ];
        format!("ScatterGrid({})", fields.join(", "))
    }
}

impl Node for Cells {
    /// Distance to the nearest copy. Among the cells it is cut off at [`Self::clearance`], so that the
    /// 27 cells around the point determine it; outside, it is cut off at the distance to the box of all
    /// copies.
    fn eval(&self, p: DVec3) -> f64 {
        let (centre, half) = self.content();
        let outside = (((p - centre).abs() - half).max(DVec3::ZERO)).length();
        let mut nearest = self.clearance();
        if outside >= nearest {
            return outside;
        }
        let cell = f64::from(self.cell);
        let last = self.cells.as_ivec3() - 1;
        let home = ((p - self.start.as_dvec3()) / cell)
            .floor()
            .as_ivec3()
            .clamp(IVec3::ZERO, last);
        for x in (home.x - 1).max(0)..=(home.x + 1).min(last.x) {
            for y in (home.y - 1).max(0)..=(home.y + 1).min(last.y) {
                for z in (home.z - 1).max(0)..=(home.z + 1).min(last.z) {
                    let Some(copy) = self.placed(IVec3::new(x, y, z).as_uvec3()) else {
                        continue;
                    };
                    let from_centre = p - copy.centre.as_dvec3();
                    let scale = f64::from(copy.scale);
                    // Beyond its reach a copy counts as at least as far as its bounding sphere,
                    // whatever its own function returns: without this rule the cut-off would not be
                    // continuous.
                    let to_sphere = from_centre.length() - f64::from(self.reach) * scale;
                    if to_sphere < nearest {
                        let distance = self.of.eval(from_centre / scale) * scale;
                        nearest = nearest.min(distance.max(to_sphere));
                    }
                }
            }
        }
        if outside > 0.0 {
            nearest.max(outside)
        } else {
            nearest
        }
    }

    fn variation(&self, radius: f64) -> f64 {
        // s·v(r/s) grows with s if v is concave with v(0) ≥ 0.
        let scale = f64::from(self.scale_low + self.scale_span);
        (self.of.variation(radius / scale) * scale).max(radius)
    }

    fn bounds(&self, level: f64) -> Bounds {
        let (centre, half) = self.content();
        Bounds {
            min: centre - half,
            max: centre + half,
        }
        .grown(DVec3::splat(level))
    }

    fn is_costly(&self) -> bool {
        true
    }

    fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        let (name, of) = (body.name("scatter"), body.name("copy"));
        body.import(
            "package::sdf::scatter::{ScatterGrid, SCATTER_NEAR, SCATTER_ALL, scatter_outside, \
             scatter_near_clearance, scatter_copy}",
        );
        body.function(&of, &self.of);
        let grid = self.emit_grid();
        body.declare(format_args!(
            "
fn {name}(p: vec3f) -> f32 {{
    let grid = {grid};
    let outside = scatter_outside(grid, p);
    var nearest = grid.clearance;
    if outside >= nearest {{
        return outside;
    }}
    for (var k = 0u; k < SCATTER_ALL; k += 1u) {{
        if k == SCATTER_NEAR && nearest <= scatter_near_clearance(grid) {{
            break;
        }}
        let copy = scatter_copy(grid, p, k, nearest);
        if copy.scale > 0.0 {{
            let value = {of}((p - copy.centre) / copy.scale) * copy.scale;
            nearest = min(nearest, max(value, copy.to_sphere));
        }}
    }}
    return select(nearest, max(nearest, outside), outside > 0.0);
}}
"
        ));
        body.variable("d", format_args!("{name}({p})"))
    }

    fn emit_bound(&self, body: &mut Body<'_>, p: &str, side: Side) -> Option<String> {
        if side == Side::Upper {
            return None;
        }
        body.helper(BOX_DISTANCE);
        let (centre, half) = self.content();
        let (centre, half) = (vector(centre), vector(half));
        let outside = body.variable("b", format_args!("box_distance({p} - {centre}, {half})"));
        // No bound is known among the copies.
        Some(body.variable(
            "b",
            format_args!("select(-FAR, {outside}, {outside} > 0.0)"),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::sdf::Sphere;
    use crate::world::sdf::tests::points;

    #[test]
    fn every_copy_is_found() {
        let scatter = Scatter {
            min: DVec3::splat(-20.0),
            max: DVec3::new(20.0, 9.0, 25.0),
            cell: 8.0,
            probability: 0.6,
            jitter: 0.3,
            scale: (0.5, 1.5),
            reach: 3.0,
            seed: 5,
            of: Box::new(Sphere { radius: 3.0 }.into()),
        };
        let cells = scatter.cells(&Arc::new(NoiseBank::new(&[])));
        let mut copies = Vec::new();
        for x in 0..cells.cells.x {
            for y in 0..cells.cells.y {
                for z in 0..cells.cells.z {
                    copies.extend(cells.placed(UVec3::new(x, y, z)));
                }
            }
        }
        let all = f64::from(cells.cells.element_product());
        assert!(
            (copies.len() as f64 / all - 0.6).abs() < 0.15,
            "{} of {all}",
            copies.len()
        );
        for p in points(5_000) {
            let nearest = copies
                .iter()
                .map(|copy| p.distance(copy.centre.as_dvec3()) - 3.0 * f64::from(copy.scale));
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            let value = cells.eval(p);
            assert!(value <= nearest + 1e-9);
            assert!(
                (value - nearest).abs() < 1e-9 || value >= cells.clearance() - 1e-9,
                "at {p}: {value}, {nearest}"
            );
        }
    }
}
