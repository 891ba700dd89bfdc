//! The table as one self-contained HTML page: small pictures are part of it.

use std::path::{Path, PathBuf};

use base64::prelude::{BASE64_STANDARD, Engine as _};
use serde::{Deserialize, Serialize};

use super::{
    super::Failure,
    motion,
    report::Report,
    row::{Pictures, Row, Target},
    table::{LEGEND, of_rows, of_settings},
};
use crate::{
    measure::{
        magma::heat_map,
        picture::Picture,
        picture_file, plot,
        thumbnail::{jpeg, reduced, reduced_map},
        whole_file,
    },
    world::{Camera, World},
};

/// A page that grows row by row.
pub struct Page {
    fragments: Vec<Fragment>,
    /// Width of the pictures in the page, in pixels; 0 leaves them out.
    width: u32,
    /// Where every picture is stored in full size, if anywhere.
    folder: Option<PathBuf>,
    /// The name of the most recent world.
    world: String,
    /// The name of the most recent camera.
    camera: String,
}

/// The part of the page for a world, a camera or a row.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fragment {
    /// Position among all worlds, cameras and rows, in their order; those of other parts count too.
    pub place: u32,
    pub html: String,
    /// Names of files in the folder of pictures.
    pub files: Vec<String>,
}

/// The folder beside the page for pictures in full size.
pub const PICTURES: &str = "pictures";

const STYLE: &str = "\
:root{color-scheme:light dark;--line:#8884;--faint:#8882}\
body{font:15px/1.5 system-ui,sans-serif;max-width:1360px;margin:2rem auto;padding:0 1.5rem}\
h1,h2,h3{line-height:1.2}h2{margin-top:3rem;border-top:1px solid var(--line);padding-top:1.5rem}\
.scroll{overflow-x:auto;margin:1.5rem 0}table{border-collapse:collapse;font-variant-numeric:tabular-nums}\
th,td{padding:.3rem .8rem;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap}\
th{white-space:normal;vertical-align:bottom;max-width:9em}h4{margin:1.5rem 0 .5rem}\
.name{text-align:left}tbody tr:hover{background:var(--faint)}\
.row{display:grid;grid-template-columns:repeat(4,minmax(0,320px));gap:1rem;margin:.5rem 0 1.5rem}\
.wide{grid-column:span 2}@media(max-width:800px){.row{grid-template-columns:repeat(2,1fr)}}\
figure{margin:0}img{width:100%;max-width:320px;height:auto;display:block;border-radius:4px;background:#000}\
figcaption{font-size:.85rem;opacity:.75;padding:.25rem 0;max-width:320px}p{max-width:75ch}\
.warn{color:#c60;font-weight:600}pre{white-space:pre-wrap}";

/// A picture and its caption.
struct Figure<'a> {
    /// Part of a file's name.
    what: &'a str,
    caption: String,
    picture: Show<'a>,
}

