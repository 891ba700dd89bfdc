//! Which material a solid voxel takes: the world's rules, ready for evaluation.

use glam::DVec3;

use super::materials::{Condition, Rule};
use super::sdf::{NoiseId, Shape};

/// The rules of a world, in order.
#[derive(Clone, Debug)]
pub struct RuleSet {
    rules: Vec<(u8, Test)>,
}

/// A [`Condition`] with its sub-trees prepared.
#[derive(Clone, Debug)]
pub(super) enum Test {
    Always,
    Below(f64),
    Above(f64),
    InBox { min: DVec3, max: DVec3 },
    Inside(Shape),
    NoiseBelow { noise: NoiseId, value: f64 },
    ShallowerThan(f64),
    FacesUp,
    FacesDown,
    All(Vec<Test>),
    Any(Vec<Test>),
    Not(Box<Test>),
}

impl RuleSet {
    /// Prepares checked rules; their sub-trees share the noise tables of the world's shape.
    ///
    /// # Panics
    /// Without any rule. The last rule of a checked world always holds.
    pub fn new(rules: &[Rule], shape: &Shape) -> Self {
        assert!(!rules.is_empty(), "a world has at least one rule");
        let rules = rules
            .iter()
            .map(|rule| (rule.material, Test::new(&rule.when, shape)))
            .collect();
        Self { rules }
    }

    /// Material of the solid voxel with this centre (world space), from the first rule that holds.
    /// `value` is the shape's value at the centre.
    pub fn material(&self, centre_ws: DVec3, value: f64, shape: &Shape) -> u8 {
        let mut rules = self.rules.iter();
        let found = rules.find(|(_, test)| test.holds(centre_ws, value, shape));
        // The last rule always holds.
        found.or(self.rules.last()).expect("there is a rule").0
    }

    pub(super) fn tests(&self) -> impl Iterator<Item = (u8, &Test)> {
        self.rules.iter().map(|(material, test)| (*material, test))
    }
}

impl Test {
    fn new(condition: &Condition, shape: &Shape) -> Self {
        let all = |of: &[Condition]| of.iter().map(|of| Self::new(of, shape)).collect();
        match condition {
            Condition::Always => Self::Always,
            Condition::Below(height) => Self::Below(f64::from(*height)),
            Condition::Above(height) => Self::Above(f64::from(*height)),
            Condition::InBox { min, max } => Self::InBox {
                min: min.as_dvec3(),
                max: max.as_dvec3(),
            },
            Condition::Inside(sdf) => Self::Inside(Shape::with_bank(sdf, shape.bank().clone())),
            Condition::NoiseBelow { noise, value } => Self::NoiseBelow {
                noise: *noise,
                value: f64::from(*value),
            },
            Condition::ShallowerThan(depth) => Self::ShallowerThan(f64::from(*depth)),
            Condition::FacesUp => Self::FacesUp,
            Condition::FacesDown => Self::FacesDown,
            Condition::All(of) => Self::All(all(of)),
            Condition::Any(of) => Self::Any(all(of)),
            Condition::Not(of) => Self::Not(Box::new(Self::new(of, shape))),
        }
    }

    fn holds(&self, p: DVec3, value: f64, shape: &Shape) -> bool {
        match self {
            Self::Always => true,
            Self::Below(height) => p.y < *height,
            Self::Above(height) => p.y > *height,
            Self::InBox { min, max } => p.cmpge(*min).all() && p.cmple(*max).all(),
            Self::Inside(inside) => inside.eval(p) < 0.0,
            Self::NoiseBelow { noise, value } => shape.bank().value(*noise, p) < *value,
            Self::ShallowerThan(depth) => -value < *depth,
            Self::FacesUp => shape.eval(p + DVec3::Y) >= 0.0,
            Self::FacesDown => shape.eval(p - DVec3::Y) >= 0.0,
            Self::All(of) => of.iter().all(|test| test.holds(p, value, shape)),
            Self::Any(of) => of.iter().any(|test| test.holds(p, value, shape)),
            Self::Not(of) => !of.holds(p, value, shape),
        }
    }
}
