//! The pages of `docs/` are consistent: links are valid, as files and in rustdoc, and every page is part of the guide.
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

/// All texts between `open` and `close`.
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

/// The table of pages in `src/lib.rs`, without its part that lists headings, and that part.
fn table_of_pages() -> (String, String) {
    let library = read(Path::new("src/lib.rs"));
    let (_, table) = library.split_once("    pages! {\n").unwrap();
    let (table, _) = table.split_once("\n    }\n").unwrap();
    let (before, rest) = table.split_once("headings: {").unwrap();
    let (headings, after) = rest.split_once('}').unwrap();
    (format!("{before}{after}"), headings.to_owned())
}

/// The files and the headings that the table of pages in `src/lib.rs` names.
fn guide() -> BTreeSet<String> {
    let (table, headings) = table_of_pages();
    let is_row = |line: &&str| !line.trim_start().starts_with(['#', '/']);
    let rows: Vec<&str> = table.lines().filter(is_row).collect();
    let mut known = BTreeSet::from(["docs/validation.md".to_owned()]);
    for row in rows.join(" ").split(';') {
        let Some((folder, names)) = row.split_once(':') else {
            continue;
        };
        let (folder, ending) = match folder.trim() {
            "pages" => ("docs".to_owned(), "md"),
            "pictures" => ("docs/images".to_owned(), "png"),
            folder => (format!("docs/{folder}"), "md"),
        };
        let names = names.split_whitespace();
        known.extend(names.map(|name| format!("{folder}/{name}.{ending}")));
    }
    for row in headings.split(';') {
        let Some((page, names)) = row.split_once(':') else {
            continue;
        };
        let page = page.trim().trim_matches(['[', ']']).replace(' ', "/");
        let names = between(names, " \"", '"');
        known.extend(
            names
                .into_iter()
                .map(|name| format!("docs/{page}.md#{name}")),
        );
    }
    known
}

/// The name under which a heading can be linked, on a forge and in rustdoc.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter_map(|c| match c {
        ' ' => Some('-'),
        c if c.is_alphanumeric() || "-_".contains(c) => c.to_lowercase().next(),
        _ => None,
    });
    kept.collect()
}

/// The text without fenced blocks.
fn without_blocks(text: &str) -> String {
    text.split("```").step_by(2).collect()
}

/// The names of all headings of a page.
fn anchors(page: &Path) -> BTreeSet<String> {
    let text = without_blocks(&read(page));
    let headings = text.lines().filter_map(|line| {
        let heading = line.trim_start_matches('#');
        (heading.len() < line.len() && heading.starts_with(' ')).then(|| anchor(heading))
    });
    headings.collect()
}

