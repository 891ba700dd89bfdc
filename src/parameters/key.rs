//! One key of the table: found by name, read, and written with a check of its range.

use super::{KEYS, Kind, Parameters, Value, nearest, removed};

/// A tunable as `--set`, `grotto info --keys` and the panel see it.
#[derive(Debug)]
pub struct Key {
    /// `section.field`.
    pub name: &'static str,
    /// One line: what it is, and what higher and lower values cost.
    pub doc: &'static str,
    pub kind: Kind,
    pub remake: Remake,
    pub(super) get: fn(&Parameters) -> Value,
    pub(super) put: fn(&mut Parameters, Value),
}

/// What must be rebuilt after a change of a parameter, in ascending order of cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Remake {
    /// Nothing: the next frame reads the new value.
    Nothing,
    /// The probe field: its buffers depend on it.
    Probes,
    /// The world is voxelised again.
    World,
}

/// What is wrong with an assignment, and what would be valid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ParameterError {
    #[error("`{0}` is not KEY=VALUE, as in `probes.rays=128`")]
    NotAnAssignment(String),
    #[error(
        "no parameter is called `{name}`; {}`grotto info --keys` lists them all",
        did_you_mean(near)
    )]
    UnknownKey {
        name: String,
        near: Vec<&'static str>,
    },
    #[error("`{name}` is no longer a parameter: {instead}")]
    RemovedKey { name: String, instead: &'static str },
    /// Two values that do not go together, and a remedy.
    #[error("`{assignment}` needs {needs}")]
    Contradiction { assignment: String, needs: String },
    #[error("`{key}` takes {kind}, not `{text}`{}", instead.map_or(String::new(), |text| format!(": {text}")))]
    BadValue {
        key: &'static str,
        kind: String,
        text: String,
        instead: Option<&'static str>,
    },
}

fn did_you_mean(near: &[&str]) -> String {
    match near {
        [] => String::new(),
        near => format!("did you mean `{}`? ", near.join("`, `")),
    }
}

impl Key {
    /// # Errors
    /// [`ParameterError::UnknownKey`] with the nearest names; [`ParameterError::RemovedKey`] with its
    /// replacement.
    pub fn find(name: &str) -> Result<&'static Self, ParameterError> {
        KEYS.iter().find(|key| key.name == name).ok_or_else(|| {
            if let Some(instead) = removed::instead_of(name) {
                let name = name.to_owned();
                return ParameterError::RemovedKey { name, instead };
            }
            let near = nearest(name, KEYS.iter().map(|key| key.name));
            ParameterError::UnknownKey {
                name: name.to_owned(),
                near,
            }
        })
    }

    /// The value in `parameters`.
    pub fn get(&self, parameters: &Parameters) -> Value {
        (self.get)(parameters)
    }

    /// The default value.
    pub fn default(&self) -> Value {
        self.get(&Parameters::default())
    }

    /// # Errors
    /// [`ParameterError::BadValue`] if the value is of another kind or out of range.
    pub fn set(&self, parameters: &mut Parameters, value: Value) -> Result<(), ParameterError> {
        if !self.kind.holds(&value) {
            return Err(self.refused(&value.to_string()));
        }
        (self.put)(parameters, value);
        Ok(())
    }

    /// Parses a value as users write it.
    ///
    /// # Errors
    /// [`ParameterError::BadValue`].
    pub fn parse(&self, text: &str) -> Result<Value, ParameterError> {
        let value = self.kind.parse(text);
        value
            .filter(|value| self.kind.holds(value))
            .ok_or_else(|| self.refused(text))
    }

    fn refused(&self, text: &str) -> ParameterError {
        ParameterError::BadValue {
            key: self.name,
            kind: self.kind.to_string(),
            text: text.to_owned(),
            instead: removed::instead_of_value(self.name, text),
        }
    }
}
