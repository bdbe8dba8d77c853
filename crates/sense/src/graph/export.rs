//! A sensorgraph as functions in other languages: nothing but arithmetic, so that it runs anywhere.

use std::fmt::Write as _;

use super::model::{Frame, Polynomial, Sensorgraph};
use realgap_core::error::{Error, Result};
use realgap_core::file::look_up;

/// A language that functions can be written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// C99.
    C,
    /// Python 3.
    Python,
    /// Rust.
    Rust,
}

impl Language {
    /// Every language.
    pub const ALL: [Self; 3] = [Self::C, Self::Python, Self::Rust];

    /// Its name in options.
    pub fn name(self) -> &'static str {
        match self {
            Self::C => "c",
            Self::Python => "python",
            Self::Rust => "rust",
        }
    }

    /// The language of this name.
    ///
    /// # Errors
    /// No such language; the error lists them.
    pub fn by_name(name: &str) -> Result<Self> {
        look_up("language", name, Self::ALL, |language| language.name())
    }
}

/// A number that every language reads as a floating-point one.
fn literal(value: f64) -> String {
    format!("{value:?}")
}

/// A polynomial as a sum of products.
fn sum(polynomial: &Polynomial) -> String {
    let terms: Vec<String> = polynomial
        .terms
        .iter()
        .map(|term| {
            let mut product = format!("({})", literal(term.value));
            for (name, power) in ["u", "v"].iter().zip(term.powers) {
                for _ in 0..power {
                    product += "*";
                    product += name;
                }
            }
            product
        })
        .collect();
    terms.join(" + ")
}

/// A file with one function, `sensorgraph_range_m(x_m, y_m, heading_rad, segment)`, and what it needs.
///
/// # Errors
/// A model that looks its log up, and has no polynomials.
pub fn functions(model: &Sensorgraph, language: Language) -> Result<String> {
    if model.frame.is_lookup() {
        return Err(
            Error::invalid("a lookup has no polynomials that could be a function")
                .field("frame")
                .hint("fit polynomials, in the frame `world` or `robot`"),
        );
    }
    Ok(match language {
        Language::C => c(model),
        Language::Python => python(model),
        Language::Rust => rust(model),
    })
}

/// The numbers that pick polynomials: headings, segments, middles of the segments in radians.
fn middles(model: &Sensorgraph) -> String {
    let middles: Vec<String> = model
        .segments_deg
        .iter()
        .map(|d| literal(d.to_radians()))
        .collect();
    middles.join(", ")
}

fn about(model: &Sensorgraph) -> String {
    format!(
        "{} polynomials; {} segments of {} degrees, segment 0 at {} degrees from straight ahead, counter-clockwise",
        model.polynomials.len(),
        model.segments_deg.len(),
        model.width_deg,
        model.segments_deg[0]
    )
}

fn c(model: &Sensorgraph) -> String {
    let (n, segments) = (model.headings, model.segments_deg.len());
    let mut text = format!("/* {} */\n#include <math.h>\n\n", about(model));
    let _ = writeln!(
        text,
        "static double sensorgraph_polynomial(int k, double u, double v) {{\n    double r = 0.0, low = 0.0, high = 0.0;\n    switch (k) {{"
    );
    for (k, p) in model.polynomials.iter().enumerate() {
        let _ = writeln!(
            text,
            "    case {k}: r = {}; low = {}; high = {}; break;",
            sum(p),
            literal(p.limits_m.0),
            literal(p.limits_m.1)
        );
    }
    let _ = writeln!(
        text,
        "    }}\n    return r < low ? low : r > high ? high : r;\n}}\n"
    );
    let _ = writeln!(
        text,
        "double sensorgraph_range_m(double x_m, double y_m, double heading_rad, int segment) {{"
    );
    let _ = writeln!(
        text,
        "    const double turn = 6.283185307179586, middle[] = {{{}}};",
        middles(model)
    );
    let _ = writeln!(
        text,
        "    double u = (x_m - ({})) / {}, v = (y_m - ({})) / {};",
        literal(model.centre_m.0),
        literal(model.scale_m),
        literal(model.centre_m.1),
        literal(model.scale_m)
    );
    match model.frame {
        Frame::Robot => {
            let _ = writeln!(
                text,
                "    double share = heading_rad / turn - floor(heading_rad / turn);\n    int k = (int)(share * {n}) % {n};\n    (void)middle;\n    return sensorgraph_polynomial(k * {segments} + segment, u, v);"
            );
        }
        _ => {
            let _ = writeln!(
                text,
                "    double direction = (heading_rad + middle[segment]) / turn;\n    double steps = (direction - floor(direction)) * {n};\n    int k = (int)steps;\n    double low = sensorgraph_polynomial(k % {n}, u, v), high = sensorgraph_polynomial((k + 1) % {n}, u, v);\n    return low + (steps - k) * (high - low);"
            );
        }
    }
    text + "}\n"
}

