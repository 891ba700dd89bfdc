//! A world's shape and rules as text: a WESL module that the GPU passes import as
//! `package::generated::shape`. Straight-line code, one function for each noise field, repeat and
//! scatter; the helpers lie in `shaders/sdf/`.

mod copies;
mod fold;
mod noise;
mod rules;

use std::collections::BTreeSet;
use std::fmt::Write as _;

use glam::{DMat3, DVec3, Vec3};

use self::fold::Combine;
use super::NoiseId;
use super::shape::{Node, Shape, WARP_SHIFTS};
use crate::world::World;
use crate::world::generate::{BLOCK, block_radius};
use crate::world::noise::NoiseBank;
use crate::world::rules::RuleSet;
use crate::world::voxels::CELL;

/// What f32 evaluation may differ from f64 at most, with a wide margin (voxels): blocks are culled
/// only when their value clears the bound by this much.
const ROUNDING_MARGIN: f64 = 0.01;

/// The module for a world. It declares:
/// - `fn shape(p_ws: vec3f) -> f32`: as [`Shape::eval`];
/// - `fn material_by(p_ws: vec3f, values: vec3f) -> u32`: as [`RuleSet::material`], given the shape's
///   value there, one voxel above and one below, and `const RULE_NEEDS: u32`: which of the three the
///   rules read (bit 0, 1, 2);
/// - `const SHAPE_LIPSCHITZ: f32`: as [`Shape::lipschitz`];
/// - `const SHAPE_CELL_VARIATION: f32` and `SHAPE_BLOCK_VARIATION`: where |shape(centre)| exceeds
///   them, the 8³ (4³) voxels around a centre are all stone or all air.
///
/// It reads `noise_tables`, which [`NoiseBank::packed_tables`] of the same noise fields fills.
pub fn shape_module(world: &World) -> String {
    let shape = Shape::new(&world.shape, &world.noises);
    let rules = RuleSet::new(&world.rules, &shape);
    let mut writer = Writer {
        bank: shape.bank(),
        module: String::new(),
        noises: BTreeSet::new(),
        names: 0,
    };
    writer.function("shape", &shape.root);
    writer.rules(&rules);
    let margin = |edge| shape.variation(block_radius(edge)) + ROUNDING_MARGIN;
    let constants = [
        ("LIPSCHITZ", shape.lipschitz()),
        ("CELL_VARIATION", margin(CELL)),
        ("BLOCK_VARIATION", margin(BLOCK)),
    ];
    let mut module = String::from(
        "import package::sdf::noise::{perlin3, open_simplex3, worley3, value3};\n\
         import package::sdf::primitives::{FAR, box_distance, capsule_distance, cylinder_distance, \
         circle_distance, smooth_min};\n\
         import package::sdf::scatter::{ScatterGrid, SCATTER_NEAR, SCATTER_ALL, scatter_outside, \
         scatter_near_clearance, scatter_copy};\n\n",
    );
    for (name, value) in constants {
        push(
            &mut module,
            format_args!("const SHAPE_{name}: f32 = {};\n", number(value)),
        );
    }
    let noises: Vec<NoiseId> = writer.noises.iter().copied().collect();
    for id in noises {
        writer.noise(id);
    }
    module + &writer.module
}

struct Writer<'a> {
    bank: &'a NoiseBank,
    /// Finished functions.
    module: String,
    /// The fields that the functions so far call.
    noises: BTreeSet<NoiseId>,
    /// Counts names of functions and variables, each used once in the module.
    names: u32,
}

