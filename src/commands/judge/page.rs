//! The table as one HTML page that needs nothing else: pictures are part of it.

use std::fmt::{Display, Write as _};

use super::{
    Report,
    row::{Pictures, Row, Target},
    table::{HEADS, cells},
};
use crate::{
    measure::{base64, magma::heat_map, picture::Picture, picture_file},
    world::{Camera, World},
};

/// Grows world by world.
#[derive(Default)]
pub struct Page {
    pictures: String,
}

const STYLE: &str = "\
:root{color-scheme:light dark;--line:#8884;--faint:#8882}\
body{font:15px/1.5 system-ui,sans-serif;max-width:1560px;margin:2rem auto;padding:0 1.5rem}\
h1,h2,h3{line-height:1.2}h2{margin-top:3rem;border-top:1px solid var(--line);padding-top:1.5rem}\
.scroll{overflow-x:auto}table{border-collapse:collapse;font-variant-numeric:tabular-nums}\
th,td{padding:.3rem .8rem;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap}\
th{white-space:normal;vertical-align:bottom;max-width:9em}h4{margin:1.5rem 0 .5rem}\
th:nth-child(-n+3),td:nth-child(-n+3){text-align:left}tbody tr:hover{background:var(--faint)}\
.row{display:grid;grid-template-columns:repeat(auto-fit,minmax(300px,1fr));gap:1rem;margin:.5rem 0 1.5rem}\
figure{margin:0}img{width:100%;height:auto;display:block;border-radius:4px;background:#000;image-rendering:auto}\
figcaption{font-size:.85rem;opacity:.75;padding:.25rem 0}p{max-width:75ch}.warn{color:#c60;font-weight:600}\
summary{cursor:pointer;opacity:.75;font-size:.85rem}pre{white-space:pre-wrap}";

impl Page {
    pub fn world(&mut self, world: &World) {
        self.add(format_args!(
            "<h2>{}</h2>\n<p>{}</p>\n",
            escaped(&world.name),
            escaped(&world.title)
        ));
    }

    pub fn camera(&mut self, camera: &Camera, target: &Target) {
        let name = escaped(&camera.name);
        self.add(format_args!("<h3>Camera {name}</h3>\n"));
        let shown = [
            ("Reference: all light", &target.full.display),
            ("Reference: bounced light alone", &target.indirect.display),
        ];
        self.figures(&shown);
    }

    pub fn row(&mut self, row: &Row, pictures: &Pictures) {
        let size = row.full.size;
        let [full_map, indirect_map] =
            [&pictures.full_map, &pictures.indirect_map].map(|map| heat_map(size, map));
        self.add(format_args!(
            "<h4>{}, {} rays</h4>\n",
            escaped(&row.layout),
            row.rays
        ));
        let captions = [&row.full, &row.indirect].map(|figures| {
            format!(
                "FLIP: mean {:.4}, p99 {:.4}; absolute {:.4}; energy {:.3}",
                figures.flip.mean, figures.flip.p99, figures.abs_sum.mean, figures.energy_ratio
            )
        });
        self.figures(&[
            ("DDGI: all light", &pictures.full.display),
            (&captions[0], &full_map),
        ]);
        self.add(format_args!(
            "<details><summary>Bounced light alone</summary>\n"
        ));
        self.figures(&[
            ("DDGI: bounced light alone", &pictures.indirect.display),
            (&captions[1], &indirect_map),
        ]);
        self.add(format_args!("</details>\n"));
    }

    fn figures(&mut self, all: &[(&str, &Picture)]) {
        self.add(format_args!("<div class=\"row\">\n"));
        for (caption, picture) in all {
            let caption = escaped(caption);
            let png = base64::encode(&picture_file::png_bytes(picture));
            self.add(format_args!(
                "<figure><img alt=\"{caption}\" width=\"{}\" height=\"{}\" loading=\"lazy\" \
                 src=\"data:image/png;base64,{png}\"><figcaption>{caption}</figcaption></figure>\n",
                picture.width, picture.height
            ));
        }
        self.add(format_args!("</div>\n"));
    }

    fn add(&mut self, text: impl Display) {
        // Writing to a String cannot fail.
        let _ = write!(self.pictures, "{text}");
    }

    /// The whole page.
    pub fn finish(self, report: &Report<'_>) -> String {
        let adapter = report.adapter;
        let [width, height] = report.size;
        let software = if adapter.is_software() {
            "<p class=\"warn\">A software adapter made these pictures: they are those of a GPU, but for \
             rounding.</p>\n"
        } else {
            ""
        };
        let head: String = HEADS
            .iter()
            .map(|head| format!("<th>{head}</th>"))
            .collect();
        let body: String = report.rows.iter().map(table_row).collect();
        let failures: String = report
            .failures
            .iter()
            .map(|missing| format!("<pre class=\"warn\">{}</pre>\n", escaped(&missing.message)))
            .collect();
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width\">\n\
             <title>grotto judge</title>\n<style>{STYLE}</style>\n\
             <h1>DDGI against path-traced references</h1>\n\
             <p>grotto {} on {} ({}, {}, {}), {width} × {height} pixels; references of {} paths a pixel.</p>\n\
             {software}{failures}<div class=\"scroll\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n\
             {body}</tbody></table></div>\n{LEGEND}{}</html>\n",
            escaped(report.version),
            escaped(&adapter.name),
            escaped(adapter.kind),
            escaped(&adapter.backend),
            escaped(&adapter.driver),
            report.spp,
            self.pictures
        )
    }
}

const LEGEND: &str = "<p><b>FLIP</b> (mean; 0 is no visible difference) and <b>absolute</b> (mean sum over RGB \
of the absolute difference, 0 to 3) compare the tone-mapped pictures. <b>Energy</b> is the light of DDGI over that of \
the reference. <b>Leak</b> is the light that DDGI adds where the reference has none, over the light of the world's \
brightest camera. <b>Stability</b> is the mean change of a pixel between consecutive frames of the still scene, sum \
over RGB. The last two columns count frames until 90&nbsp;% of a change of the indirect light are there. Heat maps show \
FLIP in magma: black is 0, pale yellow is 1.</p>\n";

fn table_row(row: &Row) -> String {
    let cells: String = cells(row)
        .iter()
        .map(|cell| format!("<td>{}</td>", escaped(cell)))
        .collect();
    format!("<tr>{cells}</tr>\n")
}

fn escaped(text: &str) -> String {
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
}