enum Show<'a> {
    /// Display values.
    Picture(&'a Picture),
    /// FLIP of each pixel.
    Map([u32; 2], &'a [f32]),
}

impl Page {
    /// A page with pictures of this width in pixels (0: none). With `full_size`, all pictures are also stored
    /// in full size in a folder beside the page.
    ///
    /// # Errors
    /// When that folder cannot be created.
    pub fn new(out: &Path, width: u32, full_size: bool) -> Result<Self, Failure> {
        let folder = full_size.then(|| out.join(PICTURES));
        if let Some(folder) = &folder {
            whole_file::create_folder(folder)?;
        }
        Ok(Self {
            fragments: Vec::new(),
            width,
            folder,
            world: String::new(),
            camera: String::new(),
        })
    }

    /// A page of fragments, in the order of their places, whose pictures have this width.
    pub fn of_fragments(fragments: Vec<Fragment>, width: u32) -> Self {
        Self {
            fragments,
            width,
            folder: None,
            world: String::new(),
            camera: String::new(),
        }
    }

    pub fn fragments(&self) -> &[Fragment] {
        &self.fragments
    }

    pub fn world(&mut self, place: u32, world: &World) {
        self.world.clone_from(&world.name);
        let html = match self.width {
            0 => String::new(),
            _ => {
                let (name, title) = (escaped(&world.name), escaped(&world.title));
                format!("<h2>{name}</h2>\n<p>{title}</p>\n")
            }
        };
        self.fragments.push(Fragment {
            place,
            html,
            files: Vec::new(),
        });
    }

    /// # Errors
    /// When a picture in full size cannot be written.
    pub fn camera(&mut self, place: u32, camera: &Camera, target: &Target) -> Result<(), Failure> {
        self.camera.clone_from(&camera.name);
        let stem = format!("{} {}", self.world, self.camera);
        let shown = |what, caption: &str, picture| Figure {
            what,
            caption: caption.to_owned(),
            picture: Show::Picture(picture),
        };
        self.figures(
            place,
            &format!("<h3>Camera {}</h3>\n", escaped(&camera.name)),
            &stem,
            &[
                shown("reference", "Reference: all light", &target.full.display),
                shown(
                    "reference bounced",
                    "Reference: bounced light alone",
                    &target.indirect.display,
                ),
            ],
        )
    }

    /// # Errors
    /// See [`camera`](Self::camera).
    pub fn row(&mut self, place: u32, row: &Row, pictures: &Pictures) -> Result<(), Failure> {
        let caption = |of: &crate::measure::comparison::Comparison| {
            format!(
                "FLIP: mean {:.4}, p99 {:.4}; absolute {:.4}; energy {:.3}",
                of.flip.mean, of.flip.p99, of.abs_sum.mean, of.energy_ratio
            )
        };
        let size = row.full.size;
        let (heading, who) = match row.direct_alone {
            true => (escaped(&row.layout), "No probes"),
            false => (
                format!(
                    "{}, {} rays{}",
                    escaped(&row.layout),
                    row.rays,
                    row.settings.note()
                ),
                "DDGI",
            ),
        };
        let stem = format!("{} {} {}", self.world, self.camera, row.layout);
        self.figures(
            place,
            &format!("<h4>{heading}</h4>\n"),
            &stem,
            &[
                Figure {
                    what: "all",
                    caption: format!("{who}: all light"),
                    picture: Show::Picture(&pictures.full.display),
                },
                Figure {
                    what: "all flip",
                    caption: caption(&row.full),
                    picture: Show::Map(size, &pictures.full_map),
                },
                Figure {
                    what: "bounced",
                    caption: format!("{who}: bounced light alone"),
                    picture: Show::Picture(&pictures.indirect.display),
                },
                Figure {
                    what: "bounced flip",
                    caption: caption(&row.indirect),
                    picture: Show::Map(size, &pictures.indirect_map),
                },
            ],
        )?;
        if let Some(fragment) = self.fragments.last_mut() {
            fragment.html += &motion::plot(row);
        }
        Ok(())
    }

    /// Adds pictures to the page under a heading, and in full size to files whose names contain `stem`. The
    /// places distinguish pictures with equal names.
    fn figures(
        &mut self,
        place: u32,
        heading: &str,
        stem: &str,
        all: &[Figure<'_>],
    ) -> Result<(), Failure> {
        let mut texts = String::new();
        let mut files = Vec::new();
        // The two pictures of a reference are above the four of a row.
        let class = if all.len() == 2 {
            " class=\"wide\""
        } else {
            ""
        };
        for figure in all {
            let file = match &self.folder {
                None => None,
                Some(folder) => {
                    let name = format!(
                        "{}.png",
                        file_stem(&format!("{place:03} {stem} {}", figure.what))
                    );
                    picture_file::write_png(&folder.join(&name), &figure.picture.full())?;
                    files.push(name.clone());
                    Some(name)
                }
            };
            if self.width == 0 {
                continue;
            }
            let small = figure.picture.small(self.width);
            let (caption, [width, height]) =
                (escaped(&figure.caption), [small.width, small.height]);
            let data = BASE64_STANDARD.encode(jpeg(&small));
            let image = format!(
                "<img alt=\"{caption}\" width=\"{width}\" height=\"{height}\" loading=\"lazy\" \
                 src=\"data:image/jpeg;base64,{data}\">"
            );
            let image = match file {
                Some(name) => format!("<a href=\"{PICTURES}/{name}\">{image}</a>"),
                None => image,
            };
            texts +=
                &format!("<figure{class}>{image}<figcaption>{caption}</figcaption></figure>\n");
        }
        let html = match self.width {
            0 => String::new(),
            _ => format!("{heading}<div class=\"row\">\n{texts}</div>\n"),
        };
        self.fragments.push(Fragment { place, html, files });
        Ok(())
    }

    /// The whole page with the tables of this report.
    pub fn with(&self, report: &Report<'_>) -> String {
        let warnings = report.warnings().into_iter();
        let warnings: String = warnings
            .map(|warning| format!("<p class=\"warn\">{}</p>\n", escaped(warning)))
            .collect();
        let failures: String = report
            .failures
            .iter()
            .map(|missing| format!("<pre class=\"warn\">{}</pre>\n", escaped(&missing.message)))
            .collect();
        let settings = match &report.by_setting[..] {
            [] => String::new(),
            settings => of_settings(settings, report.varied).html(),
        };
        let maps = match self.width {
            0 => "",
            _ => " Heat maps show FLIP in the colour map magma: black is 0, pale yellow is 1.",
        };
        let motion = motion::of_rows(report.rows, report.varied);
        let (style, motion) = match motion {
            None => (String::new(), String::new()),
            Some(table) => (
                format!("{}{}", plot::STYLE, motion::STYLE),
                format!("{}<p>{}</p>\n", table.html(), motion::LEGEND),
            ),
        };
        let pictures: String = self.fragments.iter().map(|f| &f.html[..]).collect();
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width\">\n\
             <title>grotto judge</title>\n<style>{STYLE}{style}</style>\n\
             <h1>DDGI against path-traced references</h1>\n<p>{}</p>\n\
             {warnings}{failures}{settings}{}<p>{LEGEND}{maps}</p>\n{motion}{}</html>\n",
            escaped(&report.made_by()),
            of_rows(report.rows, report.varied).html(),
            pictures
        )
    }
}

impl Show<'_> {
    fn full(&self) -> Picture {
        match self {
            Self::Picture(picture) => (*picture).clone(),
            Self::Map(size, values) => heat_map(*size, values),
        }
    }

    fn small(&self, width: u32) -> Picture {
        match self {
            Self::Picture(picture) => reduced(picture, width),
            Self::Map(size, values) => {
                let (size, values) = reduced_map(*size, values, width);
                heat_map(size, &values)
            }
        }
    }
}

/// A name that is valid in every file system and page.
fn file_stem(text: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    text.chars().map(letter).collect()
}

pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_become_markup() {
        assert_eq!(escaped("<b a=\"&\">"), "&lt;b a=&quot;&amp;&quot;&gt;");
    }

    #[test]
    fn names_cannot_leave_their_folder() {
        assert_eq!(file_stem("../a b/ü\"c"), "---a-b---c");
    }
}
