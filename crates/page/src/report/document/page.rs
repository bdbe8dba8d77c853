//! A page: one HTML file that needs no network and runs only its own scripts.

use std::fmt::Write as _;

use serde::Serialize;
use sha2::{Digest as _, Sha256};

pub(in crate::report) use crate::markup::html;
use crate::report::document::base64;
use realgap_core::text::escaped_json;

// Style sheet and scripts that pages share.
pub(in crate::report) const STYLE: &str = include_str!("asset/style.css");
pub(in crate::report) const BLOCK: &str = include_str!("asset/block.js");
pub(in crate::report) const CLOCK: &str = include_str!("asset/clock.js");
pub(in crate::report) const CHART: &str = include_str!("asset/chart.js");
pub(in crate::report) const THREE: &str = include_str!("asset/three.min.js");
pub(in crate::report) const SCENE: &str = include_str!("asset/scene.js");
pub(in crate::report) const REPLAY: &str = include_str!("asset/replay.js");
/// The slider of the time, and the buttons beside it.
pub(in crate::report) const BAR: &str = include_str!("asset/bar.html");

/// JSON that can stand inside of a `script` element: no `<`, `>` or `&` ends it early.
pub(in crate::report) fn script_json(value: &impl Serialize) -> String {
    // Names and numbers can always be written.
    let json = escaped_json(serde_json::to_string(value).unwrap_or_default());
    // Such characters stand inside of strings only.
    json.replace('<', "\\u003c")
        .replace('>', "\\u003e")
        .replace('&', "\\u0026")
}

/// How a content policy names a script or a style sheet.
fn source_hash(text: &str) -> String {
    format!("'sha256-{}'", base64::encode(&Sha256::digest(text)))
}

/// A template with each `{{name}}` replaced by its value, in one pass: what looks like a name inside of a value stays as it is.
pub(in crate::report) fn fill<V: AsRef<str>>(template: &str, values: &[(&str, V)]) -> String {
    let mut text = String::with_capacity(2 * template.len());
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        text.push_str(before);
        let (name, after) = after.split_once("}}").unwrap_or((after, ""));
        let value = values.iter().find(|(known, _)| *known == name);
        text.push_str(value.map_or("", |(_, value)| value.as_ref()));
        rest = after;
    }
    text.push_str(rest);
    text
}

/// The parts of a page.
#[derive(Debug)]
pub(in crate::report) struct Page<'a> {
    /// The title, which the tab of the browser shows.
    pub title: &'a str,
    /// Style sheets, one after the other.
    pub styles: &'a [&'a str],
    /// The visible HTML; texts of others in it were escaped by [`html`].
    pub body: &'a str,
    /// Data for the scripts: id and content, JSON of [`script_json`] or base64.
    pub data: &'a [(&'a str, String)],
    /// Scripts, in order.
    pub scripts: &'a [&'a str],
    /// Seconds after which a browser loads the file again; `None` for a page that stays as it is.
    pub renewed_every_s: Option<u32>,
}

impl Page<'_> {
    /// The file.
    pub fn text(&self) -> String {
        let hashes = |texts: &[&str]| {
            let all: Vec<String> = texts.iter().map(|text| source_hash(text)).collect();
            if all.is_empty() {
                "'none'".to_owned()
            } else {
                all.join(" ")
            }
        };
        let policy = format!(
            "default-src 'none'; script-src {}; style-src {}; img-src data:; base-uri 'none'; form-action 'none'",
            hashes(self.scripts),
            hashes(self.styles),
        );
        let mut page = String::with_capacity(1 << 20);
        let _infallible = write!(
            page,
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"generator\" content=\"realgap {}\">\n<title>{}</title>\n",
            env!("CARGO_PKG_VERSION"),
            html(self.title),
        );
        if let Some(seconds) = self.renewed_every_s {
            let renewed = "<meta http-equiv=\"refresh\" content=";
            let _infallible = writeln!(page, "{renewed}\"{seconds}\">");
        }
        for style in self.styles {
            let _infallible = writeln!(page, "<style>{style}</style>");
        }
        let _infallible = writeln!(page, "</head>\n<body>\n{}", self.body);
        for (id, content) in self.data {
            let _infallible = writeln!(
                page,
                "<script type=\"application/octet-stream\" id=\"{id}\">{content}</script>"
            );
        }
        for script in self.scripts {
            let _infallible = writeln!(page, "<script>{script}</script>");
        }
        page.push_str("</body>\n</html>\n");
        page
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn nothing_of_others_is_markup_or_turns_the_text() {
        let hostile = "</script><script>alert(1)</script>]]>\"'&\u{202e}x";
        let shown = html(hostile);
        assert!(
            !shown.contains(['<', '>', '"', '\'', '\u{202e}']),
            "{shown}"
        );
        let json = script_json(&BTreeMap::from([("name", hostile)]));
        assert!(!json.contains(['<', '>', '&', '\u{202e}']), "{json}");
        let back: BTreeMap<String, String> = serde_json::from_str(&json).unwrap();
        assert_eq!(back["name"], hostile);
    }

    #[test]
    fn values_are_filled_in_once() {
        let values = [("a", "{{b}}"), ("b", "2")];
        assert_eq!(fill("x {{a}} {{b}} y", &values), "x {{b}} 2 y");
    }

    #[test]
    fn only_the_pages_own_scripts_may_run() {
        let page = Page {
            title: "<b>",
            styles: &["p{}"],
            body: "<p>x</p>",
            data: &[],
            scripts: &["1"],
            renewed_every_s: None,
        };
        let text = page.text();
        // printf 1 | openssl dgst -sha256 -binary | base64
        assert!(text.contains("script-src 'sha256-a4ayc/80/OGda4BO/1o/V0etpOqiLx1JwB5S3beHW0s='"));
        assert!(text.contains("<title>&lt;b&gt;</title>"));
    }
}
