//! Exports a sensorgraph as source code in C, Python or Rust that uses arithmetic only.

use crate::graph::model::{Frame, Polynomial, Sensorgraph};
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

    /// The name of the language in options.
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

/// A number as a floating-point literal that is valid in every language.
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

/// A source file with the function `sensorgraph_range_m(x_m, y_m, heading_rad, segment)` and everything that it calls.
///
/// # Errors
/// A model that looks up its log and therefore has no polynomials.
pub fn functions(model: &Sensorgraph, language: Language) -> Result<String> {
    if model.frame.is_lookup() {
        return Err(
            Error::invalid("a model that looks up its log has no polynomials to export")
                .field("frame")
                .hint("fit polynomials, in the frame `world` or `robot`"),
        );
    }
    let (n, segments) = (model.headings, model.segments_deg.len());
    let about = format!(
        "{} polynomials; {segments} segments of {} degrees, segment 0 at {} degrees from straight ahead, counter-clockwise",
        model.polynomials.len(),
        model.width_deg,
        model.segments_deg[0]
    );
    let middles = model.segments_deg.iter();
    let middles: Vec<String> = middles.map(|d| literal(d.to_radians())).collect();
    let middles = middles.join(", ");
    let scaled = |name: &str, centre_m: f64| {
        let (centre_m, scale_m) = (literal(centre_m), literal(model.scale_m));
        format!("({name} - ({centre_m})) / {scale_m}")
    };
    let (u, v) = (
        scaled("x_m", model.centre_m.0),
        scaled("y_m", model.centre_m.1),
    );
    let each = |line: &dyn Fn(usize, &str, &str, &str) -> String| -> String {
        let all = model.polynomials.iter().enumerate();
        all.map(|(k, p)| {
            let (low, high) = (literal(p.limits_m.0), literal(p.limits_m.1));
            line(k, &sum(p), &low, &high)
        })
        .collect()
    };
    let is_robot = model.frame == Frame::Robot;
    Ok(match language {
        Language::C => {
            let cases = each(&|k, sum, low, high| {
                format!("    case {k}: r = {sum}; low = {low}; high = {high}; break;\n")
            });
            let range = if is_robot {
                format!(
                    "    double share = heading_rad / turn - floor(heading_rad / turn);\n    int k = (int)(share * {n}) % {n};\n    (void)middle;\n    return sensorgraph_polynomial(k * {segments} + segment, u, v);"
                )
            } else {
                format!(
                    "    double direction = (heading_rad + middle[segment]) / turn;\n    double steps = (direction - floor(direction)) * {n};\n    int k = (int)steps;\n    double low = sensorgraph_polynomial(k % {n}, u, v), high = sensorgraph_polynomial((k + 1) % {n}, u, v);\n    return low + (steps - k) * (high - low);"
                )
            };
            format!(
                "/* {about} */\n#include <math.h>\n\n\
                static double sensorgraph_polynomial(int k, double u, double v) {{\n    double r = 0.0, low = 0.0, high = 0.0;\n    switch (k) {{\n{cases}    }}\n    return r < low ? low : r > high ? high : r;\n}}\n\n\
                double sensorgraph_range_m(double x_m, double y_m, double heading_rad, int segment) {{\n    const double turn = 6.283185307179586, middle[] = {{{middles}}};\n    double u = {u}, v = {v};\n{range}\n}}\n"
            )
        }
        Language::Python => {
            let lines = each(&|_, sum, low, high| {
                format!("    lambda u, v: min(max({sum}, {low}), {high}),\n")
            });
            let range = if is_robot {
                format!(
                    "    k = int(heading_rad % (2 * math.pi) / (2 * math.pi) * {n}) % {n}\n    return _POLYNOMIALS[k * {segments} + segment](u, v)"
                )
            } else {
                format!(
                    "    steps = (heading_rad + _MIDDLE[segment]) % (2 * math.pi) / (2 * math.pi) * {n}\n    k = int(steps)\n    low, high = _POLYNOMIALS[k % {n}](u, v), _POLYNOMIALS[(k + 1) % {n}](u, v)\n    return low + (steps - k) * (high - low)"
                )
            };
            format!(
                "# {about}\nimport math\n\n_POLYNOMIALS = [\n{lines}]\n_MIDDLE = [{middles}]\n\n\n\
                def sensorgraph_range_m(x_m, y_m, heading_rad, segment):\n    u, v = {u}, {v}\n{range}\n"
            )
        }
        Language::Rust => {
            let arms =
                each(&|k, sum, low, high| format!("        {k} => ({sum}, {low}, {high}),\n"));
            let range = if is_robot {
                format!(
                    "    let k = (heading_rad.rem_euclid(turn) / turn * {n}.0) as usize % {n};\n    sensorgraph_polynomial(k * {segments} + segment, u, v)"
                )
            } else {
                format!(
                    "    let middle: [f64; {segments}] = [{middles}];\n    let steps = (heading_rad + middle[segment]).rem_euclid(turn) / turn * {n}.0;\n    let k = steps as usize;\n    let [low, high] = [k % {n}, (k + 1) % {n}].map(|k| sensorgraph_polynomial(k, u, v));\n    low + (steps - k as f64) * (high - low)"
                )
            };
            format!(
                "// {about}\n\nfn sensorgraph_polynomial(k: usize, u: f64, v: f64) -> f64 {{\n    let (r, low, high): (f64, f64, f64) = match k {{\n{arms}        _ => (0.0 * u * v, 0.0, 0.0),\n    }};\n    r.clamp(low, high)\n}}\n\n\
                pub fn sensorgraph_range_m(x_m: f64, y_m: f64, heading_rad: f64, segment: usize) -> f64 {{\n    let turn = std::f64::consts::TAU;\n    let (u, v) = ({u}, {v});\n{range}\n}}\n"
            )
        }
    })
}
