//! docs/cli.md: the help of every command on one page.

use std::collections::{BTreeMap, BTreeSet};

use clap::{Arg, Command, CommandFactory as _, Parser as _};
use realgap::warning::Code;

use super::committed::must_hold;
use super::{Cli, NOTES, QUESTIONS};

/// Widest line of prose.
const WIDTH: usize = 100;
/// An option is described once for all commands where at least this many commands or groups have it with the same help.
const COMMON: usize = 3;

const HEAD: &str = "\
# The command line

This page is generated from the commands; it has the text of `realgap --help` and
`realgap COMMAND --help`. [docs/results.md][docs/results.md] explains what commands print and write,
[docs/start.md][docs/start.md] which command answers which question.

";

const WARNINGS: &str = "\
## Warnings

A warning is one sentence and a stable code; it is printed on standard error and stands in every
JSON. Pages show what to do about each.

| code | what it says | what to do about it |
|---|---|---|
";

/// An option or argument as the page shows it: a row of a table, below the heading of its help.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Row {
    heading: Option<String>,
    name: String,
    help: String,
}

impl Row {
    fn of(arg: &Arg) -> Self {
        let name = match (arg.get_short(), arg.get_long()) {
            (Some(short), Some(_)) => format!("-{short}, {arg}"),
            _ => arg.to_string(),
        };
        Self {
            heading: arg.get_help_heading().map(ToOwned::to_owned),
            name,
            help: help_of(arg),
        }
    }

    fn line(&self) -> String {
        let name = self.name.replace('|', "\\|");
        format!("| `{name}` | {} |\n", self.help.replace('|', "\\|"))
    }

    /// The option's long name, for lists.
    fn short(&self) -> String {
        let mut words = self.name.split([' ', '[', '=']);
        let name = words.find(|word| word.starts_with("--"));
        format!("`{}`", name.unwrap_or(&self.name))
    }
}

/// What an option means, its choices and its default, as Markdown.
fn help_of(arg: &Arg) -> String {
    let said = arg.get_long_help().or_else(|| arg.get_help());
    let said = said.map(ToString::to_string).unwrap_or_default();
    let mut text = match said.split_once("[default: ") {
        Some((before, rest)) => {
            let (default, after) = rest.split_once(']').unwrap_or((rest, ""));
            let default = format!("{}. Default: {default}{after}", before.trim_end());
            marked(&default)
        }
        None => marked(&said),
    };
    let takes_values = arg.get_action().takes_values();
    if takes_values && !arg.is_hide_possible_values_set() {
        let mut choices = Vec::new();
        for value in arg
            .get_possible_values()
            .iter()
            .filter(|v| !v.is_hide_set())
        {
            let meaning = value
                .get_help()
                .map(|help| format!(" ({})", marked(&help.to_string())));
            choices.push(format!(
                "`{}`{}",
                value.get_name(),
                meaning.unwrap_or_default()
            ));
        }
        if !choices.is_empty() {
            text += &format!(". One of {}", choices.join(", "));
        }
    }
    let defaults = arg.get_default_values();
    if takes_values && !defaults.is_empty() {
        let words: Vec<String> = defaults
            .iter()
            .map(|d| format!("`{}`", d.display()))
            .collect();
        text += &format!(". Default: {}", words.join(" "));
    }
    text
}

/// Plain words as Markdown: options, file names and words with signs of Markdown become code, pages become links.
fn marked(text: &str) -> String {
    let mut is_code = false;
    let mut words = Vec::new();
    for word in text.split_whitespace() {
        let was_code = is_code;
        is_code ^= word.matches('`').count() % 2 == 1;
        let core = word.trim_matches(|c| "()[],.;:!?'".contains(c));
        let is_page = core.starts_with("docs/") && core.ends_with(".md");
        let is_option = core.starts_with('-') && core.len() > 1;
        let is_technical = core.contains(['<', '>', '*', '_', '{', '|', '[', '~', '=']);
        words.push(if was_code || word.contains('`') || core.is_empty() {
            word.to_owned()
        } else if is_page {
            word.replace(core, &format!("[{core}][{core}]"))
        } else if is_option || is_technical {
            word.replacen(core, &format!("`{core}`"), 1)
        } else {
            word.replace('[', "\\[")
        });
    }
    words.join(" ")
}

/// Prose in lines of at most [`WIDTH`] characters, none of which begins like a list.
fn wrapped(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.last().map_or(0, |line| line.chars().count());
        let begins_list = ["-", "+", "*", "#", "="].contains(&word);
        if last > 0 && last + 1 + word.chars().count() > WIDTH && !begins_list {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            *line += if line.is_empty() { "" } else { " " };
            *line += word;
        }
    }
    lines.join("\n") + "\n"
}

