//! A tuned camera in words.

use std::fmt;

use super::{Known, Mismatch, TunedCamera};
use crate::PictureSource;
use realgap_core::table::{Side, TextTable};
use realgap_core::unit::counted;

fn shown(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if size < 0.01 => format!("{value:.5}"),
        size if size < 1.0 => format!("{value:.4}"),
        size if size < 100.0 => format!("{value:.2}"),
        _ => format!("{value:.0}"),
    }
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "look {:.2}, now {:.2} (1: as views differ from each other); corners {:.2} px, now {:.2} px",
            self.look_start, self.look_tuned, self.corners_start_px, self.corners_tuned_px
        )
    }
}

impl fmt::Display for TunedCamera {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let real = match self.real {
            PictureSource::StandIn => "stand-ins in place of real pictures",
            _ => "real pictures",
        };
        writeln!(
            f,
            "camera {} tuned to {real} of {}; 90 % intervals\n",
            self.start,
            counted(self.fitted_views.len(), "view")
        )?;
        let mut table = TextTable::new([
            ("setting", Side::Left),
            ("before", Side::Right),
            ("now", Side::Right),
            ("from", Side::Right),
            ("to", Side::Right),
            ("", Side::Left),
        ]);
        for setting in &self.settings {
            table.push([
                format!("{} {}", setting.name, setting.unit)
                    .trim_end()
                    .to_owned(),
                shown(setting.start),
                shown(setting.value),
                shown(setting.low),
                shown(setting.high),
                match setting.known {
                    Known::Determined => "determined",
                    Known::AtMost => "at most; less is not excluded",
                    Known::AtLeast => "at least; more is not excluded",
                    Known::Undetermined => "not determined by these pictures",
                }
                .to_owned(),
            ]);
        }
        writeln!(f, "{}", table.render(false))?;
        writeln!(f, "fitted views: {}", self.fitted)?;
        match &self.held_out {
            Some(held_out) => {
                writeln!(
                    f,
                    "held out ({}): {held_out}",
                    self.held_out_views.join(", ")
                )?;
            }
            None => writeln!(f, "held out: none")?,
        }
        write!(
            f,
            "cameras stood {:.1} mm and looked {:.2} degrees from where they should, on average",
            1e3 * self.misplaced_m,
            self.turned_rad.to_degrees()
        )
    }
}
