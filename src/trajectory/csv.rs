//! CSV with a header: `t_s,x_m,y_m[,z_m][,qw,qx,qy,qz][,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s]`.

use std::collections::HashMap;

use super::Trajectory;
use super::format::{Format, Parsed, Rendered};
use super::sample::{Layout, Samples};
use super::text::{Cell, Separator, cut, excerpt, push_number};
use crate::error::{Advice, Error, Result};
use crate::unit::LengthUnit;
use crate::warning::{Code, Warning};

const QUATERNION: [&str; 4] = ["qw", "qx", "qy", "qz"];
const LINEAR: [&str; 3] = ["vx", "vy", "vz"];
const ANGULAR: [&str; 3] = ["wx_rad_s", "wy_rad_s", "wz_rad_s"];

/// Comma-separated values with a header; columns in any order, extra ones ignored with a warning.
///
/// Units are in the column names. Without z the trajectory is planar. Quaternions: real part first,
/// world from body. Linear velocity in the world frame, angular velocity in the body frame.
///
/// Files that are not in metres are read with [`LengthUnit::Centimetre`] or
/// [`LengthUnit::Millimetre`]: then every length and linear velocity is scaled, and its column may be called
/// `x_m`, `x_cm` (or `x_mm`), or plainly `x`; likewise `vx_m_s`, `vx_cm_s`, `vx`.
#[derive(Debug, Clone, Copy)]
pub struct Csv;

impl Format for Csv {
    fn name(&self) -> &'static str {
        "csv"
    }

    fn doc(&self) -> &'static str {
        "comma-separated values with a header that names columns and units"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["csv"]
    }

    fn parse(&self, text: &str, unit: LengthUnit) -> Result<Parsed> {
        let mut table = Table::open(text, unit, &[])?;
        let mut samples = Samples::new(unit);
        while let Some((line, cells)) = table.rows.next()? {
            samples.push(&table.layout, cells, line)?;
        }
        let (trajectory, mut warnings) = samples.finish(&table.layout)?;
        warnings.splice(0..0, table.warnings);
        Ok(Parsed {
            trajectory,
            warnings,
        })
    }

    fn columns<'a>(&self, text: &'a str) -> Vec<&'a str> {
        let mut cells = Vec::new();
        let header = text.lines().find(|line| !line.trim().is_empty());
        match cut(header.unwrap_or_default(), 1, Separator::Comma, &mut cells) {
            Ok(()) => cells.iter().map(|cell| cell.text).collect(),
            // Reading the samples will say what is wrong with the header.
            Err(_) => Vec::new(),
        }
    }

    fn parse_groups(
        &self,
        text: &str,
        unit: LengthUnit,
        group_columns: &[&str],
    ) -> Result<Vec<(Vec<String>, Parsed)>> {
        let mut table = Table::open(text, unit, group_columns)?;
        let mut groups: Vec<(Vec<String>, Samples)> = Vec::new();
        let mut index_of: HashMap<Vec<String>, usize> = HashMap::new();
        let mut current: Option<usize> = None;
        let key_columns = table.group_columns.clone();
        while let Some((line, cells)) = table.rows.next()? {
            let value = |&column: &usize| cells.get(column).map_or("", |cell: &Cell<'_>| cell.text);
            let same = current.is_some_and(|index| {
                let values = key_columns.iter().map(value);
                groups[index].0.iter().map(String::as_str).eq(values)
            });
            let index = match current {
                Some(index) if same => index,
                _ => {
                    let key: Vec<String> =
                        key_columns.iter().map(value).map(str::to_owned).collect();
                    *index_of.entry(key).or_insert_with_key(|key| {
                        groups.push((key.clone(), Samples::new(unit)));
                        groups.len() - 1
                    })
                }
            };
            current = Some(index);
            groups[index].1.push(&table.layout, cells, line)?;
        }
        if groups.is_empty() {
            return Err(Error::invalid("too few points for a trajectory")
                .at_line(1, 1)
                .found("no sample")
                .allowed("at least 2 samples"));
        }
        let mut parsed = Vec::with_capacity(groups.len());
        for (key, samples) in groups {
            let (trajectory, mut warnings) = samples
                .finish(&table.layout)
                .map_err(|error| error.field(format!("group {}", key.join("/"))))?;
            warnings.splice(0..0, table.warnings.iter().cloned());
            parsed.push((
                key,
                Parsed {
                    trajectory,
                    warnings,
                },
            ));
        }
        Ok(parsed)
    }

    fn render(&self, trajectory: &Trajectory) -> Rendered {
        let mut header = vec!["t_s", "x_m", "y_m"];
        let orientations = trajectory.orientations_world_from_body();
        let velocities = trajectory
            .velocities_world_m_s()
            .zip(trajectory.angular_velocities_body_rad_s());
        if !trajectory.is_planar() {
            header.push("z_m");
        }
        if orientations.is_some() {
            header.extend(QUATERNION);
        }
        if velocities.is_some() {
            header.extend(["vx_m_s", "vy_m_s", "vz_m_s"]);
            header.extend(ANGULAR);
        }
        let mut text = header.join(",");
        text.push('\n');
        let dimensions = if trajectory.is_planar() { 2 } else { 3 };
        for (index, (time_s, position)) in trajectory
            .times_s()
            .iter()
            .zip(trajectory.positions_world_m())
            .enumerate()
        {
            push_number(&mut text, *time_s);
            let mut push = |value: f64| {
                text.push(',');
                push_number(&mut text, value);
            };
            position
                .iter()
                .take(dimensions)
                .copied()
                .for_each(&mut push);
            if let Some(q) = orientations.map(|all| all[index]) {
                [q.w, q.i, q.j, q.k].into_iter().for_each(&mut push);
            }
            if let Some((linear, angular)) = velocities {
                linear[index].iter().copied().for_each(&mut push);
                angular[index].iter().copied().for_each(&mut push);
            }
            text.push('\n');
        }
        Rendered {
            text,
            warnings: Vec::new(),
        }
    }
}

