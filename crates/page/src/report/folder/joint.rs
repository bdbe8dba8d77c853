//! Joints over time: recorded, simulated at the best point, and below them what is left between the two.

use std::collections::BTreeSet;

use crate::plot::{Inline, InlineChart, JointPanel, legend};
use crate::report::document::page::html;
use crate::report::document::section::figures;
use crate::results::study::joint::{JointSample, panels};
use realgap_core::unit::number;

/// A figure a joint of the first recording; nothing where no joints were recorded.
pub(super) fn joints(samples: &[JointSample]) -> String {
    let Some((recording, joints)) = panels(samples) else {
        return String::new();
    };
    let all: Vec<String> = joints.iter().map(joint).collect();
    let keys = joints.first().map_or_else(String::new, |joint| {
        joint.charts().iter().map(legend).collect()
    });
    let table = residual_table(samples);
    let recordings: BTreeSet<&str> = samples.iter().map(|s| s.recording.as_str()).collect();
    let which = match recordings.len() {
        1 => html(&recording),
        many => format!("{}, the first of {many} in joints.csv", html(&recording)),
    };
    format!(
        "<p class=\"note\">Recording {which}. A residual that repeats shows what the model lacks: a step is an offset, a lag is a delay, a bulge under load is a compliance.</p>{keys}{}{table}",
        figures(&all)
    )
}

/// Residuals of every channel over the samples that are shown of all recordings; nothing where only angles are compared.
fn residual_table(samples: &[JointSample]) -> String {
    if samples.iter().all(|sample| sample.quantity.0 == "angle") {
        return String::new();
    }
    let mut channels: Vec<(&JointSample, Vec<f64>)> = Vec::new();
    for sample in samples {
        let off = sample.simulated - sample.recorded;
        match channels
            .iter_mut()
            .find(|(first, _)| first.joint == sample.joint)
        {
            Some((_, all)) => all.push(off),
            None => channels.push((sample, vec![off])),
        }
    }
    let row = |(first, off): &(&JointSample, Vec<f64>)| {
        let count = off.len() as f64;
        let absolute = off.iter().map(|off| off.abs()).sum::<f64>() / count;
        let rms = (off.iter().map(|off| off * off).sum::<f64>() / count).sqrt();
        let bias = off.iter().sum::<f64>() / count;
        let cells = [absolute, rms, bias].map(|value| format!("<td>{}</td>", number(value)));
        format!(
            "<tr><td>{}</td><td>{}</td>{}</tr>",
            html(&first.joint),
            html(&first.quantity.1),
            cells.concat()
        )
    };
    let rows: String = channels.iter().map(row).collect();
    format!(
        "<table><thead><tr><th>channel</th><th>unit</th><th>mean absolute residual</th><th>root mean square</th><th>mean</th></tr></thead><tbody>{rows}</tbody></table>"
    )
}

fn joint(joint: &JointPanel) -> String {
    let (name, word) = (&joint.name, &joint.quantity.0);
    let mut capital = word.clone();
    if let Some(first) = capital.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    let alt = [
        format!("{capital} of {name} over time, recorded and simulated"),
        format!("Simulated minus recorded {word} of {name} over time"),
    ];
    let charts = joint.charts();
    let charts = charts.iter().zip(&alt);
    let charts: String = charts
        .map(|(chart, alt)| chart.inline(&Inline::new(alt)))
        .collect();
    format!("<figure><h3>{}</h3>{charts}</figure>", html(name))
}
