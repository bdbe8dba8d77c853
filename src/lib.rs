//! *How far is my simulated robot from my real one, what closes the gap, and how sure may I be?*
//!
//! `realgap` simulates modular cube robots with Rapier, compares what they do with recorded real runs, and
//! searches the parameters of the simulation (friction, restitution, any other named number) for what matches
//! reality best, together with everything that cannot be told apart from the best. The method is that of
//! "Lessons on the Reality-Gap: Iterations between Virtual and Real Robots" (paper 003 in these pages).
//!
//! # Primer
//!
//! Data flows one way, and every room is a step that can be used alone:
//!
//! [`robot`] → [`simulation`] → [`trajectory`] → [`comparison`] → [`calibration`] → [`prediction`] → [`search`] → [`results`]
//!
//! A robot is a text; a simulation is plain data that [`simulation::run`] turns into a trajectory; two
//! trajectories, prepared, have a distance:
//!
//! ```
//! use realgap::comparison::{Context, Pair, by_name};
//! use realgap::file::Source;
//! use realgap::robot::morphology::Morphology;
//! use realgap::simulation::{Experiment, run};
//! use realgap::trajectory::prepare;
//!
//! let robot = Morphology::parse(&Source::new(
//!     "walker",
//!     r#"(
//!         name: "walker",
//!         defaults: (side_m: 0.06, mass_kg: 0.1),
//!         modules: [
//!             (name: "tail", kind: Active(face: PosX, axis: Tangent(axis: PosY),
//!                 servo: (law: Velocity(gain_1_s: 20.0), max_torque_nm: 0.5),
//!                 gait: (amplitude_rad: 0.6, frequency_hz: 1.0))),
//!             (name: "head", kind: Passive()),
//!         ],
//!         glue: [(parent: "tail", face: PosX, child: "head")],
//!     )"#,
//! ))?;
//!
//! let mut real = Experiment::new(robot.assemble());
//! real.duration_s = 2.0;
//! let mut simulated = real.clone();
//! simulated.floor.friction = 0.2;
//!
//! let motions = [run(&real)?.outcome.into_result()?, run(&simulated)?.outcome.into_result()?];
//! let prepared = [prepare(&motions[0])?, prepare(&motions[1])?];
//! let pair = Pair {
//!     real: &motions[0],
//!     simulated: &motions[1],
//!     real_prepared: &prepared[0],
//!     simulated_prepared: &prepared[1],
//! };
//! let score = by_name("rms")?.compare(&pair, &Context::default())?;
//! assert!(score.value > 0.0 && score.value < 0.5, "{} {}", score.value, score.unit);
//! # Ok::<(), realgap::Error>(())
//! ```
//!
//! Recordings, a robot and what is not known of it are a [`calibration::Study`]; what it answers says how sure it is:
//!
//! ```
//! use realgap::calibration::Study;
//! use realgap::robot::morphology::Morphology;
//! use realgap::unit::LengthUnit;
//! use realgap::{RunOptions, comparison, trajectory};
//!
//! let real = trajectory::read("real_trajectories/tripod_standin/run_00.csv", LengthUnit::Metre)?;
//! let study = Study::builder("friction", Morphology::read("morphologies/tripod.ron")?)
//!     .recording(real)
//!     .duration_s(2.0)
//!     .vary("floor.friction", 0.1, 0.9, 5)
//!     .metric(comparison::by_name("rms")?)
//!     .build()?;
//! let answer = study.sweep(&RunOptions::default())?;
//! println!("{answer}");
//! assert!(answer.report.verdicts[0].low <= answer.report.verdicts[0].best);
//! # Ok::<(), realgap::Error>(())
//! ```
//!
//! [`RunOptions`] say on how many threads, who hears of the progress, and what stops it. A store that survives a crash
//! ([`Study::sweep_into`](calibration::Study::sweep_into)) and pictures ([`results::write`]) are steps of their own. Ensembles
//! ([`prediction::EnsembleReport`]), gaps ([`prediction::gap::StudyGap`]) and cards ([`prediction::Card`]) are values that print
//! themselves, too. Short programs for each lie in `examples/`.
//!
//! Errors are one type, [`Error`]; warnings are values that travel with results; the library never prints.
//!
//! Units are SI and stand in the names, frames too: [`guide::conventions`]. Why things are as they are:
//! [`guide::design`]. What was measured: [`guide::fidelity`]. Words: [`guide::glossary`].

#[cfg(feature = "schema")]
pub mod schema;

/// From recordings to parameters of the simulation, and how sure one may be of them.
pub mod calibration {
    #[doc(inline)]
    pub use realgap_lab::calibration::*;
    #[doc(inline)]
    pub use realgap_vision::tuning as camera;
}

