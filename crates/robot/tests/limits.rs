//! Tests that no file of others makes an import take long, take much memory, print a panic or end the process.

use std::fmt::Write as _;
use std::path::Path;
use std::time::{Duration, Instant};

use proptest::prelude::*;
use realgap_core::file::Source;
use realgap_robot::import::{Note, Options};
use realgap_robot::morphology::Morphology;

/// The time in which a hostile file is refused.
const SOON: Duration = Duration::from_secs(2);
/// The memory that the process may have taken after all hostile files, kB.
const MOST_KB: u64 = 300_000;

/// A cube of 0.1 m as a Collada file, with these words in place of its numbers.
fn collada(count: &str, indices: &str, nodes: (&str, &str)) -> String {
    let (open, close) = nodes;
    format!(
        r##"<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="{count}">0 0 0 0 0 .1 0 .1 0 0 .1 .1 .1 0 0 .1 0 .1 .1 .1 0 .1 .1 .1</float_array><technique_common><accessor source="#pa" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>{indices}</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">{open}<node id="n"><instance_geometry url="#g"/></node>{close}</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"##
    )
}

const CUBE: &str = "0 1 3 0 3 2 4 6 7 4 7 5 0 4 5 0 5 1 2 3 7 2 7 6 0 2 6 0 6 4 1 5 7 1 7 3";

fn urdf(mesh: &str) -> String {
    format!(
        r#"<robot name="r"><link name="a"><inertial><mass value="0.5"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3"/></inertial><collision><geometry><mesh filename="{mesh}"/></geometry></collision></link></robot>"#
    )
}

/// Bodies of which each lies in the one before.
fn snake(bodies: usize) -> String {
    let mut text = "<mujoco><worldbody>".to_owned();
    for body in 0..bodies {
        let _ = write!(text, r#"<body name="b{body}"><joint/><geom size=".1"/>"#);
    }
    text + &"</body>".repeat(bodies) + "</worldbody></mujoco>"
}

/// The notes of an import, or the text of its error.
fn import(path: &Path, text: &str) -> Result<Vec<Note>, String> {
    let start = Instant::now();
    let result = Morphology::import(&Source::new(path, text), &Options::default());
    assert!(
        start.elapsed() < SOON,
        "{}: {:?}",
        path.display(),
        start.elapsed()
    );
    result.map(|(_, notes)| notes).map_err(|e| e.to_string())
}

/// What an import of a robot with one mesh says about this mesh.
fn of_mesh(name: &str, bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), bytes).unwrap();
    let notes = match import(&folder.path().join("r.urdf"), &urdf(name)) {
        Ok(notes) => notes,
        Err(error) => return error,
    };
    let of_mesh = notes.into_iter().filter(|note| note.what.contains("mesh"));
    of_mesh.map(|note| note.what).collect::<Vec<_>>().join("\n")
}

/// What an import of an MJCF beside these files says.
fn of_files(files: &[(String, String)]) -> String {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let (name, text) = &files[0];
    import(&folder.path().join(name), text).unwrap_err()
}

fn stl(stated: u32, there: usize) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(stated.to_le_bytes());
    bytes.extend(vec![0; 50 * there]);
    bytes
}

#[test]
fn a_sound_collada_file_is_read() {
    let said = of_mesh("cube.dae", collada("24", CUBE, ("", "")).as_bytes());
    assert_eq!(said, "");
}

