//! No branch of a kernel depends on uniforms alone: `shaders/math/per_thread.wesl` says what Mesa's lavapipe makes of one.
//! What is a constant, what follows from uniforms, and what differs from thread to thread is derived over all functions of a
//! composed shader; compilers see the same once they have inlined calls. What only some values of an `override` make
//! uniform is not seen.

use std::collections::{BTreeMap, BTreeSet};

use grotto::{gpu::ShaderLibrary, world::sdf::shape_module};
use naga::{AddressSpace, Block, Expression, Function, Handle, LocalVariable, Module, Statement};

use crate::{composition::kernels, support::shipped};

/// What a value depends on; the greatest of its operands' is its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Constant,
    Uniform,
    Varying,
}

/// A composed shader, and what has been found in it.
struct Shader<'a> {
    module: &'a Module,
    wgsl: &'a str,
    /// By function and the kinds of its arguments: the kind of its result. Compilers inline each call.
    results: BTreeMap<(usize, Vec<Kind>), Kind>,
    /// Lines of branches that depend on uniforms alone.
    found: BTreeSet<String>,
}

/// The branches of a composed shader that depend on uniforms alone, as the texts of their lines.
fn uniform_branches(module: &Module, wgsl: &str) -> BTreeSet<String> {
    let mut shader = Shader {
        module,
        wgsl,
        results: BTreeMap::new(),
        found: BTreeSet::new(),
    };
    for entry in &module.entry_points {
        let arguments = vec![Kind::Varying; entry.function.arguments.len()];
        shader.examine(&entry.function, arguments);
    }
    shader.found
}

impl Shader<'_> {
    /// Finds the branches of a function that is called with such arguments, and returns the kind of its result.
    fn examine(&mut self, function: &Function, arguments: Vec<Kind>) -> Kind {
        let mut call = Call {
            module: self.module,
            function,
            arguments,
            locals: vec![(Kind::Constant, false); function.local_variables.len()],
            results: BTreeMap::new(),
        };
        // The kinds of local variables only rise.
        loop {
            let before = call.locals.clone();
            call.follow(self, &function.body, false, Kind::Constant);
            if call.locals == before {
                break;
            }
        }
        let mut lines = Vec::new();
        call.branches(&function.body, false, self.wgsl, &mut lines);
        let name = function.name.clone().unwrap_or_default();
        let found = lines.into_iter().map(|line| format!("{name}: {line}"));
        self.found.extend(found);
        call.result()
    }

    fn result(&mut self, function: Handle<Function>, arguments: Vec<Kind>) -> Kind {
        let key = (function.index(), arguments.clone());
        if let Some(known) = self.results.get(&key) {
            return *known;
        }
        let module = self.module;
        let kind = self.examine(&module.functions[function], arguments);
        self.results.insert(key, kind);
        kind
    }
}

/// The kinds of a function's values in one call.
struct Call<'a> {
    module: &'a Module,
    function: &'a Function,
    arguments: Vec<Kind>,
    /// By local variable: the kind of what is stored there, and whether that happens within a loop.
    locals: Vec<(Kind, bool)>,
    /// Of the calls in it, by the expression that holds it.
    results: BTreeMap<usize, Kind>,
}

