//! Sections of a page, and the sections that every page has.

use crate::plot::{Inline, InlineChart, LinePlot, legend};
use crate::report::document::page::html;
use crate::report::document::value::folded;
use crate::report::document::value::*;
use crate::report::folder::tree::ReportTree;
use realgap_core::warning::Code;

/// A part of a page with a name in its contents.
#[derive(Debug, Clone)]
pub(in crate::report) struct Section {
    /// Target of the link in the contents.
    pub id: &'static str,
    /// Title, also in the contents.
    pub title: &'static str,
    /// The HTML below the title; empty where the section is left out.
    pub html: String,
}

impl Section {
    /// A section; empty content leaves it out.
    pub fn new(id: &'static str, title: &'static str, html: impl Into<Option<String>>) -> Self {
        let html = html.into().unwrap_or_default();
        Self { id, title, html }
    }
}

/// Sections one after the other.
pub(in crate::report) fn body(sections: &[Section]) -> String {
    let there = sections.iter().filter(|section| !section.html.is_empty());
    let there = there.map(|Section { id, title, html }| {
        format!("<section class=\"card\" id=\"{id}\"><h2>{title}</h2>{html}</section>\n")
    });
    there.collect()
}

/// Links to the sections.
pub(in crate::report) fn contents(sections: &[Section]) -> String {
    let there = sections.iter().filter(|section| !section.html.is_empty());
    let link =
        |Section { id, title, .. }: &Section| format!("<li><a href=\"#{id}\">{title}</a></li>");
    let links: String = there.map(link).collect();
    format!("<nav class=\"contents\" aria-label=\"Contents\"><ol>{links}</ol></nav>")
}

/// A figure with a chart and a caption.
pub(in crate::report) fn figure(title: &str, chart: &str, caption: &str) -> String {
    format!(
        "<figure><h3>{}</h3>{chart}<figcaption>{}</figcaption></figure>",
        html(title),
        html(caption)
    )
}

/// A figure with a chart, its legend and a caption.
pub(in crate::report) fn chart_figure(
    title: &str,
    plot: &LinePlot,
    inline: &Inline<'_>,
    caption: &str,
) -> String {
    let chart = plot.inline(inline) + &legend(plot);
    figure(title, &chart, caption)
}

/// Several figures beside each other, where there is room.
pub(in crate::report) fn figures(all: &[String]) -> String {
    format!("<div class=\"figures\">{}</div>", all.concat())
}

/// An element with this content; nothing for empty content.
pub(in crate::report) fn within(tag: &str, content: String) -> String {
    match content.as_str() {
        "" => content,
        _ => format!("<{tag}>{content}</{tag}>"),
    }
}

/// The warnings of a report and of its parts, each with its remedy.
pub(in crate::report) fn warnings(report: &ReportTree) -> Section {
    warning_section(pairs_of(&report.warnings()))
}

/// More messages of one kind than this are folded away.
const MESSAGES: usize = 3;

/// Warnings by code and message: all messages of one code are one item, with the remedy of the code.
pub(in crate::report) fn warning_section<'a>(
    all: impl Iterator<Item = (&'a str, &'a str)>,
) -> Section {
    let mut kinds: Vec<(&str, Vec<&str>)> = Vec::new();
    for (code, message) in all {
        match kinds.iter_mut().find(|(known, _)| *known == code) {
            Some((_, messages)) if messages.contains(&message) => {}
            Some((_, messages)) => messages.push(message),
            None => kinds.push((code, vec![message])),
        }
    }
    let items = kinds.into_iter().map(|(code, messages)| {
        let remedy = Code::by_name(code).map_or_else(String::new, |code| {
            let remedy = html(code.remedy());
            format!("<span class=\"remedy\">What to do: {remedy}.</span>")
        });
        let code = html(code);
        let list = |messages: &[&str]| -> String {
            let lines = messages.iter().map(|m| format!("<p>{}</p>", html(m)));
            lines.collect()
        };
        let said = match messages.split_at(messages.len().min(MESSAGES)) {
            ([one], []) => html(one),
            (all, []) => list(all),
            (first, rest) => list(first) + &folded(&format!("{} more", rest.len()), &list(rest)),
        };
        format!("<li><code>{code}</code> {said} {remedy}</li>")
    });
    Section::new("warnings", "Warnings", within("ul", items.collect()))
}

/// Numbers of the report that no other section holds.
pub(in crate::report) fn numbers(report: &ReportTree, shown_elsewhere: &str) -> Section {
    let always = "description provenance warnings engine version";
    let others = shown_elsewhere.split(' ').chain(always.split(' '));
    let all = report.scalars(&others.collect::<Vec<_>>());
    Section::new("numbers", "Numbers", within("dl", entries(pairs_of(&all))))
}

/// Versions, settings, hashes, and the command that computes the results again.
pub(in crate::report) fn provenance(
    report: &ReportTree,
    command: Option<&str>,
    page: Option<&str>,
) -> Section {
    let named = |name: &str, text: Option<String>| Some((name.to_owned(), text?));
    let mut pairs = Vec::from_iter(named("run it again", command.map(str::to_owned)));
    let own = ["engine", "version", "seed"].into_iter();
    pairs.extend(own.filter_map(|name| {
        let shown = if name == "version" { "realgap" } else { name };
        named(shown, report.scalar(name))
    }));
    pairs.extend(report.provenance());
    pairs.extend(named("this page", page.map(str::to_owned)));
    let shown = within("dl", entries(pairs_of(&pairs)));
    Section::new("provenance", "How this was made", shown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_of_one_kind_are_one_item_with_its_remedy() {
        let section = warning_section([("few-recordings", "<2>"); 2].into_iter());
        assert_eq!(section.html.matches("<li>").count(), 1);
        assert!(section.html.contains(Code::FewRecordings.remedy()));
        assert!(!section.html.contains("<2>"));
        // The same of several recordings is one warning, its remedy said once.
        let of = ["run 0", "run 1", "run 2", "run 3", "run 4"];
        let html = warning_section(of.map(|run| ("few-recordings", run)).into_iter()).html;
        assert_eq!(html.matches("<li>").count(), 1);
        assert_eq!(html.matches("What to do").count(), 1);
        assert!(html.contains("run 4") && html.contains("<summary>2 more</summary>"));
    }
}
