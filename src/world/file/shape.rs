//! The tree of the shape, and boxes.

use glam::Vec3;

use super::Problem;
use super::resolve::Reader;
use super::schema::Vector;
use super::values::{Read, or};
use crate::world::Sdf;
use crate::world::sdf::WrittenSdf;

impl Reader<'_> {
    /// A tree; the files in `sdf/primitives` and `sdf/operators` define how each shape is read.
    pub(in crate::world) fn shape(&mut self, written: &WrittenSdf) -> Read<Sdf> {
        written.read(self)
    }

    /// A box in world space; omitted corners are the world's.
    pub(super) fn bounds(&self, min: &Option<Vector>, max: &Option<Vector>) -> Read<(Vec3, Vec3)> {
        let (low, high) = self.world_box();
        let low = or(min, low, |vector| self.source.point(vector, "min"))?;
        let high = or(max, high, |vector| self.source.point(vector, "max"))?;
        if low.cmple(high).all() {
            return Ok((low, high));
        }
        let message = format!("this box is empty: `min` is {low} and `max` is {high}");
        let help = "`min` must be at most `max` on every axis; left out, they are the world's box";
        Err(match max.as_ref().or(min.as_ref()) {
            Some(vector) => self.source.at_vector(vector, message, help),
            None => Problem::of_file(message, help),
        })
    }
}
