//! Simulates messages between robots, which are delivered, too weak or lost (paper 002, section IV: the server).

use rand::RngExt;
use rand_distr::StandardNormal;
use serde::Serialize;

use super::link::Link;
use super::model::RadioModel;
use super::pair::{Between, Pairs};
use super::shadow::ShadowField;
use crate::arena::Arena;
use realgap_core::error::{Error, Result};
use realgap_core::random::Numbered;
use realgap_core::range::Range;

/// Options of the simulation of messages.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServiceOptions {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Whether shadowing and fading are added; otherwise every strength is the mean strength.
    pub noise: bool,
    /// Strength above the sensitivity at which half of the messages are lost, dB.
    pub loss_half_db: f64,
    /// Width in decibels over which the probability of loss falls from 73 % to 27 %; 0 for a step, as in the paper.
    pub loss_width_db: f64,
    /// Mean time from sending to receiving, seconds.
    pub latency_s: f64,
    /// Standard deviation of the time from sending to receiving, seconds.
    pub latency_sd_s: f64,
}

impl Default for ServiceOptions {
    /// As in paper 002: a message whose strength is above the sensitivity is delivered without delay.
    fn default() -> Self {
        Self {
            seed: 1,
            noise: true,
            loss_half_db: 0.0,
            loss_width_db: 0.0,
            latency_s: 0.0,
            latency_sd_s: 0.0,
        }
    }
}

/// A message that is sent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Message {
    /// Number of the message; its random numbers depend on this number and the seed only.
    pub number: u64,
    /// Position of the sender, metres.
    pub from_m: [f64; 3],
    /// Position of the receiver, metres.
    pub to_m: [f64; 3],
    /// Time of sending, seconds.
    pub at_s: f64,
}

/// The outcome of a message.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Delivery {
    /// The message is received.
    Delivered {
        /// Time of receiving, seconds.
        at_s: f64,
        /// Strength of the signal, dBm.
        strength_dbm: f64,
    },
    /// The signal is below the receiver's sensitivity.
    TooWeak {
        /// Strength of the signal, dBm.
        strength_dbm: f64,
    },
    /// The signal is strong enough, but the message is lost.
    Lost {
        /// Strength of the signal, dBm.
        strength_dbm: f64,
    },
}

/// Simulates the delivery of messages. The outcome of a message does not depend on other messages or their order.
///
/// The mean strength and the shadowing between two positions are cached for later messages between them, for at most
/// [`MOST_PAIRS`](super::MOST_PAIRS) pairs.
#[derive(Debug)]
pub struct Service<'a> {
    model: &'a RadioModel,
    arena: &'a Arena,
    options: ServiceOptions,
    shadow: ShadowField,
    pairs: Pairs,
}

impl<'a> Service<'a> {
    /// A service in an arena.
    ///
    /// # Errors
    /// Negative widths or times, numbers that are not finite.
    pub fn new(model: &'a RadioModel, arena: &'a Arena, options: ServiceOptions) -> Result<Self> {
        for (field, value, least, unit) in [
            ("loss_half_db", options.loss_half_db, -1e9, "dB"),
            ("loss_width_db", options.loss_width_db, 0.0, "dB"),
            ("latency_s", options.latency_s, 0.0, "s"),
            ("latency_sd_s", options.latency_sd_s, 0.0, "s"),
        ] {
            let range = Range::within(least, 1e9, unit);
            range.check(value, field).map_err(Error::into_usage)?;
        }
        Ok(Self {
            model,
            arena,
            options,
            shadow: ShadowField::new(options.seed, model.shadowing_distance_m),
            pairs: Pairs::default(),
        })
    }

    /// Simulates the delivery of a message and returns its outcome.
    pub fn send(&self, message: &Message) -> Delivery {
        let options = &self.options;
        let mut rng = Numbered::Message.generator(options.seed, message.number);
        let (fading, late): (f64, f64) = (rng.sample(StandardNormal), rng.sample(StandardNormal));
        let chance: f64 = rng.random();
        let between = self.between(message.from_m, message.to_m);
        let mut strength_dbm = between.mean_dbm;
        if options.noise {
            strength_dbm +=
                self.model.shadowing_sd_db * between.shadow + self.model.fading_sd_db * fading;
        }
        let margin_db = strength_dbm - self.model.sensitivity_dbm;
        if margin_db < 0.0 {
            return Delivery::TooWeak { strength_dbm };
        }
        if chance < self.loss(margin_db) {
            return Delivery::Lost { strength_dbm };
        }
        let latency_s = (options.latency_s + options.latency_sd_s * late).max(0.0);
        Delivery::Delivered {
            at_s: message.at_s + latency_s,
            strength_dbm,
        }
    }

    /// Number of cached pairs of positions, where both directions count separately; at most [`MOST_PAIRS`](super::MOST_PAIRS).
    pub fn kept_pairs(&self) -> usize {
        self.pairs.len()
    }

    fn between(&self, from_m: [f64; 3], to_m: [f64; 3]) -> Between {
        if let Some(between) = self.pairs.get(from_m, to_m) {
            return between;
        }
        let shadow = match self.pairs.get(to_m, from_m) {
            // Shadowing is bitwise equal in both directions, because it is a sum of two terms. The loss of walls is computed for
            // each direction, because the order of walls may affect its rounding.
            Some(back) => back.shadow,
            None if self.options.noise => {
                let [a, b] = [from_m, to_m].map(|[x, y, _]| [x, y]);
                self.shadow.at(a, b)
            }
            None => 0.0,
        };
        let link = Link::new(self.arena, from_m, to_m);
        let mean_dbm = self.model.strength_dbm(&link);
        let between = Between { mean_dbm, shadow };
        self.pairs.keep(from_m, to_m, between);
        between
    }

    /// Probability that a message is lost whose strength is this margin above the sensitivity.
    pub fn loss(&self, margin_db: f64) -> f64 {
        let above_db = margin_db - self.options.loss_half_db;
        if self.options.loss_width_db == 0.0 {
            return if above_db < 0.0 { 1.0 } else { 0.0 };
        }
        1.0 / (1.0 + libm::exp(2.0 * above_db / self.options.loss_width_db))
    }
}
