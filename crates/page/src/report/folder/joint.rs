//! Joints over time: recorded, simulated at the best point, and below them what is left between the two.

use std::path::Path;

use crate::plot::JointPanel;
use crate::report::document::page::html;
use crate::report::document::section::figures;
use crate::report::folder::chart::{Chart, key, over};
use crate::report::folder::sheet::Sheet;
use crate::results::kind::file;
use crate::results::study::joint::{Row, panels};
use realgap_core::error::Result;

/// A figure a joint of the first recording; nothing where the folder holds no joints.
pub(in crate::report) fn joints(folder: &Path) -> Result<String> {
    let sheet = Sheet::read(folder, file::JOINTS)?;
    let (recordings, names) = (sheet.texts("recording"), sheet.texts("joint"));
    let numbers = ["t_s", "recorded_rad", "simulated_rad"].map(|name| sheet.numbers(name));
    let row = |k: usize| {
        let [time_s, recorded_rad, simulated_rad] =
            numbers.each_ref().map(|column| column.get(k).copied());
        Some(Row {
            recording: (*recordings.get(k)?).to_owned(),
            joint: (*names.get(k)?).to_owned(),
            time_s: time_s?,
            recorded_rad: recorded_rad?,
            simulated_rad: simulated_rad?,
        })
    };
    let rows: Vec<Row> = (0..recordings.len()).filter_map(row).collect();
    let Some((recording, joints)) = panels(&rows) else {
        return Ok(String::new());
    };
    let all: Vec<String> = joints.iter().map(joint).collect();
    let keys =
        key("real", "recorded") + &key("sim", "simulated, best point") + &key("b1", "residual");
    let keys = keys + &key("band", "90 % of the residuals of all recordings");
    Ok(format!(
        "<p class=\"note\">Recording {}. What a residual does again and again is what the model lacks: a step is an offset, a lag a delay, a bulge under load a compliance.</p><div class=\"legend\">{keys}</div>{}",
        html(&recording),
        figures(&all)
    ))
}

fn joint(joint: &JointPanel) -> String {
    const MRAD: f64 = 1e3;
    let name = &joint.name;
    let over = |values: &[f64]| over(&joint.times_s, values);
    let alt = format!("Angle of {name} over time, recorded and simulated");
    let angles = Chart::over_time(alt, "angle [rad]")
        .line("real", over(&joint.recorded_rad))
        .line("sim", over(&joint.simulated_rad));
    let off: Vec<f64> = joint.residuals_rad().map(|rad| MRAD * rad).collect();
    let [low, high] = joint.spread_rad.map(|rad| MRAD * rad);
    let ends = joint
        .times_s
        .first()
        .into_iter()
        .chain(joint.times_s.last());
    let alt = format!("Simulated minus recorded angle of {name} over time");
    let residuals = Chart::over_time(alt, "residual [mrad]")
        .band(ends.map(|t| [*t, low, high]).collect())
        .line("b1", over(&off));
    let (name, angles, residuals) = (html(name), angles.svg(), residuals.svg());
    format!("<figure><h3>{name}</h3>{angles}{residuals}</figure>")
}
