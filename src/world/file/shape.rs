//! The tree of the shape: every number and name read and checked in place.

use glam::Vec3;

use super::leaf::Leaf;
use super::resolve::Reader;
use super::schema::Shape;
use super::values::{Read, or};
use crate::world::Sdf;

impl Reader<'_> {
    pub(super) fn shape(&mut self, shape: &Shape) -> Read<Sdf> {
        let source = self.source;
        let length = |leaf, key| source.length(leaf, key);
        Ok(match shape {
            Shape::Empty => Sdf::Empty,
            Shape::Sphere { radius } => Sdf::Sphere {
                radius: source.positive(radius, "radius")?,
            },
            Shape::Box { half } => Sdf::Box {
                half: source.positive3(half, "half")?,
            },
            Shape::RoundedBox { half, radius } => Sdf::RoundedBox {
                half: source.not_negative3(half, "half")?,
                radius: source.not_negative(radius, "radius")?,
            },
            Shape::Capsule { from, to, radius } => Sdf::Capsule {
                from: source.point(from, "from")?,
                to: source.point(to, "to")?,
                radius: source.positive(radius, "radius")?,
            },
            Shape::Cylinder {
                radius,
                half_height,
            } => Sdf::Cylinder {
                radius: source.positive(radius, "radius")?,
                half_height: source.positive(half_height, "half_height")?,
            },
            Shape::Torus { major, minor } => Sdf::Torus {
                major: source.positive(major, "major")?,
                minor: source.positive(minor, "minor")?,
            },
            Shape::Plane { normal, offset } => Sdf::Plane {
                normal: source.direction(normal, "normal")?,
                offset: length(offset, "offset")?,
            },
            Shape::HeightField {
                noise,
                base,
                amplitude,
                step,
            } => Sdf::HeightField {
                noise: self.noise(noise)?,
                base: length(base, "base")?,
                amplitude: length(amplitude, "amplitude")?,
                step: or(step, 0.0, |leaf| source.not_negative(leaf, "step"))?,
            },
            Shape::Union(of) => Sdf::Union(self.shapes(of)?),
            Shape::Intersection(of) => Sdf::Intersection(self.shapes(of)?),
            Shape::Subtraction(of) => Sdf::Subtraction(self.shapes(of)?),
            Shape::SmoothUnion { k, of } => Sdf::SmoothUnion {
                k: source.not_negative(k, "k")?,
                of: self.shapes(of)?,
            },
            Shape::SmoothIntersection { k, of } => Sdf::SmoothIntersection {
                k: source.not_negative(k, "k")?,
                of: self.shapes(of)?,
            },
            Shape::SmoothSubtraction { k, of } => Sdf::SmoothSubtraction {
                k: source.not_negative(k, "k")?,
                of: self.shapes(of)?,
            },
            Shape::Translate { by, of } => Sdf::Translate {
                by: source.point(by, "by")?,
                of: self.boxed(of)?,
            },
            Shape::Rotate { degrees, of } => Sdf::Rotate {
                degrees: source.point(degrees, "degrees")?,
                of: self.boxed(of)?,
            },
            Shape::Scale { by, of } => Sdf::Scale {
                by: source.scale(by, "by")?,
                of: self.boxed(of)?,
            },
            Shape::Repeat { period, of } => {
                let repeat = Sdf::Repeat {
                    period: source.not_negative3(period, "period")?,
                    of: self.boxed(of)?,
                };
                self.checked(repeat, &period.0)?
            }
            Shape::Displace {
                noise,
                amplitude,
                of,
            } => Sdf::Displace {
                noise: self.noise(noise)?,
                amplitude: length(amplitude, "amplitude")?,
                of: self.boxed(of)?,
            },
            Shape::Warp {
                noise,
                amplitude,
                of,
            } => Sdf::Warp {
                noise: self.noise(noise)?,
                amplitude: length(amplitude, "amplitude")?,
                of: self.boxed(of)?,
            },
            Shape::Scatter {
                min,
                max,
                cell,
                probability,
                jitter,
                scale,
                reach,
                seed,
                of,
            } => {
                let bounds = self.bounds(min, max)?;
                let share = |leaf: &Leaf, key| -> Read<f32> {
                    Ok(source.number_in(leaf, key, 0.0..=1.0)? as f32)
                };
                let own_seed = self.next_seed();
                let scatter = Sdf::Scatter {
                    min: bounds.0,
                    max: bounds.1,
                    cell: source.positive(cell, "cell")?,
                    probability: or(probability, 1.0, |leaf| share(leaf, "probability"))?,
                    jitter: or(jitter, 0.0, |leaf| share(leaf, "jitter"))?,
                    scale: or(scale, (1.0, 1.0), |scale| self.scale_range(scale))?,
                    reach: source.positive(reach, "reach")?,
                    seed: or(seed, own_seed, |leaf| source.seed(leaf))?,
                    of: self.boxed(of)?,
                };
                self.checked(scatter, reach)?
            }
        })
    }

    fn shapes(&mut self, of: &[Shape]) -> Read<Vec<Sdf>> {
        of.iter().map(|shape| self.shape(shape)).collect()
    }

    fn boxed(&mut self, of: &Shape) -> Read<Box<Sdf>> {
        Ok(Box::new(self.shape(of)?))
    }

    fn scale_range(&self, (low, high): &(Leaf, Leaf)) -> Read<(f32, f32)> {
        let smallest = self.source.scale(low, "scale")?;
        let greatest = self.source.scale(high, "scale")?;
        if greatest < smallest {
            return Err(self.source.at(
                high,
                format!("`scale` goes from {smallest} down to {greatest}"),
                "write the smaller factor first",
            ));
        }
        Ok((smallest, greatest))
    }

    /// Rules that a node keeps only as a whole: how far copies reach.
    fn checked(&self, sdf: Sdf, place: &Leaf) -> Read<Sdf> {
        match sdf.check(&self.noises) {
            Ok(()) => Ok(sdf),
            Err(error) => {
                let error = error.to_string();
                // What is wrong, and what to do about it, stand on either side of a semicolon.
                let (message, help) = error.rsplit_once("; ").unwrap_or((&error, ""));
                Err(self.source.at(place, message, help))
            }
        }
    }

    /// A box in world space; what is left out is the world's.
    pub(super) fn bounds(
        &self,
        min: &Option<super::schema::Vector>,
        max: &Option<super::schema::Vector>,
    ) -> Read<(Vec3, Vec3)> {
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
            None => super::Problem::of_file(message, help),
        })
    }
}
