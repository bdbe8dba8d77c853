//! `realgap study results`: lists the rows of a results folder.

use realgap::Advice;
use realgap::file::{Seal, versioned_json};
use realgap::plot::number;
use realgap::results::{RankedPoints, check_seal, ranked_points};
use realgap::store::{Cell, FolderLock, Listing};
use realgap::text::{cell, shown};

use super::kit::*;

/// List the points or robots of a results folder, also while a run is still writing into it
///
/// Use it to look at all trials of a sweep, a tuning or a search, or to hand them to another program. Everything
/// comes from the folder's results.sqlite; the files of the study or search are not needed. Every row is compared
/// with its checksum, and then the folder's other files with theirs. The table for people has one row a point, ranked
/// by its mean over all equally valid settings as in the page; --runs, another format or another order lists the single
/// runs, each with one setting.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap study results results/tripod_floor_cma-es --top 5
  realgap study results results/tripod_floor --format csv -o trials.csv")]
pub struct Results {
    /// A folder that sweep, tune or search has written, e.g. results/tripod_floor
    folder: PathBuf,
    /// Column to sort by, smallest first [default: best first, by score or fitness]
    #[arg(long, value_name = "COLUMN")]
    sort: Option<String>,
    /// Only the first N rows after sorting
    #[arg(long, value_name = "N")]
    top: Option<usize>,
    /// List single runs, each with one setting, in place of points
    #[arg(long)]
    runs: bool,
    /// Add one column per recording
    #[arg(long)]
    per_recording: bool,
    /// How to print
    #[arg(long, value_enum, default_value_t)]
    format: ResultsFormat,
    /// File to write to instead of standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
enum ResultsFormat {
    /// A table for people
    #[default]
    Table,
    /// Comma-separated values
    Csv,
    /// An array of objects
    Json,
    /// A Parquet file (needs --output)
    Parquet,
}

impl Results {
    pub fn run(self) -> Result<()> {
        let listing = Listing::read(&self.folder).map_err(|error| match error.advice() {
            [Advice::Resume] => error,
            // This command only reads, so advice to choose another folder does not apply.
            _ => error.without_advice(),
        })?;
        let mut listing = listing.sorted(self.sort.as_deref())?;
        if !self.per_recording {
            listing = listing.without_details();
        }
        let rows = listing.rows.len();
        listing.rows.truncate(self.top.unwrap_or(usize::MAX));
        let is_of_points = !self.runs && self.sort.is_none() && !self.per_recording;
        let points = match is_of_points && matches!(self.format, ResultsFormat::Table) {
            true => ranked_points(&self.folder)?,
            false => None,
        };
        let bytes = match self.format {
            ResultsFormat::Table => match points.filter(|_| listing.complete) {
                Some(points) => table_of_points(&listing, points, self.top).into_bytes(),
                None => table(&listing, rows).into_bytes(),
            },
            ResultsFormat::Csv => csv(&listing)?,
            ResultsFormat::Json => json(&listing)?.into_bytes(),
            ResultsFormat::Parquet => parquet(&listing, self.output.as_deref())?,
        };
        match &self.output {
            Some(path) => output::write(path, &bytes)?,
            None => terminal::print(String::from_utf8_lossy(&bytes).trim_end()),
        }
        // The rows come from the store, so they are printed before the other files are checked.
        match Seal::read(&self.folder) {
            _ if FolderLock::is_held(&self.folder) => Ok(()),
            Ok(None) => Ok(()),
            _ => check_seal(&self.folder),
        }
    }
}

/// Longest text in a table; the store may come from an untrusted source.
const SHOWN: usize = 120;

fn table(listing: &Listing, rows: usize) -> String {
    let names: Vec<String> = listing
        .columns
        .iter()
        .map(|c| shown(&c.name, SHOWN))
        .collect();
    let mut table = TextTable::new(names.iter().map(|name| (name.as_str(), Side::Right)));
    for row in &listing.rows {
        table.push(row.iter().map(|cell| match cell {
            Cell::Number(Some(value)) => number(*value),
            other => shown(&other.text(), SHOWN),
        }));
    }
    let state = match (listing.complete, listing.asked) {
        (true, _) => "complete".to_owned(),
        (false, Some(asked)) => format!("{rows} of {} so far", counted(asked, "row")),
        (false, None) => "unfinished".to_owned(),
    };
    format!(
        "{} of {}, {state}, {}\n{}",
        shown(&listing.kind, SHOWN),
        shown(&listing.name, SHOWN),
        shown(&listing.measure, SHOWN),
        terminal::table(&table)
    )
}

/// The points, with their means over all settings.
fn table_of_points(
    listing: &Listing,
    RankedPoints { header, rows }: RankedPoints,
    top: Option<usize>,
) -> String {
    let mut table = TextTable::new(header.iter().map(|name| (name.as_str(), Side::Right)));
    let count = rows.len();
    for row in rows.into_iter().take(top.unwrap_or(usize::MAX)) {
        table.push(row.iter().map(|text| match text.parse::<f64>() {
            Ok(value) => number(value),
            Err(_) => shown(text, SHOWN),
        }));
    }
    format!(
        "{} of {}, complete, {}, {}: first those simulated with all settings; --runs lists single runs\n{}",
        shown(&listing.kind, SHOWN),
        shown(&listing.name, SHOWN),
        shown(&listing.measure, SHOWN),
        counted(count, "point"),
        terminal::table(&table)
    )
}

fn csv(listing: &Listing) -> Result<Vec<u8>> {
    let fail = |e: csv::Error| Error::invalid(format!("cannot write the table: {e}"));
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer
        .write_record(
            listing
                .columns
                .iter()
                .map(|column| cell(&column.name).into_owned()),
        )
        .map_err(fail)?;
    for row in &listing.rows {
        writer
            .write_record(row.iter().map(|value| cell(&value.text()).into_owned()))
            .map_err(fail)?;
    }
    writer
        .into_inner()
        .map_err(|e| Error::invalid(format!("cannot write the table: {e}")))
}

#[cfg(feature = "parquet")]
fn parquet(listing: &Listing, output: Option<&Path>) -> Result<Vec<u8>> {
    let Some(path) = output else {
        return Err(Error::usage("Parquet cannot be printed as text")
            .field("--format parquet")
            .hint("name a file with --output trials.parquet"));
    };
    realgap::store::to_parquet(listing, path)
}

#[cfg(not(feature = "parquet"))]
fn parquet(_listing: &Listing, _output: Option<&Path>) -> Result<Vec<u8>> {
    Err(
        Error::usage("this program was built without the feature `parquet`")
            .field("--format parquet")
            .hint(
                "build it with its default features (`cargo build --release`), or use --format csv",
            ),
    )
}

/// A trial: its columns by name.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrialRow(serde_json::Map<String, serde_json::Value>);

fn json(listing: &Listing) -> Result<String> {
    let rows = listing.rows.iter().map(|row| {
        let names = listing.columns.iter().map(|column| column.name.clone());
        TrialRow(names.zip(row.iter().map(Cell::json)).collect())
    });
    versioned_json(&rows.collect::<Vec<_>>())
}
