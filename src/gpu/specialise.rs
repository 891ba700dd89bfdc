//! The part of a shader that one kernel runs: its constants have their values, and branches that they rule out are gone.
//!
//! Drivers inline every function before they look at a condition, so code that a constant switches off costs them as much time
//! as code that runs: a world without bodies waited for all of their shaders' branches. What is gone binds no buffers either.

use std::{collections::HashMap, mem};

use naga::{
    Arena, BinaryOperator, Block, Constant, Expression, Function, Handle, Literal, LocalVariable,
    Module, ShaderStage, Statement, UnaryOperator,
    back::pipeline_constants::process_overrides,
    compact::{KeepUnused, compact},
    valid::{Capabilities, ModuleInfo, ValidationFlags, Validator},
};

use super::Composed;

/// The module of one entry point, without `override` declarations.
pub(super) struct Specialised {
    pub(super) module: Module,
    pub(super) info: ModuleInfo,
}

/// What `entry` of a shader runs when its `override` declarations, named as in the composed text, have these values.
///
/// # Errors
/// A message, if a declaration has neither a value nor a default, or a value that its type does not hold.
pub(super) fn specialise(
    composed: &Composed,
    entry: &str,
    constants: &[(&str, f64)],
) -> Result<Specialised, String> {
    let constants = constants
        .iter()
        .map(|&(name, value)| (name.to_owned(), value))
        .collect();
    let (module, _) = process_overrides(
        &composed.module,
        &composed.info,
        Some((ShaderStage::Compute, entry)),
        &constants,
    )
    .map_err(|error| error.to_string())?;
    let mut module = module.into_owned();
    let mut functions = module.functions.take();
    let mut entry_points = mem::take(&mut module.entry_points);
    let entries = entry_points.iter_mut().map(|point| &mut point.function);
    let constants = Constants {
        declared: &module.constants,
        values: &module.global_expressions,
    };
    for function in functions
        .iter_mut()
        .map(|(_, function)| function)
        .chain(entries)
    {
        constants.fold(function);
    }
    module.functions = functions;
    module.entry_points = entry_points;
    compact(&mut module, KeepUnused::No);
    let info = Validator::new(ValidationFlags::all(), Capabilities::all())
        .validate(&module)
        .map_err(|error| error.emit_to_string(&composed.wgsl))?;
    Ok(Specialised { module, info })
}

/// The constants of a module.
struct Constants<'a> {
    declared: &'a Arena<Constant>,
    values: &'a Arena<Expression>,
}

impl Constants<'_> {
    /// Puts the branch that is taken in the place of each `if` whose condition is known.
    fn fold(&self, function: &mut Function) {
        // Names may be those of expressions that are gone now.
        function.named_expressions.clear();
        let mut known = Known {
            constants: self,
            expressions: &function.expressions,
            results: HashMap::new(),
        };
        loop {
            let results = known.find_results(&function.body, &function.local_variables);
            let is_more = results.len() > known.results.len();
            known.results = results;
            if !known.fold(&mut function.body) && !is_more {
                break;
            }
        }
    }
}

/// What is known of a function's conditions.
struct Known<'a> {
    constants: &'a Constants<'a>,
    expressions: &'a Arena<Expression>,
    /// The results of `&&` and `||` that are always the same, by the variables that hold them.
    results: HashMap<Handle<LocalVariable>, bool>,
}

