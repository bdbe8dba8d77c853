//! Fingerprints: a log used as a map of strengths, which is a baseline for radio models.

use super::log::RadioLog;
use realgap_core::error::{Error, Result};

/// Positions (metres) and strengths (dBm) at which an anchor was received.
type Received = Vec<([f64; 2], f64)>;

/// Predicts a strength by the mean of the nearest logged ones (k nearest neighbours).
#[derive(Debug, Clone)]
pub struct Fingerprints {
    neighbours: usize,
    /// For each anchor of the log, its name and the strengths at which it was received.
    received: Vec<(String, Received)>,
}

impl Fingerprints {
    /// The fingerprints of a log, with this number of neighbours.
    ///
    /// # Errors
    /// No neighbours.
    pub fn new(log: &RadioLog, neighbours: usize) -> Result<Self> {
        if neighbours == 0 {
            return Err(Error::usage("must be at least 1")
                .field("neighbours")
                .found(0));
        }
        let received = log
            .anchors
            .iter()
            .enumerate()
            .map(|(anchor, name)| {
                let own = log.readings.iter().filter(|r| r.anchor == anchor);
                (
                    name.clone(),
                    own.map(|r| (r.position_m, r.strength_dbm)).collect(),
                )
            })
            .collect();
        Ok(Self {
            neighbours,
            received,
        })
    }

    /// The mean strength of an anchor at the nearest logged positions; `None` if the anchor was never received in the log.
    pub fn strength_dbm(&self, anchor: &str, position_m: [f64; 2]) -> Option<f64> {
        let (_, received) = self.received.iter().find(|(name, _)| name == anchor)?;
        let mut near: Vec<(f64, f64)> = received
            .iter()
            .map(|(at, dbm)| ((at[0] - position_m[0]).hypot(at[1] - position_m[1]), *dbm))
            .collect();
        let count = self.neighbours.min(near.len());
        if count == 0 {
            return None;
        }
        near.select_nth_unstable_by(count - 1, |a, b| {
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        Some(near[..count].iter().map(|(_, dbm)| dbm).sum::<f64>() / count as f64)
    }
}
