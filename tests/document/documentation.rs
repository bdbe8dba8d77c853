//! The pages of `docs/` hold together: links lead somewhere, as files and in rustdoc, and nothing is left out.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The pages below `folder`, as paths from the project's folder.
fn pages(folder: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(common::project().join(folder)).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        let path = format!("{folder}/{name}");
        if common::project().join(&path).is_dir() {
            found.extend(pages(&path));
        } else if name.ends_with(".md") {
            found.push(PathBuf::from(path));
        }
    }
    found.sort();
    found
}

/// Every page that people read: those of `docs/` and those beside `Cargo.toml`.
fn all_pages() -> Vec<PathBuf> {
    let mut all = pages("docs");
    all.extend(["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(PathBuf::from));
    all
}

fn read(page: &Path) -> String {
    std::fs::read_to_string(common::project().join(page)).unwrap()
}

/// The text without fenced blocks and inline code.
fn prose(text: &str) -> String {
    let outside: Vec<&str> = text.split("```").step_by(2).collect();
    outside.join("\n").split('`').step_by(2).collect()
}

/// What stands between `open` and `close`, wherever both are found.
fn between<'a>(text: &'a str, open: &str, close: char) -> Vec<&'a str> {
    text.split(open)
        .skip(1)
        .filter_map(|rest| rest.split_once(close).map(|(inside, _)| inside))
        .collect()
}

/// `[name]: target` at the start of a line.
fn definitions(text: &str) -> BTreeMap<&str, &str> {
    text.lines()
        .filter_map(|line| line.strip_prefix('[')?.split_once("]: "))
        .collect()
}

/// A link's file as a path from the project's folder, without `..`.
fn resolved(page: &Path, target: &str) -> PathBuf {
    let mut path = PathBuf::new();
    for part in page.parent().unwrap().join(target).components() {
        match part {
            std::path::Component::ParentDir => {
                path.pop();
            }
            part => path.push(part),
        }
    }
    path
}

