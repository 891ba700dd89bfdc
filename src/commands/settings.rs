//! `--vary KEY=VALUE,VALUE…`: rows for several values of the probes' parameters, in all combinations.

use std::fmt;

use serde::{Serialize, Serializer, ser::SerializeMap as _};

use super::Failure;
use crate::parameters::{Key, ParameterError, Parameters, Value};

/// The sections whose keys may vary within a table: their keys do not affect the reference.
const SECTIONS: [&str; 2] = ["probes.", "source."];
/// Most settings of a table.
const MOST_SETTINGS: usize = 4096;

/// A key with the values that rows are made for.
#[derive(Clone, Debug)]
pub struct Varied {
    key: &'static Key,
    /// Never empty, without duplicates.
    values: Vec<Value>,
}

impl Varied {
    /// Reads `KEY=VALUE,VALUE…`.
    pub fn parse(text: &str) -> Result<Self, String> {
        let not_an_assignment =
            || format!("`{text}` is not KEY=VALUE,VALUE…, as in `probes.relocation=off,exact`");
        let (name, values) = text.split_once('=').ok_or_else(not_an_assignment)?;
        Self::of(name, values.split(',')).map_err(|error| error.to_string())
    }

    /// Rays per probe, as `--rays` varies them.
    pub fn rays(counts: &[u32]) -> Result<Self, VaryError> {
        let texts: Vec<String> = counts.iter().map(u32::to_string).collect();
        Self::of(RAYS, texts.iter().map(String::as_str))
    }

    fn of<'t>(name: &str, texts: impl Iterator<Item = &'t str>) -> Result<Self, VaryError> {
        let key = Key::find(name)?;
        if !SECTIONS.iter().any(|section| key.name.starts_with(section)) {
            return Err(VaryError::ChangesTheTruth(key.name));
        }
        let mut values: Vec<Value> = Vec::new();
        for text in texts {
            let value = key.parse(text.trim())?;
            if values.contains(&value) {
                let text = text.trim().to_owned();
                return Err(VaryError::Twice(key.name, text));
            }
            values.push(value);
        }
        Ok(Self { key, values })
    }

    pub fn name(&self) -> &'static str {
        self.key.name
    }
}

/// The key that `--rays` stands for.
pub const RAYS: &str = "probes.rays";

/// The errors of a list of values.
#[derive(Debug, thiserror::Error)]
pub enum VaryError {
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error(
        "`{0}` may change the reference or the display; within one table only probes.* and source.* may \
         vary: make one table for each value, with --set"
    )]
    ChangesTheTruth(&'static str),
    #[error("`{0}` takes the value `{1}` twice; every value makes one row")]
    Twice(&'static str, String),
}

/// A value for each varied key: the difference between the rows of one setting and all others.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Setting {
    values: Vec<(&'static str, Value)>,
}

impl Setting {
    /// All combinations of the values; the last key changes fastest. One empty setting where nothing varies.
    ///
    /// # Errors
    /// For a key that varies twice or that `set` also sets, and for too many settings.
    pub fn product(varied: &[Varied], set: &[String]) -> Result<Vec<Self>, Failure> {
        for (index, one) in varied.iter().enumerate() {
            let name = one.name();
            if varied[..index].iter().any(|other| other.name() == name) {
                return Err(Failure::bad_input(format!(
                    "`{name}` varies twice; write all of its values in one --vary (--rays is that of {RAYS})"
                )));
            }
            let sets = |assignment: &String| {
                assignment
                    .split_once('=')
                    .is_some_and(|(key, _)| key.trim() == name)
            };
            if set.iter().any(sets) {
                return Err(Failure::bad_input(format!(
                    "`{name}` is set by --set and varies; leave one of them out"
                )));
            }
        }
        let count = varied
            .iter()
            .try_fold(1usize, |count, one| count.checked_mul(one.values.len()));
        if count.is_none_or(|count| count > MOST_SETTINGS) {
            return Err(Failure::bad_input(format!(
                "--vary makes more than {MOST_SETTINGS} settings; take fewer values"
            )));
        }
        let mut settings = vec![Self::default()];
        for Varied { key, values } in varied {
            let with = |setting: &Self, value: &Value| {
                let mut values = setting.values.clone();
                values.push((key.name, value.clone()));
                Self { values }
            };
            settings = settings
                .iter()
                .flat_map(|setting| values.iter().map(|value| with(setting, value)))
                .collect();
        }
        Ok(settings)
    }

    /// These parameters, with the values of this setting.
    pub fn of(&self, parameters: &Parameters) -> Parameters {
        let mut parameters = parameters.clone();
        for (name, value) in &self.values {
            Key::find(name)
                .and_then(|key| key.set(&mut parameters, value.clone()))
                .expect("values were read for their keys");
        }
        parameters
    }

    /// Keys and values as text.
    pub fn texts(&self) -> Vec<(String, String)> {
        let text = |(name, value): &(&'static str, Value)| ((*name).to_owned(), value.to_string());
        self.values.iter().map(text).collect()
    }

    /// Reads [`texts`](Self::texts).
    ///
    /// # Errors
    /// For unknown keys, and for values that their keys do not accept.
    pub fn from_texts(texts: &[(String, String)]) -> Result<Self, ParameterError> {
        let read = |(name, text): &(String, String)| {
            let key = Key::find(name)?;
            Ok((key.name, key.parse(text)?))
        };
        let values = texts.iter().map(read).collect::<Result<_, _>>()?;
        Ok(Self { values })
    }

    /// The value of a key as text, if the key varies.
    pub fn value(&self, name: &str) -> Option<String> {
        let found = self.values.iter().find(|(key, _)| *key == name);
        found.map(|(_, value)| value.to_string())
    }

    /// A suffix for a row that already names its rays: `, relocation off`, or nothing.
    pub fn note(&self) -> String {
        let others = self.values.iter().filter(|(key, _)| *key != RAYS);
        others
            .map(|(name, value)| format!(", {} {value}", short(name)))
            .collect()
    }
}

/// The name of a key without the section that most keys share.
fn short(name: &str) -> &str {
    name.strip_prefix(SECTIONS[0]).unwrap_or(name)
}

/// For example `relocation off, distance_texels 8`.
impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (name, value)) in self.values.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(f, "{comma}{} {value}", short(name))?;
        }
        Ok(())
    }
}

