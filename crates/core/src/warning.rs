//! Warnings are values: they travel with the result and are printed by the command line only.

use std::fmt;

use crate::text::shown;

/// Most characters of a message that are shown.
const SHOWN: usize = 1000;

/// Writes the enum of codes, their stable names, what to do about each, and the list of all.
macro_rules! codes {
    ($($variant:ident $name:literal $doc:literal $remedy:literal;)*) => {
        /// What a [`Warning`] is about; its name (`undefined-heading`) is stable and stands in every output.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        pub enum Code {
            $(#[doc = $doc] $variant,)*
        }

        impl Code {
            /// All codes, by name.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            /// The stable name.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }

            /// What it says, one sentence.
            pub fn about(self) -> &'static str {
                match self {
                    $(Self::$variant => $doc,)*
                }
            }

            /// What to do about it.
            pub fn remedy(self) -> &'static str {
                match self {
                    $(Self::$variant => $remedy,)*
                }
            }

            /// A warning about this, with one sentence for people.
            pub fn warning(self, message: impl Into<String>) -> Warning {
                Warning {
                    code: self,
                    message: message.into(),
                }
            }

            /// The code of that name.
            pub fn by_name(name: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|code| code.name() == name)
            }
        }
    };
}

codes! {
    AnchorInWall "anchor-in-wall" "A radio anchor stands in a wall, which does not count for it." "move the anchor or the wall in the arena's file";
    AtypicalPrediction "atypical-prediction" "The run without noise is unlike its own repeats." "trust the median of the repeats rather than the run without noise";
    BaselineNotBeaten "baseline-not-beaten" "A search found nothing better than what it started from." "give the search a larger budget, more modules or another strategy";
    BeliefRestarted "belief-restarted" "Readings were impossible at every distance, and a belief began again." "characterise the sensor over more distances, or let its model expect more wrong readings";
    BentTooFar "bent-too-far" "A gait bends a face into its own cube." "make amplitude or offset smaller in the robot's file";
    BeyondLimits "beyond-limits" "A gait asks a joint to go beyond its limits." "lower the gait's amplitude or offset (radians), or correct the limits";
    BodyContradicted "body-contradicted" "Flight says otherwise than the robot's file about masses, inertias or hinges." "take over what `realgap study identify` found, or weigh and measure the robot again";
    CentreOfMassContradicted "centre-of-mass-contradicted" "Flight puts the centre of mass elsewhere than the robot's file." "take over the values that `realgap study identify` writes";
    CentreOfMassOutside "centre-of-mass-outside" "A centre of mass lies outside of its cube." "correct the centre of mass in the robot's file";
    CoarseGrid "coarse-grid" "Beliefs are narrower than the cells of their grid." "give the belief more cells";
    ColumnsIgnored "columns-ignored" "A recording has columns that nothing uses." "say what the columns are when reading, or leave them out of the file";
    ComponentsMissDifference "components-miss-difference" "The kept principal components hardly see how two runs differ." "use the metric `rms`, or keep more components";
    CompressionUnknown "compression-unknown" "Pictures do not say with which quality they were compressed." "give pictures as the camera wrote them, and begin with a camera of its `jpeg_quality`";
    ContourStuck "contour-stuck" "A contour came to rest where there is no edge, or did not come to rest." "start the contour nearer to the edge, or look at the picture's contrast";
    DifferentDurations "different-durations" "Recordings of one comparison last differently long." "crop recordings to one length, or compare at equal times";
    DifferentRobots "different-robots" "Recordings of one comparison name different robots." "check that every recording is of the robot that is simulated";
    Diverged "diverged" "Simulations blew up and are left out." "use a shorter timestep or more substeps, or narrow the ranges that diverge";
    DuplicateSamples "duplicate-samples" "Samples that repeat the one before are left out." "nothing to do, unless the recorder should not repeat samples";
    EmptyHeadings "empty-headings" "A log never looked into some directions." "log another walk that looks into all directions";
    EnergyOpen "energy-open" "A balance of energy does not close." "use a shorter timestep; do not rely on energies of this run";
    EngineFallback "engine-fallback" "The chosen engine cannot simulate this experiment, and Rapier did." "choose the engine rapier, or leave out what the sentence names";
    EnginesDiffer "engines-differ" "Two equally valid engines want different values." "do not rely on what only one engine wants; measure the parameter by itself, or record a motion on which both agree";
    EstimatedNoise "estimated-noise" "Nobody stated the noise; an estimate is used." "state the noise in the study, or in a file of its own";
    EstimatedVelocity "estimated-velocity" "Velocities are differences of positions." "record velocities, or more samples a second";
    ExclusionNotExported "exclusion-not-exported" "A format cannot say which parts never touch." "exclude these contacts by hand in the other simulator";
    Extrapolated "extrapolated" "A model is asked beyond what it was fitted to." "record where the model is asked, or do not rely on it there";
    FewDistances "few-distances" "Too few distances to choose a form by what it predicts." "log more distances";
    FewPlaces "few-places" "Too few places to say how wrong a model is elsewhere." "log more places";
    FewRecordings "few-recordings" "Too few recordings for what is asked of them." "record more repeats of the same run";
    FewRepeats "few-repeats" "Too few repeats for what is asked of them." "ask for more";
    FewSessions "few-sessions" "Sessions are too few to tell how they differ." "log three sessions or more";
    FewerTerms "fewer-terms" "Polynomials have fewer terms than asked for: the log has too few samples." "log more samples, or ask for fewer terms";
    FloorNotExported "floor-not-exported" "A format has no floor." "add a floor by hand in the other simulator";
    FreeParameter "free-parameter" "A free parameter was given no value." "give it a value, or take it from a file of fitted ones";
    GaitNeedsProgram "gait-needs-program" "A format holds servos, but not what commands them." "command the servos from a program, as the file's comment says";
    GaitNotExported "gait-not-exported" "A format has no gait." "command the servos from a program";
    GaitTooFast "gait-too-fast" "A gait is faster than the steps can follow." "use a shorter timestep or a slower gait";
    GravityContradicted "gravity-contradicted" "Flight falls otherwise than gravity says." "check units and times of the recordings; `realgap study identify` says what flight tells";
    Hole "hole" "A recording has a hole that is interpolated." "record again, or crop the recording before the hole";
    ImpossibleReadings "impossible-readings" "Readings that cannot be were counted as missing." "check the sensor's wiring and range; the readings are counted as missing";
    InSample "in-sample" "The values were fitted on the same recordings." "judge on other recordings: hold some out, or fit in folds";
    Incomplete "incomplete" "The work was interrupted; this is what there is." "resume it, or run the command again";
    InsideWall "inside-wall" "Scans were taken where an arena has a wall." "correct the arena's walls or the logged places";
    KnownLimit "known-limit" "A result depends on something that the engine is known to do wrongly." "see docs/limits.md; check the result by another engine or by experiment";
    LackOfFit "lack-of-fit" "A fitted form misses the data by more than chance." "allow a form with more terms";
    LongTask "long-task" "A task took more than a week." "give durations in seconds";
    LookupBetter "lookup-better" "A lookup of the nearest logged scan foretells better than polynomials." "fit again in the frame `turned` or `nearest`";
    LostSamples "lost-samples" "Samples without numbers are left out." "look for gaps of the recorder; fine if they are few";
    MassRatio "mass-ratio" "A joint holds a very light and a very heavy part." "make the light part heavier, or use more substeps";
    ModelContradicted "model-contradicted" "No parameters of a model explain the recordings." "check axes, units, robot and gait (`realgap check`); then free contact parameters, or trust the widened intervals only";
    MovingAtEnd "moving-at-end" "Recordings that end while moving are left out, as the study asks." "record until the body rests";
    NoCamera "no-camera" "The noise has no camera, and recordings have one." "give the noise a `camera`, so that it knows what recording adds";
    NoEdges "no-edges" "A picture has no edges." "check that it is the right picture, and sharp";
    NoEffect "no-effect" "Something that was set changes nothing." "remove it, or check its name with `realgap study parameters`";
    NoFlight "no-flight" "No free flight was found." "record tosses in which the body flies for some samples";
    NoInterval "no-interval" "A model states no interval, so that its coverage says nothing." "fit a model that states one";
    NoNoise "no-noise" "Repeats that differ by nothing." "state at least one kind of noise";
    NoOwnPlaces "no-own-places" "Nobody said where things are in real pictures, so that where the camera stood counts." "say where things are in the real pictures, in a views.ron beside them";
    NoRecordings "no-recordings" "Nothing real to compare with." "name recordings, so that there is something real to compare with";
    NoRepeats "no-repeats" "No repeat of a simulation ended well." "use a shorter timestep or more substeps";
    NoSimulatedOdds "no-simulated-odds" "The simulated resting faces could not be counted." "start the runs as recorded (`start: FromRecording`) and record until the body rests";
    NoSuccessRule "no-success-rule" "Nobody said what success is." "say how far is far enough";
    NoSurvivor "no-survivor" "No finalist holds under other numerics." "build none of these before looking closer; search with finer numerics";
    NoWalls "no-walls" "No link of a log crosses a wall." "log links through walls, if walls matter";
    NotNormal "not-normal" "Readings are not spread normally." "use the histogram or a mixture in place of a normal distribution";
    NotSettled "not-settled" "A robot did not come to rest before its run." "lift the robot less, or give it longer to settle";
    NotWritten "not-written" "A result could not be written." "check the folder and the disk, then run the command again";
    OffFloor "off-floor" "Recorded poses put the robot into the floor, or leave it above." "check the robot's size, the unit of lengths, the axes, the order of quaternions and the floor's height";
    OneRecording "one-recording" "One recording does not know its own spread." "record at least two more repeats of the same run";
    OnlyDistributions "only-distributions" "Small differences grow so fast that single runs do not compare." "compare distributions (`realgap ensemble`, `realgap gap`) rather than single runs";
    OtherRobot "other-robot" "A recording names another robot." "check that the recording is of this robot";
    OutlineOutside "outline-outside" "A known outline lies outside of its picture." "give outlines in pixels of this picture, from its upper left corner";
    OutsideArena "outside-arena" "Readings were taken outside of the arena." "correct the arena's size or the logged places";
    Overfitted "overfitted" "Recordings that were held out are fitted worse." "free fewer parameters, or record more";
    PicturesUnpaired "pictures-unpaired" "Pictures have no partner of the same name and are left out." "give both pictures of a pair one name";
    PlateBlocked "plate-blocked" "A plate hits its own robot." "turn or move the module whose plate is in the way";
    QuantisedReadings "quantised-readings" "Readings come in steps as wide as they spread." "nothing to do: the spread counts the steps; a finer reading would tell more";
    QuaternionOrder "quaternion-order" "Orientations look as if their real part stood elsewhere." "say which column holds the real part";
    QuaternionsRenormalised "quaternions-renormalised" "Orientations had lengths other than 1." "nothing to do if the lengths were near 1";
    ReadAs "read-as" "Recordings are read otherwise than as they stand." "say with the options of docs/recordings.md how the file is meant, if this is wrong";
    RefinedStart "refined-start" "Start states have seen more than the first sample." "judge on recordings whose start was not refined";
    RestitutionNotExported "restitution-not-exported" "A format has no restitution." "set the restitution by hand in the other simulator";
    RoughScore "rough-score" "Least squares met a score that is not smooth." "take another optimizer, e.g. cma-es, or begin it where this one ended";
    SameRun "same-run" "One run is named twice." "name every run once: repeats that are copies make reality look more repeatable than it is";
    SamplesSorted "samples-sorted" "Samples are sorted by time." "nothing to do, unless the recorder's clock jumps";
    ScansWithoutPose "scans-without-pose" "Scans outside of the times of the poses are left out." "record poses for as long as scans";
    ServoTooSlow "servo-too-slow" "A gait asks for more speed than its servo has." "make the gait slower or smaller, or give the servo its true speed";
    SeveralMaterials "several-materials" "Readings off different materials are fitted as one sensor." "fit each material by itself";
    SeveralPeaks "several-peaks" "Readings of one distance crowd in several places." "look at the histograms: an echo, a step of the converter or a second surface may be why";
    SeveralRobots "several-robots" "A recording looks like the paths of several robots." "choose one robot by the value of a column";
    SeveralSessions "several-sessions" "Sessions of a log are taken together." "fit each session by itself";
    ShortRecording "short-recording" "A recording ends before the study." "record longer, or shorten `duration_s` of the study";
    ShorterSimulation "shorter-simulation" "A simulation ends before its recording." "simulate as long as the recording";
    SolverNotExported "solver-not-exported" "A format does not hold the solver's settings." "set timestep and solver by hand in the other simulator";
    SpeedLimitInvented "speed-limit-invented" "A format asks for a speed limit that the robot does not have." "check the speed limit in the written file";
    SpringNotExported "spring-not-exported" "Springs, armatures, compliance and marks are not in an exported file." "set them in the other program; mjcf holds all but compliance";
    StaleSamples "stale-samples" "Samples repeat the joints of the one before although commands move." "read the joints again in every sample, or expect errors as large as they move in one";
    StandIn "stand-in" "A simulator made the recordings." "record real runs: a fit to a simulator says nothing about reality";
    Standstill "standstill" "A recording begins before the robot moves." "crop the standstill";
    TiedPlate "tied-plate" "A plate carries as much as its cube, and chance decides which of them slips." "change the robot a little, so that plate and cube do not carry alike";
    Toppled "toppled" "A robot fell over before its run." "turn the robot, or start it lower";
    TrackNotExported "track-not-exported" "A format cannot say which module is tracked." "choose the tracked body by hand in the other simulator";
    UncertainParameters "uncertain-parameters" "Parameters that tuning left open were drawn." "fit with more recordings, so that fewer values are left open";
    UndefinedHeading "undefined-heading" "A path that goes nowhere has no heading." "compare with a metric that needs no heading, or let the robot walk farther";
    UnequalMoments "unequal-moments" "Moments of inertia differ where a method takes them as equal." "use a body whose moments are equal, or do not rely on spins";
    UnknownAxes "unknown-axes" "A recording does not say which way its axes point, or its motion says otherwise." "say it when reading: `axes: \"world\"` (z up), `y-up`, `z-down` or `camera` (z forward, y down)";
    UnlikelyAngle "unlikely-angle" "Recorded angles lie far beyond their joint's limits." "name columns of degrees NAME_deg, or give the joint its zero or its true limits";
    UnlikelyLength "unlikely-length" "Lengths do not fit the robot, or each other." "name the unit of lengths when reading";
    UnlikelyMass "unlikely-mass" "A module is lighter than air or denser than any metal." "give masses in kilograms and lengths in metres";
    UnlikelyTime "unlikely-time" "Times do not look like seconds." "name the unit of time when reading";
    UnmatchedConditions "unmatched-conditions" "A condition stands in one of two logs only." "log the same conditions in both";
    Unresolved "unresolved" "Numerical settings change a score as much as a parameter does." "use finer numerics, another gait or another metric; more recordings will not help";
    UnsynchronisedClocks "unsynchronised-clocks" "Joints move before they are told to, or ever later." "stamp commands and angles by one clock";
    VelocitiesLate "velocities-late" "Recorded velocities belong to an earlier moment." "let `realgap study identify` correct the lag, or record velocities without filter";
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

/// Something the reader of a result should know; `code` is stable, `message` is for people.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Warning {
    /// What it is about.
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
