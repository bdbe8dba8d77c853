//! A results folder as one page: what its own files say, nothing else.
//!
//! A command has all of it in memory when it writes the folder, and makes the page from that; `realgap report` reads the files
//! of the folder into the same values. One renderer makes the page of both.

pub(in crate::report) mod claim;
mod comparison;
pub(in crate::report) mod content;
mod ensemble;
mod fleet;
mod gap;
mod joint;
pub(in crate::report) mod page_data;
mod path;
mod points;
mod prediction;
mod search;
mod study;
mod summary;
pub(in crate::report) mod tree;

use std::path::Path;

pub use comparison::compared_page;
use content::PageContent;
use ensemble::EnsembleSummary;
use gap::GapSummary;
use page_data::PageData;
use prediction::PredictionSummary;
use search::SearchContent;
use serde::Serialize;
use summary::StudySummary;
use tree::ReportTree;

use super::document::picture::Pictures;
use super::document::section::{Section, numbers, provenance, warnings};
use super::replay::page::stage;
use crate::results::kind::file;
use crate::results::study::data::StudyData;
use crate::results::table::CsvTable;
use crate::results::{History, Kind, SearchSummary, check_seal};
use realgap_core::error::{Error, Result};
use realgap_lab::prediction::{Card, EnsembleReport};

/// What the page of a results folder shows, but for what a command keeps beside it ([`PageData`]).
#[derive(Debug)]
pub struct ResultsPage {
    report: ReportTree,
    findings: Findings,
    pictures: Pictures,
}

/// What was found, by the kind of the results.
#[derive(Debug)]
enum Findings {
    Study(Box<StudySummary>, StudyData),
    Search(Box<SearchContent>),
    Ensemble(Box<EnsembleSummary>),
    Gap(Box<GapSummary>),
    Prediction(Box<PredictionSummary>),
}

/// Reports that folders hold, the first that is there says what the folder is of.
const REPORTS: [&str; 4] = [file::SUMMARY, file::ENSEMBLE, file::GAP, file::PREDICTION];

impl ResultsPage {
    /// The page of a sweep or a tuning.
    pub(crate) fn of_study(
        report: &impl Serialize,
        data: StudyData,
        pictures: Pictures,
    ) -> Result<Self> {
        let report = ReportTree::of_report(report)?;
        let summary = report.typed(Path::new(file::SUMMARY))?;
        Ok(Self {
            report,
            findings: Findings::Study(Box::new(summary), data),
            pictures,
        })
    }

    /// The page of a search with the cards of its finalists.
    pub(crate) fn of_search(
        report: &SearchSummary,
        history: History,
        archive: CsvTable,
        cards: &[(String, Card)],
        pictures: Pictures,
    ) -> Result<Self> {
        let report = ReportTree::of_report(report)?;
        let summary = report.typed(Path::new(file::SUMMARY))?;
        let cards = cards.iter().map(|(name, card)| {
            let card = ReportTree::of_report(card)?.typed(Path::new(name))?;
            Ok((name.clone(), card))
        });
        let content = SearchContent {
            summary,
            history,
            archive,
            cards: cards.collect::<Result<_>>()?,
        };
        Ok(Self {
            report,
            findings: Findings::Search(Box::new(content)),
            pictures,
        })
    }

    /// The page of repeats of a study.
    pub(crate) fn of_ensemble(report: &EnsembleReport, pictures: Pictures) -> Result<Self> {
        let report = ReportTree::of_report(report)?;
        let summary = report.typed(Path::new(file::ENSEMBLE))?;
        Ok(Self {
            report,
            findings: Findings::Ensemble(Box::new(summary)),
            pictures,
        })
    }

    /// The page of a gap, or of noise floors alone.
    pub(crate) fn of_gap(report: &impl Serialize, pictures: Pictures) -> Result<Self> {
        let report = ReportTree::of_report(report)?;
        let summary = report.typed(Path::new(file::GAP))?;
        Ok(Self {
            report,
            findings: Findings::Gap(Box::new(summary)),
            pictures,
        })
    }