#[test]
fn includes_that_multiply_are_refused_where_they_do() {
    let level = |k: usize| {
        let inside = format!(r#"<include file="b{}.xml"/>"#, k + 1).repeat(10);
        (
            format!("b{k}.xml"),
            format!("<mujoco><worldbody>{inside}</worldbody></mujoco>"),
        )
    };
    let mut files: Vec<_> = (0..8).map(level).collect();
    files.push(("b8.xml".to_owned(), snake(1)));
    let said = of_files(&files);
    assert!(
        said.contains("b7.xml:1:") && said.contains("included twice"),
        "{said}"
    );
    // Many files that are small each are too much together.
    let large = format!("<mujoco><!--{}--></mujoco>", " ".repeat(1_000_000));
    let many: String = (0..20)
        .map(|k| format!(r#"<include file="f{k}.xml"/>"#))
        .collect();
    let mut files = vec![("main.xml".to_owned(), format!("<mujoco>{many}</mujoco>"))];
    files.extend((0..20).map(|k| (format!("f{k}.xml"), large.clone())));
    let said = of_files(&files);
    assert!(
        said.contains("main.xml") && said.contains("too large"),
        "{said}"
    );
    // So are many elements.
    let full = format!(
        "<mujoco><worldbody>{}</worldbody></mujoco>",
        "<geom/>".repeat(50_000)
    );
    let many: String = (0..5)
        .map(|k| format!(r#"<include file="e{k}.xml"/>"#))
        .collect();
    let mut files = vec![("main.xml".to_owned(), format!("<mujoco>{many}</mujoco>"))];
    files.extend((0..5).map(|k| (format!("e{k}.xml"), full.clone())));
    let said = of_files(&files);
    assert!(said.contains("e3.xml") || said.contains("e4.xml"), "{said}");
    assert!(said.contains("200000"), "{said}");
}

#[test]
fn models_that_attach_models_are_refused_when_they_multiply() {
    let level = |k: usize| {
        let attached = format!(r#"<attach model="m" body="b" prefix="p{k}"/>"#).repeat(10);
        let text = format!(
            r#"<mujoco><asset><model name="m" file="m{}.xml"/></asset><worldbody><body name="b"><geom size=".1"/>{attached}</body></worldbody></mujoco>"#,
            k + 1
        );
        (format!("m{k}.xml"), text)
    };
    let mut files: Vec<_> = (0..9).map(level).collect();
    files.push((
        "m9.xml".to_owned(),
        r#"<mujoco><worldbody><body name="b"><geom size=".1"/></body></worldbody></mujoco>"#
            .to_owned(),
    ));
    let said = of_files(&files);
    assert!(
        said.contains("models are attached") || said.contains("too many elements"),
        "{said}"
    );
}

#[test]
fn files_that_lead_back_to_themselves_are_refused() {
    let said = of_files(&[
        (
            "a.xml".to_owned(),
            r#"<mujoco><include file="b.xml"/></mujoco>"#.to_owned(),
        ),
        (
            "b.xml".to_owned(),
            "<mujoco>\n<include file=\"b.xml\"/></mujoco>".to_owned(),
        ),
    ]);
    assert!(
        said.contains("b.xml:2") && said.contains("included twice"),
        "{said}"
    );
    let own = r#"<mujoco><asset><model name="m" file="a.xml"/></asset><worldbody><body name="b"><geom size=".1"/><attach model="m" body="b" prefix="p"/></body></worldbody></mujoco>"#;
    let said = of_files(&[("a.xml".to_owned(), own.to_owned())]);
    assert!(
        said.contains("a.xml:1") && said.contains("100 models"),
        "{said}"
    );
}

#[cfg(unix)]
#[test]
fn a_device_is_neither_included_nor_read_as_a_mesh() {
    let said = import(
        "dev.xml".as_ref(),
        r#"<mujoco><include file="/dev/zero"/></mujoco>"#,
    )
    .unwrap_err();
    assert!(
        said.contains("/dev/zero") && said.contains("no regular file") && said.contains("dev.xml"),
        "{said}"
    );
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("link.stl");
    std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
    let notes = import(&folder.path().join("r.urdf"), &urdf("link.stl")).unwrap();
    assert!(
        notes.iter().any(|note| note.what.contains("link.stl")),
        "{notes:?}"
    );
}

#[test]
fn as_many_nested_bodies_are_read_as_a_robot_may_have() {
    let count = |bodies: usize| {
        let source = Source::new("snake.xml", snake(bodies));
        let (robot, _) =
            Morphology::import(&source, &Options::default()).map_err(|e| e.to_string())?;
        Ok::<_, String>(robot.summary().modules)
    };
    assert_eq!(count(999), Ok(1000));
    assert!(count(1001).unwrap_err().contains("at most 1000"));
    let said = count(30_000).unwrap_err();
    assert!(
        said.contains("nested") && said.contains("snake.xml:1:"),
        "{said}"
    );
    // Included files stand inside each other, too.
    let half = snake(700);
    let inside = format!(r#"<include file="half.xml"/>{}"#, "</body>".repeat(700));
    let said = of_files(&[
        (
            "main.xml".to_owned(),
            half.replace(&"</body>".repeat(700), &inside),
        ),
        ("half.xml".to_owned(), half),
    ]);
    assert!(
        said.contains("nested too deep") && said.contains("half.xml"),
        "{said}"
    );
}

#[test]
fn too_many_links_joints_and_shapes_are_refused_at_once() {
    let chain = |links: usize| {
        let mut text = "<robot name=\"r\">".to_owned();
        for k in 0..links {
            let _ = write!(
                text,
                r#"<link name="l{k}"/><joint name="j{k}" type="continuous"><parent link="l{k}"/><child link="l{}"/></joint>"#,
                k + 1
            );
        }
        text + "</robot>"
    };
    let said = import("chain.urdf".as_ref(), &chain(20_000)).unwrap_err();
    assert!(
        said.contains("too many links") && said.contains("at most 1000"),
        "{said}"
    );
    let shape = r#"<collision><geometry><sphere radius="1"/></geometry></collision>"#;
    let said = import(
        "shapes.urdf".as_ref(),
        &format!(
            r#"<robot name="r"><link name="a">{}</link></robot>"#,
            shape.repeat(20_001)
        ),
    )
    .unwrap_err();
    assert!(said.contains("too many shapes"), "{said}");
    let wide = format!(
        r#"<robot name="r" {}/>"#,
        (0..100_000)
            .map(|k| format!("a{k}=''"))
            .collect::<Vec<_>>()
            .join(" ")
    );
    let said = import("wide.urdf".as_ref(), &wide).unwrap_err();
    assert!(said.contains("attributes of one element"), "{said}");
}

#[test]
fn counts_of_a_mesh_are_compared_with_its_size() {
    let dae = |text: String| of_mesh("m.dae", text.as_bytes());
    let said = dae(collada("4294967295", CUBE, ("", "")));
    assert!(
        said.contains("m.dae") && said.contains("4294967295 values"),
        "{said}"
    );
    let sound = collada("24", CUBE, ("", ""));
    let said = dae(sound.replace(r#"offset="0""#, r#"offset="4000000000""#));
    assert!(said.contains("indices"), "{said}");
    let said = dae(sound
        .replace(
            r#"<triangles count="12">"#,
            r#"<polylist count="1"><vcount>4000000000</vcount>"#,
        )
        .replace("</triangles>", "</polylist>"));
    assert!(said.contains("4000000000 indices"), "{said}");
    let said = of_mesh("m.stl", &stl(u32::MAX, 2));
    assert!(
        said.contains("states 4294967295 triangles, and the file has 2"),
        "{said}"
    );
}

#[test]
fn indices_beyond_the_corners_are_told() {
    for index in ["8", "4000000000", "-1"] {
        let said = of_mesh(
            "m.dae",
            collada("24", &CUBE.replacen('3', index, 1), ("", "")).as_bytes(),
        );
        assert!(said.contains("is not used"), "{index}: {said}");
    }
    for face in [
        "f 1 2 9",
        "f 1 2 -9",
        "f 1 2 99999999999999999999",
        "f 1/7/7 2 3",
    ] {
        let said = of_mesh(
            "m.obj",
            format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{face}\n").as_bytes(),
        );
        assert!(said.contains("m.obj"), "{face}: {said}");
    }
}

#[test]
fn a_mesh_file_of_deep_nodes_is_refused() {
    let (open, close) = ("<node>".repeat(30_000), "</node>".repeat(30_000));
    let said = of_mesh("m.dae", collada("24", CUBE, (&open, &close)).as_bytes());
    assert!(
        said.contains("nested") && said.contains("at most 256"),
        "{said}"
    );
}

/// A mutation of a text: bytes are replaced, removed or repeated.
fn mutated(text: &str, changes: &[(u8, prop::sample::Index, prop::sample::Index)]) -> Vec<u8> {
    let words: [&[u8]; 8] = [
        b"4294967295",
        b"-1",
        b"nan",
        b"<",
        b"\"",
        b"1e308",
        b"/",
        b"\xff",
    ];
    let mut bytes = text.as_bytes().to_vec();
    for (kind, here, there) in changes {
        if bytes.is_empty() {
            break;
        }
        let (a, b) = (here.index(bytes.len()), there.index(bytes.len()));
        let (low, high) = (a.min(b), (a.min(b) + 200).min(a.max(b)));
        match kind % 4 {
            0 => drop(bytes.drain(low..high)),
            1 => drop(bytes.splice(low..low, bytes[low..high].to_vec())),
            2 => drop(bytes.splice(a..=a, words[b % words.len()].iter().copied())),
            _ => bytes[a] = bytes[b],
        }
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]
    #[test]
    fn mutants_end_soon_in_a_robot_a_doubt_or_an_error(
        changes in prop::collection::vec((any::<u8>(), any::<prop::sample::Index>(), any::<prop::sample::Index>()), 1..6)
    ) {
        of_mesh("m.dae", &mutated(&collada("24", CUBE, ("<node>", "</node>")), &changes));
        of_mesh("m.obj", &mutated("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf -1 -2 -3\nusemtl a\nf 1//1 2//1 4//1\n", &changes));
        of_mesh("m.stl", &mutated("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n", &changes));
        of_mesh("m.stl", &mutated(&String::from_utf8(stl(2, 2)).unwrap(), &changes));
        for (name, text) in [("m.xml", snake(3)), ("m.urdf", urdf("none.stl"))] {
            let _ = import(name.as_ref(), &String::from_utf8_lossy(&mutated(&text, &changes)));
        }
    }
}

/// The largest memory that this process has taken, kB.
#[cfg(target_os = "linux")]
fn peak_kb() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))
        .unwrap();
    line.trim().trim_end_matches(" kB").parse().unwrap()
}

/// Runs all tests of this file in a process of its own, whose memory and output nothing else changes.
#[cfg(target_os = "linux")]
#[test]
fn hostile_files_take_little_memory_and_print_nothing() {
    if std::env::var_os("REALGAP_TEST_ALONE").is_some() {
        counts_of_a_mesh_are_compared_with_its_size();
        indices_beyond_the_corners_are_told();
        a_mesh_file_of_deep_nodes_is_refused();
        includes_that_multiply_are_refused_where_they_do();
        models_that_attach_models_are_refused_when_they_multiply();
        a_device_is_neither_included_nor_read_as_a_mesh();
        as_many_nested_bodies_are_read_as_a_robot_may_have();
        too_many_links_joints_and_shapes_are_refused_at_once();
        let peak = peak_kb();
        eprintln!("{peak} kB at most");
        assert!(peak < MOST_KB, "{peak} kB");
        return;
    }
    let name = "limits::hostile_files_take_little_memory_and_print_nothing";
    let output = std::process::Command::new(std::env::current_exe().unwrap())
        .args(["--exact", name, "--nocapture", "--test-threads=1"])
        .env("REALGAP_TEST_ALONE", "1")
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    assert!(
        told.contains("kB at most") && !told.contains("panicked"),
        "{told}"
    );
}
