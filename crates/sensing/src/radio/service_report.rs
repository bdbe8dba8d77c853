//! Statistics of the outcomes of many messages: how many were received, with which strength and how late.

use std::fmt;

use serde::Serialize;

use super::service::{Delivery, Message};
use realgap_core::statistics::{mean, quantile};
use realgap_core::unit::counted;

/// Statistics of the outcomes of many messages.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ServiceReport {
    /// Number of messages that were sent.
    pub sent: usize,
    /// Number of messages that were received.
    pub delivered: usize,
    /// Number of messages below the sensitivity.
    pub too_weak: usize,
    /// Number of messages above the sensitivity that were lost.
    pub lost: usize,
    /// Mean strength of all messages, dBm.
    pub mean_strength_dbm: f64,
    /// Median time from sending to receiving, seconds; `None` if no message was received.
    pub median_latency_s: Option<f64>,
    /// 95 % quantile of the time from sending to receiving, seconds; `None` if no message was received.
    pub latency_95_s: Option<f64>,
}

impl ServiceReport {
    /// The statistics of messages with their outcomes; at least one message is needed.
    pub fn new(messages: &[(Message, Delivery)]) -> Self {
        let (mut latencies_s, mut too_weak, mut lost) = (Vec::new(), 0, 0);
        let mut strengths = Vec::with_capacity(messages.len());
        for (message, delivery) in messages {
            let (Delivery::Delivered { strength_dbm, .. }
            | Delivery::TooWeak { strength_dbm }
            | Delivery::Lost { strength_dbm }) = *delivery;
            strengths.push(strength_dbm);
            match delivery {
                Delivery::Delivered { at_s, .. } => latencies_s.push(at_s - message.at_s),
                Delivery::TooWeak { .. } => too_weak += 1,
                Delivery::Lost { .. } => lost += 1,
            }
        }
        let of = |level: f64| (!latencies_s.is_empty()).then(|| quantile(&latencies_s, level));
        Self {
            sent: messages.len(),
            delivered: latencies_s.len(),
            too_weak,
            lost,
            mean_strength_dbm: mean(&strengths),
            median_latency_s: of(0.5),
            latency_95_s: of(0.95),
        }
    }
}

impl fmt::Display for ServiceReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} of {} delivered ({:.1} %), {} too weak, {} lost; {:.1} dBm on average",
            self.delivered,
            counted(self.sent, "message"),
            100.0 * self.delivered as f64 / self.sent as f64,
            self.too_weak,
            self.lost,
            self.mean_strength_dbm
        )?;
        if let (Some(median_s), Some(most_s)) = (self.median_latency_s, self.latency_95_s) {
            write!(
                f,
                "; median time from sending to arriving {median_s:.4} s, 95 % within {most_s:.4} s"
            )?;
        }
        Ok(())
    }
}
