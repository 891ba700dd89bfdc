//! A scene: the text of a world, and the parameters that it is rendered with.

use std::path::{Path, PathBuf};

use super::{
    super::Failure,
    grammar::{self, term::Term},
};
use crate::world::{
    World,
    file::{self, Overrides, parse},
};

/// A scene to be examined.
#[derive(Clone, Debug)]
pub struct Scene {
    /// `scene-17`, or the stem of a file.
    pub name: String,
    pub seed: u32,
    pub text: String,
    /// `KEY=VALUE`.
    pub set: Vec<String>,
    /// The folder of a file's models.
    pub folder: Option<PathBuf>,
    /// The choices that the text was made from; `None` for a file.
    pub tree: Option<Term>,
}

impl Scene {
    /// The scene of a seed; `set` overrides the scene's own parameters.
    pub fn generated(seed: u32, set: &[String]) -> Self {
        let generated = grammar::generate(seed);
        Self {
            name: format!("scene-{seed}"),
            seed,
            text: generated.world.file(),
            set: generated
                .set
                .into_iter()
                .chain(set.iter().cloned())
                .collect(),
            folder: None,
            tree: Some(generated.world),
        }
    }

    /// # Errors
    /// When the file cannot be read.
    pub fn of_file(path: &Path, seed: u32, set: &[String]) -> Result<Self, Failure> {
        let stem = path
            .file_stem()
            .map(|stem| stem.to_string_lossy().into_owned());
        Ok(Self {
            name: stem.unwrap_or_else(|| "world".to_owned()),
            seed,
            text: file::text(path)?,
            set: set.to_vec(),
            folder: path.parent().map(Path::to_path_buf),
            tree: None,
        })
    }

    /// # Errors
    /// The message of `grotto check`, if the text is not a valid world.
    pub fn load(&self) -> Result<World, Failure> {
        let mut parameters = crate::parameters::Parameters::default();
        for assignment in &self.set {
            parameters.set(assignment)?;
        }
        let overrides = Overrides::from(&parameters);
        Ok(parse(
            &self.text,
            &self.name,
            self.folder.as_deref(),
            &overrides,
        )?)
    }

    /// The command that reproduces the failure from a file of this scene.
    pub fn command(&self, file: &str) -> String {
        let set: String = self
            .set
            .iter()
            .map(|assignment| format!(" --set {assignment}"))
            .collect();
        format!(
            "grotto stress --world {file} --seed {}{set} --out again",
            self.seed
        )
    }

    /// The same scene with another tree.
    pub fn with_tree(&self, tree: Term) -> Self {
        Self {
            text: tree.file(),
            tree: Some(tree),
            ..self.clone()
        }
    }
}
