//! A world's shape and rules as text: a WESL module that the GPU passes import as
//! `package::generated::shape`. Straight-line code, one function for each noise field, repeat and
//! scatter; the helpers lie in `shaders/sdf/`.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use glam::{DVec3, Vec3};

use super::NoiseId;
use super::scatter::Scatter;
use super::shape::{Node, Repeat, Shape, WARP_SHIFTS};
use crate::world::World;
use crate::world::generate::{BLOCK, block_radius};
use crate::world::noise::{Basis, Fractal, NoiseBank, RIDGE_ATTENUATION};
use crate::world::rules::{RuleSet, Test};
use crate::world::voxels::CELL;

/// What f32 evaluation may differ from f64 at most, with a wide margin (voxels): blocks are culled
/// only when their value clears the bound by this much.
const ROUNDING_MARGIN: f64 = 0.01;

/// The module for a world. It declares:
/// - `fn shape(p_ws: vec3f) -> f32`: as [`Shape::eval`];
/// - `fn material_at(p_ws: vec3f) -> u32`: as [`RuleSet::material`];
/// - `fn material_by(p_ws: vec3f, values: vec3f) -> u32`: the same, given the shape's value there,
///   one voxel above and one below, and `const RULE_NEEDS: u32`: which of the three the rules read
///   (bit 0, 1, 2);
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
            Node::Union(of) => self.fold(body, of, p, |a, b| format!("min({a}, {b})")),
            Node::Intersection(of) => self.fold(body, of, p, |a, b| format!("max({a}, {b})")),
            Node::SmoothUnion { k, of } if *k > 0.0 => {
                let k = number(*k);
                self.fold(body, of, p, |a, b| format!("smooth_min({a}, {b}, {k})"))
            }
            Node::SmoothIntersection { k, of } if *k > 0.0 => {
                let k = number(*k);
                self.fold(body, of, p, |a, b| format!("-smooth_min(-{a}, -{b}, {k})"))
            }
            Node::SmoothUnion { of, .. } => self.fold(body, of, p, |a, b| format!("min({a}, {b})")),
            Node::SmoothIntersection { of, .. } => {
                self.fold(body, of, p, |a, b| format!("max({a}, {b})"))
            }
            Node::Translate { by, of } => {
                let q = self.variable(body, "p", format_args!("{p} - {}", vector(*by)));
                self.node(body, of, &q)
            }
            Node::Rotate { inverse, of } => {
                let columns = [inverse.x_axis, inverse.y_axis, inverse.z_axis]
                    .map(vector)
                    .join(", ");
                let q = self.variable(body, "p", format_args!("mat3x3f({columns}) * {p}"));
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

    fn fold(
        &mut self,
        body: &mut String,
        of: &[Node],
        p: &str,
        combine: impl Fn(&str, &str) -> String,
    ) -> String {
        let mut result: Option<String> = None;
        for node in of {
            let value = self.node(body, node, p);
            result = Some(match result {
                None => value,
                Some(before) => {
                    self.variable(body, "d", format_args!("{}", combine(&before, &value)))
                }
            });
        }
        result.unwrap_or_else(|| "FAR".to_owned())
    }

    fn repeat(&mut self, repeat: &Repeat) -> String {
        let (name, of) = (self.name("repeat"), self.name("tile"));
        self.function(&of, &repeat.of);
        let repeats = repeat.period.cmpgt(DVec3::ZERO);
        let period = vector(DVec3::select(repeats, repeat.period, DVec3::ONE));
        let zero_or_period = vector(repeat.period);
        let repeats_vector = format!("vec3<bool>({}, {}, {})", repeats.x, repeats.y, repeats.z);
        let corners = repeats.bitmask();
        let (min, max) = (vector(repeat.bounds.min), vector(repeat.bounds.max));
        let clearance = number(repeat.clearance);
        push(
            &mut self.module,
            format_args!(
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
            ),
        );
        name
    }

    fn scatter(&mut self, scatter: &Scatter) -> String {
        let (name, of) = (self.name("scatter"), self.name("copy"));
        self.function(&of, &scatter.of);
        let (centre, half) = scatter.content();
        let last = scatter.cells - 1;
        let grid = [
            vector(scatter.start.as_dvec3()),
            single(scatter.cell),
            format!("vec3i({}, {}, {})", last.x, last.y, last.z),
            single(scatter.jitter),
            vector(centre),
            number(scatter.clearance()),
            vector(half),
            single(scatter.reach),
            single(scatter.scale_low),
            single(scatter.scale_span),
            format!("{}u", scatter.threshold),
            format!("{}u", scatter.seed_bits),
        ]
        .join(", ");
        push(
            &mut self.module,
            format_args!(
                "
fn {name}(p: vec3f) -> f32 {{
    let grid = ScatterGrid({grid});
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
            ),
        );
        name
    }

    fn call_noise(&mut self, id: NoiseId, p: &str) -> String {
        self.noises.insert(id);
        format!("noise_{id}({p})")
    }

    fn noise(&mut self, id: NoiseId) {
        let field = self.bank.field(id);
        let basis = match field.basis {
            Basis::Perlin => "perlin3",
            Basis::OpenSimplex => "open_simplex3",
            Basis::Worley => "worley3",
            Basis::Value => "value3",
        };
        let table = self.bank.first_table(id);
        let (frequency, offset) = (vector(field.frequency), vector(field.offset));
        let sample = format!("{basis}(q, {table}u + octave)");
        // What comes before the loop, what makes an octave's signal, and the first amplitude.
        let (before, signal, amplitude) = match field.fractal {
            Fractal::None => ("", String::new(), 1.0),
            Fractal::Fbm { persistence, .. } => {
                ("", format!("let signal = {sample};"), persistence)
            }
            Fractal::Billow { persistence, .. } => (
                "",
                format!("let signal = abs({sample}) * 2.0 - 1.0;"),
                persistence,
            ),
            Fractal::Ridged { .. } => {
                let attenuation = number(RIDGE_ATTENUATION);
                let signal = format!(
                    "let ridge = 1.0 - abs({sample});
        let signal = ridge * ridge * weight;
        weight = clamp(signal / {attenuation}, 0.0, 1.0);"
                );
                ("    var weight = 1.0;\n", signal, 1.0)
            }
        };
        let body = match field.fractal {
            Fractal::None => {
                format!("    return {basis}(p * {frequency} + {offset}, {table}u);\n")
            }
            Fractal::Fbm {
                lacunarity,
                persistence,
                ..
            }
            | Fractal::Billow {
                lacunarity,
                persistence,
                ..
            }
            | Fractal::Ridged {
                lacunarity,
                persistence,
                ..
            } => {
                let (lacunarity, persistence) = (number(lacunarity), number(persistence));
                let (amplitude, scale) = (number(amplitude), number(field.scale()));
                let octaves = field.octaves();
                // Ridges begin at 0; the field begins at −1.
                let shift = if before.is_empty() { "" } else { " - 1.0" };
                format!(
                    "    var q = p * {frequency} + {offset};
    var sum = 0.0;
    var amplitude = {amplitude};
{before}    for (var octave = 0u; octave < {octaves}u; octave += 1u) {{
        {signal}
        sum += signal * amplitude;
        amplitude *= {persistence};
        q *= {lacunarity};
    }}
    return sum * {scale}{shift};
"
                )
            }
        };
        push(
            &mut self.module,
            format_args!("\nfn noise_{id}(p: vec3f) -> f32 {{\n{body}}}\n"),
        );
    }

    fn rules(&mut self, rules: &RuleSet) {
        let mut body = String::new();
        let (mut last, mut needs) = (0, 0);
        for (material, test) in rules.tests() {
            last = material;
            needs |= value_needs(test);
            let condition = self.condition(test);
            push(
                &mut body,
                format_args!("    if {condition} {{\n        return {material}u;\n    }}\n"),
            );
        }
        push(
            &mut self.module,
            format_args!(
                "
const RULE_NEEDS: u32 = {needs}u;

fn material_by(p: vec3f, values: vec3f) -> u32 {{
{body}    return {last}u;
}}

fn material_at(p: vec3f) -> u32 {{
    let up = vec3f(0.0, 1.0, 0.0);
    return material_by(p, vec3f(shape(p), shape(p + up), shape(p - up)));
}}
"
            ),
        );
    }

    /// A boolean expression of the point `p` and the `values` at, above and below it.
    fn condition(&mut self, test: &Test) -> String {
        let mut joined = |of: &[Test], operator: &str, none: &str| {
            let parts: Vec<String> = of.iter().map(|test| self.condition(test)).collect();
            if parts.is_empty() {
                none.to_owned()
            } else {
                format!("({})", parts.join(operator))
            }
        };
        match test {
            Test::Always => "true".to_owned(),
            Test::Below(height) => format!("p.y < {}", number(*height)),
            Test::Above(height) => format!("p.y > {}", number(*height)),
            Test::InBox { min, max } => {
                format!("(all(p >= {}) && all(p <= {}))", vector(*min), vector(*max))
            }
            Test::Inside(shape) => {
                let name = self.name("inside");
                self.function(&name, &shape.root);
                format!("{name}(p) < 0.0")
            }
            Test::NoiseBelow { noise, value } => {
                format!("{} < {}", self.call_noise(*noise, "p"), number(*value))
            }
            Test::ShallowerThan(depth) => format!("-values.x < {}", number(*depth)),
            Test::FacesUp => "values.y >= 0.0".to_owned(),
            Test::FacesDown => "values.z >= 0.0".to_owned(),
            Test::All(of) => joined(of, " && ", "true"),
            Test::Any(of) => joined(of, " || ", "false"),
            Test::Not(of) => format!("!({})", self.condition(of)),
        }
    }
}

/// Which of the values at, above and below a point a rule reads: bits 0, 1 and 2.
fn value_needs(test: &Test) -> u32 {
    match test {
        Test::ShallowerThan(_) => 1,
        Test::FacesUp => 2,
        Test::FacesDown => 4,
        Test::All(of) | Test::Any(of) => of.iter().map(value_needs).fold(0, |a, b| a | b),
        Test::Not(of) => value_needs(of),
        _ => 0,
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