/// A CSV text whose header has been understood.
struct Table<'a> {
    rows: Rows<'a>,
    layout: Layout,
    group_columns: Vec<usize>,
    warnings: Vec<Warning>,
}

impl<'a> Table<'a> {
    fn open(text: &'a str, unit: LengthUnit, group_columns: &[&str]) -> Result<Self> {
        let mut lines = text.lines().enumerate();
        let Some((index, header)) = lines.by_ref().find(|(_, line)| !line.trim().is_empty()) else {
            return Err(Error::invalid("the file is empty")
                .at_line(1, 1)
                .allowed("a header such as t_s,x_m,y_m and at least 2 samples"));
        };
        let mut cells = Vec::new();
        cut(header, index + 1, Separator::Comma, &mut cells)?;
        let mut columns = Header::new(&cells, unit)?;
        let layout = columns.layout(group_columns)?;
        let groups = group_columns
            .iter()
            .map(|name| columns.required(&[(*name).to_owned()]))
            .collect::<Result<_>>()?;
        let warnings = columns.ignored_warning().into_iter().collect();
        Ok(Self {
            rows: Rows { lines, cells },
            layout,
            group_columns: groups,
            warnings,
        })
    }
}

/// The lines below the header.
struct Rows<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    cells: Vec<Cell<'a>>,
}

impl<'a> Rows<'a> {
    /// The next line that is not blank, with its number from 1.
    fn next(&mut self) -> Result<Option<(usize, &[Cell<'a>])>> {
        for (index, line) in self.lines.by_ref() {
            if !line.trim().is_empty() {
                cut(line, index + 1, Separator::Comma, &mut self.cells)?;
                return Ok(Some((index + 1, &self.cells)));
            }
        }
        Ok(None)
    }
}

/// The names in the first line, and which of them are already used.
struct Header<'c, 'a> {
    cells: &'c [Cell<'a>],
    used: Vec<bool>,
    unit: LengthUnit,
}

