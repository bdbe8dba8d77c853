//! Warnings about valid but implausible robots.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::Isometry3;

use super::Morphology;
use super::module::DriveAxis;
use realgap_core::Warning;
use realgap_core::unit::number;
use realgap_core::warning::Code;

/// Largest ratio of the masses of two jointed parts for which solvers keep the joint closed well.
const MASS_RATIO: f64 = 1000.0;
/// Plausible densities, from that of air to more than that of the densest metal, kg/m³.
const DENSITIES_KG_M3: std::ops::RangeInclusive<f64> = 1.2..=25_000.0;

/// In a robot of bodies, densities are checked only for bodies with at least this fraction of the robot's mass.
const SHARE: f64 = 0.01;

impl Morphology {
    /// Warnings about values that are valid but probably wrong: a gait that commands a larger speed than its servo's limit
    /// (`servo-too-slow`) or bends a face beyond a right angle (`bent-too-far`), a plate as large as its cube (`tied-plate`), a
    /// joint between a very light and a very heavy part (`mass-ratio`), a module with an implausible density (`unlikely-mass`), a
    /// gait beyond a joint's limits (`beyond-limits`).
    pub fn warnings(&self) -> Vec<Warning> {
        let modules = self.modules().iter();
        let mut warnings: Vec<Warning> = modules
            .filter_map(|module| {
                let drive = module.drive?;
                let peak_rad_s = TAU * drive.actuator.gait.frequency_hz * drive.actuator.gait.amplitude_rad.abs();
                let limit_rad_s = drive.actuator.servo.max_speed_rad_s;
                (peak_rad_s > limit_rad_s).then(|| {
                    Code::ServoTooSlow.warning(format!(
                        "the gait of `{}` asks for {peak_rad_s:.2} rad/s, its servo turns at {limit_rad_s} rad/s at most",
                        module.name
                    ))
                })
            })
            .collect();
        warnings.extend(self.bent_too_far());
        warnings.extend(self.tied_plates());
        warnings.extend(self.mass_ratios());
        warnings.extend(self.densities());
        warnings.extend(self.beyond_limits());
        warnings
    }

    fn densities(&self) -> Vec<Warning> {
        let modules = self.modules();
        // Links of imported robots often represent only frames or sensors, and state no realistic mass or size.
        let least_kg = match self.built.is_some() {
            true => SHARE * modules.iter().map(|module| module.mass_kg).sum::<f64>(),
            false => 0.0,
        };
        let doubts = modules.iter().filter_map(|module| {
            let density_kg_m3 = module.mass_kg / module.sides_m.product();
            // The density of a body without shapes is not finite.
            let counts = density_kg_m3.is_finite() && module.mass_kg >= least_kg;
            (counts && !DENSITIES_KG_M3.contains(&density_kg_m3)).then(|| {
                let [x, y, z] = [0, 1, 2].map(|axis| number(module.sides_m[axis]));
                Code::UnlikelyMass.warning(format!(
                    "`{}` of {x} x {y} x {z} m weighs {} kg, a density of {density_kg_m3:.3} kg/m³ (air has 1.2, water 1000): \
                         is the mass in kilograms, and are the lengths in metres?",
                    module.name,
                    module.mass_kg
                ))
            })
        });
        doubts.collect()
    }

    fn beyond_limits(&self) -> Vec<Warning> {
        let hinges = self.assemble().hinges;
        let beyond = hinges.iter().filter_map(|hinge| {
            let gait = hinge.actuator?.gait;
            let (low, high) = hinge.bearing.limits_rad?;
            let ends = [gait.offset_rad - gait.amplitude_rad.abs(), gait.offset_rad + gait.amplitude_rad.abs()];
            let slack = 1e-9 + 0.05 * (high - low);
            (ends[0] < low - slack || ends[1] > high + slack).then(|| {
                Code::BeyondLimits.warning(format!(
                    "the gait of `{}` goes from {} to {}, but its limits are {low} and {high}: lower offset_rad or amplitude_rad",
                    hinge.name,
                    ends[0],
                    ends[1]
                ))
            })
        });
        beyond.collect()
    }

    fn bent_too_far(&self) -> impl Iterator<Item = Warning> {
        self.modules().iter().filter_map(|module| {
            let drive = module.drive?;
            let farthest_rad = drive.actuator.gait.offset_rad.abs() + drive.actuator.gait.amplitude_rad.abs();
            let bends = matches!(drive.axis, DriveAxis::Tangent { .. });
            (bends && farthest_rad > FRAC_PI_2 * (1.0 + 1e-9)).then(|| {
                Code::BentTooFar.warning(format!(
                    "the gait of `{}` bends its face by up to {:.0} degrees, so that it overlaps its own cube: at most 90 degrees are possible; \
                         lower offset_rad or amplitude_rad",
                    module.name,
                    farthest_rad.to_degrees()
                ))
            })
        })
    }

    fn tied_plates(&self) -> impl Iterator<Item = Warning> {
        self.modules().iter().filter_map(|module| {
            let plate = module.plate()?;
            (module.is_cube() && plate.side_m == module.sides_m.x).then(|| {
                Code::TiedPlate.warning(format!(
                    "the plate of `{}` is as large as its cube: both carry the robot, and which of them slips depends only on the difference of their friction coefficients (friction_plate_relative of the noise)",
                    module.name
                ))
            })
        })
    }

    fn mass_ratios(&self) -> Vec<Warning> {
        let assembly = self.assemble();
        let masses_kg: Vec<f64> = assembly
            .parts
            .iter()
            .map(|part| part.mass(&Isometry3::identity()).mass_kg)
            .collect();
        let of = |hinge: &super::Hinge| {
            let [a, b] = [hinge.parent_part, hinge.child_part].map(|part| masses_kg[part]);
            (a.min(b), a.max(b))
        };
        let hinges = assembly.hinges.iter();
        hinges
            .filter(|hinge| {
                let (light_kg, heavy_kg) = of(hinge);
                // Links without mass are intended.
                light_kg > 0.0 && heavy_kg > MASS_RATIO * light_kg
            })
            .map(|hinge| {
                let (light_kg, heavy_kg) = of(hinge);
                Code::MassRatio.warning(format!(
                    "the joint `{}` has {light_kg} kg and {heavy_kg} kg on its sides: beyond a ratio of {MASS_RATIO} joints separate \
                         in any simulation; check the masses",
                    hinge.name
                ))
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gait_beyond_the_limits_of_its_joint_gives_a_warning() {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../morphologies/unitree_a1.ron"
        );
        let text = std::fs::read_to_string(file).unwrap();
        let codes = |text: &str| {
            let source = realgap_core::file::Source::new(file, text);
            let robot = Morphology::parse(&source).unwrap();
            let codes: Vec<Code> = robot
                .warnings()
                .iter()
                .map(|warning| warning.code)
                .collect();
            codes
        };
        assert_eq!(codes(&text), []);
        let swung = text.replacen("amplitude_rad: 0.", "amplitude_rad: 50.", 1);
        assert_ne!(swung, text);
        assert!(codes(&swung).contains(&Code::BeyondLimits));
    }
}
