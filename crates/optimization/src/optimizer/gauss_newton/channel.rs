//! Errors by channel: a joint whose errors are small has its own scale beside one whose errors are large.

use realgap_core::statistics::median;

/// Consecutive errors of one channel (a joint, for example) within one log.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorBlock {
    /// Number of the channel.
    pub channel: usize,
    /// Number of the log.
    pub log: usize,
    /// Number of errors.
    pub count: usize,
    /// Step between the values that the sensor can report, in the unit of the errors; 0 where none is known.
    pub resolution: f64,
}

/// The scale of a channel is at least this share of the largest scale of all channels: a channel that does not move and has no noise
/// would otherwise outweigh all others.
const LEAST_SHARE: f64 = 1e-3;

/// The blocks of these errors; one block where the problem states none, or where they do not fit the errors.
pub fn blocks_of(stated: &[ErrorBlock], errors: usize) -> Vec<ErrorBlock> {
    let total: usize = stated.iter().map(|block| block.count).sum();
    if total == errors && !stated.is_empty() {
        return stated.to_vec();
    }
    vec![ErrorBlock {
        channel: 0,
        log: 0,
        count: errors,
        resolution: 0.0,
    }]
}

/// Size of a typical error of each error's channel: the median absolute error, of the errors that are not zero where most are zero,
/// and at least the step of the sensor. Positive.
pub fn error_scales(blocks: &[ErrorBlock], errors: &[f64]) -> Vec<f64> {
    let channels = blocks.iter().map(|block| block.channel + 1).max();
    let mut sizes: Vec<Vec<f64>> = vec![Vec::new(); channels.unwrap_or(0)];
    let mut resolutions = vec![0.0_f64; sizes.len()];
    let mut first = 0;
    for block in blocks {
        let own = &errors[first..first + block.count];
        sizes[block.channel].extend(own.iter().map(|error| error.abs()));
        resolutions[block.channel] = resolutions[block.channel].max(block.resolution);
        first += block.count;
    }
    let scale = |(sizes, resolution): (&Vec<f64>, &f64)| {
        if sizes.is_empty() {
            return 0.0;
        }
        let typical = median(sizes);
        let moved: Vec<f64> = sizes.iter().copied().filter(|size| *size > 0.0).collect();
        let typical = match typical > 0.0 || moved.is_empty() {
            true => typical,
            false => median(&moved),
        };
        typical.max(*resolution)
    };
    let scales: Vec<f64> = sizes.iter().zip(&resolutions).map(scale).collect();
    let largest = scales.iter().copied().fold(0.0, f64::max);
    let least = (LEAST_SHARE * largest).max(1e-12);
    let of_errors = blocks
        .iter()
        .flat_map(|block| std::iter::repeat_n(scales[block.channel].max(least), block.count));
    of_errors.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(channel: usize, count: usize, resolution: f64) -> ErrorBlock {
        ErrorBlock {
            channel,
            log: 0,
            count,
            resolution,
        }
    }

    #[test]
    fn a_joint_that_stands_still_does_not_take_the_scale_from_one_that_moves() {
        let mut errors = vec![0.0; 60];
        errors.extend([0.02, -0.03, 0.01, 0.02]);
        let blocks = [block(0, 60, 0.0015), block(1, 4, 0.0015)];
        let scales = error_scales(&blocks, &errors);
        assert_eq!((scales[0], scales[63]), (0.0015, 0.02));
    }

    #[test]
    fn most_errors_of_zero_leave_the_scale_to_those_that_are_not() {
        let errors = [0.0, 0.0, 0.0, 0.004, -0.002];
        assert_eq!(error_scales(&[block(0, 5, 0.0)], &errors)[0], 0.003);
        assert!(error_scales(&[block(0, 5, 0.0)], &[0.0; 5])[0] > 0.0);
    }

    #[test]
    fn blocks_that_do_not_fit_the_errors_are_not_used() {
        assert_eq!(blocks_of(&[block(3, 2, 0.1)], 5), [block(0, 5, 0.0)]);
        assert_eq!(blocks_of(&[block(3, 5, 0.1)], 5), [block(3, 5, 0.1)]);
    }
}
