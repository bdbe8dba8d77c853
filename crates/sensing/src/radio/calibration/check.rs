//! Checks that a log, an arena and anchors are consistent with each other.

use super::log::RadioLog;
use crate::arena::{Anchor, Arena};
use realgap_core::error::{Error, Result};
use realgap_core::unit::counted;
use realgap_core::warning::{Code, Warning};

/// Warnings about readings outside of the arena and about anchors inside of walls.
pub(super) fn check_places(
    log: &RadioLog,
    arena: &Arena,
    anchors: &[Anchor],
) -> Result<Vec<Warning>> {
    let mut warnings = Vec::new();
    let is_in = |[x, y]: [f64; 2]| {
        (0.0..=arena.size_m[0]).contains(&x) && (0.0..=arena.size_m[1]).contains(&y)
    };
    let outside = log.readings.iter().filter(|r| !is_in(r.position_m)).count();
    if outside == log.readings.len() {
        let [x, y] = log.readings[0].position_m;
        return Err(
            Error::invalid("the whole log was taken outside of the arena")
                .found(format!("({x}, {y}) m"))
                .allowed(format!(
                    "(0, 0) to ({}, {}) m",
                    arena.size_m[0], arena.size_m[1]
                ))
                .hint("log and arena must share origin and axes"),
        );
    }
    if outside > 0 {
        warnings.push(Code::OutsideArena.warning(format!(
            "{} were taken outside of the arena",
            counted(outside, "reading")
        )));
    }
    let walled: Vec<&str> = anchors
        .iter()
        .filter(|a| {
            arena
                .object_at([a.position_m[0], a.position_m[1]])
                .is_some()
        })
        .map(|a| a.name.as_str())
        .collect();
    if !walled.is_empty() {
        warnings.push(Code::AnchorInWall.warning(format!(
            "these anchors are inside of a wall, and that wall is not counted between the anchor and a robot: {}",
            walled.join(", ")
        )));
    }
    Ok(warnings)
}
