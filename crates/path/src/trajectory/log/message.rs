//! What the messages of a log say, whatever they are coded in.

/// Names of the types of messages that hold poses, and what each says.
pub(super) struct Kinds<K: 'static>(pub(super) &'static [(&'static str, K)]);

impl<K: Copy> Kinds<K> {
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        self.0.iter().map(|(name, _)| *name)
    }

    /// `None` for all that are no poses.
    pub(super) fn of(&self, name: &str) -> Option<K> {
        let known = self.0.iter().find(|(known, _)| *known == name);
        known.map(|(_, kind)| *kind)
    }
}

/// One pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sample {
    /// What the message says, nanoseconds; 0 where it says nothing.
    pub(super) stamp_ns: i64,
    /// When it was recorded, nanoseconds.
    pub(super) log_ns: i64,
    pub(super) place_m: [f64; 3],
    pub(super) turn_xyzw: [f64; 4],
    /// Linear and angular velocity, both in the frame of the body.
    pub(super) twist: Option<[f64; 6]>,
}

/// Parent and child of a transform.
pub(super) type Frames = Option<(String, String)>;

/// What one message says.
pub(super) enum Content {
    /// Poses, each with its frames where it is a transform.
    Poses(Vec<(Frames, Sample)>),
    /// All of a path so far.
    Path(Vec<Sample>),
}