#[test]
fn every_heading_that_a_page_links_exists() {
    let mut broken = Vec::new();
    for page in all_pages() {
        let text = read(&page);
        let text = prose(&text);
        let inline = between(&text, "](", ')');
        for target in inline.into_iter().chain(definitions(&text).into_values()) {
            let Some((file, heading)) = target.split_once('#') else {
                continue;
            };
            if target.starts_with("http") {
                continue;
            }
            let other = match file.is_empty() {
                true => page.clone(),
                false => resolved(&page, file),
            };
            if !anchors(&other).contains(heading) {
                broken.push(format!("{}: {target}", page.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn every_heading_in_the_table_of_pages_exists() {
    for name in guide() {
        if let Some((page, heading)) = name.split_once('#') {
            assert!(
                anchors(Path::new(page)).contains(heading),
                "src/lib.rs names {name}"
            );
        }
    }
}

/// The glossary's terms, each with the text below its heading.
fn glossary() -> Vec<(String, String)> {
    let page = read(Path::new("docs/concepts.md"));
    let (_, glossary) = page.split_once("\n## Glossary\n").unwrap();
    let terms = glossary.split("\n#### ").skip(1);
    let terms = terms.map(|term| {
        let (name, text) = term.split_once('\n').unwrap();
        let text = text.split("\n#").next().unwrap();
        let text = text.split("\n[docs/").next().unwrap();
        (name.to_owned(), text.trim().to_owned())
    });
    terms.collect()
}

#[test]
fn every_term_of_the_glossary_is_defined_once_in_a_sentence_or_two() {
    let terms = glossary();
    assert!(terms.len() > 80, "{} terms", terms.len());
    let known = guide();
    let mut seen = BTreeSet::new();
    for (name, text) in terms {
        assert!(
            text.ends_with('.') && text.split_whitespace().count() < 70,
            "{name}: {text}"
        );
        let link = format!("docs/concepts.md#{}", anchor(&name));
        assert!(known.contains(&link), "src/lib.rs lacks {link}");
        assert!(seen.insert(link), "{name} is there twice");
    }
}

/// Tables on pages of measurements that hold no measurements: they explain names.
const EXPLAINING: [&str; 4] = [
    "| check | closed form |",
    "| part | what it is |",
    "| setting | value | why |",
    "| feature | rule |",
];

/// What a command of a measurement begins with.
const COMMANDS: [&str; 6] = ["realgap ", "cargo ", "python", "tools/", "REALGAP_", "pip "];

/// Words that say on which day a table was made.
fn says_a_date(text: &str) -> bool {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let text = text.to_lowercase();
    ["run on 20", "run between 20"]
        .iter()
        .any(|words| text.contains(words))
}

/// Lines of a section in pieces, each with one table: the text since the table before it, the table, and the text up to the next.
fn tables(section: &str) -> Vec<(String, String)> {
    let lines: Vec<&str> = section.lines().collect();
    let is_head = |i: usize| {
        lines[i].starts_with('|')
            && lines
                .get(i + 1)
                .is_some_and(|next| next.starts_with("|---"))
    };
    let heads: Vec<usize> = (0..lines.len()).filter(|i| is_head(*i)).collect();
    let mut found = Vec::new();
    let mut begin = 0;
    for (number, head) in heads.iter().enumerate() {
        let end = heads.get(number + 1).copied().unwrap_or(lines.len());
        found.push((lines[*head].to_owned(), lines[begin..end].join("\n")));
        let rows = lines[*head..]
            .iter()
            .take_while(|line| line.starts_with('|'));
        begin = head + rows.count();
    }
    found
}

/// A table of measurements has its date beside it, and its command in the same section of the page.
#[test]
fn every_table_of_measurements_has_a_command_and_a_date() {
    let mut lacking = Vec::new();
    let mut count = 0;
    for page in pages("docs/validation") {
        for section in read(&page).split("\n## ") {
            for (head, text) in tables(section) {
                if EXPLAINING.contains(&head.as_str()) {
                    continue;
                }
                count += 1;
                if !says_a_date(&text) {
                    lacking.push(format!("{}: {head}: no date", page.display()));
                }
                if !COMMANDS.iter().any(|command| section.contains(command)) {
                    lacking.push(format!("{}: {head}: no command", page.display()));
                }
            }
        }
    }
    assert!(count > 40, "{count} tables");
    assert!(lacking.is_empty(), "{}", lacking.join("\n"));
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
    for folder in [
        "src",
        "crates",
        "tests",
        "benches",
        "examples",
        "sweeps",
        "morphologies",
        "real_trajectories",
        "tools",
        "python/realgap",
        "python/tests",
    ] {
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
        } else if path.extension().is_some_and(|end| {
            ["rs", "ron", "py", "sh", "md"]
                .iter()
                .any(|known| end == *known)
        }) {
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

/// The rows of a table of `docs/design.md`: the names in its first cells, and the last cells.
fn rows_of_design() -> BTreeMap<String, String> {
    let design = read(Path::new("docs/design.md"));
    let rows = design.lines().filter_map(|line| {
        let (name, rest) = line.strip_prefix("| `")?.split_once('`')?;
        let last = rest.trim_end_matches(['|', ' ']).rsplit('|').next()?;
        Some((name.trim_end_matches(".rs").to_owned(), last.to_owned()))
    });
    rows.collect()
}

#[test]
fn the_tables_of_design_name_every_part_of_the_facade() {
    let rows = rows_of_design();
    for entry in std::fs::read_dir(common::project().join("src")).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        let module = name.trim_end_matches(".rs");
        if module != "main" {
            assert!(rows.contains_key(module), "docs/design.md lacks {module}");
        }
    }
}

#[test]
fn the_table_of_crates_says_what_each_crate_may_see() {
    let rows = rows_of_design();
    for entry in std::fs::read_dir(common::project().join("crates")).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        let manifest = read(&Path::new("crates").join(&name).join("Cargo.toml"));
        let (_, seen) = manifest.split_once("\n[dependencies]\n").unwrap();
        let seen: BTreeSet<&str> = seen
            .lines()
            .take_while(|line| !line.starts_with('['))
            .filter_map(|line| line.strip_prefix("realgap-"))
            .map(|line| line.split(['.', ' ', '=']).next().unwrap())
            .filter(|other| *other != "core")
            .collect();
        let row = rows.get(&name);
        let row = row.unwrap_or_else(|| panic!("docs/design.md lacks the crate {name}"));
        let said: BTreeSet<&str> = match row.contains("no other") {
            true => BTreeSet::new(),
            false => row.split('`').skip(1).step_by(2).collect(),
        };
        assert_eq!(said, seen, "docs/design.md, crate {name}");
    }
}

/// Words of earlier versions, and the field's word that is said for the same thing today, in docs, help, messages and pages.
const REPLACED: [(&str, &str); 5] = [
    ("drawn alike", "same distribution? (energy test)"),
    ("alike? p", "same distribution? p"),
    ("new draws", "fresh seeds"),
    (
        "cannot be told apart from the best",
        "in the confidence set",
    ),
    ("indistinguishable set", "confidence set"),
];

#[test]
fn one_thing_has_one_word_and_it_is_that_of_the_field() {
    let python = common::project().join("python");
    let mut texts: Vec<(String, String)> = all_pages()
        .iter()
        .map(|page| (page.display().to_string(), read(page)))
        .collect();
    texts.extend(sources("src"));
    texts.extend(sources("crates"));
    for folder in ["realgap", "notebooks"] {
        for entry in std::fs::read_dir(python.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let ending = path.extension().unwrap_or_default();
            if ["py", "ipynb"].iter().any(|known| ending == *known) {
                texts.push((path.display().to_string(), read(&path)));
            }
        }
    }
    let mut wrong = Vec::new();
    for (place, text) in &texts {
        let text = prose(text).to_lowercase();
        for (before, now) in REPLACED {
            if text.contains(before) {
                wrong.push(format!("{place}: `{before}`, say `{now}`"));
            }
        }
    }
    assert!(texts.len() > 100, "only {} texts", texts.len());
    assert!(wrong.is_empty(), "{wrong:#?}");
}