impl Call<'_> {
    /// Follows the stores and calls of a block. `chosen_by`: what the branches around it depend on, and with them what is
    /// stored afterwards.
    fn follow(&mut self, shader: &mut Shader<'_>, block: &Block, in_loop: bool, chosen_by: Kind) {
        for statement in block.iter() {
            match statement {
                Statement::Store { pointer, value } => {
                    if let Some(local) = self.local(*pointer) {
                        let kind = self.kind(*value, true).max(chosen_by);
                        let (own, looped) = &mut self.locals[local.index()];
                        *own = (*own).max(kind);
                        *looped |= in_loop;
                    }
                }
                Statement::Call {
                    function,
                    arguments,
                    result,
                } => {
                    let kinds = arguments.iter().map(|value| self.kind(*value, false));
                    let kind = shader.result(*function, kinds.collect());
                    if let Some(result) = result {
                        self.results.insert(result.index(), kind);
                    }
                    // What a callee writes through a pointer is not followed.
                    for value in arguments {
                        if let Some(local) = self.local(*value) {
                            self.locals[local.index()].0 = Kind::Varying;
                        }
                    }
                }
                _ => {}
            }
            let chosen_by = match statement {
                Statement::If {
                    condition: value, ..
                }
                | Statement::Switch {
                    selector: value, ..
                } => chosen_by.max(self.kind(*value, false)),
                _ => chosen_by,
            };
            for (inner, is_loop) in blocks(statement) {
                self.follow(shader, inner, in_loop || is_loop, chosen_by);
            }
        }
    }

    /// The local variable that a pointer leads to.
    fn local(&self, pointer: Handle<Expression>) -> Option<Handle<LocalVariable>> {
        match self.function.expressions[pointer] {
            Expression::LocalVariable(local) => Some(local),
            Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => {
                self.local(base)
            }
            _ => None,
        }
    }

    /// `counts`: whether variables that a loop changes count as what they are changed by. The end of a loop may depend on a
    /// counter; in other branches it is a value of its own in each turn.
    fn kind(&self, value: Handle<Expression>, counts: bool) -> Kind {
        let kind = |value: Handle<Expression>| self.kind(value, counts);
        match self.function.expressions[value] {
            Expression::Literal(_)
            | Expression::Constant(_)
            | Expression::Override(_)
            | Expression::ZeroValue(_) => Kind::Constant,
            Expression::Compose { ref components, .. } => {
                let kinds = components.iter().map(|component| kind(*component));
                kinds.max().unwrap_or(Kind::Constant)
            }
            // Only what lies at a known place is known.
            Expression::Access { base, index } => match kind(index) {
                Kind::Constant => kind(base),
                _ => Kind::Varying,
            },
            Expression::AccessIndex { base, .. } => kind(base),
            Expression::Splat { value, .. } => kind(value),
            Expression::Swizzle { vector, .. } => kind(vector),
            Expression::FunctionArgument(index) => self.arguments[index as usize],
            Expression::GlobalVariable(global) => {
                match self.module.global_variables[global].space {
                    AddressSpace::Uniform => Kind::Uniform,
                    _ => Kind::Varying,
                }
            }
            Expression::LocalVariable(local) => {
                let (stored, in_loop) = self.locals[local.index()];
                let declared = &self.function.local_variables[local];
                match declared.init {
                    _ if in_loop && !counts => Kind::Varying,
                    Some(first) => stored.max(kind(first)),
                    None => stored,
                }
            }
            Expression::Load { pointer } => kind(pointer),
            Expression::Unary { expr, .. } | Expression::As { expr, .. } => kind(expr),
            Expression::Binary { left, right, .. } => kind(left).max(kind(right)),
            Expression::Select {
                condition,
                accept,
                reject,
            } => kind(condition).max(kind(accept)).max(kind(reject)),
            Expression::Relational { argument, .. } => kind(argument),
            Expression::Math {
                arg,
                arg1,
                arg2,
                arg3,
                ..
            } => {
                let all = [Some(arg), arg1, arg2, arg3].into_iter().flatten();
                all.map(kind).max().unwrap_or(Kind::Varying)
            }
            Expression::CallResult(_) => {
                let known = self.results.get(&value.index());
                known.copied().unwrap_or(Kind::Constant)
            }
            _ => Kind::Varying,
        }
    }

    /// Which of several values is returned is not followed.
    fn result(&self) -> Kind {
        let mut kinds = Vec::new();
        self.returns(&self.function.body, &mut kinds);
        match kinds[..] {
            [kind] => kind,
            _ => Kind::Varying,
        }
    }

    fn returns(&self, block: &Block, kinds: &mut Vec<Kind>) {
        for statement in block.iter() {
            if let Statement::Return { value: Some(value) } = statement {
                kinds.push(self.kind(*value, false));
            }
            for (inner, _) in blocks(statement) {
                self.returns(inner, kinds);
            }
        }
    }

    /// Lines of the branches of a block that depend on uniforms alone.
    fn branches(&self, block: &Block, in_loop: bool, wgsl: &str, lines: &mut Vec<String>) {
        for statement in block.iter() {
            let deciding = match statement {
                Statement::If {
                    condition,
                    accept,
                    reject,
                } => {
                    let ends = |block: &Block| {
                        block.len() == 1 && matches!(block.first(), Some(Statement::Break))
                    };
                    Some((*condition, in_loop && (ends(accept) || ends(reject))))
                }
                Statement::Switch { selector, .. } => Some((*selector, false)),
                Statement::Loop {
                    break_if: Some(condition),
                    ..
                } => Some((*condition, true)),
                _ => None,
            };
            if let Some((value, counts)) = deciding
                && self.kind(value, counts) == Kind::Uniform
            {
                let place = self.function.expressions.get_span(value).location(wgsl);
                let line = wgsl.lines().nth(place.line_number as usize - 1);
                lines.push(line.unwrap_or_default().trim().to_owned());
            }
            for (inner, is_loop) in blocks(statement) {
                self.branches(inner, in_loop || is_loop, wgsl, lines);
            }
        }
    }
}

