//! Fingerprints: a log used as a map, the baseline of every radio model.

use super::log::RadioLog;
use realgap_core::error::{Error, Result};

/// Where an anchor was heard (metres), and how strong (dBm).
type Heard = Vec<([f64; 2], f64)>;

/// Predicts a strength by the mean of the nearest logged ones (k nearest neighbours).
#[derive(Debug, Clone)]
pub struct Fingerprints {
    neighbours: usize,
    /// For each anchor of the log its name and where it was heard how strongly.
    heard: Vec<(String, Heard)>,
}

impl Fingerprints {
    /// Of a log, with this many neighbours.
    ///
    /// # Errors
    /// No neighbours.
    pub fn new(log: &RadioLog, neighbours: usize) -> Result<Self> {
        if neighbours == 0 {
            return Err(Error::usage("must be at least 1")
                .field("neighbours")
                .found(0));
        }
        let heard = log
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
        Ok(Self { neighbours, heard })
    }

    /// The mean strength of an anchor at the nearest places; `None` where the log never heard it.
    pub fn strength_dbm(&self, anchor: &str, position_m: [f64; 2]) -> Option<f64> {
        let (_, heard) = self.heard.iter().find(|(name, _)| name == anchor)?;
        let mut near: Vec<(f64, f64)> = heard
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
