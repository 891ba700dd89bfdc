//! A world's shape and rules as text: a WESL module that the GPU passes import as
//! `package::generated::shape`. Straight-line code, and one function for each noise field, repeat and
//! scatter. Shapes write themselves ([`Node::emit`](super::Node::emit)) into a [`Body`].

mod noise;
mod rules;

use std::collections::BTreeSet;
use std::fmt::{Arguments, Write as _};

use glam::{DVec3, Vec3};

use super::{NoiseId, Shape, Side, Tree};
use crate::world::World;
use crate::world::generate::{BLOCK, block_radius};
use crate::world::rules::RuleSet;
use crate::world::voxels::CELL;

/// The name of the constant for the distance to nothing, beyond everything. Every module declares it.
pub const FAR: &str = "FAR";

/// Most that f32 evaluation may differ from f64, with a wide margin (voxels): blocks are culled only if
/// their value clears the bound by this much.
const ROUNDING_MARGIN: f64 = 0.01;

/// The module for a world. It declares:
/// - `fn shape(p_ws: vec3f) -> f32`: as [`Shape::eval`];
/// - `fn material_by(p_ws: vec3f, values: vec3f) -> u32`: as [`RuleSet::material`], given the shape's
///   value there, one voxel above and one below, and `const RULE_NEEDS: u32`: which of the three the
///   rules read (bit 0, 1, 2);
/// - `const SHAPE_LIPSCHITZ: f32`: as [`Shape::lipschitz`];
/// - `const SHAPE_CELL_VARIATION: f32` and `SHAPE_BLOCK_VARIATION`: where |shape(centre)| exceeds
///   them, the 8³ voxels of the cell (2³ of the block) around a centre are all solid or all air.
///
/// It reads `noise_tables`, which must hold
/// [`packed_tables`](crate::world::noise::NoiseBank::packed_tables) of the same noise fields.
pub fn shape_module(world: &World) -> String {
    let shape = Shape::new(&world.shape, &world.noises);
    let rules = RuleSet::new(&world.rules, &shape);
    let mut module = Module::default();
    module.function("shape", &shape.root);
    module.rules(&rules);
    for id in module.noises.clone() {
        module.noise(id, shape.bank());
    }
    let margin = |edge| shape.variation(block_radius(edge)) + ROUNDING_MARGIN;
    module.finish([
        ("FAR", 1e30),
        ("SHAPE_LIPSCHITZ", shape.lipschitz()),
        ("SHAPE_CELL_VARIATION", margin(CELL)),
        ("SHAPE_BLOCK_VARIATION", margin(BLOCK)),
    ])
}

/// A module while it is being written.
#[derive(Default)]
struct Module {
    imports: BTreeSet<&'static str>,
    /// Functions that shapes need, each declared once.
    helpers: BTreeSet<&'static str>,
    /// Functions of noise fields.
    fields: String,
    /// Further finished functions.
    functions: String,
    /// The fields called by the functions so far.
    noises: BTreeSet<NoiseId>,
    /// Counter for names of functions and variables, each used once in the module.
    names: u32,
}

impl Module {
    fn name(&mut self, kind: &str) -> String {
        self.names += 1;
        format!("{kind}{}", self.names)
    }

    /// A function of a point that returns the tree's value.
    fn function(&mut self, name: &str, tree: &Tree) {
        let mut body = Body {
            module: self,
            text: String::new(),
        };
        let value = tree.emit(&mut body, "p");
        let text = body.text;
        push(
            &mut self.functions,
            format_args!("\nfn {name}(p: vec3f) -> f32 {{\n{text}    return {value};\n}}\n"),
        );
    }

    /// A WGSL expression of a noise field at the point given by the expression `p`.
    fn call_noise(&mut self, id: NoiseId, p: &str) -> String {
        self.noises.insert(id);
        format!("noise_{id}({p})")
    }

    /// The text of the whole module, with these constants (f32).
    fn finish<const N: usize>(&self, constants: [(&str, f64); N]) -> String {
        let mut text = String::new();
        for import in &self.imports {
            push(&mut text, format_args!("import {import};\n"));
        }
        for (name, value) in constants {
            push(
                &mut text,
                format_args!("const {name}: f32 = {};\n", number(value)),
            );
        }
        let helpers = self.helpers.iter().copied();
        text.extend(helpers.chain([self.fields.as_str(), self.functions.as_str()]));
        text
    }
}

/// The body of a WGSL function while it is being written.
pub struct Body<'m> {
    module: &'m mut Module,
    text: String,
}

impl Body<'_> {
    /// A name that is unique in the module; `kind` tells readers what it names.
    pub fn name(&mut self, kind: &str) -> String {
        self.module.name(kind)
    }

    /// Appends text.
    pub fn push(&mut self, text: Arguments<'_>) {
        push(&mut self.text, text);
    }

    /// Appends a variable; returns its name.
    pub fn variable(&mut self, kind: &str, value: Arguments<'_>) -> String {
        let name = self.name(kind);
        self.push(format_args!("    let {name} = {value};\n"));
        name
    }

    /// Makes the module declare this function, once for all callers.
    pub fn helper(&mut self, function: &'static str) {
        self.module.helpers.insert(function);
    }

    /// Makes the module import these items of `shaders/`.
    pub fn import(&mut self, items: &'static str) {
        self.module.imports.insert(items);
    }

    /// Makes the module declare a function.
    pub fn declare(&mut self, function: Arguments<'_>) {
        push(&mut self.module.functions, function);
    }

    /// Makes the module declare a function of a point that returns the tree's value.
    pub fn function(&mut self, name: &str, tree: &Tree) {
        self.module.function(name, tree);
    }

    /// A WGSL expression of a noise field at the point given by the expression `p`.
    pub fn call_noise(&mut self, id: NoiseId, p: &str) -> String {
        self.module.call_noise(id, p)
    }

    /// Appends the statements of a bound on the tree's value at point `p`, without noise or copies;
    /// returns an expression, or `None` if no bound is known.
    pub fn bound(&mut self, tree: &Tree, p: &str, side: Side) -> Option<String> {
        if tree.is_costly() {
            tree.emit_bound(self, p, side)
        } else {
            Some(tree.emit(self, p))
        }
    }
}

fn push(text: &mut String, arguments: Arguments<'_>) {
    text.write_fmt(arguments).expect("writing to a string");
}

/// An f32 literal; values beyond ±1e30 are clamped, which is as good as infinite.
pub fn number(value: f64) -> String {
    single(value.clamp(-1e30, 1e30) as f32)
}

/// An f32 literal of exactly this number.
pub fn single(value: f32) -> String {
    format!("{value:?}f")
}

/// A `vec3f` of f32 literals, clamped as in [`number`].
pub fn vector(value: DVec3) -> String {
    let value: Vec3 = value
        .clamp(DVec3::splat(-1e30), DVec3::splat(1e30))
        .as_vec3();
    format!("vec3f({:?}, {:?}, {:?})", value.x, value.y, value.z)
}
