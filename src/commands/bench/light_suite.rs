//! What the suites about light share: the choice of their worlds, and the output of their rows.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::super::{
    Failure,
    options::RunOptions,
    out_file::OutFile,
    output,
    test_case::{TestCase, TestCaseOptions, Unnamed},
};
use crate::gpu::{AdapterSummary, Gpu};

/// The options of a suite about light.
pub struct LightSuite<'a> {
    pub name: &'static str,
    pub subjects: &'a TestCaseOptions,
    pub run: &'a RunOptions,
    /// The folder to write `NAME.json` into, if any.
    pub out: Option<&'a Path>,
    /// The world that is measured when none is named.
    pub otherwise: &'static str,
    /// Width and height in pixels, where rows depend on them.
    pub size: Option<[u32; 2]>,
}

#[derive(Serialize)]
struct Record<'a, R> {
    suite: &'static str,
    adapter: &'a AdapterSummary,
    /// Width and height in pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    size: Option<[u32; 2]>,
    rows: Vec<R>,
}

impl LightSuite<'_> {
    /// Measures every world, and writes the rows to the file and to the terminal: as JSON, or as the text that
    /// `text` makes of them and of the adapter's name.
    ///
    /// # Errors
    /// For worlds that cannot be read, for cameras and layouts that no world has, for a folder that cannot be
    /// written, and for errors of `measure`.
    pub fn run<R: Serialize>(
        &self,
        measure: impl Fn(&Gpu, &TestCase) -> Result<Vec<R>, Failure>,
        text: impl Fn(&str, &[R]) -> String,
    ) -> Result<(), Failure> {
        let subjects = subjects(self.subjects, self.run, self.otherwise)?;
        let json = format!("{}.json", self.name);
        let file = self.out.map(|folder| OutFile::new(folder, &json));
        let file = file.transpose()?;
        let gpu = output::open_gpu(self.run)?;
        let mut rows = Vec::new();
        for case in &subjects {
            rows.extend(measure(&gpu, case)?);
        }
        let record = Record {
            suite: self.name,
            adapter: &gpu.summary,
            size: self.size,
            rows,
        };
        if let Some(file) = file {
            file.write_json(&record)?;
        }
        if self.run.json {
            output::print_json(&record)
        } else {
            output::print(&text(&gpu.summary.name, &record.rows))
        }
    }
}

/// The worlds of suites about light, at their first camera and layout unless others are named. The world is
/// `otherwise` if none is named.
///
/// # Errors
/// For a world that cannot be read, and for cameras and layouts that no world has.
fn subjects(
    options: &TestCaseOptions,
    run: &RunOptions,
    otherwise: &str,
) -> Result<Vec<TestCase>, Failure> {
    let otherwise = [PathBuf::from(otherwise)];
    let paths = match &options.worlds[..] {
        [] => &otherwise[..],
        given => given,
    };
    let mut subjects = Vec::new();
    for path in paths {
        subjects.extend(TestCase::load(path, run, options, Unnamed::First)?);
    }
    if subjects.is_empty() {
        return Err(Failure::bad_input(
            "no world has the cameras and layouts that --camera and --layout name",
        ));
    }
    Ok(subjects)
}