/// From an experiment to a run.
pub mod simulation {
    #[doc(inline)]
    pub use realgap_engine::*;
    #[doc(inline)]
    pub use realgap_verify as verification;
}

/// What robots perceive, and how far a simulated sensor is from the real one.
pub mod sensing {
    #[doc(inline)]
    pub use realgap_sense::{arena, belief, graph, radio, range};
    #[doc(inline)]
    pub use realgap_vision as vision;
}

/// Robots: modules, servos and glue; genomes and what they develop into.
pub mod robot {
    #[doc(inline)]
    pub use realgap_robot::{genome, morphology};
}

#[doc(inline)]
pub use realgap_core::{error, file, quantity, random, statistics, table, text, unit, warning};
#[doc(inline)]
pub use realgap_engine::export;
#[doc(inline)]
pub use realgap_lab::{plan, prediction, search};
#[doc(inline)]
pub use realgap_optimize as optimization;
#[doc(inline)]
pub use realgap_page::{plot, report, results};
#[doc(inline)]
pub use realgap_path::{comparison, trajectory};
#[doc(inline)]
pub use realgap_robot::import;
#[doc(inline)]
pub use realgap_sense::task;
#[doc(inline)]
pub use realgap_store as store;

pub use realgap_core::{Advice, Error, ErrorKind, Result, Warning};
pub use realgap_optimize::{Progress, RunOptions};

/// The pages of `docs/`, shipped with the code they describe.
pub mod guide {
    /// Where the links of the pages lead in these pages. A page defines the same names once more, at its end, for
    /// those who read it as a file: the first definition wins.
    macro_rules! links {
        () => {
            "
[docs/tutorial.md]: crate::guide::tutorial
[docs/cli.md]: crate::guide::cli
[docs/conventions.md]: crate::guide::conventions
[docs/recordings.md]: crate::guide::recordings
[docs/robots.md]: crate::guide::robots
[docs/gallery.md]: crate::guide::gallery
[docs/files.md]: crate::guide::files
[docs/python.md]: crate::guide::python
[docs/scale.md]: crate::guide::scale
[docs/pages.md]: crate::guide::pages
[docs/glossary.md]: crate::guide::glossary
[docs/design.md]: crate::guide::design
[docs/fidelity.md]: crate::guide::fidelity
[docs/compare.md]: crate::guide::compare
[docs/limits.md]: crate::guide::limits
[docs/bibliography.md]: crate::guide::bibliography
[docs/fidelity/verification.md]: crate::guide::fidelity::verification
[docs/fidelity/contact.md]: crate::guide::fidelity::contact
[docs/fidelity/settings.md]: crate::guide::fidelity::settings
[docs/fidelity/precision.md]: crate::guide::fidelity::precision
[docs/fidelity/joints.md]: crate::guide::fidelity::joints
[docs/fidelity/tosses.md]: crate::guide::fidelity::tosses
[docs/fidelity/energy.md]: crate::guide::fidelity::energy
[docs/fidelity/hardware.md]: crate::guide::fidelity::hardware
[docs/fidelity/servo.md]: crate::guide::fidelity::servo
[docs/fidelity/engines.md]: crate::guide::fidelity::engines
[docs/fidelity/stand_ins.md]: crate::guide::fidelity::stand_ins
[docs/fidelity/tuning.md]: crate::guide::fidelity::tuning
[docs/fidelity/intervals.md]: crate::guide::fidelity::intervals
[docs/fidelity/sensitivity.md]: crate::guide::fidelity::sensitivity
[docs/fidelity/ensembles.md]: crate::guide::fidelity::ensembles
[docs/fidelity/gap.md]: crate::guide::fidelity::gap
[docs/fidelity/genomes.md]: crate::guide::fidelity::genomes
[docs/fidelity/search.md]: crate::guide::fidelity::search
[docs/fidelity/sensing.md]: crate::guide::fidelity::sensing
[docs/fidelity/radio.md]: crate::guide::fidelity::radio
[docs/fidelity/vision.md]: crate::guide::fidelity::vision
[docs/upstream/contact_stiffness.md]: crate::guide::upstream::contact_stiffness
[docs/upstream/friction_direction.md]: crate::guide::upstream::friction_direction
[docs/upstream/multibody_root.md]: crate::guide::upstream::multibody_root
[docs/upstream/restitution.md]: crate::guide::upstream::restitution
"
        };
    }

