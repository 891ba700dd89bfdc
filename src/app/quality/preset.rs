//! The presets: one table of what each sets.

use crate::parameters::{Key, Parameters};

/// A choice between speed and truth. `high` is what every table of figures measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    Low,
    Medium,
    High,
    Ultra,
}

/// The key of the picture's scale.
const SCALE: &str = "picture.scale";

/// What the presets set, in the order of [`Preset::ALL`]. docs/notes/quality.md has the same table with what was measured.
const TABLE: &[(&str, [&str; 4])] = &[
    (SCALE, ["0.5", "0.67", "1", "1"]),
    ("probes.rays", ["128", "128", "128", "256"]),
    ("probes.ray_share", ["0.25", "0.5", "1", "1"]),
    ("probes.face_share", ["0.25", "0.5", "1", "1"]),
    ("probes.face_pixels", ["2", "2", "1", "1"]),
];

impl Preset {
    pub const ALL: [Self; 4] = [Self::Low, Self::Medium, Self::High, Self::Ultra];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Low => "low",
            Self::Medium => "medium",
            Self::High => "high",
            Self::Ultra => "ultra",
        }
    }

    /// Edge length of the rendered picture, as a share of the shown one.
    pub fn scale(self) -> f32 {
        let mut parameters = Parameters::default();
        self.apply(&mut parameters);
        parameters.picture.scale
    }

    /// Sets the parameters that presets choose; all others stay.
    pub fn apply(self, parameters: &mut Parameters) {
        for (name, values) in TABLE {
            parameters
                .set(&format!("{name}={}", values[self as usize]))
                .expect("a test holds the table to the keys");
        }
    }

    /// Whether what presets choose is as this one has it.
    pub fn is(self, parameters: &Parameters) -> bool {
        keys().all(|key| key.get(parameters) == self.value(key))
    }

    /// The parameters without what this preset sets: what belongs to the world rather than to the machine. Values
    /// other than the preset's stay, except the scale, which always belongs to the machine.
    pub fn without(self, parameters: &Parameters) -> Parameters {
        let mut rest = parameters.clone();
        let is_left_out = |key: &&Key| key.name == SCALE || key.get(parameters) == self.value(key);
        for key in keys().filter(is_left_out) {
            key.set(&mut rest, key.default())
                .expect("defaults are valid");
        }
        rest
    }

    fn value(self, key: &Key) -> crate::parameters::Value {
        let mut parameters = Parameters::default();
        self.apply(&mut parameters);
        key.get(&parameters)
    }
}

fn keys() -> impl Iterator<Item = &'static Key> {
    TABLE
        .iter()
        .map(|(name, _)| Key::find(name).expect("a test holds the table to the keys"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::Remake;

    #[test]
    fn the_table_names_keys_that_take_its_values() {
        for preset in Preset::ALL {
            let mut parameters = Parameters::default();
            preset.apply(&mut parameters);
            assert!(preset.is(&parameters), "{preset:?}");
            for other in Preset::ALL.into_iter().filter(|other| *other != preset) {
                assert!(!other.is(&parameters), "{other:?}");
            }
        }
        assert!(keys().all(|key| key.remake < Remake::World));
    }

    #[test]
    fn high_is_the_default_of_every_key() {
        let mut parameters = Parameters::default();
        Preset::High.apply(&mut parameters);
        assert_eq!(parameters, Parameters::default());
    }

    #[test]
    fn presets_of_less_work_than_high_keep_the_light_of_the_probes() {
        let of = |preset: Preset| {
            let mut parameters = Parameters::default();
            preset.apply(&mut parameters);
            parameters
        };
        for preset in [Preset::Low, Preset::Medium] {
            let remake = of(preset).remake_for(&of(Preset::High));
            assert_eq!(remake, Remake::Nothing, "{preset:?}");
        }
    }

    #[test]
    fn what_a_user_set_stays_and_what_the_preset_set_does_not() {
        let mut parameters = Parameters::default();
        Preset::Low.apply(&mut parameters);
        parameters.probes.rays = 16;
        parameters.picture.exposure_ev = 1.0;
        parameters.picture.scale = 0.8;
        let rest = Preset::Low.without(&parameters);
        let mut expected = Parameters::default();
        expected.probes.rays = 16;
        expected.picture.exposure_ev = 1.0;
        assert_eq!(rest, expected);
    }

    /// The rows of the note's table that name a key.
    #[test]
    fn the_note_has_the_same_table() {
        let note = include_str!("../../../docs/notes/quality.md");
        let row = |name: &str, values: [String; 4]| {
            let row = format!("| `{name}` | {} |", values.join(" | "));
            assert!(note.contains(&row), "docs/notes/quality.md lacks: {row}");
        };
        for (name, values) in TABLE {
            row(name, values.map(str::to_owned));
        }
    }
}
