//! Bad input of the command: errors say where it is, what was found and what is allowed.

use std::path::{Path, PathBuf};

use super::drawing::{grey, texture};
use crate::common;

/// A temporary folder in which a test writes pictures and lists of views.
struct Desk(tempfile::TempDir);

impl Desk {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }

    fn run(&self, args: &[&str]) -> (i32, String, String) {
        let done = common::realgap()
            .current_dir(self.0.path())
            .args(args)
            .output()
            .unwrap();
        let code = done.status.code().unwrap();
        (code, common::text(&done.stdout), common::text(&done.stderr))
    }

    fn refused(&self, args: &[&str], expected: &[&str]) {
        let (code, _, said) = self.run(args);
        assert!(code == 1 || code == 2, "{args:?}: {code} {said}");
        for word in expected {
            assert!(said.contains(word), "{args:?}: {word} is missing in {said}");
        }
    }

    fn warned(&self, args: &[&str], expected: &[&str]) {
        let (code, _, said) = self.run(args);
        assert_eq!(code, 0, "{args:?}: {said}");
        for word in expected {
            assert!(said.contains(word), "{args:?}: {word} is missing in {said}");
        }
    }
}

/// A PNG of one grey value, of any size and depth.
fn even(side: u32, depth: png::BitDepth) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side, side);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(depth);
    let bits = side as usize * depth as usize;
    let mut writer = encoder.write_header().unwrap();
    writer
        .write_image_data(&vec![0; bits.div_ceil(8) * side as usize])
        .unwrap();
    writer.finish().unwrap();
    bytes
}

fn room() -> String {
    let path = common::project().join("scenes/room.ron");
    path.to_str().unwrap().to_owned()
}

#[test]
fn folders_without_pictures_of_the_views_are_refused() {
    let desk = Desk::new();
    desk.write("good/door.png", texture(80, 60).picture().to_png().unwrap());
    desk.write(
        "small/door.png",
        texture(80, 30).picture().to_png().unwrap(),
    );
    desk.write(
        "other/attic.png",
        texture(80, 60).picture().to_png().unwrap(),
    );
    desk.write("text/door.png", "t_s,x_m\n0,0\n");
    std::fs::create_dir(desk.path("empty")).unwrap();
    for [a, b] in [["empty", "good"], ["good", "empty"]] {
        desk.refused(
            &["sense", "vision", "compare", a, b],
            &["empty: there are no pictures", ".png, .jpg"],
        );
        let (a, b) = (a.replace("empty", "text"), b.replace("empty", "text"));
        desk.refused(
            &["sense", "vision", "compare", &a, &b],
            &["door.png: not a picture", "74 5f 73 2c", "PNG and JPEG"],
        );
    }
    desk.refused(
        &["sense", "vision", "compare", "good", "nowhere"],
        &["nowhere", "check the path"],
    );
    desk.refused(
        &["sense", "vision", "compare", "good", "other"],
        &[
            "no pictures have the same name",
            "attic",
            "names of good: door",
        ],
    );
    desk.refused(
        &[
            "sense",
            "vision",
            "compare",
            "good",
            "good",
            "--extractor",
            "snake",
        ],
        &["--extractor", "snake", "edges, template, contour, text"],
    );
    desk.refused(
        &[
            "sense",
            "vision",
            "compare",
            "good",
            "good",
            "--extractor",
            "text",
        ],
        &[
            "good",
            "nothing that the extractors could search for",
            "text",
            "views.ron states",
        ],
    );
    desk.refused(
        &["sense", "vision", "compare", "good", "small"],
        &[
            "small/door.png",
            "80 x 30 px",
            "80 x 60 px",
            "scale or crop",
        ],
    );
    desk.refused(
        &[
            "sense",
            "vision",
            "compare",
            "good",
            "good",
            "--badly-lit",
            "small",
        ],
        &["small/door.png", "different sizes"],
    );
    let room = room();
    for (folder, expected) in [
        ("empty", ["empty: there are no pictures", ".png, .jpg"]),
        ("text", ["text/door.png: not a picture", "PNG and JPEG"]),
        ("other", ["no picture has the name of a view", "attic"]),
        ("small", ["small/door.png", "at least 64 x 48 px"]),
        ("good", ["good: too few views", "1 view"]),
    ] {
        desk.refused(&["sense", "vision", "tune", &room, folder], &expected);
    }
}

