//! `realgap sense vision compare` on folders of pictures.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::album::folders;
use crate::common;
use realgap::vision::Grey;

#[test]
fn the_command_prints_a_table_and_json_and_draws_pictures() {
    let root = tempfile::tempdir().unwrap();
    let [simulated, real, bad] = folders(root.path());
    let out = root.path().join("out");
    let run = |more: &[&str]| {
        let mut command = common::realgap();
        command
            .args(["sense", "vision", "compare"])
            .arg(&simulated)
            .arg(&real);
        let done = command
            .arg("--badly-lit")
            .arg(&bad)
            .args(more)
            .output()
            .unwrap();
        assert!(done.status.success(), "{}", common::text(&done.stderr));
        common::text(&done.stdout)
    };
    let table = run(&["--views", "-o", out.to_str().unwrap()]);
    assert!(table.contains("Is a simulated picture nearer"), "{table}");
    assert!(table.contains("contour (figure 8)"), "{table}");
    for name in ["edges.png", "contour.png"] {
        let drawn = Grey::read(out.join(name)).unwrap();
        assert!(drawn.width() > 500, "{name}");
    }
    let json = common::schema::answer("vision-compare", &run(&["--format", "json"]));
    assert_eq!(json["extractors"][0]["verdict"]["answer"], "nearer");
    let sheet = root.path().join("steps.png");
    let done = common::realgap()
        .args(["sense", "vision", "extract", "--extractor", "contour", "-o"])
        .arg(&sheet)
        .arg(simulated.join("view1.png"))
        .output()
        .unwrap();
    assert!(done.status.success(), "{}", common::text(&done.stderr));
    assert!(common::text(&done.stdout).contains("mean snake distance"));
    assert!(Grey::read(sheet).unwrap().width() > 600);
}
