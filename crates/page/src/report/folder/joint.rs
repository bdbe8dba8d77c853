//! Joints over time: recorded, simulated at the best point, and below them what is left between the two.

use crate::plot::{Inline, InlineChart, JointPanel, legend};
use crate::report::document::page::html;
use crate::report::document::section::figures;
use crate::results::study::joint::{JointSample, panels};

/// A figure a joint of the first recording; nothing where no joints were recorded.
pub(super) fn joints(samples: &[JointSample]) -> String {
    let Some((recording, joints)) = panels(samples) else {
        return String::new();
    };
    let all: Vec<String> = joints.iter().map(joint).collect();
    let keys = joints.first().map_or_else(String::new, |joint| {
        joint.charts().iter().map(legend).collect()
    });
    format!(
        "<p class=\"note\">Recording {}. A residual that repeats shows what the model lacks: a step is an offset, a lag is a delay, a bulge under load is a compliance.</p>{keys}{}",
        html(&recording),
        figures(&all)
    )
}

fn joint(joint: &JointPanel) -> String {
    let name = &joint.name;
    let alt = [
        format!("Angle of {name} over time, recorded and simulated"),
        format!("Simulated minus recorded angle of {name} over time"),
    ];
    let charts = joint.charts();
    let charts = charts.iter().zip(&alt);
    let charts: String = charts
        .map(|(chart, alt)| chart.inline(&Inline::new(alt)))
        .collect();
    format!("<figure><h3>{}</h3>{charts}</figure>", html(name))
}
