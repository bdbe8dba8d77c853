//! *How far is my simulated robot from my real one, what closes the gap, and how sure may I be?*
//!
//! `realgap` simulates robots with Rapier or a solver of its own, compares what they do with recorded real runs, and
//! searches the parameters of the simulation (friction, restitution, any other named number) for what matches
//! reality best, together with the confidence set: everything that fits as well. The method is that of
//! "Lessons on the Reality-Gap: Iterations between Virtual and Real Robots" (paper 003 in these pages).
//!
//! # Primer
//!
//! Data flows one way, and every module is a step that can be used alone:
//!
//! [`robot`] → [`simulation`] → [`trajectory`] → [`comparison`] → [`calibration`] → [`prediction`] → [`search`] → [`results`]
//!
//! A robot is a text; a simulation is plain data that [`simulation::run`] turns into a trajectory; [`comparison::compare`] gives the
//! distance between two trajectories:
//!
//! ```
//! use realgap::comparison::compare;
//! use realgap::robot::morphology::Morphology;
//! use realgap::simulation::{Experiment, run};
//! use realgap::{trajectory, unit::LengthUnit};
//!
//! let real = trajectory::read("real_trajectories/tripod_mujoco/run_00.csv", LengthUnit::Metre)?.trajectory;
//!
//! let mut experiment = Experiment::new(Morphology::read("morphologies/tripod.ron")?.assemble());
//! experiment.duration_s = real.duration_s();
//! let simulated = run(&experiment)?.outcome.into_result()?;
//!
//! let score = compare(&real, &simulated, "rms")?;
//! println!("{score}");
//! assert!(score.value > 0.0 && score.value < 1.0);
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
//! [`RunOptions`] hold the number of threads, the function that is told the progress, and the signal that stops a run. A store that
//! survives a crash ([`Study::sweep_into`](calibration::Study::sweep_into)) and pictures ([`results::write`]) are steps of their own. Ensembles
//! ([`prediction::EnsembleReport`]), gaps ([`prediction::gap::StudyGap`]) and cards ([`prediction::Card`]) are values that print
//! themselves, too. Short programs for each lie in `examples/`.
//!
//! Errors are one type, [`Error`]; warnings are values that travel with results; the library never prints.
//!
//! Units are SI and stand in the names, and so do frames. The ideas, conventions and terms are in [`guide::concepts`], the first
//! steps in [`guide::start`], the reasons for decisions in [`guide::design`], the measurements in [`guide::validation`].

#[cfg(feature = "schema")]
pub mod schema;

// A crate that is one module of the library has that module's name.
#[doc(inline)]
pub use realgap_guest as guest;
#[doc(inline)]
pub use realgap_identification as identification;
#[doc(inline)]
pub use realgap_inference as inference;
#[doc(inline)]
pub use realgap_optimization as optimization;
#[doc(inline)]
pub use realgap_robot as robot;
#[doc(inline)]
pub use realgap_sensing as sensing;
#[doc(inline)]
pub use realgap_simulation as simulation;
#[doc(inline)]
pub use realgap_store as store;
#[doc(inline)]
pub use realgap_verification as verification;
#[cfg(feature = "papers")]
#[doc(inline)]
pub use realgap_vision as vision;

// Crates of several modules show each under its own name.
#[doc(inline)]
pub use realgap_core::{error, file, quantity, random, statistics, table, text, unit, warning};
#[doc(inline)]
pub use realgap_lab::{calibration, claim, plan, prediction, search};
#[doc(inline)]
pub use realgap_page::{plot, report, results};
#[doc(inline)]
pub use realgap_path::{comparison, trajectory};

pub use realgap_core::{Advice, Error, ErrorKind, Result, Warning};
pub use realgap_optimization::{Progress, RunOptions};