#[test]
fn every_link_leads_to_a_file_that_exists() {
    let mut broken = Vec::new();
    for page in all_pages() {
        let text = read(&page);
        let text = prose(&text);
        let inline = between(&text, "](", ')');
        for target in inline.into_iter().chain(definitions(&text).into_values()) {
            let file = target.split('#').next().unwrap();
            if target.starts_with("http") || file.is_empty() {
                continue;
            }
            if !common::project().join(resolved(&page, file)).exists() {
                broken.push(format!("{}: {target}", page.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn a_page_links_to_others_by_names_that_rustdoc_knows_too() {
    let known = guide();
    let mut wrong = Vec::new();
    for page in pages("docs") {
        let text = read(&page);
        let text = prose(&text);
        let own = definitions(&text);
        for name in between(&text, "][", ']') {
            if !own.contains_key(name) {
                wrong.push(format!("{}: [{name}] is not defined", page.display()));
            }
        }
        for (name, target) in own {
            let is_itself = resolved(&page, target) == Path::new(name);
            if !is_itself || !known.contains(name) {
                wrong.push(format!("{}: [{name}]: {target}", page.display()));
            }
        }
        for target in between(&text, "](", ')') {
            if !target.starts_with("http") && !target.starts_with('#') {
                wrong.push(format!("{}: ({target}) breaks in rustdoc", page.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The files that the table of pages in `src/lib.rs` names.
fn guide() -> BTreeSet<String> {
    let library = read(Path::new("src/lib.rs"));
    let (_, table) = library.split_once("    pages! {\n").unwrap();
    let (table, _) = table.split_once("\n    }\n").unwrap();
    let is_row = |line: &&str| !line.trim_start().starts_with(['#', '/']);
    let rows: Vec<&str> = table.lines().filter(is_row).collect();
    let mut files = BTreeSet::from(["docs/validation.md".to_owned()]);
    for row in rows.join(" ").split(';') {
        let Some((room, names)) = row.split_once(':') else {
            continue;
        };
        let (folder, ending) = match room.trim() {
            "pages" => ("docs".to_owned(), "md"),
            "pictures" => ("docs/images".to_owned(), "png"),
            room => (format!("docs/{room}"), "md"),
        };
        let names = names.split_whitespace();
        files.extend(names.map(|name| format!("{folder}/{name}.{ending}")));
    }
    files
}

#[test]
fn every_page_is_part_of_the_guide() {
    let known = guide();
    for page in pages("docs") {
        let page = page.display().to_string();
        assert!(known.contains(&page), "src/lib.rs lacks {page}");
    }
}

#[test]
fn pages_that_messages_and_comments_name_exist() {
    for folder in ["src", "crates", "tests", "sweeps", "morphologies"] {
        for (file, text) in sources(folder) {
            for name in between(&text, "docs/", ' ') {
                let Some((name, _)) = name.split_once(".md") else {
                    continue;
                };
                let page = format!("docs/{name}.md");
                let is_plain = name
                    .chars()
                    .all(|c| c.is_alphanumeric() || "_/".contains(c));
                assert!(
                    !is_plain || common::project().join(&page).exists(),
                    "{file} names {page}"
                );
            }
        }
    }
}

fn sources(folder: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(common::project().join(folder)).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            let inside = path.strip_prefix(common::project()).unwrap();
            found.extend(sources(&inside.to_string_lossy()));
        } else if path
            .extension()
            .is_some_and(|end| end == "rs" || end == "ron")
        {
            let text = std::fs::read_to_string(&path).unwrap();
            found.push((path.display().to_string(), text));
        }
    }
    found
}

#[test]
fn lines_of_prose_wrap_at_a_hundred_columns() {
    let mut long = Vec::new();
    for page in all_pages() {
        if page == Path::new("CHANGELOG.md") {
            continue;
        }
        let text = read(&page);
        let mut in_output = false;
        for (number, line) in text.lines().enumerate() {
            if line.trim_start().starts_with("```") {
                in_output = !in_output && line.trim_start() == "```text";
            }
            let may_be_long = in_output
                || line.starts_with('|')
                || line.starts_with("![")
                || definitions(line).len() == 1;
            if !may_be_long && line.chars().count() > 100 {
                long.push(format!("{}:{}", page.display(), number + 1));
            }
        }
    }
    assert!(long.is_empty(), "{}", long.join("\n"));
}

#[test]
fn every_file_of_a_results_folder_is_explained() {
    let source = read(Path::new("crates/page/src/results/kind.rs"));
    let (_, names) = source.split_once("mod file {").unwrap();
    let (names, _) = names.split_once("impl Kind").unwrap();
    let names: Vec<&str> = names.split('"').skip(1).step_by(2).collect();
    assert!(names.len() > 15, "{names:?}");
    let page = read(Path::new("docs/results.md"));
    for name in names {
        let is_listed = page
            .lines()
            .any(|line| line.starts_with("| `") && line.contains(&format!("`{name}`")));
        assert!(is_listed, "docs/results.md lacks {name}");
    }
}

#[test]
fn hand_written_pages_stay_short() {
    let made = ["docs/files.md", "docs/cli.md"].map(PathBuf::from);
    let mut all = pages("docs");
    all.extend(["README.md", "CONTRIBUTING.md"].map(PathBuf::from));
    let written = all.iter().filter(|page| !made.contains(page));
    let words: usize = written
        .map(|page| read(page).split_whitespace().count())
        .sum();
    assert!(words <= 45_000, "{words} words");
    let design = read(Path::new("docs/design.md"));
    let minutes = design.split_whitespace().count() / 185;
    assert!(minutes <= 20, "docs/design.md takes {minutes} minutes");
}

#[test]
fn the_table_of_rooms_names_every_room() {
    let design = read(Path::new("docs/design.md"));
    for entry in std::fs::read_dir(common::project().join("src")).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        let room = name.trim_end_matches(".rs");
        if !["lib", "main"].contains(&room) {
            let is_listed = design
                .lines()
                .any(|line| line.starts_with("| `") && line.contains(&format!("`{room}`")));
            assert!(is_listed, "docs/design.md does not list the room {room}");
        }
    }
}
