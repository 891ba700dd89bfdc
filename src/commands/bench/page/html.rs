//! Pieces of the page.

use std::fmt::Write as _;

use crate::measure::plot::{STYLE as PLOT_STYLE, colour, escaped};

const STYLE: &str = "\
:root{color-scheme:light dark;--line:#8884;--faint:#8882;--warn:#b04000}\
@media(prefers-color-scheme:dark){:root{--warn:#ffa050}}\
*{box-sizing:border-box}\
body{font:15px/1.5 system-ui,sans-serif;max-width:1160px;margin:1.5rem auto;padding:0 16px;overflow-wrap:anywhere}\
h1,h2,h3{line-height:1.25;text-wrap:balance}h2{margin-top:2.5rem;border-top:1px solid var(--line);padding-top:1.25rem}\
h3{margin:1.5rem 0 .25rem}p,li{max-width:75ch}\
.scroll{overflow-x:auto;margin:1rem 0}table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:14px}\
th,td{padding:.25rem .6rem;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap;overflow-wrap:normal}\
th{vertical-align:bottom;font-weight:600}th:first-child,td:first-child,.facts th,.facts td{text-align:left}\
.facts td{white-space:normal;overflow-wrap:anywhere}.facts th{vertical-align:top}tbody tr:hover{background:var(--faint)}\
.plots{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(344px,100%),1fr));gap:1.25rem 1rem;margin:1rem 0}\
figure{margin:0;min-width:0}figcaption{font-weight:600;margin-bottom:.4rem}figure p{margin:.35rem 0;font-size:14px}\
.key{display:flex;flex-wrap:wrap;gap:.1rem .9rem;font-size:13px;margin:.35rem 0}\
.key i{display:inline-block;width:.7em;height:.7em;border-radius:2px;margin-right:.35em}\
img{width:100%;max-width:344px;height:auto;display:block;border-radius:4px;background:#000}\
.warn{color:var(--warn);font-weight:600}summary{cursor:pointer;margin:.75rem 0}\
.loud{border:2px solid var(--warn);border-radius:6px;padding:.75rem 1rem;color:var(--warn);font-weight:600}\
code{font-size:13px}";

/// A whole page with this body.
pub fn document(title: &str, body: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>{}</title>\n<style>{STYLE}{PLOT_STYLE}</style>\n{body}</html>\n",
        escaped(title)
    )
}

/// A plot with its title, the key of its colours, and words. `words` and `key` are text, `svg` is markup.
pub fn plot(title: &str, svg: &str, key: &[(usize, String)], words: &[String]) -> String {
    let mut text = format!("<figure><figcaption>{}</figcaption>{svg}", escaped(title));
    if key.len() > 1 {
        text += "<div class=\"key\">";
        for (series, name) in key {
            // Writing to a String cannot fail.
            let _ = write!(
                text,
                "<span><i style=\"background:{}\"></i>{}</span>",
                colour(*series),
                escaped(name)
            );
        }
        text += "</div>";
    }
    for words in words {
        let _ = write!(text, "<p>{}</p>", escaped(words));
    }
    text + "</figure>\n"
}

pub fn plots(all: &str) -> String {
    match all {
        "" => String::new(),
        _ => format!("<div class=\"plots\">\n{all}</div>\n"),
    }
}

/// A table of text.
pub fn table<S: AsRef<str>>(header: &[S], rows: &[Vec<String>]) -> String {
    let cells = |tag: &str, cells: &mut dyn Iterator<Item = &str>| {
        let cells: String = cells
            .map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell)))
            .collect();
        format!("<tr>{cells}</tr>\n")
    };
    let head = cells("th", &mut header.iter().map(AsRef::as_ref));
    let body: String = rows
        .iter()
        .map(|row| cells("td", &mut row.iter().map(String::as_str)))
        .collect();
    format!(
        "<div class=\"scroll\"><table>\n<thead>{head}</thead>\n<tbody>\n{body}</tbody></table></div>\n"
    )
}

/// A table of two columns: names and values.
pub fn facts(all: &[(&str, String)]) -> String {
    let lines = all.iter().map(|(name, value)| {
        format!(
            "<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n",
            escaped(name),
            escaped(value)
        )
    });
    format!(
        "<table class=\"facts\"><tbody>\n{}</tbody></table>\n",
        lines.collect::<String>()
    )
}

pub fn paragraph(text: &str) -> String {
    format!("<p>{}</p>\n", escaped(text))
}

pub fn warning(text: &str) -> String {
    format!("<p class=\"warn\">{}</p>\n", escaped(text))
}
