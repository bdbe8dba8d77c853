//! A results folder's story on its way into a page.

use crate::report::document::page::{
    BAR, BLOCK, CHART, CLOCK, Page, REPLAY, SCENE, STYLE, THREE, fill, html, script_json,
};
use crate::report::document::section::{Section, body, contents};
use crate::report::folder::page_data::Kept;

const REPORT: &str = include_str!("../document/asset/report.js");

/// What a folder says, in order.
#[derive(Debug, Default)]
pub(in crate::report) struct Story {
    /// What it is: sweep, gap, …
    pub kind: &'static str,
    /// Of what.
    pub name: String,
    /// Two sentences.
    pub answer: String,
    /// What it is for.
    pub description: String,
    /// Parts, in order; warnings, numbers and provenance come last.
    pub sections: Vec<Section>,
    /// Fields of the report that the sections tell, a blank between two.
    pub said: &'static str,
    /// Data for the scripts.
    pub data: Vec<(&'static str, String)>,
}

impl Story {
    /// The page.
    pub fn page(self, kept: Option<&Kept>) -> String {
        let replay = kept.and_then(|kept| kept.replay.as_ref());
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
        }
        .text()
    }
}
