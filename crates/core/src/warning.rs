//! Warnings: values that are returned with a result; only the command line prints them.

use std::fmt;

use crate::text::shown;

/// The largest number of characters of a message that is shown.
const SHOWN: usize = 1000;

/// Declares the enum of codes with their stable names, descriptions and remedies, and the list of all codes.
macro_rules! codes {
    ($($variant:ident $name:literal $doc:literal $remedy:literal;)*) => {
        /// The subject of a [`Warning`]; its name (e.g. `undefined-heading`) never changes and is part of every output.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        pub enum Code {
            $(#[doc = $doc] $variant,)*
        }

        impl Code {
            /// All codes, sorted by name.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            /// The stable name.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }

            /// What the warning means, in one sentence.
            pub fn about(self) -> &'static str {
                match self {
                    $(Self::$variant => $doc,)*
                }
            }

            /// What the user can do about the warning.
            pub fn remedy(self) -> &'static str {
                match self {
                    $(Self::$variant => $remedy,)*
                }
            }

            /// A warning with this code and a message of one sentence for people.
            pub fn warning(self, message: impl Into<String>) -> Warning {
                Warning {
                    code: self,
                    message: message.into(),
                }
            }

            /// The code with this name.
            pub fn by_name(name: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|code| code.name() == name)
            }
        }
    };
}