/// The help text of clap as Markdown: paragraphs, and blocks of indented lines below a heading line.
fn prose(text: &str) -> String {
    let mut page = String::new();
    let paragraphs = text.split("\n\n").map(str::trim_end);
    for paragraph in paragraphs.filter(|text| !text.is_empty()) {
        let (first, indented) = paragraph.split_once("\n  ").unwrap_or((paragraph, ""));
        if indented.is_empty() {
            page += &format!("{}\n", wrapped(&marked(first)));
            continue;
        }
        let is_example = first == "Examples:";
        if !is_example {
            page += &format!("{}\n", wrapped(&marked(first)));
        }
        let language = if is_example { "sh" } else { "text" };
        let block = indented.replace("\n  ", "\n");
        page += &format!("```{language}\n{block}\n```\n\n");
    }
    page
}

fn table(rows: &[&Row]) -> String {
    let lines: String = rows.iter().map(|row| row.line()).collect();
    format!("| | |\n|---|---|\n{lines}\n")
}

/// The Markdown heading for a heading of the help.
fn title(heading: Option<&str>) -> &str {
    heading.map_or("Options of many commands", |heading| {
        heading.split(" (").next().unwrap_or(heading)
    })
}

fn anchor(title: &str) -> String {
    title.to_lowercase().replace(' ', "-")
}

/// A command with its full name.
struct Page {
    name: String,
    depth: usize,
    command: Command,
    rows: Vec<Row>,
}

/// Every command; the commands of a group follow after it.
fn pages(parent: &Command, path: &str, depth: usize, found: &mut Vec<Page>) {
    for command in parent.get_subcommands().filter(|c| c.get_name() != "help") {
        let name = format!("{path}{}", command.get_name());
        let shown = command.get_arguments().filter(|arg| {
            !arg.is_hide_set() && !["help", "version"].contains(&arg.get_id().as_str())
        });
        found.push(Page {
            depth,
            command: command.clone(),
            rows: shown.map(Row::of).collect(),
            name: name.clone(),
        });
        pages(command, &format!("{name} "), depth + 1, found);
    }
}

impl Page {
    fn about(&self) -> String {
        self.command
            .get_about()
            .map(ToString::to_string)
            .unwrap_or_default()
    }

    fn is_group(&self) -> bool {
        self.command.has_subcommands()
    }

    /// The help of the command below its first line.
    fn text(&mut self, common: &BTreeSet<Row>) -> String {
        let about = self.about();
        let mut text = format!("{} `{}`\n\n", "#".repeat(self.depth), self.name);
        text += &format!(
            "{}\n",
            wrapped(&format!("{}.", marked(&about)).replace("?.", "?"))
        );
        if let Some(examples) = self.command.get_after_help() {
            text += &prose(&examples.to_string());
        }
        let long = self.command.get_long_about().map(ToString::to_string);
        let rest = long.and_then(|long| long.strip_prefix(&about).map(str::to_owned));
        text += &prose(rest.unwrap_or_default().trim_start_matches(['.', '\n']));
        if self.is_group() {
            return text;
        }
        let usage = self.command.render_usage().to_string();
        text += &format!("```text\n{}\n```\n\n", usage.trim_start_matches("Usage: "));
        let own: Vec<&Row> = self
            .rows
            .iter()
            .filter(|row| !common.contains(row))
            .collect();
        if !own.is_empty() {
            text += &table(&own);
        }
        text += &self.shared(common);
        text
    }

    /// Links to the options that are described once for all commands; by their heading where the command has all of that heading.
    fn shared(&self, common: &BTreeSet<Row>) -> String {
        let is_global = |row: &Row| row.name == "--force";
        let mut names = Vec::new();
        for heading in headings(common) {
            let all: Vec<&Row> = common.iter().filter(|row| row.heading == heading).collect();
            let here: Vec<&Row> = self
                .rows
                .iter()
                .filter(|row| all.contains(row) && !is_global(row))
                .collect();
            if heading.is_some() && here.len() == all.len() {
                let title = title(heading.as_deref());
                names.push(format!("[{}](#{})", title.to_lowercase(), anchor(title)));
            } else {
                names.extend(here.iter().map(|row| row.short()));
            }
        }
        if names.is_empty() {
            return String::new();
        }
        format!("{}\n", wrapped(&format!("Also: {}.", names.join(", "))))
    }
}

