//! The function of the material rules.

use super::{Module, number, push, vector};
use crate::world::rules::{RuleSet, Test};

impl Module {
    /// Declares the function of the material rules.
    pub(super) fn rules(&mut self, rules: &RuleSet) {
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
            &mut self.functions,
            format_args!(
                "
const RULE_NEEDS: u32 = {needs}u;

fn material_by(p: vec3f, values: vec3f) -> u32 {{
{body}    return {last}u;
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
