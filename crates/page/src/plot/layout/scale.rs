//! From values to positions and colours, and the round numbers to write beside them.

/// How scores are spread over colours or heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ScoreScale {
    /// Logarithmic where the scores span more than 1.5 decades, linear otherwise: over at most four
    /// decades of colours, or twelve of an axis, below the largest score; scores below that range, or
    /// 0, are drawn at its lower end. Where some are negative: linear, ending at the 98th percentile.
    #[default]
    Auto,
    /// Linear from the smallest to the largest score.
    Linear,
    /// Linear, a unit as long as one of the horizontal axis: maps. Colours take it as linear.
    LikeX,
}

/// Decades of scores from which on [`ScoreScale::Auto`] is logarithmic.
const LOG_FROM_DECADES: f64 = 1.5;
/// Decades that logarithmic colours show at most: one perfect match must not wash out the rest.
pub(in crate::plot) const COLOUR_DECADES: f64 = 4.0;
/// Decades that a logarithmic axis shows at most; height tells more steps apart than colour.
pub(in crate::plot) const AXIS_DECADES: f64 = 12.0;
const ROBUST_SHARE: f64 = 0.98;

/// A range of values, `low < high`, and how to get from values to shares of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    pub low: f64,
    pub high: f64,
    pub is_log: bool,
    /// Some values lie below or above.
    pub is_clipped: bool,
    /// Values above the end share its colour, so that the others differ more.
    pub is_cut: bool,
}

/// A position on a scale and what to write there.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    pub value: f64,
    pub label: String,
}

impl Tick {
    /// A value among multiples of `step`.
    fn at(value: f64, step: f64) -> Self {
        let label = label(value, step);
        Self { value, label }
    }
}

impl Scale {
    /// A linear scale; widened where it would be empty.
    pub(crate) fn linear(low: f64, high: f64) -> Self {
        let (low, high) = if high - low > 1e-12 * low.abs().max(high.abs()) {
            (low, high)
        } else {
            let pad = if low == 0.0 { 1.0 } else { 0.1 * low.abs() };
            (low - pad, high + pad)
        };
        Self {
            low,
            high,
            is_log: false,
            is_clipped: false,
            is_cut: false,
        }
    }

    /// The scale for `values`, of which there is at least one, all finite.
    pub(in crate::plot) fn for_scores(values: &[f64], wanted: ScoreScale, decades: f64) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (Some(&low), Some(&high)) = (sorted.first(), sorted.last()) else {
            return Self::linear(0.0, 1.0);
        };
        let positive = sorted.iter().copied().find(|&v| v > 0.0);
        let spans_decades = positive.is_some_and(|p| (high / p).log10() > LOG_FROM_DECADES);
        let as_log = |from: f64| {
            let from = from.max(high * 10f64.powf(-decades));
            Self {
                low: from,
                high,
                is_log: true,
                is_clipped: low < from,
                is_cut: false,
            }
        };
        match (wanted, positive) {
            (ScoreScale::Auto, Some(p)) if spans_decades && low >= 0.0 => as_log(p),
            (ScoreScale::Auto, _) if spans_decades => {
                let last = ((sorted.len() - 1) as f64 * ROBUST_SHARE).floor() as usize;
                let mut scale = Self::linear(low, sorted[last]);
                scale.is_clipped = sorted[last] < high;
                scale
            }
            // All scores 0: negative ones on the colour bar would only puzzle.
            _ if low == 0.0 && high == 0.0 => Self::linear(0.0, 1.0),
            _ => Self::linear(low, high),
        }
    }

    /// The share of the scale below `value`; 0 at `low`, 1 at `high`, beyond them outside.
    pub(in crate::plot) fn share(&self, value: f64) -> f64 {
        if self.is_log {
            if value <= 0.0 {
                return 0.0;
            }
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// What to add to the label of the scale, so that readers notice a colour bar that is not linear.
    pub(in crate::plot) fn remark(&self) -> String {
        let end = match self.is_cut {
            true => ", last colour: so much or more",
            false => "",
        };
        format!("{}{end}", self.shape_remark())
    }

    /// The same without what the last colour stands for, where a caption says that.
    pub(in crate::plot) fn shape_remark(&self) -> &'static str {
        match (self.is_log, self.is_clipped) {
            (false, false) => "",
            (false, true) => ", scale ends at 98th percentile",
            (true, false) => ", log scale",
            (true, true) => ", log scale, lowest values cut",
        }
    }

    /// About `count` round values within the scale.
    pub(crate) fn ticks(&self, count: usize) -> Vec<Tick> {
        if self.is_log {
            let ticks = log_ticks(self.low, self.high, count);
            if ticks.len() >= 3 {
                return ticks;
            }
        }
        linear_ticks(self.low, self.high, count)
    }
}

