//! The content of messages with poses, joints, commands or sensors, independent of their encoding.

/// The names of the message types that are read, with their kinds.
pub(super) struct Kinds<K: 'static>(pub(super) &'static [(&'static str, K)]);

impl<K: Copy> Kinds<K> {
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        self.0.iter().map(|(name, _)| *name)
    }

    /// The kind of the message type with this name; `None` for a type that is not read.
    pub(super) fn of(&self, name: &str) -> Option<K> {
        let known = self.0.iter().find(|(known, _)| *known == name);
        known.map(|(_, kind)| *kind)
    }
}

/// One pose with its times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sample {
    /// The time in the message, nanoseconds; 0 if the message has none.
    pub(super) stamp_ns: i64,
    /// The time of recording, nanoseconds.
    pub(super) log_ns: i64,
    pub(super) place_m: [f64; 3],
    pub(super) turn_xyzw: [f64; 4],
    /// Linear and angular velocity, both in the frame of the body.
    pub(super) twist: Option<[f64; 6]>,
}

/// The parent and child frames of a transform; `None` for other messages.
pub(super) type Frames = Option<(String, String)>;

/// The content of one message.
pub(super) enum Content {
    /// Poses, with frames for transforms.
    Poses(Vec<(Frames, Sample)>),
    /// The whole path up to the time of the message.
    Path(Vec<Sample>),
    /// Numbers of joints, commands or sensors.
    Row(Row),
    /// A planned motion of joints.
    Plan(Plan),
}

/// What a number of a joint is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Quantity {
    Angle,
    Speed,
    Effort,
    /// What a controller reports as its reference.
    Reference,
}

/// What a number in a message is.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Column {
    /// A quantity of a joint.
    Joint(String, Quantity),
    /// A quantity with a name and unit of its own.
    Named(String),
    /// One of several numbers that have no names, by its index.
    Numbered(usize),
}

/// The numbers of one message; NaN where the message has none.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    /// The time in the message, nanoseconds; 0 if the message has none.
    pub(super) stamp_ns: i64,
    /// The time of recording, nanoseconds.
    pub(super) log_ns: i64,
    pub(super) columns: Vec<Column>,
    pub(super) values: Vec<f64>,
}

/// A planned motion: angles of joints at times after its start.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Plan {
    /// The start in the message, nanoseconds; 0 for a plan that starts when it arrives.
    pub(super) stamp_ns: i64,
    pub(super) log_ns: i64,
    pub(super) joints: Vec<String>,
    pub(super) points: Vec<Point>,
}

/// One point of a planned motion.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Point {
    pub(super) after_start_ns: i64,
    pub(super) angles: Vec<f64>,
    /// Speeds; empty where the plan has none.
    pub(super) speeds: Vec<f64>,
}