/// The pages of `docs/`, shipped with the code they describe.
pub mod guide {
    /// A module for every page, each with the links to all pages, headings and pictures: pictures as seen from the folder that
    /// `cargo doc` writes. A page defines the same names once more, at its end, for those who read it as a file: rustdoc uses the
    /// first definition.
    macro_rules! pages {
        (
            pictures: $($picture:ident)*;
            pages: $($page:ident)*;
            headings: { $($path:tt: $($heading:literal)*;)* }
            $($(#[$about:meta])* $folder:ident: $($inner:ident)*;)*
        ) => {
            macro_rules! links {
                () => {
                    concat!(
                        "\n[docs/validation.md]: crate::guide::validation\n",
                        $("[docs/", stringify!($page), ".md]: crate::guide::", stringify!($page), "\n",)*
                        $(link_inside!($folder: $($inner)*),)*
                        $(links_to_headings!($path: $($heading)*),)*
                        $("[docs/images/", stringify!($picture), ".png]: ../../../../../docs/images/",
                            stringify!($picture), ".png\n",)*
                    )
                };
            }
            $(
                #[doc = links!()]
                #[doc = include_str!(concat!("../docs/", stringify!($page), ".md"))]
                pub mod $page {}
            )*
            $(
                $(#[$about])*
                pub mod $folder {
                    pages_inside!($folder: $($inner)*);
                }
            )*
        };
    }

    macro_rules! link_inside {
        ($folder:ident: $($page:ident)*) => {
            concat!($("[docs/", stringify!($folder), "/", stringify!($page), ".md]: crate::guide::", stringify!($folder), "::",
                stringify!($page), "\n",)*)
        };
    }

    macro_rules! links_to_headings {
        ($path:tt: $($heading:literal)*) => {
            concat!($(link_to_heading!($path $heading),)*)
        };
    }

    macro_rules! link_to_heading {
        ([$($step:ident)*] $heading:literal) => {
            concat!("[docs", $("/", stringify!($step),)* ".md#", $heading, "]: crate::guide", $("::", stringify!($step),)* "#",
                $heading, "\n")
        };
    }

    macro_rules! pages_inside {
        ($folder:ident: $($page:ident)*) => {
            $(
                #[doc = links!()]
                #[doc = include_str!(concat!("../docs/", stringify!($folder), "/", stringify!($page), ".md"))]
                pub mod $page {}
            )*
        };
    }

    // A page is a word in this table, and so is a heading that another page links; `tests/document/documentation.rs` compares the
    // table with the folder.
    pages! {
        pictures: aloha compare confidence convergence corner curves ensemble fitness gallery heatmap histograms joints map paths profile ride
            robot seen sensitivity sensor so101_arm steps template time times tosses trajectories turtlebot3_burger unitree_a1 unitree_go2 verdict
            visits watched;
        pages: start concepts robots recordings control simulator simulator_examples scale cli files results python gallery limits compare design bibliography;
        headings: {
            [bibliography]:
                "sensors";
            [compare]:
                "how-near-do-these-programs-come-to-the-same-real-tosses";
            [concepts]:
                "archive" "armature" "band" "basis" "bayes-filter" "behaviour" "best-point" "body-length" "brier-score" "case"
                "claim" "cma-es" "conformal-prediction" "cost-of-transport" "coverage" "descriptor" "development" "diverged"
                "emulator" "energy-ratio" "energy-score" "energy-test" "ensemble" "envelope" "equally-valid-settings"
                "experiment" "extractor" "failure" "finalist" "fingerprint" "fingerprinting" "fold" "gait" "gap" "gap-ratio"
                "genome" "glossary" "hard-contact" "history-matching" "hold-out" "identification" "implausible" "impulse-joint"
                "in-sample" "indistinguishable" "interval" "map-elites" "metric" "model-discrepancy" "model-error" "module"
                "morphology" "multibody-joint" "net-displacement" "noise" "noise-floor" "numerical-audit" "objective"
                "overfitted" "parameter" "plate" "point" "prediction-card" "prepared-path" "prior" "profile" "provenance"
                "recording" "repeat" "restitution" "resume" "run" "sampling-error" "score" "sensorgraph" "servo-law" "session"
                "settled" "shard" "simulation-confidence" "stand-in" "strategy" "study" "substep" "time-of-a-comparison" "timestep" "toppled"
                "tracked-module" "trajectory" "trajectory-files" "transfer" "tree-solver" "trial" "verdict" "wave"
                "winners-curse";
            [design]:
                "does-the-model-explain-the-recordings" "files-pictures-pages" "what-is-the-score-of-a-point";
            [gallery]:
                "the-papers-row-by-row";
            [python]:
                "functions-of-your-own";
            [recordings]:
                "joint-logs";
            [results]:
                "pages";
            [robots]:
                "floors-that-differ-from-place-to-place" "limits-of-the-import";
            [simulator]:
                "timesteps-and-intervals";
            [upstream restitution]:
                "friction-does-not-feel-restitution";
            [validation contact]:
                "against-other-engines" "the-table" "what-do-timestep-and-substeps-cost" "which-joints";
            [validation intervals]:
                "bands-of-predictions" "fits-of-joints-by-least-squares";
            [validation radio]:
                "what-it-costs";
            [validation verification]:
                "the-checks";
        }
        #[doc = links!()]
        #[doc = include_str!("../docs/validation.md")]
        validation: verification contact joints tosses hardware servo arm legs car floors robots compiled energy engines stand_ins tuning intervals ensembles
            gap search sensing radio vision pages;
        /// Defects of the engine, each with the output of a program that shows it.
        upstream: contact_stiffness friction_direction multibody_cost multibody_root multibody_swing restitution small_inertia;
    }
}