impl Writer<'_> {
    fn name(&mut self, kind: &str) -> String {
        self.names += 1;
        format!("{kind}{}", self.names)
    }

    /// A function of a point that returns the node's value.
    fn function(&mut self, name: &str, node: &Node) {
        let mut body = String::new();
        let value = self.node(&mut body, node, "p");
        push(
            &mut self.module,
            format_args!("\nfn {name}(p: vec3f) -> f32 {{\n{body}    return {value};\n}}\n"),
        );
    }

    fn variable(
        &mut self,
        body: &mut String,
        kind: &str,
        value: std::fmt::Arguments<'_>,
    ) -> String {
        let name = self.name(kind);
        push(body, format_args!("    let {name} = {value};\n"));
        name
    }

    /// Appends the statements of a node at point `p`; returns the name of its value.
    fn node(&mut self, body: &mut String, node: &Node, p: &str) -> String {
        match node {
            Node::Empty => "FAR".to_owned(),
            Node::Sphere { radius } => {
                self.variable(body, "d", format_args!("length({p}) - {}", number(*radius)))
            }
            Node::Box { half, radius } => {
                let (half, radius) = (vector(*half), number(*radius));
                self.variable(
                    body,
                    "d",
                    format_args!("box_distance({p}, {half}) - {radius}"),
                )
            }
            Node::Capsule {
                from,
                along,
                inverse_length_squared,
                radius,
            } => self.variable(
                body,
                "d",
                format_args!(
                    "capsule_distance({p} - {}, {}, {}) - {}",
                    vector(*from),
                    vector(*along),
                    number(*inverse_length_squared),
                    number(*radius)
                ),
            ),
            Node::Cylinder {
                radius,
                half_height,
            } => {
                let (radius, half_height) = (number(*radius), number(*half_height));
                self.variable(
                    body,
                    "d",
                    format_args!("cylinder_distance({p}, {radius}, {half_height})"),
                )
            }
            Node::Torus { major, minor } => {
                let (major, minor) = (number(*major), number(*minor));
                self.variable(
                    body,
                    "d",
                    format_args!("circle_distance({p}, {major}) - {minor}"),
                )
            }
            Node::Plane { normal, offset } => {
                let (normal, offset) = (vector(*normal), number(*offset));
                self.variable(body, "d", format_args!("dot({p}, {normal}) - {offset}"))
            }
            Node::HeightField {
                noise,
                base,
                amplitude,
                step,
                slope,
            } => {
                let noise = self.call_noise(*noise, &format!("vec3f({p}.x, 0.0, {p}.z)"));
                let mut rise =
                    self.variable(body, "r", format_args!("{} * {noise}", number(*amplitude)));
                if *step > 0.0 {
                    let step = number(*step);
                    rise =
                        self.variable(body, "r", format_args!("floor({rise} / {step}) * {step}"));
                }
                let (base, slope) = (number(*base), number(*slope));
                self.variable(
                    body,
                    "d",
                    format_args!("({p}.y - {base} - {rise}) / {slope}"),
                )
            }
            Node::Complement(of) => {
                let of = self.node(body, of, p);
                self.variable(body, "d", format_args!("-{of}"))
            }
            Node::Union(of) => self.fold(
                body,
                of,
                p,
                Combine {
                    largest: false,
                    k: 0.0,
                },
            ),
            Node::Intersection(of) => self.fold(
                body,
                of,
                p,
                Combine {
                    largest: true,
                    k: 0.0,
                },
            ),
            Node::SmoothUnion { k, of } => self.fold(
                body,
                of,
                p,
                Combine {
                    largest: false,
                    k: *k,
                },
            ),
            Node::SmoothIntersection { k, of } => self.fold(
                body,
                of,
                p,
                Combine {
                    largest: true,
                    k: *k,
                },
            ),
            Node::Translate { by, of } => {
                let q = self.variable(body, "p", format_args!("{p} - {}", vector(*by)));
                self.node(body, of, &q)
            }
            Node::Rotate { inverse, of } => {
                let q = self.rotated(body, *inverse, p);
                self.node(body, of, &q)
            }
            Node::Scale { by, of } => {
                let by = number(*by);
                let q = self.variable(body, "p", format_args!("{p} / {by}"));
                let of = self.node(body, of, &q);
                self.variable(body, "d", format_args!("{of} * {by}"))
            }
            Node::Repeat(repeat) => {
                let name = self.repeat(repeat);
                self.variable(body, "d", format_args!("{name}({p})"))
            }
            Node::Displace {
                noise,
                amplitude,
                of,
            } => {
                let of = self.node(body, of, p);
                let noise = self.call_noise(*noise, p);
                self.variable(
                    body,
                    "d",
                    format_args!("{of} + {} * {noise}", number(*amplitude)),
                )
            }
            Node::Warp {
                noise,
                amplitude,
                of,
            } => {
                let x = self.call_noise(*noise, p);
                let [y, z] = WARP_SHIFTS
                    .map(|shift| self.call_noise(*noise, &format!("{p} + {}", vector(shift))));
                let amplitude = number(*amplitude);
                let q = self.variable(
                    body,
                    "p",
                    format_args!("{p} + {amplitude} * vec3f({x}, {y}, {z})"),
                );
                self.node(body, of, &q)
            }
            Node::Scatter(scatter) => {
                let name = self.scatter(scatter);
                self.variable(body, "d", format_args!("{name}({p})"))
            }
        }
    }

    fn rotated(&mut self, body: &mut String, matrix: DMat3, p: &str) -> String {
        let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis]
            .map(vector)
            .join(", ");
        self.variable(body, "p", format_args!("mat3x3f({columns}) * {p}"))
    }
}

fn push(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    text.write_fmt(arguments).expect("writing to a string");
}

/// An f32 literal; beyond ±1e30 that is as good as infinite.
fn number(value: f64) -> String {
    single(value.clamp(-1e30, 1e30) as f32)
}

fn single(value: f32) -> String {
    format!("{value:?}f")
}

fn vector(value: DVec3) -> String {
    let value: Vec3 = value
        .clamp(DVec3::splat(-1e30), DVec3::splat(1e30))
        .as_vec3();
    format!("vec3f({:?}, {:?}, {:?})", value.x, value.y, value.z)
}
