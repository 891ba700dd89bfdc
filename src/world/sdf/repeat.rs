//! A sub-tree repeated in tiles.

use glam::DVec3;

use super::bounds::Bounds;
use super::shape::Node;
use crate::world::noise::NoiseBank;

/// A sub-tree in every tile; the copy of the nearest neighbour tile counts too, so that the distance
/// is continuous across tiles and the sub-tree may lean over its tile's edge.
#[derive(Clone, Debug)]
pub(super) struct Repeat {
    /// 0 on the axes that do not repeat.
    pub period: DVec3,
    /// The sub-tree's bounds: the distance to them is what a copy is at least away.
    pub bounds: Bounds,
    /// No copy beyond the nearest two along each axis is nearer than this.
    pub clearance: f64,
    pub of: Node,
}

impl Repeat {
    pub(super) fn new(period: DVec3, of: Node, bank: &NoiseBank) -> Self {
        let bounds = of.bounds(0.0, bank);
        let clearance = (0..3)
            .filter(|&axis| period[axis] > 0.0)
            .map(|axis| period[axis] - bounds.max[axis].max(-bounds.min[axis]))
            .fold(f64::INFINITY, f64::min);
        Self {
            period,
            bounds,
            clearance,
            of,
        }
    }

    pub(super) fn eval(&self, p: DVec3, bank: &NoiseBank) -> f64 {
        let repeats = self.period.cmpgt(DVec3::ZERO);
        let period = DVec3::select(repeats, self.period, DVec3::ONE);
        let tile = DVec3::select(repeats, (p / period).round(), DVec3::ZERO);
        let local = p - tile * self.period;
        // Towards the neighbour that the point leans to.
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
                let value = self.of.eval(q, bank);
                // Outside of its bounds a copy is at least as far as they are, whatever its own
                // function says: without this the cut-off would not be continuous.
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
}