/// The blocks of a statement, each with whether it is run again and again.
fn blocks(statement: &Statement) -> Vec<(&Block, bool)> {
    match statement {
        Statement::Block(block) => vec![(block, false)],
        Statement::If { accept, reject, .. } => vec![(accept, false), (reject, false)],
        Statement::Switch { cases, .. } => cases.iter().map(|case| (&case.body, false)).collect(),
        Statement::Loop {
            body, continuing, ..
        } => vec![(body, true), (continuing, true)],
        _ => Vec::new(),
    }
}

#[test]
fn no_branch_depends_on_uniforms_alone() {
    let shape = shape_module(&shipped("cave"));
    let library = ShaderLibrary::embedded();
    let mut found = BTreeSet::new();
    for name in kernels(&library) {
        let composed = library.compose(name, &[("shape", &shape)]);
        let composed = composed.unwrap_or_else(|error| panic!("{error}"));
        let branches = uniform_branches(&composed.module, &composed.wgsl);
        found.extend(branches.into_iter().map(|line| format!("{name}: {line}")));
    }
    let lines: Vec<String> = found.into_iter().collect();
    assert!(
        lines.is_empty(),
        "see shaders/math/per_thread.wesl:\n{}",
        lines.join("\n")
    );
}

#[test]
fn planted_uniform_branches_are_found() {
    let found = |body: &str| {
        let wgsl = format!(
            "struct Info {{ count: u32, parts: array<vec4u, 4> }}
            @group(0) @binding(0) var<uniform> info: Info;
            @group(0) @binding(1) var<storage, read_write> words: array<u32>;
            fn is_few(count: u32) -> bool {{
                return count < 4u;
            }}
            fn either(first: bool, second: bool) -> bool {{
                return first || second;
            }}
            @compute @workgroup_size(64)
            fn main(@builtin(global_invocation_id) id: vec3u) {{
                let thread = id.x;
                {body}
            }}"
        );
        let module = naga::front::wgsl::parse_str(&wgsl).expect("a shader");
        uniform_branches(&module, &wgsl).len()
    };
    for body in [
        "if info.count == 0u { words[thread] = 1u; }",
        "if is_few(info.count) { words[thread] = 1u; }",
        "if either(info.count == 1u, info.count == 2u) { words[thread] = 1u; }",
        "if info.parts[2].y > 0u { words[thread] = 1u; }",
        "for (var i = 0u; i < info.count; i += 1u) { words[i] = thread; }",
        "var last = info.count; if thread == 0u { words[last] = 1u; } if last > 2u { words[0] = 1u; }",
        "switch info.count { case 1u: { words[0] = 1u; } default: {} }",
    ] {
        assert!(found(body) > 0, "{body}");
    }
    for body in [
        "if thread < info.count { words[thread] = 1u; }",
        "if is_few(info.count + thread) { words[thread] = 1u; }",
        "if thread == 1u && info.count == 2u { words[thread] = 1u; }",
        "if info.parts[thread].y > 0u { words[thread] = 1u; }",
        "for (var i = thread; i < words[0]; i += 1u) { words[i] = thread; }",
        "var last = 1u; if thread == 0u { last = info.count; } if last > 2u { words[0] = 1u; }",
        "if select(info.count, 0u, thread == 0xffffffffu) > 2u { words[thread] = 1u; }",
        "words[thread] = select(1u, 2u, info.count == 0u);",
    ] {
        assert_eq!(found(body), 0, "{body}");
    }
}
