//! Interprets the header line of a CSV file: the role and the unit of each column.

use super::column::{Column, Role};
use super::joint_column;
use super::reading::Reading;
use super::sample::Layout;
use super::text::{Cell, Separator, excerpt};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::unit::{AngleUnit, LengthUnit, TimeUnit};
use realgap_core::warning::{Code, Warning};

const QUATERNION: [Role; 4] = [Role::Qw, Role::Qx, Role::Qy, Role::Qz];
const LINEAR: [Role; 3] = [Role::Vx, Role::Vy, Role::Vz];
const ANGULAR: [Role; 3] = [Role::Wx, Role::Wy, Role::Wz];

/// The names in the header line, and which of them already have a role.
pub(super) struct Header<'c, 'a> {
    cells: &'c [Cell<'a>],
    used: Vec<bool>,
    factors: Vec<f64>,
    reading: &'c Reading,
    separator: Separator,
}

impl<'c, 'a> Header<'c, 'a> {
    pub(super) fn new(
        cells: &'c [Cell<'a>],
        reading: &'c Reading,
        separator: Separator,
    ) -> Result<Self> {
        for (index, cell) in cells.iter().enumerate() {
            // A line of numbers is not a header; the missing header is reported later.
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
            factors: vec![1.0; cells.len()],
            reading,
            separator,
        })
    }

    pub(super) fn layout(&mut self, group_columns: &[&str]) -> Result<Layout> {
        let time = self.required(Role::Time)?;
        let places = [self.optional(Role::X)?, self.optional(Role::Y)?];
        let place = if places == [None, None] && self.has_joints() {
            // The recording has joints only.
            None
        } else {
            Some([self.required(Role::X)?, self.required(Role::Y)?])
        };
        let z = self.optional(Role::Z)?;
        let mut quaternion = self.complete(&QUATERNION)?;
        if let (Some(columns), Some(order)) = (&mut quaternion, self.reading.quaternion) {
            columns.sort_unstable();
            *columns = order.wxyz(*columns);
        }
        let heading = self.optional(Role::Heading)?;
        let linear = self.complete(&LINEAR)?;
        let angular = self.complete(&ANGULAR)?;
        // A trajectory holds both velocities or none; if only one is complete, its columns are ignored.
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
            factors: self.factors.clone(),
            time,
            place,
            z,
            quaternion,
            heading: heading.filter(|_| quaternion.is_none()),
            velocity,
            time_hint,
            joints: Vec::new(),
            signals: Vec::new(),
        })
    }

    /// True if any column is the angle of a joint.
    fn has_joints(&self) -> bool {
        let names: Vec<&str> = self.cells.iter().map(|cell| cell.text).collect();
        let factors = &mut self.factors.clone();
        !joint_column::find(&names, &mut self.used.clone(), factors).is_empty()
    }

    /// Adds the joints and signals among the columns without a role.
    pub(super) fn add_joints(&mut self, layout: &mut Layout) {
        let names: Vec<&str> = self.cells.iter().map(|cell| cell.text).collect();
        layout.joints = joint_column::find(&names, &mut self.used, &mut layout.factors);
        layout.signals = joint_column::find_signals(&names, &mut self.used);
    }

    /// The column with exactly this name, which is then marked as used.
    pub(super) fn named(&mut self, name: &str) -> Result<usize> {
        match self.place(name) {
            Some(index) => {
                self.used[index] = true;
                Ok(index)
            }
            None => Err(self.missing(name, false)),
        }
    }

    /// The columns without a role.
    pub(super) fn unused(&self) -> Vec<usize> {
        (0..self.cells.len()).filter(|i| !self.used[*i]).collect()
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.cells.iter().position(|cell| cell.text == name)
    }

    /// The names that a column of this role may have without a mapping: with the unit, or without it if the reading states the unit of the
    /// file.
    fn names(&self, role: Role) -> Vec<String> {
        let reading = self.reading;
        let name = role.name();
        let lengths = |per: &str| {
            let mut names = vec![format!("{name}_m{per}")];
            let other = |unit: &LengthUnit| *unit != LengthUnit::Metre;
            if let Some(unit) = reading.length.filter(other) {
                names.extend([format!("{name}_{}{per}", unit.symbol()), name.to_owned()]);
            }
            names
        };
        match role {
            Role::Time => {
                let mut names = vec!["t_s".to_owned()];
                let other = |unit: &TimeUnit| *unit != TimeUnit::Second;
                if let Some(unit) = reading.time.filter(other) {
                    names.extend([format!("t_{}", unit.symbol()), "t".to_owned()]);
                }
                names
            }
            Role::X | Role::Y | Role::Z => lengths(""),
            Role::Vx | Role::Vy | Role::Vz => lengths("_s"),
            Role::Wx | Role::Wy | Role::Wz => {
                let mut names = vec![format!("{name}_rad_s")];
                let other = |unit: &AngleUnit| *unit != AngleUnit::Radian;
                if let Some(unit) = reading.angle.filter(other) {
                    names.extend([format!("{name}_{}_s", unit.symbol()), name.to_owned()]);
                }
                names
            }
            Role::Qw | Role::Qx | Role::Qy | Role::Qz => vec![name.to_owned()],
            // Files of other programs use these names with other meanings, so they need a mapping.
            Role::Heading | Role::Condition | Role::Run => Vec::new(),
        }
    }

    fn optional(&mut self, role: Role) -> Result<Option<usize>> {
        let usual = self.reading.factor(role.measure());
        if let Some(column) = self.reading.columns.get(role) {
            let index = self.place(&column.name);
            let index = index.ok_or_else(|| self.not_there(role, column))?;
            self.used[index] = true;
            self.factors[index] = column.factor.unwrap_or(usual);
            return Ok(Some(index));
        }
        let names = self.names(role);
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
                self.factors[index] = usual;
            }
        }
        Ok(found)
    }

    fn required(&mut self, role: Role) -> Result<usize> {
        match self.optional(role)? {
            Some(index) => Ok(index),
            None => {
                let names = self.names(role);
                Err(self.missing(&names.join(" or "), role != Role::Time))
            }
        }
    }

    /// The columns of several roles, if the file has all of them; `None` if it has none of them.
    fn complete<const K: usize>(&mut self, roles: &[Role; K]) -> Result<Option<[usize; K]>> {
        let mut indices = [0; K];
        let mut missing = Vec::new();
        for (index, role) in indices.iter_mut().zip(roles) {
            match self.optional(*role)? {
                Some(found) => *index = found,
                None => missing.push(self.names(*role).join(" or ")),
            }
        }
        match missing.len() {
            0 => Ok(Some(indices)),
            n if n == K => Ok(None),
            _ => {
                let is_length = LINEAR.contains(&roles[0]);
                Err(self.missing(&missing.join(", "), is_length))
            }
        }
    }

    /// The error about a column of the mapping that the file does not have.
    fn not_there(&self, role: Role, column: &Column) -> Error {
        let error = self.at_start(Error::invalid(format!(
            "there is no column `{}`",
            excerpt(&column.name)
        )));
        let error = error
            .field(role.name())
            .found(self.found())
            .advise(Advice::MapColumns);
        match column.name.rsplit_once(" in ") {
            Some((_, unit)) => error.hint(format!(
                "`{}` was taken as a part of the name, because it is not a unit; units are m, cm, mm, s, ms, us, ns, rad, deg and those of velocities, e.g. mm/s",
                excerpt(unit)
            )),
            None => error,
        }
    }

    fn at_start(&self, error: Error) -> Error {
        match self.cells.first() {
            Some(cell) => cell.locate(error),
            None => error.at_line(1, 1),
        }
    }

    fn found(&self) -> String {
        let found: Vec<&str> = self.cells.iter().map(|cell| cell.text).collect();
        excerpt_list(&found)
    }

    fn missing(&self, what: &str, is_length: bool) -> Error {
        let names = || self.cells.iter().map(|cell| cell.text);
        let error = self.at_start(Error::invalid("missing column"));
        let error = error.field(what).found(self.found());
        let has = |suffix: &str| {
            names().any(|name| name.ends_with(suffix) || name.ends_with(&format!("{suffix}_s")))
        };
        if is_length && has("_cm") {
            error
                .hint("the file is in centimetres")
                .advise(Advice::Unit(LengthUnit::Centimetre))
        } else if is_length && has("_mm") {
            error
                .hint("the file is in millimetres")
                .advise(Advice::Unit(LengthUnit::Millimetre))
        } else if names().all(|name| self.separator.number(name).is_some()) {
            error
                .hint("the first line must name the columns: t_s,x_m,y_m[,z_m][,qw,qx,qy,qz]; if other lines come before it")
                .advise(Advice::SkipLines)
        } else {
            error
                .hint("column names end with the unit: t_s,x_m,y_m[,z_m][,qw,qx,qy,qz]")
                .advise(Advice::MapColumns)
        }
    }

    pub(super) fn ignored_warning(&self) -> Option<Warning> {
        let ignored = self.unused();
        let ignored: Vec<&str> = ignored.iter().map(|i| self.cells[*i].text).collect();
        // The four columns of an orientation are often called q0 to q3, which does not say which one is the real part.
        let is_turn = ignored
            .iter()
            .filter(|name| name.starts_with(['q', 'Q']))
            .count()
            == 4;
        let turn = if is_turn {
            ": are four of them an orientation? Then map them to qw, qx, qy, qz (`columns: {\"qw\": \"NAME\", ...}` of a reading)"
        } else {
            ""
        };
        (!ignored.is_empty()).then(|| {
            let message = format!("columns not used: {}{turn}", excerpt_list(&ignored));
            Code::ColumnsIgnored.warning(message)
        })
    }
}

/// The first 16 names, and the number of further names.
pub(super) fn excerpt_list(names: &[&str]) -> String {
    let shown: Vec<String> = names.iter().take(16).map(|name| excerpt(name)).collect();
    let more = names.len() - shown.len();
    if more == 0 {
        shown.join(", ")
    } else {
        format!("{} and {more} more", shown.join(", "))
    }
}
