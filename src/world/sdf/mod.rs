//! The tree of signed distance functions that shapes a world. Negative inside the solid.
//!
//! **A shape is one file**, in `primitives/` or `operators/`: its keys in world files, their rules, its
//! value on the CPU and on the GPU, how fast the value changes and how far the solid reaches. Two lines
//! in this file register it.

mod bounds;
mod check;
mod forms;
mod hash;
mod keys;
mod node;
mod noise;
mod shape;
#[cfg(test)]
mod tests;
mod wgsl;

/// Shapes without sub-trees.
mod primitives {
    pub mod capsule;
    pub mod cuboid;
    pub mod cylinder;
    pub mod empty;
    pub mod height_field;
    pub mod plane;
    pub mod rounded_box;
    pub mod sphere;
    pub mod torus;
}

/// Shapes made of other shapes.
mod operators {
    pub mod displace;
    mod fold;
    pub mod intersection;
    pub mod repeat;
    pub mod rotate;
    pub mod scale;
    pub mod scatter;
    pub mod subtraction;
    pub mod translate;
    pub mod union;
    pub mod warp;
}

use self::node::{Fault, Form, Node, Side, Tree};
use super::file::{Read, Reader, VariantKeys};
use super::noise::NoiseField;

pub use bounds::Bounds;
pub use check::SdfError;
pub use hash::pcg3d;
pub use shape::Shape;
pub use wgsl::shape_module;

/// Index into [`super::World::noises`].
pub type NoiseId = usize;

// Every shape: its name in world files, and its type.
forms::forms! {
    Empty(primitives::empty::Empty),
    Sphere(primitives::sphere::Sphere),
    Box(primitives::cuboid::Cuboid),
    RoundedBox(primitives::rounded_box::RoundedBox),
    Capsule(primitives::capsule::Capsule),
    Cylinder(primitives::cylinder::Cylinder),
    Torus(primitives::torus::Torus),
    Plane(primitives::plane::Plane),
    HeightField(primitives::height_field::HeightField),
    Union(operators::union::Union),
    Intersection(operators::intersection::Intersection),
    Subtraction(operators::subtraction::Subtraction),
    SmoothUnion(operators::union::SmoothUnion),
    SmoothIntersection(operators::intersection::SmoothIntersection),
    SmoothSubtraction(operators::subtraction::SmoothSubtraction),
    Translate(operators::translate::Translate),
    Rotate(operators::rotate::Rotate),
    Scale(operators::scale::Scale),
    Repeat(operators::repeat::Repeat),
    Displace(operators::displace::Displace),
    Warp(operators::warp::Warp),
    Scatter(operators::scatter::Scatter),
}