fn headings(rows: &BTreeSet<Row>) -> BTreeSet<Option<String>> {
    rows.iter().map(|row| row.heading.clone()).collect()
}

/// The rows of options that many commands have with the same help.
fn common(pages: &[Page]) -> BTreeSet<Row> {
    let mut users: BTreeMap<Row, BTreeSet<&str>> = BTreeMap::new();
    for page in pages.iter().filter(|page| !page.is_group()) {
        let first = page.name.split(' ').next().unwrap_or_default();
        for row in page.rows.iter().filter(|row| row.name.contains("--")) {
            users.entry(row.clone()).or_default().insert(first);
        }
    }
    let many = users.into_iter().filter(|(_, users)| users.len() >= COMMON);
    many.map(|(row, _)| row).collect()
}

/// The tables of commands, by question and by group.
fn contents(pages: &[Page]) -> String {
    let mut text = String::from("## Commands\n");
    let line = |page: &Page| {
        let anchor = anchor(&page.name);
        format!(
            "| [`realgap {}`](#{anchor}) | {} |\n",
            page.name,
            marked(&page.about()).replace('|', "\\|")
        )
    };
    for page in pages
        .iter()
        .filter(|page| page.depth == 2 && !page.command.is_hide_set())
    {
        for (_, question) in QUESTIONS.iter().filter(|(first, _)| *first == page.name) {
            text += &format!("\n{question}\n\n| | |\n|---|---|\n");
        }
        text += &line(page);
    }
    for group in pages
        .iter()
        .filter(|page| page.depth == 2 && page.is_group())
    {
        text += &format!("\n`realgap {}`:\n\n| | |\n|---|---|\n", group.name);
        let inside = format!("{} ", group.name);
        let leaves = pages
            .iter()
            .filter(|page| page.name.starts_with(&inside) && !page.is_group());
        text += &leaves.map(line).collect::<String>();
    }
    text += "\nNot in the list of `realgap --help`:\n\n| | |\n|---|---|\n";
    let unlisted = pages.iter().filter(|page| page.command.is_hide_set());
    text += &unlisted.map(line).collect::<String>();
    text + "\n"
}

/// The page.
fn reference() -> String {
    let mut root = Cli::command();
    root.build();
    let mut all = Vec::new();
    pages(&root, "", 2, &mut all);
    let common = common(&all);
    let mut text = HEAD.to_owned() + &contents(&all);
    text += "## Common options\n\n";
    text += &prose(NOTES);
    for heading in headings(&common) {
        let rows: Vec<&Row> = common.iter().filter(|row| row.heading == heading).collect();
        text += &format!("### {}\n\n{}", title(heading.as_deref()), table(&rows));
    }
    for page in &mut all {
        text += &page.text(&common);
    }
    text += WARNINGS;
    for code in Code::ALL {
        let about = marked(code.about().trim_end_matches('.'));
        text += &format!(
            "| `{}` | {about} | {} |\n",
            code.name(),
            marked(code.remedy())
        );
    }
    let links = links(&text);
    text + "\n" + &links
}

/// Link definitions of the pages that the text names.
fn links(text: &str) -> String {
    let named = text
        .split("][")
        .skip(1)
        .filter_map(|rest| rest.split(']').next());
    let named: BTreeSet<&str> = named.collect();
    let lines = named
        .iter()
        .map(|name| format!("[{name}]: {}\n", name.trim_start_matches("docs/")));
    lines.collect()
}

#[test]
fn the_page_of_the_command_line_equals_the_help_of_the_commands() {
    must_hold("docs/cli.md", &reference(), "--bin realgap reference");
}

#[test]
fn every_example_is_parsed() {
    let mut root = Cli::command();
    root.build();
    let mut all = Vec::new();
    pages(&root, "", 2, &mut all);
    let mut count = 0;
    for page in all.iter().filter(|page| !page.is_group()) {
        let help = page.command.get_after_help().map(ToString::to_string);
        let help = help.unwrap_or_default().replace("\\\n", " ");
        let mut own = 0;
        for line in help.lines().filter(|line| line.starts_with("  realgap ")) {
            let words = line.split(['#', '>']).next().unwrap_or_default();
            let words: Vec<String> = words
                .split_whitespace()
                .map(|w| w.replace('\'', ""))
                .collect();
            let parsed = Cli::try_parse_from(&words);
            assert!(parsed.is_ok(), "{line}: {:?}", parsed.err());
            own += usize::from(line.contains(&format!("realgap {}", page.name)));
            count += 1;
        }
        assert!(own > 0, "{} has no example", page.name);
    }
    assert!(count > 50, "{count}");
}