impl<'c, 'a> Header<'c, 'a> {
    fn new(cells: &'c [Cell<'a>], unit: LengthUnit) -> Result<Self> {
        for (index, cell) in cells.iter().enumerate() {
            // Numbers are no names: the missing header is reported instead.
            let name = !cell.text.is_empty() && cell.text.parse::<f64>().is_err();
            if name && cells[..index].iter().any(|other| other.text == cell.text) {
                return Err(cell.locate(
                    Error::invalid("two columns have the same name").found(excerpt(cell.text)),
                ));
            }
        }
        Ok(Self {
            cells,
            used: vec![false; cells.len()],
            unit,
        })
    }

    fn layout(&mut self, group_columns: &[&str]) -> Result<Layout> {
        let time = self.required(&["t_s".to_owned()])?;
        let x = self.required(&self.length_names("x", ""))?;
        let y = self.required(&self.length_names("y", ""))?;
        let z = self.optional(&self.length_names("z", ""))?;
        let quaternion = self.complete(&QUATERNION.map(|name| vec![name.to_owned()]))?;
        let linear = self.complete(&LINEAR.map(|name| self.length_names(name, "_s")))?;
        let angular = self.complete(&ANGULAR.map(|name| vec![name.to_owned()]))?;
        // A trajectory holds both velocities or none: half of them are ignored like extra columns.
        let velocity = match (linear, angular) {
            (Some([a, b, c]), Some([d, e, f])) => Some([a, b, c, d, e, f]),
            (linear, angular) => {
                for index in linear.into_iter().chain(angular).flatten() {
                    self.used[index] = false;
                }
                None
            }
        };
        let run = self.cells.iter().any(|cell| cell.text == "run");
        let time_hint = if run && group_columns.is_empty() {
            Some("the column `run` says that this file holds several recordings".to_owned())
        } else {
            None
        };
        Ok(Layout {
            names: self.cells.iter().map(|c| excerpt(c.text)).collect(),
            time,
            x,
            y,
            z,
            quaternion,
            velocity,
            time_hint,
        })
    }

    /// The names that a length (or, with `_s`, a linear velocity) may have in a file of this unit.
    fn length_names(&self, base: &str, per: &str) -> Vec<String> {
        let mut names = vec![format!("{base}_m{per}")];
        match self.unit {
            LengthUnit::Metre => {}
            LengthUnit::Centimetre => names.extend([format!("{base}_cm{per}"), base.to_owned()]),
            LengthUnit::Millimetre => names.extend([format!("{base}_mm{per}"), base.to_owned()]),
        }
        names
    }

    fn optional(&mut self, names: &[String]) -> Result<Option<usize>> {
        let mut found = None;
        for (index, cell) in self.cells.iter().enumerate() {
            if names.iter().any(|name| name == cell.text) {
                if let Some(other) = found.replace(index) {
                    let other: &Cell<'_> = &self.cells[other];
                    return Err(cell.locate(
                        Error::invalid("two columns hold the same quantity")
                            .found(format!("{} and {}", other.text, cell.text)),
                    ));
                }
                self.used[index] = true;
            }
        }
        Ok(found)
    }

    fn required(&mut self, names: &[String]) -> Result<usize> {
        match self.optional(names)? {
            Some(index) => Ok(index),
            None => Err(self.missing(&names.join(" or "), names)),
        }
    }

    /// All of several columns, or none of them.
    fn complete<const K: usize>(&mut self, names: &[Vec<String>; K]) -> Result<Option<[usize; K]>> {
        let mut indices = [0; K];
        let mut missing = Vec::new();
        for (index, names) in indices.iter_mut().zip(names) {
            match self.optional(names)? {
                Some(found) => *index = found,
                None => missing.push(names.join(" or ")),
            }
        }
        match missing.len() {
            0 => Ok(Some(indices)),
            n if n == K => Ok(None),
            _ => Err(self.missing(&missing.join(", "), &names[0])),
        }
    }

    fn missing(&self, what: &str, names: &[String]) -> Error {
        let found: Vec<&str> = self.cells.iter().map(|cell| cell.text).collect();
        let error = Error::invalid("missing column")
            .field(what)
            .found(excerpt_list(&found));
        let error = match self.cells.first() {
            Some(cell) => cell.locate(error),
            None => error.at_line(1, 1),
        };
        let length = names.iter().any(|name| name.contains("_m"));
        let has = |suffix: &str| {
            found
                .iter()
                .any(|name| name.ends_with(suffix) || name.ends_with(&format!("{suffix}_s")))
        };
        if length && has("_cm") {
            error
                .hint("the file is in centimetres")
                .advise(Advice::Unit(LengthUnit::Centimetre))
        } else if length && has("_mm") {
            error
                .hint("the file is in millimetres")
                .advise(Advice::Unit(LengthUnit::Millimetre))
        } else if found.len() == 1 && found[0].contains([';', '\t']) {
            error.hint("columns are separated by commas")
        } else if found.iter().all(|name| name.parse::<f64>().is_ok()) {
            error.hint("the first line must name the columns: t_s,x_m,y_m[,z_m][,qw,qx,qy,qz]")
        } else {
            error.hint("names carry the unit: t_s,x_m,y_m[,z_m][,qw,qx,qy,qz]; rename the columns")
        }
    }

    fn ignored_warning(&self) -> Option<Warning> {
        let ignored: Vec<&str> = self
            .cells
            .iter()
            .zip(&self.used)
            .filter(|(_, used)| !**used)
            .map(|(cell, _)| cell.text)
            .collect();
        (!ignored.is_empty()).then(|| {
            Warning::new(
                Code::ColumnsIgnored,
                format!("columns not used: {}", excerpt_list(&ignored)),
            )
        })
    }
}

/// The first dozen names, and how many more there are.
fn excerpt_list(names: &[&str]) -> String {
    let shown: Vec<String> = names.iter().take(16).map(|name| excerpt(name)).collect();
    let more = names.len() - shown.len();
    if more == 0 {
        shown.join(", ")
    } else {
        format!("{} and {more} more", shown.join(", "))
    }
}
