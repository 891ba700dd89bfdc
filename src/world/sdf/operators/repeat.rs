//! A sub-tree repeated in tiles.

use std::sync::Arc;

use glam::DVec3;

use crate::world::noise::{NoiseBank, NoiseField};
use crate::world::sdf::keys::{NotNegative, SubTree, Three, keys};
use crate::world::sdf::wgsl::{Body, number, vector};
use crate::world::sdf::{Bounds, Fault, Form, Node, Shape, Tree};

keys! {
    /// Repeats a sub-tree with this period on every axis whose period is above 0. On those axes the
    /// sub-tree must lie within one period of its own origin.
    pub struct Repeat {
        /// Voxels.
        pub period: Three<NotNegative>,
        pub of: SubTree,
    }
}

impl Form for Repeat {
    fn check(&self, noises: &[NoiseField]) -> Result<(), Fault> {
        let bounds = Shape::new(&self.of, noises).bounds();
        for (axis, name) in ['x', 'y', 'z'].into_iter().enumerate() {
            let (low, high, period) = (bounds.min[axis], bounds.max[axis], self.period[axis]);
            let farthest = high.max(-low);
            if period > 0.0 && !bounds.is_empty() && farthest >= period {
                return Err(Fault {
                    keys: &["period"],
                    message: format!(
                        "the sub-tree spans {low} … {high} along {name}, farther than the period of \
                         {} from its origin",
                        period as f32
                    ),
                    remedy: "make the period larger or bound the sub-tree".to_owned(),
                });
            }
        }
        Ok(())
    }

    fn prepare(&self, bank: &Arc<NoiseBank>) -> Tree {
        let of = self.of.prepare(bank);
        let bounds = of.bounds(0.0);
        let clearance = (0..3)
            .filter(|&axis| self.period[axis] > 0.0)
            .map(|axis| self.period[axis] - bounds.max[axis].max(-bounds.min[axis]))
            .fold(f64::INFINITY, f64::min);
        Arc::new(Tiles {
            period: self.period,
            bounds,
            clearance,
            of,
        })
    }
}

/// A sub-tree in every tile. The copy in the nearest neighbour tile counts too, so that the distance is
/// continuous across tiles and the sub-tree may extend over its tile's edge.
#[derive(Debug)]
struct Tiles {
    /// 0 on the axes that do not repeat.
    period: DVec3,
    /// The sub-tree's bounds: a copy is at least as far away as they are.
    bounds: Bounds,
    /// No copy beyond the nearest two along each axis is closer than this.
    clearance: f64,
    of: Tree,
}

impl Node for Tiles {
    fn eval(&self, p: DVec3) -> f64 {
        let repeats = self.period.cmpgt(DVec3::ZERO);
        let period = DVec3::select(repeats, self.period, DVec3::ONE);
        let tile = DVec3::select(repeats, (p / period).round(), DVec3::ZERO);
        let local = p - tile * self.period;
        // Towards the neighbour tile that is closest to the point.
        let lean = DVec3::select(local.cmplt(DVec3::ZERO), -self.period, self.period);
        let mut nearest = self.clearance;
        for corner in 0..8 {
            let towards = DVec3::new(
                (corner & 1) as f64,
                (corner >> 1 & 1) as f64,
                (corner >> 2) as f64,
            );
            if (towards.cmpgt(DVec3::ZERO) & !repeats).any() {
                continue;
            }
            let q = local - towards * lean;
            let to_bounds = (self.bounds.min - q)
                .max(q - self.bounds.max)
                .max(DVec3::ZERO)
                .length();
            if to_bounds < nearest {
                let value = self.of.eval(q);
                // Outside its bounds a copy counts as at least as far as the bounds, whatever its own
                // function returns: without this rule the cut-off would not be continuous.
                let value = if to_bounds > 0.0 {
                    value.max(to_bounds)
                } else {
                    value
                };
                nearest = nearest.min(value);
            }
        }
        nearest
    }

    fn variation(&self, radius: f64) -> f64 {
        self.of.variation(radius).max(radius)
    }

    fn bounds(&self, level: f64) -> Bounds {
        let one = self.of.bounds(level);
        let repeats = self.period.cmpgt(DVec3::ZERO);
        Bounds {
            min: DVec3::select(repeats, DVec3::NEG_INFINITY, one.min),
            max: DVec3::select(repeats, DVec3::INFINITY, one.max),
        }
    }

    fn is_costly(&self) -> bool {
        true
    }

    fn emit(&self, body: &mut Body<'_>, p: &str) -> String {
        let (name, of) = (body.name("repeat"), body.name("tile"));
        body.function(&of, &self.of);
        let repeats = self.period.cmpgt(DVec3::ZERO);
        let period = vector(DVec3::select(repeats, self.period, DVec3::ONE));
        let zero_or_period = vector(self.period);
        let repeats_vector = format!("vec3<bool>({}, {}, {})", repeats.x, repeats.y, repeats.z);
        let corners = repeats.bitmask();
        let (min, max) = (vector(self.bounds.min), vector(self.bounds.max));
        let clearance = number(self.clearance);
        body.declare(format_args!(
            "
fn {name}(p: vec3f) -> f32 {{
    let tile = select(vec3f(0.0), round(p / {period}), {repeats_vector});
    let local = p - tile * {zero_or_period};
    let lean = select({zero_or_period}, -{zero_or_period}, local < vec3f(0.0));
    var nearest = {clearance};
    for (var corner = 0u; corner < 8u; corner += 1u) {{
        if (corner & {corners}u) != corner {{
            continue;
        }}
        let q = local - vec3f(vec3u(corner, corner >> 1u, corner >> 2u) & vec3u(1u)) * lean;
        let to_bounds = length(max(max({min} - q, q - {max}), vec3f(0.0)));
        if to_bounds < nearest {{
            let value = {of}(q);
            nearest = min(nearest, select(value, max(value, to_bounds), to_bounds > 0.0));
        }}
    }}
    return nearest;
}}
"
        ));
        body.variable("d", format_args!("{name}({p})"))
    }
}