#[test]
fn one_pixel_and_sixteen_bits_are_compared_and_pictures_without_edges_give_a_warning() {
    let desk = Desk::new();
    desk.write(
        "one/door.png",
        grey(1, 1, |_, _| 0.4).picture().to_png().unwrap(),
    );
    desk.warned(
        &["sense", "vision", "compare", "one", "one"],
        &["no-edges", "1 view: with fewer than 6"],
    );
    desk.warned(
        &[
            "sense",
            "vision",
            "extract",
            "one/door.png",
            "-o",
            "steps.png",
        ],
        &["no-edges"],
    );
    assert!(desk.path("steps.png").exists());
    desk.write("deep/door.png", even(64, png::BitDepth::Sixteen));
    desk.write("flat/door.png", even(64, png::BitDepth::Eight));
    let (code, said, _) = desk.run(&["sense", "vision", "compare", "deep", "flat"]);
    assert!(code == 0 && said.contains("0.000"), "{said}");
}

/// The memory of the process is limited to 400 MB, which is a tenth of what the pixels alone would take.
#[test]
#[cfg(unix)]
fn pictures_of_a_hundred_megapixels_are_refused_with_little_memory() {
    let desk = Desk::new();
    desk.write("good/door.png", texture(80, 60).picture().to_png().unwrap());
    desk.write("large/door.png", even(10_000, png::BitDepth::One));
    // A JPEG that ends after its header.
    let mut jpeg = texture(16, 16).picture().to_jpeg(80).unwrap();
    let frame = jpeg.windows(2).position(|w| w == [0xff, 0xc0]).unwrap();
    jpeg[frame + 5..frame + 9].copy_from_slice(&[0x27, 0x10, 0x27, 0x10]);
    desk.write("header/door.jpg", jpeg);
    let room = room();
    for args in [
        &["sense", "vision", "compare", "large", "good"][..],
        &["sense", "vision", "compare", "good", "large"],
        &["sense", "vision", "compare", "header", "good"],
        &["sense", "vision", "extract", "large/door.png"],
        &["sense", "vision", "tune", &room, "large"],
    ] {
        let done = std::process::Command::new("sh")
            .args(["-c", "ulimit -v 400000; exec \"$@\"", "sh"])
            .arg(env!("CARGO_BIN_EXE_realgap"))
            .args(args)
            .env("RAYON_NUM_THREADS", "1")
            .current_dir(desk.0.path())
            .output()
            .unwrap();
        let said = common::text(&done.stderr);
        assert_eq!(done.status.code(), Some(1), "{args:?}: {said}");
        assert!(
            said.contains("10000 x 10000") && said.contains("32 megapixels"),
            "{args:?}: {said}"
        );
    }
}

