//! *How far is my simulated robot from my real one, what closes the gap, and how sure may I be?*
//!
//! `realgap` simulates robots with Rapier or a solver of its own, compares what they do with recorded real runs, and
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

// A crate that is one module of the library has that module's name.
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
    /// A module for every page, each with the links to all pages and pictures: pictures as seen from the folder that `cargo doc`
    /// writes. A page defines the same names once more, at its end, for those who read it as a file: the first definition wins.
    macro_rules! pages {
        (
            pictures: $($picture:ident)*;
            pages: $($page:ident)*;
            $($(#[$about:meta])* $room:ident: $($inner:ident)*;)*
        ) => {
            macro_rules! links {
                () => {
                    concat!(
                        "\n[docs/fidelity.md]: crate::guide::fidelity\n",
                        $("[docs/", stringify!($page), ".md]: crate::guide::", stringify!($page), "\n",)*
                        $(link_inside!($room: $($inner)*),)*
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
                pub mod $room {
                    pages_inside!($room: $($inner)*);
                }
            )*
        };
    }

    macro_rules! link_inside {
        ($room:ident: $($page:ident)*) => {
            concat!($("[docs/", stringify!($room), "/", stringify!($page), ".md]: crate::guide::", stringify!($room), "::",
                stringify!($page), "\n",)*)
        };
    }

    macro_rules! pages_inside {
        ($room:ident: $($page:ident)*) => {
            $(
                #[doc = links!()]
                #[doc = include_str!(concat!("../docs/", stringify!($room), "/", stringify!($page), ".md"))]
                pub mod $page {}
            )*
        };
    }

    // A page is a word in this table; `tests/document/documentation.rs` holds it to the folder.
    pages! {
        pictures: compare confidence convergence corner curves ensemble fitness gallery heatmap histograms joints map paths profile ride
            robot seen sensitivity sensor so101_arm steps template time times tosses trajectories turtlebot3_burger unitree_a1 visits
            watched;
        pages: tutorial cli results conventions files python recordings joints robots control scale glossary gallery pages design compare limits
            questions bibliography;
        #[doc = links!()]
        #[doc = include_str!("../docs/fidelity.md")]
        fidelity: verification contact settings joints tosses energy hardware servo engines stand_ins tuning
            intervals sensitivity ensembles gap genomes search sensing radio vision;
        /// Defects of the engine, each with what a program shows of it.
        upstream: contact_stiffness friction_direction multibody_cost multibody_root multibody_swing restitution small_inertia;
    }
}