fn python(model: &Sensorgraph) -> String {
    let (n, segments) = (model.headings, model.segments_deg.len());
    let mut text = format!("# {}\nimport math\n\n_POLYNOMIALS = [\n", about(model));
    for p in &model.polynomials {
        let _ = writeln!(
            text,
            "    lambda u, v: min(max({}, {}), {}),",
            sum(p),
            literal(p.limits_m.0),
            literal(p.limits_m.1)
        );
    }
    let _ = writeln!(text, "]\n_MIDDLE = [{}]\n\n", middles(model));
    let _ = writeln!(
        text,
        "def sensorgraph_range_m(x_m, y_m, heading_rad, segment):\n    u, v = (x_m - ({})) / {}, (y_m - ({})) / {}",
        literal(model.centre_m.0),
        literal(model.scale_m),
        literal(model.centre_m.1),
        literal(model.scale_m)
    );
    match model.frame {
        Frame::Robot => {
            let _ = writeln!(
                text,
                "    k = int(heading_rad % (2 * math.pi) / (2 * math.pi) * {n}) % {n}\n    return _POLYNOMIALS[k * {segments} + segment](u, v)"
            );
        }
        _ => {
            let _ = writeln!(
                text,
                "    steps = (heading_rad + _MIDDLE[segment]) % (2 * math.pi) / (2 * math.pi) * {n}\n    k = int(steps)\n    low, high = _POLYNOMIALS[k % {n}](u, v), _POLYNOMIALS[(k + 1) % {n}](u, v)\n    return low + (steps - k) * (high - low)"
            );
        }
    }
    text
}

fn rust(model: &Sensorgraph) -> String {
    let (n, segments) = (model.headings, model.segments_deg.len());
    let mut text = format!(
        "// {}\n\nfn sensorgraph_polynomial(k: usize, u: f64, v: f64) -> f64 {{\n    let (r, low, high): (f64, f64, f64) = match k {{\n",
        about(model)
    );
    for (k, p) in model.polynomials.iter().enumerate() {
        let _ = writeln!(
            text,
            "        {k} => ({}, {}, {}),",
            sum(p),
            literal(p.limits_m.0),
            literal(p.limits_m.1)
        );
    }
    let _ = writeln!(
        text,
        "        _ => (0.0 * u * v, 0.0, 0.0),\n    }};\n    r.clamp(low, high)\n}}\n"
    );
    let _ = writeln!(
        text,
        "pub fn sensorgraph_range_m(x_m: f64, y_m: f64, heading_rad: f64, segment: usize) -> f64 {{\n    let turn = std::f64::consts::TAU;\n    let (u, v) = ((x_m - ({})) / {}, (y_m - ({})) / {});",
        literal(model.centre_m.0),
        literal(model.scale_m),
        literal(model.centre_m.1),
        literal(model.scale_m)
    );
    match model.frame {
        Frame::Robot => {
            let _ = writeln!(
                text,
                "    let k = (heading_rad.rem_euclid(turn) / turn * {n}.0) as usize % {n};\n    sensorgraph_polynomial(k * {segments} + segment, u, v)"
            );
        }
        _ => {
            let _ = writeln!(
                text,
                "    let middle: [f64; {segments}] = [{}];\n    let steps = (heading_rad + middle[segment]).rem_euclid(turn) / turn * {n}.0;\n    let k = steps as usize;\n    let [low, high] = [k % {n}, (k + 1) % {n}].map(|k| sensorgraph_polynomial(k, u, v));\n    low + (steps - k as f64) * (high - low)",
                middles(model)
            );
        }
    }
    text + "}\n"
}