#[test]
fn features_outside_of_the_picture_are_refused_or_get_a_warning() {
    let desk = Desk::new();
    for folder in ["sought", "real"] {
        let name = format!("{folder}/door.png");
        desk.write(&name, texture(80, 60).picture().to_png().unwrap());
    }
    desk.write(
        "sought/template.png",
        texture(700, 700).picture().to_png().unwrap(),
    );
    let views = |view: &str| {
        desk.write(
            "sought/views.ron",
            format!(
                "Views(template: Some(\"template.png\"), views: [View(name: \"door\", {view})])"
            ),
        );
    };
    let both = |extractor: &str, expected: &[&str]| {
        let extract = [
            "sense",
            "vision",
            "extract",
            "sought/door.png",
            "--extractor",
            extractor,
        ];
        desk.refused(&extract, expected);
        desk.refused(&["sense", "vision", "compare", "sought", "real"], expected);
    };
    views("template_at_px: Some((40, 30))");
    both(
        "template",
        &[
            "sought/door.png",
            "larger than the picture",
            "700 x 700",
            "320 x 240",
        ],
    );
    views("start_px: [(1, 1), (200, 1), (200, 50), (1, 50)]");
    both(
        "contour",
        &[
            "sought/door.png",
            "outside of the picture",
            "(200, 1)",
            "80 x 60",
        ],
    );
    views("start_px: [(1, 1), (NaN, 1), (20, 50), (1, 50)]");
    both("contour", &["(NaN, 1)"]);
    views("start_px: [(1, 1), (20, 1)]");
    both("contour", &["too few points", "4 or more"]);
    views(
        "start_px: [(9, 9), (20, 9), (20, 20), (9, 20)], outline_px: [(500, 500), (600, 500), (600, 600)]",
    );
    for args in [
        &["sense", "vision", "compare", "sought", "real"][..],
        &[
            "sense",
            "vision",
            "extract",
            "sought/door.png",
            "--extractor",
            "contour",
        ],
    ] {
        desk.warned(args, &["outline-outside", "(500, 500)", "80 x 60"]);
    }
    desk.write("sought/views.ron", "Views(view: [])");
    both("edges", &["sought/views.ron:1", "did you mean `views`?"]);
    desk.write("sought/views.ron", "Views(template: Some(\"none.png\"))");
    both("edges", &["sought/none.png", "check the path"]);
    desk.refused(
        &[
            "sense",
            "vision",
            "extract",
            "sought/door.png",
            "--extractor",
            "snake",
        ],
        &["edges, template, contour, text"],
    );
}

#[test]
fn invalid_scenes_and_options_are_refused() {
    let desk = Desk::new();
    let text = std::fs::read_to_string(Path::new(&room())).unwrap();
    let scene = |from: &str, to: &str, expected: &[&str]| {
        assert!(text.contains(from), "{from}");
        desk.write("scene.ron", text.replacen(from, to, 1));
        desk.refused(&["sense", "picture", "scene.ron", "-o", "out"], expected);
    };
    for (resolution, found) in [("10000, 10000", "10000 x 10000"), ("0, 1", "0 x 1")] {
        scene(
            "field_of_view_deg: 62,",
            &format!("resolution_px: ({resolution}),"),
            &["scene.ron:", "resolution_px", found, "16 megapixels"],
        );
    }
    scene(
        "field_of_view_deg: 62,",
        "field_of_view_deg: NaN,",
        &["NaN", "1 degrees to 150"],
    );
    scene(
        "(3.0, 0.6, 1.5)",
        "(3.0, -5, 1.5)",
        &["views[0]", "not inside of the room"],
    );
    scene(
        "(3.0, 0.6, 1.5)",
        "(1.2, 4.5, 0.36)",
        &["views[0]", "stands in a box"],
    );
    scene(
        "(3.1, 5.0, 1.5)",
        "(3.0, 0.6, 1.5)",
        &["the direction of the camera is not valid"],
    );
    desk.write("scene.ron", &text);
    for (option, allowed) in [
        ("--view", "door, middle"),
        ("--light", "badly, well"),
        ("--camera", "model, standin"),
    ] {
        desk.refused(
            &[
                "sense",
                "picture",
                "scene.ron",
                "-o",
                "out",
                option,
                "attic",
            ],
            &[option, "attic", allowed],
        );
    }
    desk.refused(
        &["sense", "picture", "scene.ron", "-o", "scene.ron"],
        &["scene.ron"],
    );
    desk.refused(
        &["sense", "picture", ".", "-o", "out"],
        &["this is a folder"],
    );
    // A picture of one pixel is allowed.
    let tiny = text.replacen("field_of_view_deg: 62,", "resolution_px: (1, 1),", 1);
    desk.write("scene.ron", tiny);
    desk.warned(
        &[
            "sense",
            "picture",
            "scene.ron",
            "-o",
            "out",
            "--view",
            "door",
        ],
        &[],
    );
}
