//! Draws pictures with known outlines for tests.
#![allow(dead_code, reason = "every test binary uses its own part")]

use realgap_vision::Grey;

/// A picture of the values of a function at every pixel.
pub fn grey(width: usize, height: usize, value: impl Fn(usize, usize) -> f32) -> Grey {
    let values = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| value(x, y))
        .collect();
    Grey::new(width, height, values).unwrap()
}

/// A pattern without repetition, of whole numbers divided by 255; it has the same bits as in tools/golden_vision.py.
pub fn texture(width: usize, height: usize) -> Grey {
    grey(width, height, |x, y| {
        let value = (x * x * 7 + y * y * 13 + x * y * 5 + 31 * x + 17 * y) % 256;
        value as f32 / 255.0
    })
}

/// An ellipse; each pixel at the border is the mean of 8 x 8 samples.
pub fn ellipse(
    width: usize,
    height: usize,
    [cx, cy, a, b]: [f64; 4],
    inside: f64,
    outside: f64,
) -> Grey {
    grey(width, height, |x, y| {
        let mut covered = 0.0;
        for i in 0..8 {
            for j in 0..8 {
                let at =
                    |pixel: usize, part: i32| pixel as f64 + (f64::from(part) + 0.5) / 8.0 - 0.5;
                let (dx, dy) = ((at(x, i) - cx) / a, (at(y, j) - cy) / b);
                covered += f64::from(u8::from(dx * dx + dy * dy <= 1.0)) / 64.0;
            }
        }
        (outside + (inside - outside) * covered) as f32
    })
}

/// Points around an ellipse.
pub fn around([cx, cy, a, b]: [f64; 4], factor: f64, count: usize) -> Vec<[f64; 2]> {
    (0..count)
        .map(|k| {
            let (sin, cos) = (k as f64 / count as f64 * std::f64::consts::TAU).sin_cos();
            [cx + factor * a * cos, cy + factor * b * sin]
        })
        .collect()
}
