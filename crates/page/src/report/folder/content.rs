//! What a page of results says, in the order of its parts, before it becomes HTML.

use super::page_data::PageData;
use crate::report::document::page::{
    BAR, BLOCK, CHART, CLOCK, Page, REPLAY, SCENE, STYLE, THREE, fill, html, script_json,
};
use crate::report::document::section::{Section, body, contents};
use realgap_lab::claim::{self, Claim, Conclusion};

const REPORT: &str = include_str!("../document/asset/report.js");

/// The content of a page.
#[derive(Debug, Default)]
pub(in crate::report) struct PageContent {
    /// What the results are of: sweep, gap, …
    pub kind: &'static str,
    /// Name of the study, the robot or the recordings.
    pub name: String,
    /// The claims of the results: those of the verdict stand first on the page.
    pub claims: Vec<Claim>,
    /// What the verdict rests on, in a few sentences.
    pub answer: String,
    /// What the study is for.
    pub description: String,
    /// Parts, in order; warnings, numbers and provenance come last.
    pub sections: Vec<Section>,
    /// Fields of the report that the sections show, a blank between two: the section of numbers leaves them out.
    pub shown_fields: &'static str,
    /// Data for the scripts.
    pub data: Vec<(&'static str, String)>,
}

impl PageContent {
    /// The page as HTML.
    pub fn html(self, page_data: Option<&PageData>) -> String {
        let replay = page_data.and_then(|data| data.replay.as_ref());
        let mut data = self.data;
        let mut scripts = vec![BLOCK, CLOCK, CHART];
        if let Some(replay) = replay {
            data.push(("scene-data", script_json(&replay.scene)));
            data.push(("motion-data", replay.motion.clone()));
            scripts.extend([THREE, SCENE, REPLAY]);
        }
        scripts.push(REPORT);
        let values = [
            ("kind", self.kind.to_owned()),
            ("name", html(&self.name)),
            ("verdict", verdict(&self.claims)),
            ("answer", html(&self.answer)),
            ("description", html(&self.description)),
            ("contents", contents(&self.sections)),
            ("sections", body(&self.sections)),
            ("bar", BAR.to_owned()),
        ];
        Page {
            title: &format!("{}: {}", self.name, self.kind),
            styles: &[STYLE],
            body: &fill(include_str!("../document/asset/report.html"), &values),
            data: &data,
            scripts: &scripts,
            renewed_every_s: None,
        }
        .text()
    }
}

/// The verdict as a list of terms; empty where there is none.
pub(super) fn verdict(claims: &[Claim]) -> String {
    let parts = claim::verdict(claims);
    if parts.is_empty() {
        return String::new();
    }
    let part = |(label, claim): &(&str, &Claim)| {
        let class = match claim.conclusion {
            Conclusion::Supported => "holds",
            Conclusion::Rejected => "fails",
            Conclusion::Inconclusive => "open",
        };
        format!(
            "<dt>{label}</dt><dd class=\"{class}\">{}</dd>",
            html(&claim.text)
        )
    };
    let parts: String = parts.iter().map(part).collect();
    format!("<dl class=\"verdict\">{parts}</dl>")
}
