//! Makes folders of simulated, real and badly lit pictures of the same views for tests.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(dead_code, reason = "every test binary uses its own part")]

use std::path::Path;

use rand::RngExt;
use realgap_core::random::Numbered;
use realgap_vision::{Grey, PictureSource, ViewFile, ViewsFile};

use crate::drawing::{around, ellipse};

pub const VIEWS: usize = 7;

/// A disc whose position differs between views.
pub fn disc(view: usize) -> [f64; 4] {
    [60.0 + 4.0 * view as f64, 55.0 - view as f64, 26.0, 24.0]
}

/// A view in some light, with noise.
pub fn picture(view: usize, light: (f32, f32), noise: f32, seed: u64) -> Grey {
    let clean = ellipse(150, 110, disc(view), 0.15, 0.8);
    let mut rng = Numbered::SensorReading.generator(seed, view as u64);
    let mut values = Vec::new();
    for v in clean.values() {
        let n: f32 = rng.random_range(-1.0..1.0);
        values.push(light.0 + light.1 * v + noise * n);
    }
    Grey::new(150, 110, values).unwrap()
}

pub fn write(folder: &Path, name: &str, picture: &Grey) {
    std::fs::create_dir_all(folder).unwrap();
    let file = folder.join(format!("{name}.png"));
    picture.picture().write_png(file).unwrap();
}

/// Simulated, real (twice a view) and badly lit pictures.
pub fn folders(root: &Path) -> [std::path::PathBuf; 3] {
    let [simulated, real, bad] = ["simulated", "real", "bad"].map(|name| root.join(name));
    let mut views = Vec::new();
    for view in 0..VIEWS {
        let name = format!("view{view}");
        write(&simulated, &name, &picture(view, (0.0, 1.0), 0.01, 1));
        for repeat in 1..=2 {
            let its = picture(view, (0.02, 0.95), 0.02, 10 + repeat);
            write(&real, &format!("{name}_{repeat}"), &its);
        }
        write(&bad, &name, &picture(view, (0.1, 0.07), 0.09, 20));
        let points = |points: Vec<[f64; 2]>| points.into_iter().map(|p| (p[0], p[1])).collect();
        views.push(ViewFile {
            name,
            start_px: points(around(disc(view), 1.3, 40)),
            outline_px: points(around(disc(view), 1.0, 200)),
            ..ViewFile::default()
        });
    }
    let file = ViewsFile {
        source: PictureSource::Simulated,
        views,
        ..ViewsFile::default()
    };
    file.write(&simulated).unwrap();
    [simulated, real, bad]
}
