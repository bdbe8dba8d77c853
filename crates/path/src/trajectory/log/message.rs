//! The content of messages with poses, independent of their encoding.

/// The names of the message types that hold poses, with their kinds.
pub(super) struct Kinds<K: 'static>(pub(super) &'static [(&'static str, K)]);

impl<K: Copy> Kinds<K> {
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        self.0.iter().map(|(name, _)| *name)
    }

    /// The kind of the message type with this name; `None` for a type without poses.
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
}
