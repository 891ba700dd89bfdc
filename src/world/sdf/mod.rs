//! The tree of signed distance functions that shapes a world. Negative inside stone.

mod bounds;
mod check;
mod prepare;
mod repeat;
mod scatter;
mod shape;
#[cfg(test)]
mod tests;
mod wgsl;

use glam::Vec3;

pub use bounds::Bounds;
pub use check::SdfError;
pub use scatter::pcg3d;
pub use shape::Shape;
pub use wgsl::shape_module;

/// Index into [`super::World::noises`].
pub type NoiseId = usize;

/// A signed distance function. Lengths in voxels, world space.
#[derive(Clone, Debug, PartialEq)]
pub enum Sdf {
    /// Nothing: +∞ everywhere.
    Empty,
    Sphere {
        radius: f32,
    },
    Box {
        half: Vec3,
    },
    /// A box of half extent `half` grown by `radius`.
    RoundedBox {
        half: Vec3,
        radius: f32,
    },
    Capsule {
        from: Vec3,
        to: Vec3,
        radius: f32,
    },
    /// Upright (along y).
    Cylinder {
        radius: f32,
        half_height: f32,
    },
    /// In the xz plane.
    Torus {
        major: f32,
        minor: f32,
    },
    /// Solid where dot(p, normal) < offset.
    Plane {
        normal: Vec3,
        offset: f32,
    },
    /// Solid where y < base + amplitude·noise(x, 0, z), the sum rounded down to whole multiples of
    /// `step` above `base` when `step` > 0. Not a distance: divided by its own Lipschitz constant.
    HeightField {
        noise: NoiseId,
        base: f32,
        amplitude: f32,
        step: f32,
    },
    Union(Vec<Sdf>),
    Intersection(Vec<Sdf>),
    /// The first without all the others.
    Subtraction(Vec<Sdf>),
    /// Smooth forms with blending width k (polynomial).
    SmoothUnion {
        k: f32,
        of: Vec<Sdf>,
    },
    SmoothIntersection {
        k: f32,
        of: Vec<Sdf>,
    },
    SmoothSubtraction {
        k: f32,
        of: Vec<Sdf>,
    },
    Translate {
        by: Vec3,
        of: Box<Sdf>,
    },
    /// Euler angles in degrees, applied x, then y, then z.
    Rotate {
        degrees: Vec3,
        of: Box<Sdf>,
    },
    Scale {
        by: f32,
        of: Box<Sdf>,
    },
    /// Repeats with this period on every axis whose period is > 0. On those axes the sub-tree must
    /// keep within one period of its own origin.
    Repeat {
        period: Vec3,
        of: Box<Sdf>,
    },
    /// Adds amplitude·noise(p).
    Displace {
        noise: NoiseId,
        amplitude: f32,
        of: Box<Sdf>,
    },
    /// Moves p by amplitude·(noise(p), noise(p + shift₁), noise(p + shift₂)) first.
    Warp {
        noise: NoiseId,
        amplitude: f32,
        of: Box<Sdf>,
    },
    /// Copies of a sub-tree, one to a cubic cell of edge `cell` inside the box [min, max] (as many
    /// whole cells as fit best along each axis, at least one, centred in the box), with this
    /// probability, moved by up to `jitter` cells along each axis and scaled by a factor from `scale`.
    /// The sub-tree must lie within `reach` (voxels, before scaling) of its own origin, and
    /// reach·scale.1 + jitter·cell must not exceed `cell`, so that 27 cells bound the search.
    Scatter {
        min: Vec3,
        max: Vec3,
        cell: f32,
        probability: f32,
        jitter: f32,
        scale: (f32, f32),
        reach: f32,
        seed: u32,
        of: Box<Sdf>,
    },
}