    /// The page of a prediction card.
    pub(crate) fn of_prediction(card: &Card, pictures: Pictures) -> Result<Self> {
        let report = ReportTree::of_report(card)?;
        let summary = report.typed(Path::new(file::PREDICTION))?;
        Ok(Self {
            report,
            findings: Findings::Prediction(Box::new(summary)),
            pictures,
        })
    }

    /// What the files of a folder say.
    ///
    /// # Errors
    /// A folder without a report; files that are not what was written there; unreadable ones; a damaged store.
    pub fn read(folder: &Path) -> Result<Self> {
        let Some(file) = REPORTS.iter().find(|name| folder.join(name).is_file()) else {
            return Err(Error::invalid("no finished results here")
                .at_file(folder)
                .allowed("a folder with summary.json, ensemble.json, gap.json or prediction.json")
                .hint(
                    "name a folder that sweep, tune, search, ensemble, gap or predict has written",
                ));
        };
        check_seal(folder)?;
        let path = folder.join(file);
        let report = ReportTree::read(&path)?;
        let (kind, findings) = match *file {
            file::ENSEMBLE => {
                let summary = Box::new(report.typed(&path)?);
                (Kind::Ensemble, Findings::Ensemble(summary))
            }
            file::GAP => (Kind::Gap, Findings::Gap(Box::new(report.typed(&path)?))),
            file::PREDICTION => {
                let summary = Box::new(report.typed(&path)?);
                (Kind::Prediction, Findings::Prediction(summary))
            }
            _ if report.has("search") => {
                let content = SearchContent::read(folder, report.typed(&path)?)?;
                (Kind::Search, Findings::Search(Box::new(content)))
            }
            _ => {
                let summary = Box::new(report.typed(&path)?);
                (
                    Kind::Study,
                    Findings::Study(summary, StudyData::read(folder)?),
                )
            }
        };
        Ok(Self {
            report,
            findings,
            pictures: Pictures::read(folder, kind)?,
        })
    }

    /// The page as HTML. `data` is what the command that wrote the results keeps for the page; `command` is the command that
    /// makes the page.
    pub fn html(&self, data: Option<&PageData>, command: &str) -> String {
        let report = &self.report;
        let mut content = self.content(data);
        content.description = report.scalar("description").unwrap_or_default();
        if let Some(shown) = data.and_then(|data| data.replay.as_ref()) {
            let seen = Section::new("replay", "In motion", stage(&shown.scene));
            let at = content.sections.len().min(2);
            content.sections.insert(at, seen);
        }
        let again = data.map(|data| data.command.as_str());
        let again = again.filter(|text| !text.is_empty());
        let own = Some(command).filter(|page| Some(*page) != again);
        content.sections.extend([
            warnings(report),
            numbers(report, content.shown_fields),
            provenance(report, again, own),
        ]);
        content.html(data)
    }

    fn content(&self, data: Option<&PageData>) -> PageContent {
        let pictures = &self.pictures;
        match &self.findings {
            Findings::Study(summary, found) => study::content(summary, found, pictures, data),
            Findings::Search(found) => search::content(found, pictures),
            Findings::Ensemble(summary) => ensemble::content(summary, pictures),
            Findings::Gap(summary) => gap::content(summary, pictures),
            Findings::Prediction(summary) => prediction::content(summary, pictures),
        }
    }

    /// The verdict and the first sentences of the page.
    #[cfg(test)]
    pub(in crate::report) fn answer(&self) -> String {
        let content = self.content(None);
        let verdict = realgap_lab::claim::verdict(&content.claims).into_iter();
        let verdict = verdict.map(|(_, claim)| claim.text.as_str());
        let all: Vec<&str> = verdict.chain([content.answer.as_str()]).collect();
        all.join(" ")
    }
}

/// The page of a results folder from its files; `command` is the command that makes the page.
///
/// # Errors
/// A folder without a report; files that are not what was written there; unreadable ones; a damaged store.
pub fn folder_page(folder: &Path, command: &str) -> Result<String> {
    let page = ResultsPage::read(folder)?;
    Ok(page.html(PageData::read(folder)?.as_ref(), command))
}