    /// The pictures, as seen from the folder that `cargo doc` writes.
    macro_rules! pictures {
        () => {
            "
[docs/images/compare.png]: ../../../../../docs/images/compare.png
[docs/images/confidence.png]: ../../../../../docs/images/confidence.png
[docs/images/convergence.png]: ../../../../../docs/images/convergence.png
[docs/images/curves.png]: ../../../../../docs/images/curves.png
[docs/images/ensemble.png]: ../../../../../docs/images/ensemble.png
[docs/images/fitness.png]: ../../../../../docs/images/fitness.png
[docs/images/gallery.png]: ../../../../../docs/images/gallery.png
[docs/images/heatmap.png]: ../../../../../docs/images/heatmap.png
[docs/images/histograms.png]: ../../../../../docs/images/histograms.png
[docs/images/map.png]: ../../../../../docs/images/map.png
[docs/images/paths.png]: ../../../../../docs/images/paths.png
[docs/images/profile.png]: ../../../../../docs/images/profile.png
[docs/images/ride.png]: ../../../../../docs/images/ride.png
[docs/images/watched.png]: ../../../../../docs/images/watched.png
[docs/images/seen.png]: ../../../../../docs/images/seen.png
[docs/images/robot.png]: ../../../../../docs/images/robot.png
[docs/images/sensitivity.png]: ../../../../../docs/images/sensitivity.png
[docs/images/sensor.png]: ../../../../../docs/images/sensor.png
[docs/images/steps.png]: ../../../../../docs/images/steps.png
[docs/images/template.png]: ../../../../../docs/images/template.png
[docs/images/time.png]: ../../../../../docs/images/time.png
[docs/images/times.png]: ../../../../../docs/images/times.png
[docs/images/visits.png]: ../../../../../docs/images/visits.png
[docs/images/trajectories.png]: ../../../../../docs/images/trajectories.png
"
        };
    }

    #[doc = links!()]
    #[doc = include_str!("../docs/tutorial.md")]
    pub mod tutorial {}

    #[doc = links!()]
    #[doc = include_str!("../docs/cli.md")]
    pub mod cli {}

    #[doc = links!()]
    #[doc = include_str!("../docs/conventions.md")]
    pub mod conventions {}

    #[doc = links!()]
    #[doc = include_str!("../docs/files.md")]
    pub mod files {}

    #[doc = links!()]
    #[doc = include_str!("../docs/python.md")]
    pub mod python {}

    #[doc = links!()]
    #[doc = include_str!("../docs/recordings.md")]
    pub mod recordings {}

    #[doc = links!()]
    #[doc = include_str!("../docs/robots.md")]
    pub mod robots {}

    #[doc = links!()]
    #[doc = include_str!("../docs/scale.md")]
    pub mod scale {}

    #[doc = links!()]
    #[doc = include_str!("../docs/glossary.md")]
    pub mod glossary {}

    #[doc = links!()]
    #[doc = pictures!()]
    #[doc = include_str!("../docs/gallery.md")]
    pub mod gallery {}

    #[doc = links!()]
    #[doc = include_str!("../docs/pages.md")]
    pub mod pages {}

    #[doc = links!()]
    #[doc = include_str!("../docs/design.md")]
    pub mod design {}

    /// Defects of the engine, each with a program that shows it.
    pub mod upstream {
        #[doc = links!()]
        #[doc = include_str!("../docs/upstream/contact_stiffness.md")]
        pub mod contact_stiffness {}

        #[doc = links!()]
        #[doc = include_str!("../docs/upstream/friction_direction.md")]
        pub mod friction_direction {}

        #[doc = links!()]
        #[doc = include_str!("../docs/upstream/multibody_root.md")]
        pub mod multibody_root {}

        #[doc = links!()]
        #[doc = include_str!("../docs/upstream/restitution.md")]
        pub mod restitution {}
    }

    #[doc = links!()]
    #[doc = include_str!("../docs/fidelity.md")]
    pub mod fidelity {
        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/verification.md")]
        pub mod verification {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/contact.md")]
        pub mod contact {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/settings.md")]
        pub mod settings {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/precision.md")]
        pub mod precision {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/joints.md")]
        pub mod joints {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/tosses.md")]
        pub mod tosses {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/energy.md")]
        pub mod energy {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/hardware.md")]
        pub mod hardware {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/servo.md")]
        pub mod servo {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/engines.md")]
        pub mod engines {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/stand_ins.md")]
        pub mod stand_ins {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/tuning.md")]
        pub mod tuning {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/intervals.md")]
        pub mod intervals {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/sensitivity.md")]
        pub mod sensitivity {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/ensembles.md")]
        pub mod ensembles {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/gap.md")]
        pub mod gap {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/genomes.md")]
        pub mod genomes {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/search.md")]
        pub mod search {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/sensing.md")]
        pub mod sensing {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/radio.md")]
        pub mod radio {}

        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity/vision.md")]
        pub mod vision {}
    }

    #[doc = links!()]
    #[doc = include_str!("../docs/compare.md")]
    pub mod compare {}

    #[doc = links!()]
    #[doc = include_str!("../docs/limits.md")]
    pub mod limits {}

    #[doc = links!()]
    #[doc = include_str!("../docs/bibliography.md")]
    pub mod bibliography {}
}
