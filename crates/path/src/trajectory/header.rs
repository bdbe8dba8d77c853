//! Interprets the header line of a CSV file: the role and the unit of each column.

use super::column::{Column, Measure, Role};
use super::column_name::{StatedUnit, counts_samples, unit_in_name, unit_in_row};
use super::joint_column;
use super::reading::Reading;
use super::sample::{Clock, Layout};
use super::text::{Cell, Separator, excerpt};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::text::fits;
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
    /// The row of units below the names; empty if there is none.
    units: Vec<&'a str>,
    /// Columns whose names state another unit than the reading.
    contradicted: Vec<usize>,
    reading: &'c Reading,
    separator: Separator,
}

impl<'c, 'a> Header<'c, 'a> {
    pub(super) fn new(
        cells: &'c [Cell<'a>],
        units: Vec<&'a str>,
        reading: &'c Reading,
        separator: Separator,
    ) -> Self {
        Self {
            cells,
            used: vec![false; cells.len()],
            factors: vec![1.0; cells.len()],
            units,
            contradicted: Vec::new(),
            reading,
            separator,
        }
    }

    /// Refuses two columns of one name, if that name is read.
    pub(super) fn must_be_unique(&self) -> Result<()> {
        for (index, cell) in self.cells.iter().enumerate() {
            let mut others = self.cells[..index].iter().enumerate();
            let is_twice = others.any(|(other, before)| {
                before.text == cell.text && (self.used[index] || self.used[other])
            });
            // A line of numbers is not a header; the missing header is reported elsewhere.
            let is_name = !cell.text.is_empty() && cell.text.parse::<f64>().is_err();
            if is_name && is_twice {
                return Err(same_name(cell));
            }
        }
        Ok(())
    }

    pub(super) fn layout(&mut self, group_columns: &[&str]) -> Result<Layout> {
        let clock = self.clock()?;
        let places = [self.optional(Role::X)?, self.optional(Role::Y)?];
        let place = if places == [None, None] && (self.has_joints() || self.has_kept()) {
            // The recording has joints only, or columns that are kept as they are.
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
            clock,
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

    /// Where times come from. A sampling rate serves files without times, and those whose time is a count of samples.
    fn clock(&mut self) -> Result<Clock> {
        let rate_hz = self.reading.rate_hz;
        let Some(time) = self.optional(Role::Time)? else {
            let Some(rate_hz) = rate_hz else {
                return self.required(Role::Time).map(Clock::Column);
            };
            let counter = (0..self.cells.len()).find(|k| counts_samples(self.cells[*k].text));
            return Ok(match counter {
                Some(column) => {
                    self.used[column] = true;
                    Clock::Counter(column, rate_hz)
                }
                None => Clock::Rate(rate_hz),
            });
        };
        if let Some(nanos) = self.optional(Role::Nanos)? {
            return Ok(Clock::TwoColumns(time, nanos));
        }
        let is_stated = |column: &Column| column.factor.is_some();
        let column = self.reading.columns.get(Role::Time);
        Ok(
            match rate_hz.filter(|_| counts_samples(self.cells[time].text)) {
                Some(rate_hz) if !column.is_some_and(is_stated) => Clock::Counter(time, rate_hz),
                _ => Clock::Column(time),
            },
        )
    }

    /// The factor from the unit of a column to SI. The unit in a mapping comes first, then the one in the column's name, the one in the row of
    /// units, and the unit of the reading.
    fn factor(&mut self, role: Role, index: usize) -> Result<f64> {
        let measure = role.measure();
        if let Some(factor) = self
            .reading
            .columns
            .get(role)
            .and_then(|column| column.factor)
        {
            return Ok(factor);
        }
        let text = self.cells[index].text;
        let in_row = || {
            self.units
                .get(index)
                .and_then(|cell| unit_in_row(cell, measure))
        };
        let usual = match role {
            Role::Nanos => 1e-9,
            _ => self.reading.factor(measure),
        };
        match unit_in_name(text, measure).or_else(in_row) {
            None => Ok(usual),
            Some(StatedUnit::Pixel) if self.reading.scale.is_some() => Ok(usual),
            Some(StatedUnit::Pixel) => Err(self.cells[index].locate(
                Error::invalid("the size of a pixel is not known")
                    .field(text)
                    .found("lengths in pixels")
                    .allowed("the metres of one pixel, where the robot moves")
                    .advise(Advice::Scale),
            )),
            Some(StatedUnit::Known(_, size)) => {
                let is_stated = match measure {
                    Measure::Length | Measure::Velocity => {
                        self.reading.length.is_some() || self.reading.scale.is_some()
                    }
                    Measure::Time => self.reading.time.is_some(),
                    _ => self.reading.angle.is_some(),
                };
                let is_new = !self.contradicted.contains(&index);
                if is_stated && is_new && (size / usual - 1.0).abs() > 1e-12 {
                    self.contradicted.push(index);
                }
                Ok(size)
            }
        }
    }

    /// The warnings about the header.
    pub(super) fn warnings(&self) -> Vec<Warning> {
        let contradicted = (!self.contradicted.is_empty()).then(|| {
            let names: Vec<&str> = self.contradicted.iter().map(|k| self.cells[*k].text).collect();
            Code::UnitInName.warning(format!(
                "the units in the names of columns are used, not the stated one: {}; if a name is wrong, map the column with its unit, e.g. `columns: (x: \"x_m in mm\")`",
                excerpt_list(&names)
            ))
        });
        contradicted
            .into_iter()
            .chain(self.ignored_warning())
            .collect()
    }

    /// True if any column is the angle of a joint.
    fn has_joints(&self) -> bool {
        let names: Vec<&str> = self.cells.iter().map(|cell| cell.text).collect();
        let factors = &mut self.factors.clone();
        !joint_column::find(&names, &mut self.used.clone(), factors, self.reading.ticks).is_empty()
    }

    /// True if the reading keeps any column as it is.
    fn has_kept(&self) -> bool {
        let kept = &self.reading.unitless;
        let mut names = self.cells.iter().map(|cell| cell.text);
        names.any(|name| kept.iter().any(|kept| fits(kept, name)))
    }

    /// Adds the joints and signals among the columns without a role.
    pub(super) fn add_joints(&mut self, layout: &mut Layout) {
        let names: Vec<&str> = self.cells.iter().map(|cell| cell.text).collect();
        layout.joints = joint_column::find(
            &names,
            &mut self.used,
            &mut layout.factors,
            self.reading.ticks,
        );
        layout.signals = joint_column::find_signals(
            &names,
            &self.reading.unitless,
            &mut self.used,
            &mut layout.factors,
        );
    }

    /// The column with exactly this name, which is then marked as used.
    pub(super) fn named(&mut self, name: &str) -> Result<usize> {
        match self.place(name) {
            Some(index) => {
                self.used[index] = true;
                Ok(index)
            }
            None => Err(self.missing(name)),
        }
    }

    /// The columns without a role.
    pub(super) fn unused(&self) -> Vec<usize> {
        (0..self.cells.len()).filter(|i| !self.used[*i]).collect()
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.cells.iter().position(|cell| cell.text == name)
    }

    /// The names that a column of this role may have without a mapping: with any unit, or without one if the reading or a row below the names
    /// states it. The name with the SI unit comes first.
    fn names(&self, role: Role) -> Vec<String> {
        let reading = self.reading;
        let name = role.name();
        let of = |base: &str, units: &[&str], per: &str, is_stated: bool| {
            let named = units.iter().map(|unit| format!("{base}_{unit}{per}"));
            let bare = is_stated.then(|| base.to_owned());
            named.chain(bare).collect::<Vec<_>>()
        };
        let has_units = !self.units.is_empty();
        let lengths: Vec<&str> = LengthUnit::ALL.iter().map(|unit| unit.symbol()).collect();
        let times: Vec<&str> = TimeUnit::ALL.iter().map(|unit| unit.symbol()).collect();
        let angles: Vec<&str> = AngleUnit::ALL.iter().map(|unit| unit.symbol()).collect();
        let has_length = reading.length.is_some() || reading.scale.is_some() || has_units;
        match role {
            Role::Time => of(name, &times, "", reading.time.is_some() || has_units),
            Role::X | Role::Y | Role::Z => of(name, &lengths, "", has_length),
            Role::Vx | Role::Vy | Role::Vz => of(name, &lengths, "_s", has_length),
            Role::Wx | Role::Wy | Role::Wz => {
                of(name, &angles, "_s", reading.angle.is_some() || has_units)
            }
            Role::Qw | Role::Qx | Role::Qy | Role::Qz => vec![name.to_owned()],
            // Files of other programs use these names with other meanings, so they need a mapping.
            Role::Heading | Role::Condition | Role::Run | Role::Nanos => Vec::new(),
        }
    }

    fn optional(&mut self, role: Role) -> Result<Option<usize>> {
        if let Some(column) = self.reading.columns.get(role) {
            // A name may end with the words `in mm`, as a mapping does.
            let index = self
                .place(&column.name)
                .or_else(|| self.place(&column.to_string()));
            let index = index.ok_or_else(|| self.not_there(role, column))?;
            self.used[index] = true;
            self.factors[index] = self.factor(role, index)?;
            return Ok(Some(index));
        }
        let names = self.names(role);
        let is_named = |cell: &Cell<'_>| names.iter().any(|name| name == cell.text);
        let mut found: Vec<usize> = Vec::new();
        for (index, cell) in self.cells.iter().enumerate() {
            if is_named(cell) {
                found.push(index);
            }
        }
        let index = match found.as_slice() {
            [] => return Ok(None),
            [index] => *index,
            [first, second, ..] => {
                let [first, second] = [first, second].map(|index| &self.cells[*index]);
                if first.text == second.text {
                    return Err(same_name(second));
                }
                return Err(second.locate(
                    Error::invalid("two columns hold the same quantity")
                        .found(format!("{} and {}", first.text, second.text))
                        .advise(Advice::MapColumns),
                ));
            }
        };
        self.used[index] = true;
        self.factors[index] = self.factor(role, index)?;
        Ok(Some(index))
    }

    fn required(&mut self, role: Role) -> Result<usize> {
        match self.optional(role)? {
            Some(index) => Ok(index),
            None => {
                let error = self.missing(&self.usual_name(role));
                Err(match role {
                    Role::Time => error.advise(Advice::Rate),
                    _ => error,
                })
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
                None => missing.push(self.usual_name(*role)),
            }
        }
        match missing.len() {
            0 => Ok(Some(indices)),
            n if n == K => Ok(None),
            _ => Err(self.missing(&missing.join(", "))),
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

    /// The name in the SI unit.
    fn usual_name(&self, role: Role) -> String {
        self.names(role).into_iter().next().unwrap_or_default()
    }

    fn missing(&self, what: &str) -> Error {
        let names = || self.cells.iter().map(|cell| cell.text);
        let error = self.at_start(Error::invalid("missing column"));
        let error = error.field(what).found(self.found());
        if names().all(|name| self.separator.number(name).is_some()) {
            error
                .hint("the first line must name the columns: t_s,x_m,y_m[,z_m][,qw,qx,qy,qz]; if other lines come before it")
                .advise(Advice::SkipLines)
                .advise(Advice::NameColumns)
        } else {
            error
                .hint("column names end with the unit: t_s,x_m,y_m[,z_m][,qw,qx,qy,qz]")
                .advise(Advice::MapColumns)
        }
    }

    fn ignored_warning(&self) -> Option<Warning> {
        let ignored = self.unused();
        // Forward speed and turn rate are used: the commanded speeds of the wheels follow from them.
        let wheels = self.reading.wheels.as_ref();
        let is_of_base = |name: &str| wheels.is_some_and(|w| name == w.forward || name == w.turn);
        let ignored = ignored.iter().map(|i| self.cells[*i].text);
        let ignored = ignored.filter(|name| !is_of_base(name));
        // A column without a name is the count of rows that some programs write.
        let ignored: Vec<&str> = ignored.filter(|name| !name.is_empty()).collect();
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

fn same_name(cell: &Cell<'_>) -> Error {
    cell.locate(Error::invalid("two columns have the same name").found(excerpt(cell.text)))
}
