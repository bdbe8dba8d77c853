//! `history.csv` and `archive.csv`: the same bytes for the same search, however it was run.

use crate::results::table::{CsvTable, number, texts};
use realgap_lab::search::{Archive, Search, SearchResults};

/// One row a robot, in the strategy's order.
pub(super) fn history(search: &Search, results: &SearchResults) -> CsvTable {
    let descriptors = search.strategy().descriptors();
    let mut header = vec![
        "robot",
        "generation",
        "modules",
        "fitness",
        "unit",
        "status",
        "seen",
        "mean_displacement_m",
    ];
    header.extend(&descriptors);
    header.extend(["parents", "genome"]);
    let unit = search.objective().measure.unit().label();
    let rows = results.robots.iter().zip(&results.parents);
    let rows = rows.map(|(robot, parents)| {
        let (status, seen) = robot.failure().map_or(("walked", ""), |failure| {
            (failure.reason.code(), failure.seen.as_str())
        });
        let mut row = vec![
            robot.index.to_string(),
            results.batch_of(robot.index).to_string(),
            robot.genome.len().to_string(),
            number(robot.fitness()),
            unit.to_owned(),
            status.to_owned(),
            seen.split_whitespace().collect::<Vec<_>>().join(" "),
            number(robot.mean_displacement_m()),
        ];
        let values = robot.performance().map_or(&[][..], |p| &p.descriptors);
        row.extend((0..descriptors.len()).map(|index| number(values.get(index).copied())));
        let parents: Vec<String> = parents.iter().map(usize::to_string).collect();
        let genes = robot.genome.genes().iter().flat_map(|gene| gene.values());
        let genes: Vec<String> = genes.map(f64::to_string).collect();
        row.extend([parents.join(" "), genes.join(" ")]);
        row
    });
    CsvTable::new(&header, rows)
}

/// One row an elite.
pub(super) fn archive(search: &Search, results: &SearchResults, archive: &Archive) -> CsvTable {
    let axes = archive.axes();
    let cells: Vec<String> = axes.iter().map(|a| format!("{}_cell", a.name)).collect();
    let mut header: Vec<&str> = cells.iter().map(String::as_str).collect();
    header.extend(axes.iter().map(|axis| axis.name.as_str()));
    header.extend(["robot", "fitness", "unit"]);
    let unit = search.objective().measure.unit().label();
    let elites = archive.elites();
    let rows = elites.iter().map(|(along, elite)| {
        let robot = &results.robots[*elite];
        let mut row: Vec<String> = along.iter().map(usize::to_string).collect();
        let values = robot.performance().map_or(&[][..], |p| &p.descriptors);
        row.extend(texts(values));
        let (index, fitness) = (robot.index.to_string(), number(robot.fitness()));
        row.extend([index, fitness, unit.to_owned()]);
        row
    });
    CsvTable::new(&header, rows)
}

/// One robot of a search.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HistoryRow {
    /// Number of the batch in which the strategy proposed it.
    pub batch: String,
    /// Number of its modules.
    pub modules: String,
    /// Its fitness; `None` where it failed.
    pub fitness: Option<f64>,
    /// Numbers of its parents, a blank between two; empty for a robot that was drawn.
    pub parents: String,
}

/// The robots of a search in their order.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct History(pub Vec<HistoryRow>);

impl History {
    /// The robots in a table.
    pub(crate) fn of(table: &CsvTable) -> Self {
        let [batches, modules, parents] =
            ["generation", "modules", "parents"].map(|name| table.texts(name));
        let text = |column: &[&str], row: usize| (*column.get(row).unwrap_or(&"")).to_owned();
        let fitness = table.numbers("fitness").into_iter();
        let rows = fitness.enumerate().map(|(row, fitness)| HistoryRow {
            batch: text(&batches, row),
            modules: text(&modules, row),
            fitness: Some(fitness).filter(|fitness| fitness.is_finite()),
            parents: text(&parents, row),
        });
        Self(rows.collect())
    }
}
