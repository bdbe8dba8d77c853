//! The numbers of joints, commands and sensors in a log, and their values at the times of another topic.

use super::message::{Column, Plan, Quantity, Row};
use super::plan::planned;

/// What the messages of a topic are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// Measured joints.
    State,
    /// Where joints or the robot should go.
    Command,
    /// What a sensor of a body measured.
    Sensor,
}

/// The times and the numbers of one message.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TimedValues {
    pub(super) stamp_ns: i64,
    pub(super) log_ns: i64,
    pub(super) values: Vec<f64>,
}

/// The messages of one topic that hold the same quantities.
#[derive(Debug, Clone)]
pub(super) struct Series {
    pub(super) topic: String,
    pub(super) kind: String,
    pub(super) role: Role,
    pub(super) columns: Vec<Column>,
    pub(super) rows: Vec<TimedValues>,
    pub(super) plans: Vec<Plan>,
    /// The number of messages, including those that are not kept.
    pub(super) count: usize,
}

/// The clock by which topics are joined: that of the stamps in the messages, or that of the recorder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Clock {
    pub(super) has_stamps: bool,
    /// What is added to a time of recording.
    pub(super) shift_ns: i64,
}

impl Clock {
    /// The clock of a topic with these stamps and times of recording. Topics without stamps are moved by the usual delay of the recorder.
    pub(super) fn of(times: impl Iterator<Item = (i64, i64)>) -> Self {
        let times: Vec<(i64, i64)> = times.collect();
        let has_stamps = times.iter().any(|(stamp_ns, _)| *stamp_ns != 0);
        let delays = times.iter();
        let mut delays: Vec<i64> = delays
            .map(|(stamp_ns, log_ns)| stamp_ns.saturating_sub(*log_ns))
            .collect();
        delays.sort_unstable();
        let usual = delays.get(delays.len() / 2).copied().unwrap_or(0);
        Self {
            has_stamps,
            shift_ns: if has_stamps { usual } else { 0 },
        }
    }
}

/// A value at each of some times; `None` where the topic says nothing about this time.
pub(super) type AtTimes = Vec<Option<Vec<f64>>>;

impl Series {
    /// Adds a row whose columns are those of this series in any order.
    pub(super) fn push(&mut self, row: Row) {
        let values = match row.columns == self.columns {
            true => row.values,
            false => {
                let place = |column: &Column| row.columns.iter().position(|own| own == column);
                let values = self.columns.iter().map(place);
                let of = |at: Option<usize>| at.map_or(f64::NAN, |at| row.values[at]);
                values.map(of).collect()
            }
        };
        self.rows.push(TimedValues {
            stamp_ns: row.stamp_ns,
            log_ns: row.log_ns,
            values,
        });
    }

    /// True if these columns are those of this series in any order.
    pub(super) fn holds(&self, columns: &[Column]) -> bool {
        let is_same = self.columns == columns;
        is_same
            || (self.columns.len() == columns.len()
                && columns.iter().all(|column| self.columns.contains(column)))
    }

    /// The names of the joints, in the order of the messages.
    pub(super) fn joints(&self) -> Vec<&str> {
        let mut all: Vec<&str> = Vec::new();
        for column in &self.columns {
            if let Column::Joint(name, _) = column
                && !all.contains(&name.as_str())
            {
                all.push(name);
            }
        }
        all
    }

    pub(super) fn has(&self, wanted: Quantity) -> bool {
        let mut all = self.columns.iter();
        all.any(|column| matches!(column, Column::Joint(_, quantity) if *quantity == wanted))
    }

    pub(super) fn has_stamps(&self) -> bool {
        self.rows.iter().any(|row| row.stamp_ns != 0)
    }

    /// Adds a plan whose joints are those of this series in any order.
    pub(super) fn push_plan(&mut self, mut plan: Plan) {
        let own: Vec<&str> = self.joints();
        if plan.joints != own {
            let names = own.iter();
            let order: Vec<usize> = names
                .filter_map(|name| plan.joints.iter().position(|joint| joint == name))
                .collect();
            let sorted = |list: &[f64]| match list.is_empty() {
                true => Vec::new(),
                false => order.iter().map(|at| list[*at]).collect(),
            };
            for point in &mut plan.points {
                point.angles = sorted(&point.angles);
                point.speeds = sorted(&point.speeds);
            }
            plan.joints = own.into_iter().map(str::to_owned).collect();
        }
        self.plans.push(plan);
    }

    /// The clock of this series, by which others are joined to it.
    pub(super) fn clock(&self) -> Clock {
        Clock::of(self.rows.iter().map(|row| (row.stamp_ns, row.log_ns)))
    }

    /// The times of the rows by a clock, nanoseconds.
    pub(super) fn times_ns(&self, clock: Clock) -> Vec<i64> {
        let is_stamped = clock.has_stamps && self.has_stamps();
        let time = |row: &TimedValues| match is_stamped {
            true => row.stamp_ns,
            false => row.log_ns.saturating_add(clock.shift_ns),
        };
        self.rows.iter().map(time).collect()
    }

    /// The rows in the order of their times, with these times.
    fn sorted(&self, clock: Clock) -> Vec<(i64, &[f64])> {
        let values = self.rows.iter().map(|row| row.values.as_slice());
        let mut all: Vec<(i64, &[f64])> = self.times_ns(clock).into_iter().zip(values).collect();
        all.sort_by_key(|(time_ns, _)| *time_ns);
        all
    }

    /// The last value at or before each time. Plans are followed from point to point.
    pub(super) fn held(&self, clock: Clock, times_ns: &[i64]) -> AtTimes {
        if !self.plans.is_empty() {
            return planned(&self.plans, clock, times_ns);
        }
        let all = self.sorted(clock);
        let at = |time_ns: &i64| {
            let next = all.partition_point(|(own_ns, _)| own_ns <= time_ns);
            let (_, values) = all.get(next.checked_sub(1)?)?;
            Some(values.to_vec())
        };
        times_ns.iter().map(at).collect()
    }

    /// The value at each time on the line between its neighbours.
    pub(super) fn interpolated(&self, clock: Clock, times_ns: &[i64]) -> AtTimes {
        let all = self.sorted(clock);
        let at = |time_ns: &i64| {
            let next = all.partition_point(|(own_ns, _)| own_ns <= time_ns);
            let (from_ns, from) = all.get(next.checked_sub(1)?)?;
            if from_ns == time_ns {
                return Some(from.to_vec());
            }
            let (to_ns, to) = all.get(next)?;
            let share = (time_ns - from_ns) as f64 / (to_ns - from_ns) as f64;
            let pairs = from.iter().zip(to.iter());
            Some(pairs.map(|(a, b)| a + share * (b - a)).collect())
        };
        times_ns.iter().map(at).collect()
    }
}