/// An object in the order of the flags; numbers are numbers, all other values are text.
impl Serialize for Setting {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.values.len()))?;
        for (name, value) in &self.values {
            match value {
                Value::Count(count) => map.serialize_entry(name, count)?,
                Value::Number(number) => map.serialize_entry(name, number)?,
                other => map.serialize_entry(name, &other.to_string())?,
            }
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn varied(texts: &[&str]) -> Vec<Varied> {
        let parsed = texts.iter().map(|text| Varied::parse(text));
        parsed.map(|one| one.expect("sound")).collect()
    }

    #[test]
    fn each_value_comes_with_each_and_the_last_key_changes_fastest() {
        let varied = varied(&["probes.relocation=off,exact", "probes.rays=8, 16,32"]);
        let settings = Setting::product(&varied, &[]).expect("sound");
        let texts: Vec<String> = settings.iter().map(Setting::to_string).collect();
        assert_eq!(
            texts,
            [
                "relocation off, rays 8",
                "relocation off, rays 16",
                "relocation off, rays 32",
                "relocation exact, rays 8",
                "relocation exact, rays 16",
                "relocation exact, rays 32",
            ]
        );
        let last = settings[5].of(&Parameters::default());
        let mut expected = Parameters::default();
        expected.set("probes.relocation=exact").expect("a key");
        expected.set("probes.rays=32").expect("a key");
        assert_eq!(last, expected);
        assert_ne!(settings[0].of(&Parameters::default()), expected);
        let json = serde_json::to_string(&settings[1]).expect("JSON");
        assert_eq!(json, r#"{"probes.relocation":"off","probes.rays":16}"#);
        assert_eq!(settings[1].note(), ", relocation off");
        assert_eq!(settings[1].value("probes.rays").as_deref(), Some("16"));
        for setting in &settings {
            let read = Setting::from_texts(&setting.texts()).expect("as written");
            assert_eq!(read, *setting);
        }
        let other = [("probes.rays".to_owned(), "many".to_owned())];
        Setting::from_texts(&other).expect_err("no number");
    }

    #[test]
    fn where_nothing_varies_there_is_one_setting() {
        let settings = Setting::product(&[], &["probes.rays=8".to_owned()]).expect("sound");
        assert_eq!(settings, [Setting::default()]);
        assert_eq!(settings[0].to_string(), "");
    }

    #[test]
    fn bad_lists_say_what_would_be_right() {
        for (text, parts) in [
            ("probes.relocation", &["KEY=VALUE,VALUE"][..]),
            ("probes.relocaton=off", &["`probes.relocation`"]),
            (
                "probes.relocation=off,sometimes",
                &["probes.relocation", "exact", "`sometimes`"],
            ),
            ("probes.relocation=", &["probes.relocation", "``"]),
            ("probes.rays=8,8", &["`probes.rays`", "`8` twice"]),
            ("probes.rays=8,4", &["8 to 4096", "`4`"]),
            ("world.seed=1,2", &["`world.seed`", "probes.*", "--set"]),
            ("lights.animate=on,off", &["`lights.animate`", "--set"]),
        ] {
            let message = Varied::parse(text).expect_err(text);
            for part in parts {
                assert!(message.contains(part), "{text}: {message}");
            }
        }
        let refused = |texts: &[&str], set: &[&str]| {
            let set: Vec<String> = set.iter().map(|&text| text.to_owned()).collect();
            let refused = Setting::product(&varied(texts), &set).expect_err("not sound");
            assert_eq!(refused.exit_code(), 2);
            refused.to_string()
        };
        assert!(refused(&["probes.rays=8", "probes.rays=16"], &[]).contains("varies twice"));
        assert!(refused(&["probes.rays=8"], &["probes.rays=9"]).contains("--set"));
        let many: Vec<String> = (8..80).map(|n| n.to_string()).collect();
        let many = many.join(",");
        let lists =
            ["rays", "alive_frames", "warmup_frames"].map(|key| format!("probes.{key}={many}"));
        let lists: Vec<&str> = lists.iter().map(String::as_str).collect();
        assert!(refused(&lists, &[]).contains("4096"));
    }
}
