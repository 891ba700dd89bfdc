//! The files of the judge. They are written after each row, so that an interrupted run keeps its rows.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::{
    super::{Failure, out_file::OutFile},
    motion,
    page::Page,
    row::Row,
    summary::Summary,
    table::{self, csv},
};
use crate::gpu::AdapterSummary;

/// The `judge.json`, and the data for the other files.
#[derive(Serialize)]
pub struct Report<'a> {
    pub version: &'static str,
    pub adapter: &'a AdapterSummary,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Paths per pixel of the references.
    pub spp: u32,
    /// Whether pictures and references are anti-aliased, as players see them.
    pub displayed: bool,
    /// Whether all rows are present: false while rows are left, and when the run was stopped.
    pub complete: bool,
    pub rows: &'a [Row],
    /// Means over the rows of each setting, if there are several settings.
    pub by_setting: Vec<Summary>,
    /// Worlds that are missing, and why.
    pub failures: Vec<Missing>,
    /// The keys that vary, with a column for each.
    #[serde(skip)]
    pub varied: &'a [&'static str],
}

#[derive(Serialize)]
pub struct Missing {
    pub world: String,
    pub message: String,
}

impl Report<'_> {
    /// All tables as a terminal shows them.
    pub fn text(&self) -> String {
        let mut text = table::of_rows(self.rows, self.varied).text();
        if !self.by_setting.is_empty() {
            text += "\n";
            text += &table::of_settings(&self.by_setting, self.varied).text();
        }
        if let Some(motion) = motion::of_rows(self.rows, self.varied) {
            text += "\n";
            text += &motion.text();
        }
        text
    }

    /// All tables in Markdown, for readers without a browser.
    fn markdown(&self) -> String {
        let mut text = format!(
            "# DDGI against path-traced references\n\n{}\n",
            self.made_by()
        );
        for warning in self.warnings() {
            text += &format!("\n**{warning}**\n");
        }
        for missing in &self.failures {
            text += &format!("\n```text\n{}\n```\n", missing.message);
        }
        if !self.by_setting.is_empty() {
            text += &format!(
                "\n{}",
                table::of_settings(&self.by_setting, self.varied).markdown()
            );
        }
        let rows = table::of_rows(self.rows, self.varied).markdown();
        text += &format!("\n{rows}\n{}\n", table::LEGEND);
        if let Some(motion) = motion::of_rows(self.rows, self.varied) {
            text += &format!("\n{}\n{}\n", motion.markdown(), motion::LEGEND);
        }
        text
    }

    /// The build, adapter and settings that made the table, in one sentence.
    pub fn made_by(&self) -> String {
        let AdapterSummary {
            name,
            kind,
            driver,
            backend,
        } = self.adapter;
        let [width, height] = self.size;
        format!(
            "grotto {} on {name} ({kind}, {backend}, {driver}), {width} × {height} pixels{}; references of {} \
             paths a pixel.",
            self.version,
            if self.displayed { ", anti-aliased" } else { "" },
            self.spp
        )
    }

    /// Warnings that a reader must know before the figures.
    pub fn warnings(&self) -> Vec<&'static str> {
        let mut warnings = Vec::new();
        if !self.complete {
            warnings.push("Not complete: the work was stopped, or is in progress.");
        }
        if self.adapter.is_software() {
            warnings.push(
                "A software adapter made these pictures: they equal those of a GPU, except for rounding.",
            );
        }
        warnings
    }
}

/// The files of a table, in one folder.
pub struct Files {
    folder: PathBuf,
}

const JSON: &str = "judge.json";
const CSV: &str = "judge.csv";
const HTML: &str = "judge.html";
const MARKDOWN: &str = "judge.md";

impl Files {
    /// Creates the folder if need be. Files in it are unchanged until there is a row.
    ///
    /// # Errors
    /// When one of the files cannot be written, with its path.
    pub fn new(folder: &Path) -> Result<Self, Failure> {
        for name in [JSON, CSV, HTML, MARKDOWN] {
            // A file that is dropped leaves no trace.
            OutFile::new(folder, name)?;
        }
        Ok(Self {
            folder: folder.to_owned(),
        })
    }

    /// Replaces the previous table; each file is replaced as a whole.
    ///
    /// # Errors
    /// When a file cannot be written, as on a full disk.
    pub fn write(&self, report: &Report<'_>, page: &Page) -> Result<(), Failure> {
        let file = |name| OutFile::new(&self.folder, name);
        file(JSON)?.write_json(report)?;
        file(CSV)?.write(&csv(report.rows, report.varied))?;
        file(MARKDOWN)?.write(&report.markdown())?;
        file(HTML)?.write(&page.with(report))
    }
}