impl Known<'_> {
    fn value(&self, condition: Handle<Expression>) -> Option<bool> {
        match self.expressions[condition] {
            Expression::Literal(Literal::Bool(value)) => Some(value),
            Expression::Constant(constant) => {
                let value = self.constants.declared[constant].init;
                match self.constants.values[value] {
                    Expression::Literal(Literal::Bool(value)) => Some(value),
                    _ => None,
                }
            }
            Expression::Load { pointer } => self.results.get(&self.variable(pointer)?).copied(),
            Expression::Unary {
                op: UnaryOperator::LogicalNot,
                expr,
            } => self.value(expr).map(|value| !value),
            Expression::Binary { op, left, right } => {
                let decides = match op {
                    BinaryOperator::And | BinaryOperator::LogicalAnd => false,
                    BinaryOperator::InclusiveOr | BinaryOperator::LogicalOr => true,
                    _ => return None,
                };
                match (self.value(left), self.value(right)) {
                    (Some(value), _) | (_, Some(value)) if value == decides => Some(decides),
                    (Some(_), Some(_)) => Some(!decides),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    fn variable(&self, pointer: Handle<Expression>) -> Option<Handle<LocalVariable>> {
        match self.expressions[pointer] {
            Expression::LocalVariable(variable) => Some(variable),
            _ => None,
        }
    }

    /// naga keeps results of `&&` and `||` in variables without names, which are written on both branches of an `if` and
    /// read after it.
    fn find_results(
        &self,
        block: &Block,
        variables: &Arena<LocalVariable>,
    ) -> HashMap<Handle<LocalVariable>, bool> {
        let mut stored = HashMap::new();
        for_each_store(block, &mut |pointer, value| {
            if let Some(variable) = self.variable(pointer)
                && variables[variable].name.is_none()
            {
                let value = self.value(value);
                let before = stored.entry(variable).or_insert(value);
                if *before != value {
                    *before = None;
                }
            }
        });
        let known = stored.into_iter();
        known
            .filter_map(|(variable, value)| Some((variable, value?)))
            .collect()
    }

    /// Whether something was folded.
    fn fold(&self, block: &mut Block) -> bool {
        let mut changed = false;
        let mut kept = Block::new();
        for (mut statement, span) in mem::take(block).span_into_iter() {
            for inner in blocks_mut(&mut statement) {
                changed |= self.fold(inner);
            }
            match statement {
                Statement::If {
                    condition,
                    accept,
                    reject,
                } => match self.value(condition) {
                    Some(taken) => {
                        kept.extend_block(if taken { accept } else { reject });
                        changed = true;
                    }
                    None => kept.push(
                        Statement::If {
                            condition,
                            accept,
                            reject,
                        },
                        span,
                    ),
                },
                other => kept.push(other, span),
            }
            // Nothing may follow what leaves a block.
            if kept.last().is_some_and(leaves) {
                break;
            }
        }
        *block = kept;
        changed
    }
}

/// Whether nothing of its block can run after it.
fn leaves(statement: &Statement) -> bool {
    matches!(
        statement,
        Statement::Break | Statement::Continue | Statement::Kill | Statement::Return { .. }
    )
}

fn for_each_store(block: &Block, found: &mut impl FnMut(Handle<Expression>, Handle<Expression>)) {
    for statement in block {
        if let Statement::Store { pointer, value } = statement {
            found(*pointer, *value);
        }
        for inner in blocks(statement) {
            for_each_store(inner, found);
        }
    }
}

/// The blocks within a statement.
fn blocks(statement: &Statement) -> Vec<&Block> {
    match statement {
        Statement::Block(block) => vec![block],
        Statement::If { accept, reject, .. } => vec![accept, reject],
        Statement::Switch { cases, .. } => cases.iter().map(|case| &case.body).collect(),
        Statement::Loop {
            body, continuing, ..
        } => vec![body, continuing],
        _ => Vec::new(),
    }
}

fn blocks_mut(statement: &mut Statement) -> Vec<&mut Block> {
    match statement {
        Statement::Block(block) => vec![block],
        Statement::If { accept, reject, .. } => vec![accept, reject],
        Statement::Switch { cases, .. } => cases.iter_mut().map(|case| &mut case.body).collect(),
        Statement::Loop {
            body, continuing, ..
        } => vec![body, continuing],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{ShaderLibrary, shader::base_name};

    /// A shader with two constants, whose entry point runs `body`.
    fn shader(body: &str) -> Composed {
        let text = format!(
            "override ON: bool = true;
             override COUNT: u32 = 4u;
             @group(0) @binding(0) var<storage, read_write> kept: array<u32>;
             @group(0) @binding(1) var<storage, read_write> gone: array<u32>;
             fn far(x: u32) -> u32 {{ gone[x] = 1u; return gone[x + 1u]; }}
             fn chosen(x: u32) -> u32 {{ if ON {{ return x; }} else {{ return far(x); }} }}
             @compute @workgroup_size(COUNT)
             fn main(@builtin(local_invocation_index) i: u32) {{ {body} }}"
        );
        let library = ShaderLibrary::embedded().with("view/specialised", &text);
        let composed = library.compose("view/specialised", &[]);
        composed.unwrap_or_else(|error| panic!("{error}"))
    }

    /// The names of the buffers that the entry point binds, with these values of the constants.
    fn bound(composed: &Composed, values: &[(&str, f64)]) -> Vec<String> {
        let specialised = specialise(composed, "main", values).expect("a valid module");
        assert_eq!(specialised.module.overrides.len(), 0);
        let variables = specialised.module.global_variables.iter();
        let names = variables.filter_map(|(_, variable)| variable.name.as_deref());
        let mut names: Vec<_> = names.map(|name| base_name(name).to_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn what_a_constant_rules_out_is_gone() {
        for body in [
            "if ON { kept[i] = 1u; } else { gone[i] = 1u; }",
            "if !ON { gone[i] = 1u; } kept[i] = 2u;",
            "kept[i] = 1u; if !ON && kept[i] > 2u { gone[i] = 1u; }",
            "kept[i] = 1u; if kept[i] > 2u && !ON { gone[i] = 1u; }",
            "if ON || kept[i] > 2u { kept[i] = 1u; } else { gone[i] = 1u; }",
            "if kept[i] > 2u || ON { kept[i] = 1u; } else { gone[i] = 1u; }",
            "if (kept[i] > 2u || ON) && !(kept[i] > 3u && !ON) { kept[i] = 1u; } else { gone[i] = 1u; }",
            "for (var j = 0u; j < i; j++) { if !ON { gone[j] = 1u; break; } kept[j] = j; }",
            "switch i { case 0u: { if !ON { gone[i] = 1u; } } default: { kept[i] = 1u; } }",
            "kept[i] = chosen(i);",
            "if ON { kept[i] = 1u; return; } kept[i] = far(i);",
            "if COUNT > 8u || !ON { gone[i] = 1u; } kept[i] = 1u;",
            "let never = !ON; if never { gone[i] = 1u; } kept[i] = 1u;",
        ] {
            let composed = shader(body);
            assert_eq!(bound(&composed, &[]), ["kept"], "{body}");
            let both = bound(&composed, &[("ON", 0.0), ("COUNT", 16.0)]);
            assert!(both.contains(&"gone".to_owned()), "{body}: {both:?}");
        }
    }

    #[test]
    fn what_may_be_either_stays() {
        for body in [
            "if i > 2u { kept[i] = 1u; } else { gone[i] = 1u; }",
            "if ON && i > 2u { kept[i] = 1u; } else { gone[i] = 1u; }",
            "if !ON || i > 2u { kept[i] = 1u; } else { gone[i] = 1u; }",
            "var changes = ON; if i > 2u { changes = false; } if changes { kept[i] = 1u; } else { gone[i] = 1u; }",
        ] {
            assert_eq!(bound(&shader(body), &[]), ["gone", "kept"], "{body}");
        }
    }

    #[test]
    fn a_workgroup_has_as_many_threads_as_its_constant_says() {
        let composed = shader("kept[i] = 1u;");
        let threads = |values: &[(&str, f64)]| {
            let specialised = specialise(&composed, "main", values).expect("a valid module");
            specialised.module.entry_points[0].workgroup_size
        };
        assert_eq!(threads(&[]), [4, 1, 1]);
        assert_eq!(threads(&[("COUNT", 32.0)]), [32, 1, 1]);
    }

    #[test]
    fn a_value_that_the_type_does_not_hold_is_an_error() {
        let composed = shader("kept[i] = COUNT;");
        assert!(specialise(&composed, "main", &[("COUNT", -1.0)]).is_err());
        assert!(specialise(&composed, "main", &[("ABSENT", 1.0)]).is_err());
    }
}