fn linear_ticks(low: f64, high: f64, count: usize) -> Vec<Tick> {
    let rough = (high - low) / count.max(1) as f64;
    let power = 10f64.powf(rough.log10().floor());
    let mut steps = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter();
    let step = steps.find(|&step| step >= 0.999 * rough);
    let step = step.unwrap_or(10.0 * power);
    if !(step.is_finite() && step > 0.0) {
        return Vec::new();
    }
    let first = (low / step - 1e-6).ceil();
    let last = (high / step + 1e-6).floor();
    // More than this many can only come from a range below the resolution of numbers.
    let how_many = (last - first + 1.0).clamp(0.0, 50.0) as usize;
    let values = (0..how_many).map(|i| (first + i as f64) * step);
    values.map(|value| Tick::at(value, step)).collect()
}

/// 1, 2 and 5 of each decade where they fit, else 1 and 3, else powers of ten.
fn log_ticks(low: f64, high: f64, count: usize) -> Vec<Tick> {
    let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
    let mut chosen = Vec::new();
    for multiples in [&[1.0, 2.0, 5.0][..], &[1.0, 3.0], &[1.0]] {
        chosen = decades
            .clone()
            .flat_map(|decade| multiples.iter().map(move |m| m * 10f64.powi(decade)))
            .filter(|v| (low * 0.9999..=high * 1.0001).contains(v))
            .collect();
        if chosen.len() <= count + 2 {
            break;
        }
    }
    let chosen = chosen.into_iter();
    chosen.map(|value| Tick::at(value, value)).collect()
}

/// `value` with the decimals that tell multiples of `step` apart.
fn label(value: f64, step: f64) -> String {
    let is_zero = value.abs() < 1e-9 * step;
    let value = if is_zero { 0.0 } else { value };
    let size = value.abs().max(step);
    let text = if value == 0.0 && !(1e-4..1e6).contains(&step) {
        "0".to_string()
    } else if !(1e-4..1e6).contains(&size) {
        let digits = (size.log10().floor() - (step * 1.0001).log10().floor()).max(0.0) as usize;
        format!("{value:.*e}", digits.min(6))
    } else {
        let decimals = (-(step * 1.0001).log10().floor()).clamp(0.0, 9.0) as usize;
        format!("{value:.decimals$}")
    };
    text.replace('-', "−")
}

/// Some room above and below the line; a linear scale starts at 0 where that is not far away.
pub(in crate::plot) fn with_room(mut scale: Scale) -> Scale {
    if scale.is_log {
        let room = (scale.high / scale.low).powf(0.06);
        (scale.low, scale.high) = (scale.low / room, scale.high * room);
        return scale;
    }
    let room = 0.07 * (scale.high - scale.low);
    let is_near = scale.low >= 0.0 && scale.low < 0.5 * scale.high;
    scale.low = if is_near { 0.0 } else { scale.low - room };
    scale.high += room;
    scale
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, count: usize) -> Vec<String> {
        scale.ticks(count).into_iter().map(|t| t.label).collect()
    }

    #[test]
    fn ticks_are_round_and_within_the_scale() {
        assert_eq!(
            labels(Scale::linear(0.03, 1.02), 5),
            ["0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(
            labels(Scale::linear(-12.0, 31.0), 5),
            ["−10", "0", "10", "20", "30"]
        );
        assert_eq!(
            labels(Scale::linear(1e-7, 3e-7), 2),
            ["1e−7", "2e−7", "3e−7"]
        );
    }

    #[test]
    fn an_empty_range_is_widened() {
        for value in [0.0, 3.0, -1e-9, 1e12] {
            let scale = Scale::linear(value, value);
            assert!(scale.low < scale.high);
            assert!((scale.share(value) - 0.5).abs() < 1e-3);
            assert!(!scale.ticks(5).is_empty());
        }
    }

    #[test]
    fn a_wide_span_is_logarithmic_or_else_robust() {
        let wide: Vec<f64> = (0..100).map(|i| 10f64.powf(f64::from(i) / 40.0)).collect();
        let scale = Scale::for_scores(&wide, ScoreScale::Auto, COLOUR_DECADES);
        assert!(scale.is_log && !scale.is_clipped);
        assert_eq!(
            labels(scale, 8),
            ["1", "2", "5", "10", "20", "50", "100", "200"]
        );

        let mut with_zero = wide.clone();
        with_zero.push(0.0);
        let scale = Scale::for_scores(&with_zero, ScoreScale::Auto, COLOUR_DECADES);
        assert!(scale.is_log && scale.is_clipped && scale.low == 1.0);
        let mut with_negative = wide.clone();
        with_negative.push(-1.0);
        let scale = Scale::for_scores(&with_negative, ScoreScale::Auto, COLOUR_DECADES);
        assert!(!scale.is_log && scale.is_clipped);
        assert!(!Scale::for_scores(&wide, ScoreScale::Linear, COLOUR_DECADES).is_log);
        assert!(!Scale::for_scores(&[2.0, 3.0, 4.0], ScoreScale::Auto, COLOUR_DECADES).is_log);
        // One perfect match must not wash out the rest.
        let scale = Scale::for_scores(&[1e-15, 0.5, 1.0], ScoreScale::Auto, COLOUR_DECADES);
        assert!(scale.is_clipped && scale.low == 1e-4);
        assert_eq!(scale.share(-1.0), 0.0);
    }
}