codes! {
    AnchorInWall "anchor-in-wall" "A radio anchor stands in a wall, and this wall does not count as an obstacle for it." "move the anchor or the wall in the arena's file";
    AtypicalPrediction "atypical-prediction" "The run without noise is not typical of its own repeats with noise." "trust the median of the repeats rather than the run without noise";
    BaselineNotBeaten "baseline-not-beaten" "A search found nothing better than what it started from." "give the search a larger budget, more modules or another strategy";
    BeliefRestarted "belief-restarted" "Readings were impossible at every distance, so a belief was reset." "characterise the sensor over more distances, or let its model allow for more wrong readings";
    BentTooFar "bent-too-far" "A gait bends a face into its own cube." "make amplitude or offset smaller in the robot's file";
    BeyondLimits "beyond-limits" "A gait asks a joint to go beyond its limits." "lower the gait's amplitude or offset (radians), or correct the limits";
    BodyContradicted "body-contradicted" "Recorded free flight contradicts the masses, inertias or hinges of the robot's file." "adopt the values that `realgap study identify` found, or weigh and measure the robot again";
    CentreOfMassContradicted "centre-of-mass-contradicted" "Recorded free flight gives another centre of mass than the robot's file." "adopt the values that `realgap study identify` writes";
    CentreOfMassOutside "centre-of-mass-outside" "A centre of mass lies outside of its cube." "correct the centre of mass in the robot's file";
    ChangedUnit "changed-unit" "A part of a recording is in another unit of length than the rest." "scale this part of the file, or crop the recording to one side of it";
    ClockOffset "clock-offset" "The stamps of two recordings look as if one clock were ahead of the other." "let the offset be estimated, or correct the stamps of one file";
    CoarseEncoder "coarse-encoder" "A joint moves over a few steps of its encoder only." "record a larger motion of this joint, or leave its parameters out";
    CoarseGrid "coarse-grid" "Beliefs (distributions over the position) are narrower than the cells of their grid." "give the belief more cells";
    ColumnsIgnored "columns-ignored" "A recording has columns that nothing uses." "say what the columns are when reading, or leave them out of the file";
    CompensationNotExported "compensation-not-exported" "The compensation of weight in an exported file acts at another place." "give all bodies of a part the same gravity_compensation";
    ComponentsMissDifference "components-miss-difference" "The kept principal components contain little of the difference between two runs." "use the metric `rms`, or keep more components";
    CompressionUnknown "compression-unknown" "The files of pictures do not state the quality with which they were compressed." "give the pictures as the camera wrote them, and start from a camera file with their `jpeg_quality`";
    ContactsOff "contacts-off" "Contacts are switched off, so the robot passes through itself and the floor." "switch contacts on where anything may touch";
    ContourStuck "contour-stuck" "A contour came to rest where there is no edge, or did not come to rest." "start the contour nearer to the edge, or look at the picture's contrast";
    DegreesAsRadians "degrees-as-radians" "Angles, commands or speeds of a joint look like degrees that were read as radians." "name columns of degrees NAME_deg (speeds NAME_deg_s)";
    DifferentDurations "different-durations" "Recordings of one comparison have different durations." "crop recordings to one length, or compare at equal times";
    DifferentRobots "different-robots" "Recordings of one comparison name different robots." "check that every recording is of the robot that is simulated";
    Diverged "diverged" "Simulations diverged numerically and are left out." "use a shorter timestep or more substeps, or narrow the ranges that diverge";
    DuplicateSamples "duplicate-samples" "Samples that repeat the previous sample are left out." "nothing to do, unless the recorder should not repeat samples";
    EmptyHeadings "empty-headings" "A log has no readings in some directions." "log another walk that looks in all directions";
    EnergyOpen "energy-open" "The energy balance of a run does not close." "use a shorter timestep; do not rely on energies of this run";
    EngineFallback "engine-fallback" "The chosen engine cannot simulate this experiment, so Rapier simulated it." "choose the engine rapier, or remove what the message names";
    EnginesDiffer "engines-differ" "Two equally valid engines are fitted best by different values." "do not rely on a value that only one engine supports; measure the parameter directly, or record a motion on which both engines agree";
    EstimatedNoise "estimated-noise" "No noise was stated, so an estimate is used." "state the noise in the study, or in a file of its own";
    EstimatedVelocity "estimated-velocity" "Velocities were not recorded; they are computed from differences of positions." "record velocities, or more samples a second";
    ExchangedJoints "exchanged-joints" "Two joints follow each other's commands." "exchange the names of the two measured columns, or of the two commanded ones";
    ExclusionNotExported "exclusion-not-exported" "A format cannot store which parts never touch." "exclude these contacts by hand in the other simulator";
    Extrapolated "extrapolated" "A model is used outside of the range it was fitted to." "record data in this range as well, or do not rely on the model there";
    FewDistances "few-distances" "A log has too few distances to choose a form by its predictions." "log more distances";
    FewPlaces "few-places" "A log has too few places to estimate a model's error at other places." "log more places";
    FewRecordings "few-recordings" "There are too few recordings for this analysis." "record more repeats of the same run";
    FewRepeats "few-repeats" "There are too few repeats for this analysis." "request more repeats";
    FewSessions "few-sessions" "There are too few sessions to estimate how sessions differ." "log three sessions or more";
    FewerTerms "fewer-terms" "Polynomials have fewer terms than requested, because the log has too few samples." "log more samples, or request fewer terms";
    FlippedSign "flipped-sign" "A joint moves against its command or against its recorded speed." "change the sign of its angles, or of its commands or speeds";
    FloorNotExported "floor-not-exported" "A format cannot store a floor." "add a floor by hand in the other simulator";
    FoldedDirections "folded-directions" "Paths are turned before they are compared, although directions matter." "state `align: World` in the study, where recordings and simulation share a world frame";
    FreeParameter "free-parameter" "A free parameter was given no value." "give it a value, or take it from a file of fitted ones";
    FrozenTracker "frozen-tracker" "A pose repeats exactly over many samples, and then jumps." "leave the frozen samples out, or crop the recording to one side of them";
    GaitNeedsProgram "gait-needs-program" "A format stores the servos, but not the commands that drive them." "command the servos from a program, as the file's comment says";
    GaitNotExported "gait-not-exported" "A format cannot store a gait." "command the servos from a program";
    GaitTooFast "gait-too-fast" "A gait is too fast for the simulation's timestep." "use a shorter timestep or a slower gait";
    GravityContradicted "gravity-contradicted" "Recorded free flight has another acceleration than gravity." "check units and times of the recordings; `realgap study identify` shows what the flight determines";
    Hole "hole" "A recording has a gap in time that is filled by interpolation." "record again, or crop the recording before the gap";
    ImplausibleGains "implausible-gains" "Gains of a servo do not fit its robot or its recordings." "state gains in N m/rad and N m s/rad at the joint; where only a firmware's numbers are known, leave them out and let stiffness and damping be fitted";
    ImpossibleReadings "impossible-readings" "Impossible readings were counted as missing." "check the sensor's wiring and range; the readings are counted as missing";
    InSample "in-sample" "The values were fitted to the same recordings that judge them." "judge on other recordings: hold some out, or fit in folds";
    Incomplete "incomplete" "The work was interrupted, so the results are incomplete." "resume it, or run the command again";
    InsideWall "inside-wall" "Scans were taken where an arena has a wall." "correct the arena's walls or the logged places";
    JointDropout "joint-dropout" "A joint's angle drops to exactly 0 and returns." "leave the samples out in which the joint was not read";
    KnownLimit "known-limit" "A result depends on something that the engine is known to simulate wrongly." "see docs/limits.md; check the result by another engine or by experiment";
    LackOfFit "lack-of-fit" "A fitted form deviates from the data by more than chance." "allow a form with more terms";
    LongTask "long-task" "A task took more than a week." "give durations in seconds";
    LookupBetter "lookup-better" "A lookup of the nearest logged scan predicts better than polynomials." "fit again in the frame `turned` or `nearest`";
    LostAsZero "lost-as-zero" "Positions are exactly 0, and the path beside them is elsewhere." "leave these samples out, or write nothing in place of lost numbers";
    LostPackets "lost-packets" "Packets were lost between a robot and its recorder." "leave these rows out, crop to a part without losses, or record again over a better link";
    LostSamples "lost-samples" "Samples without numbers are left out." "check the recorder for dropouts; a few lost samples do no harm";
    MassRatio "mass-ratio" "A joint holds a very light and a very heavy part." "make the light part heavier, or use more substeps";
    ModelContradicted "model-contradicted" "No parameters of a model explain the recordings." "check axes, units, robot and gait (`realgap check`); then fit contact parameters as well, or trust the widened intervals only";
    MovingAtEnd "moving-at-end" "Recordings that end while moving are left out, as the study asks." "record until the body rests";
    NoCamera "no-camera" "The noise has no camera, although the recordings were made by one." "give the noise a `camera`, so that it includes the errors of recording";
    NoEdges "no-edges" "A picture has no edges." "check that it is the right picture, and sharp";
    NoEffect "no-effect" "A setting changes nothing in the result." "remove it, or check its name with `realgap study parameters`";
    NoFlight "no-flight" "No free flight was found." "record throws in which the body is in the air for some samples";
    NoInterval "no-interval" "A model states no interval, so its coverage has no meaning." "fit a model that states an interval";
    NoNoise "no-noise" "All repeats are identical." "state at least one kind of noise";
    NoOwnPlaces "no-own-places" "The places of things in the real pictures are not given, so the comparison depends on where the camera stood." "state where things are in the real pictures, in a views.ron beside them";
    NoRecordings "no-recordings" "There is no real recording to compare with." "name recordings to compare with";
    NoRepeats "no-repeats" "There is no usable repeat of a run." "use a shorter timestep or more substeps";
    NoSimulatedOdds "no-simulated-odds" "The simulated resting faces could not be counted." "start the runs as recorded (`start: FromRecording`) and record until the body rests";
    NoSuccessRule "no-success-rule" "No success rule was given." "state the distance that counts as success";
    NoSurvivor "no-survivor" "No finalist keeps its performance under other numerical settings." "check these robots further before you build one; search with finer numerical settings";
    NoWalls "no-walls" "No link of a log crosses a wall." "log links through walls, if walls matter";
    NormalisedAngles "normalised-angles" "Angles look like positions that are normalised to ±100." "convert them with the calibration with which they were recorded, or record in degrees";
    NotAudited "not-audited" "An answer was not checked by further runs." "resume the run with the audit before you rely on the answer";
    NotConverged "not-converged" "A fit by least squares had not ended when its budget did." "tune with a larger budget";
    NotNormal "not-normal" "Readings are not normally distributed." "use the histogram or a mixture in place of a normal distribution";
    NotReproducible "not-reproducible" "The study's own simulator answers one question differently each time." "seed its random numbers with the `seed` of each question, and begin every answer in the same state";
    NotSettled "not-settled" "A robot did not come to rest before its run." "lift the robot less, or give it longer to settle";
    NotWritten "not-written" "A result could not be written." "check the folder and the disk, then run the command again";
    OffFloor "off-floor" "Recorded poses place the robot inside the floor or above it." "check the robot's size, the unit of lengths, the axes, the order of quaternions and the floor's height";
    OneRecording "one-recording" "One recording does not show how much repeats of a run differ." "record at least two more repeats of the same run";
    OnlyDistributions "only-distributions" "Small differences grow so fast that single runs cannot be compared." "compare distributions (`realgap ensemble`, `realgap gap`) rather than single runs";
    OtherRobot "other-robot" "A recording names another robot." "check that the recording is of this robot";
    OutlineOutside "outline-outside" "A known outline lies outside of its picture." "give outlines in pixels of this picture, from its upper left corner";
    OutsideArena "outside-arena" "Readings were taken outside of the arena." "correct the arena's size or the logged places";
    Overfitted "overfitted" "Recordings that were held out are fitted worse than the others." "fit fewer parameters, or record more";
    PicturesUnpaired "pictures-unpaired" "Pictures have no partner of the same name and are left out." "give both pictures of a pair one name";
    PlateBlocked "plate-blocked" "A plate collides with its own robot." "turn or move the module whose plate is in the way";
    QuantisedReadings "quantised-readings" "Readings come in steps as wide as their spread." "nothing to do: the spread includes the steps; a finer resolution would give more information";
    QuaternionOrder "quaternion-order" "Orientations look as if their real part were in another column." "state which column holds the real part";
    QuaternionsRenormalised "quaternions-renormalised" "Quaternions had lengths other than 1 and were normalised." "nothing to do if the lengths were near 1";
    ReadAs "read-as" "Recordings are interpreted differently from what their files state." "state how the file is meant with the options of docs/recordings.md, if this is wrong";
    RefinedStart "refined-start" "Start states were estimated from more than the first sample." "judge on recordings whose start was not refined";
    RegionUntouched "region-untouched" "Nothing ever touched a region of the floor, so its friction changes nothing." "let the robot's way lead over the region, correct its corners, or leave its parameters out";
    RestitutionNotExported "restitution-not-exported" "A format cannot store restitution." "set the restitution by hand in the other simulator";
    RoughScore "rough-score" "The least-squares optimizer met a score that is not smooth." "use another optimizer, e.g. cma-es, or start it where this one ended";
    SameRun "same-run" "One run is named twice." "name every run once: with copies, reality looks more repeatable than it is";
    SamplesSorted "samples-sorted" "Samples are sorted by time." "nothing to do, unless the recorder's clock jumps";
    SaturatedCommands "saturated-commands" "Commands are at their largest or smallest value most of the time." "record again with smaller motions, or crop to a part in which the commands move";
    ScansWithoutPose "scans-without-pose" "Scans outside of the times of the poses are left out." "record poses for as long as scans";
    ServoTooSlow "servo-too-slow" "A gait needs a higher speed than its servo reaches." "make the gait slower or smaller, or give the servo its true speed";
    SeveralMaterials "several-materials" "Readings of different materials are fitted as one sensor." "fit each material by itself";
    SeveralPeaks "several-peaks" "Readings at one distance have several peaks." "look at the histograms: possible causes are an echo, a step of the converter or a second surface";
    SeveralRobots "several-robots" "A recording looks like the paths of several robots." "choose one robot by the value of a column, or give each a file of its own";
    SeveralSessions "several-sessions" "Several sessions of a log are fitted together." "fit each session by itself";
    ShortRecording "short-recording" "A recording is shorter than the study." "record longer, or shorten `duration_s` of the study";
    ShorterSimulation "shorter-simulation" "A simulation ends before its recording." "simulate as long as the recording";
    SlowJoints "slow-joints" "A robot has so many multibody joints that Rapier takes long." "choose the engine tree, whose time grows in proportion to the number of joints";
    SolverNotExported "solver-not-exported" "A format cannot store the solver's settings." "set timestep and solver by hand in the other simulator";
    SpeedLimitInvented "speed-limit-invented" "A format requires a speed limit, and the robot has none." "check the speed limit in the written file";
    Spike "spike" "A position or an angle leaves its path for a few samples and returns." "leave these samples out, or record again";
    SpringNotExported "spring-not-exported" "Springs, armatures, compliance and marks are not in an exported file." "set them in the other program; mjcf holds all but compliance";
    StaleSamples "stale-samples" "Samples repeat the joint angles of the previous sample although the commands change." "read the joints again in every sample, or expect errors as large as the joints' motion in one sample";
    StandIn "stand-in" "The recordings were made by a simulator." "record real runs: a fit to a simulator proves nothing about reality";
    Standstill "standstill" "A recording begins before the robot moves." "crop the standstill";
    SwitchedOff "switched-off" "A joint stands still while its command moves, and follows it elsewhere." "crop the recording, or give it a column NAME_on of 0 and 1 that says when the servo is on";
    TiedPlate "tied-plate" "A plate carries as much load as its cube, so chance decides which of them slips." "change the robot a little, so that plate and cube carry different loads";
    Toppled "toppled" "A robot fell over before its run." "turn the robot, or start it lower";
    TrackNotExported "track-not-exported" "A format cannot store which module is tracked." "choose the tracked body by hand in the other simulator";
    TurningNotExported "turning-not-exported" "A format cannot store all rolling and torsional friction." "set both by hand in the other simulator";
    TyreNotExported "tyre-not-exported" "A format cannot store tyres, or how an actuator takes its commands." "set friction and commands by hand in the other simulator";
    UncertainParameters "uncertain-parameters" "Parameters that calibration did not determine were drawn at random." "fit with more recordings, so that more values are determined";
    UnconfirmedPosterior "unconfirmed-posterior" "Runs at draws of a posterior fit worse than the posterior promises." "tune with another seed or a larger budget, and compare the intervals";
    UndefinedHeading "undefined-heading" "A path that goes nowhere has no heading." "compare with a metric that needs no heading, or let the robot walk farther";
    UnequalMoments "unequal-moments" "Moments of inertia differ although a method assumes that they are equal." "use a body whose moments are equal, or do not rely on spins";
    UnitInName "unit-in-name" "A unit was stated, but the name of a column states another one, which is used." "if the name is wrong, map the column with its unit, e.g. `columns: (x: \"x_m in mm\")`";
    UnknownAxes "unknown-axes" "A recording does not state the directions of its axes, or its motion contradicts them." "state them when reading: `axes: \"world\"` (z up), `y-up`, `z-down` or `camera` (z forward, y down)";
    UnlikelyAngle "unlikely-angle" "Recorded angles lie far beyond their joint's limits." "name columns of degrees NAME_deg, or give the joint its zero or its true limits";
    UnlikelyLength "unlikely-length" "Lengths do not fit the robot, or each other." "name the unit of lengths when reading";
    UnlikelyMass "unlikely-mass" "A module is lighter than air or denser than any metal." "give masses in kilograms and lengths in metres";
    UnlikelyTime "unlikely-time" "Times do not look like seconds." "name the unit of time when reading";
    UnmatchedConditions "unmatched-conditions" "A condition is in only one of two logs." "log the same conditions in both";
    UnmatchedSamples "unmatched-samples" "Large parts of two recordings have no partner in the other." "check that the files are of the same run and clock; else compare times since each start";
    Unresolved "unresolved" "Numerical settings change a score as much as a parameter does." "use finer numerics, another gait or another metric; more recordings will not help";
    UnsynchronisedClocks "unsynchronised-clocks" "Joints move before their command, or with a growing delay." "stamp commands and angles with one clock";
    VelocitiesLate "velocities-late" "Recorded velocities belong to an earlier moment." "let `realgap study identify` correct the lag, or record velocities without a filter";
    WindowsLeftOut "windows-left-out" "Some windows of recordings are not simulated, as the study asks." "nothing, or change `windows` in the study";
    WrappedAngle "wrapped-angle" "A joint's angle jumps by a full turn." "unwrap the angles before they are read, e.g. with `numpy.unwrap`";
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl serde::Serialize for Code {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Something the reader of a result should know; programs read `code`, which is stable, and people read `message`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Warning {
    /// The subject of the warning.
    pub code: Code,
    /// One sentence for people.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} [{}]", shown(&self.message, SHOWN), self.code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_named_once_in_kebab_case_and_sorted() {
        let names: Vec<&str> = Code::ALL.iter().map(|code| code.name()).collect();
        assert!(names.windows(2).all(|pair| pair[0] < pair[1]), "{names:?}");
        let kebab = |name: &str| name.bytes().all(|b| b.is_ascii_lowercase() || b == b'-');
        assert!(names.iter().all(|name| kebab(name)), "{names:?}");
    }
}
