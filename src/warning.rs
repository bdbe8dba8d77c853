//! Warnings are values: they travel with the result and are printed by the command line only.

use std::fmt;

use crate::text::shown;

/// Most characters of a message that are shown.
const SHOWN: usize = 1000;

/// Writes the enum of codes, their stable names and the list of all.
macro_rules! codes {
    ($($variant:ident $name:literal $doc:literal;)*) => {
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
        }
    };
}

codes! {
    AnchorInWall "anchor-in-wall" "A radio anchor stands in a wall, which does not count for it.";
    AtypicalPrediction "atypical-prediction" "The run without noise is unlike its own repeats.";
    BaselineNotBeaten "baseline-not-beaten" "A search found nothing better than what it started from.";
    BeliefRestarted "belief-restarted" "Readings were impossible at every distance, and a belief began again.";
    BentTooFar "bent-too-far" "A gait bends a face into its own cube.";
    BodyContradicted "body-contradicted" "Flight says otherwise than the robot's file about masses, inertias or hinges.";
    CentreOfMassContradicted "centre-of-mass-contradicted" "Flight puts the centre of mass elsewhere than the robot's file.";
    CentreOfMassOutside "centre-of-mass-outside" "A centre of mass lies outside of its cube.";
    CoarseGrid "coarse-grid" "Beliefs are narrower than the cells of their grid.";
    ColumnsIgnored "columns-ignored" "A recording has columns that nothing uses.";
    ComponentsMissDifference "components-miss-difference" "The kept principal components hardly see how two runs differ.";
    ContourStuck "contour-stuck" "A contour came to rest where there is no edge, or did not come to rest.";
    DifferentDurations "different-durations" "Recordings of one comparison last differently long.";
    DifferentRobots "different-robots" "Recordings of one comparison name different robots.";
    Diverged "diverged" "Simulations blew up and are left out.";
    DuplicateSamples "duplicate-samples" "Samples that repeat the one before are left out.";
    EmptyHeadings "empty-headings" "A log never looked into some directions.";
    EnergyOpen "energy-open" "A balance of energy does not close.";
    EstimatedNoise "estimated-noise" "Nobody stated the noise; an estimate is used.";
    EstimatedVelocity "estimated-velocity" "Velocities are differences of positions.";
    ExclusionNotExported "exclusion-not-exported" "A format cannot say which parts never touch.";
    Extrapolated "extrapolated" "A model is asked beyond what it was fitted to.";
    FewDistances "few-distances" "Too few distances to choose a form by what it predicts.";
    FewPlaces "few-places" "Too few places to say how wrong a model is elsewhere.";
    FewRecordings "few-recordings" "Too few recordings for what is asked of them.";
    FewRepeats "few-repeats" "Too few repeats for what is asked of them.";
    FewerTerms "fewer-terms" "Polynomials have fewer terms than asked for: the log has too few samples.";
    FloorNotExported "floor-not-exported" "A format has no floor.";
    FreeParameter "free-parameter" "A free parameter was given no value.";
    GaitNeedsProgram "gait-needs-program" "A format holds servos, but not what commands them.";
    GaitNotExported "gait-not-exported" "A format has no gait.";
    GaitTooFast "gait-too-fast" "A gait is faster than the steps can follow.";
    GravityContradicted "gravity-contradicted" "Flight falls otherwise than gravity says.";
    Hole "hole" "A recording has a hole that is interpolated.";
    ImpossibleReadings "impossible-readings" "Readings that cannot be were counted as missing.";
    InSample "in-sample" "The values were fitted on the same recordings.";
    Incomplete "incomplete" "The work was interrupted; this is what there is.";
    InsideWall "inside-wall" "Scans were taken where an arena has a wall.";
    KnownLimit "known-limit" "A result depends on something that the engine is known to do wrongly.";
    LackOfFit "lack-of-fit" "A fitted form misses the data by more than chance.";
    LostSamples "lost-samples" "Samples without numbers are left out.";
    MassRatio "mass-ratio" "A joint holds a very light and a very heavy part.";
    MovingAtEnd "moving-at-end" "Recordings that end while moving are left out, as the study asks.";
    NoCamera "no-camera" "The noise has no camera, and recordings have one.";
    NoEffect "no-effect" "Something that was set changes nothing.";
    NoFlight "no-flight" "No free flight was found.";
    NoInterval "no-interval" "A model states no interval, so that its coverage says nothing.";
    NoNoise "no-noise" "Repeats that differ by nothing.";
    NoOwnPlaces "no-own-places" "Nobody said where things are in real pictures, so that where the camera stood counts.";
    NoRecordings "no-recordings" "Nothing real to compare with.";
    NoRepeats "no-repeats" "No repeat of a simulation ended well.";
    NoSimulatedOdds "no-simulated-odds" "The simulated resting faces could not be counted.";
    NoSuccessRule "no-success-rule" "Nobody said what success is.";
    NoSurvivor "no-survivor" "No finalist holds under other numerics.";
    NoWalls "no-walls" "No link of a log crosses a wall.";
    NotNormal "not-normal" "Readings are not spread normally.";
    NotSettled "not-settled" "A robot did not come to rest before its run.";
    NotWritten "not-written" "A result could not be written.";
    OneRecording "one-recording" "One recording does not know its own spread.";
    OnlyDistributions "only-distributions" "Small differences grow so fast that single runs do not compare.";
    OtherRobot "other-robot" "A recording names another robot.";
    OutsideArena "outside-arena" "Readings were taken outside of the arena.";
    Overfitted "overfitted" "Recordings that were held out are fitted worse.";
    PicturesUnpaired "pictures-unpaired" "Pictures have no partner of the same name and are left out.";
    PlateBlocked "plate-blocked" "A plate hits its own robot.";
    QuaternionOrder "quaternion-order" "Orientations look as if their real part stood elsewhere.";
    QuaternionsRenormalised "quaternions-renormalised" "Orientations had lengths other than 1.";
    ReadAs "read-as" "Recordings are read otherwise than as they stand.";
    RefinedStart "refined-start" "Start states have seen more than the first sample.";
    RestitutionNotExported "restitution-not-exported" "A format has no restitution.";
    SamplesSorted "samples-sorted" "Samples are sorted by time.";
    ScansWithoutPose "scans-without-pose" "Scans outside of the times of the poses are left out.";
    ServoTooSlow "servo-too-slow" "A gait asks for more speed than its servo has.";
    SeveralMaterials "several-materials" "Readings off different materials are fitted as one sensor.";
    SeveralRobots "several-robots" "A recording looks like the paths of several robots.";
    SeveralSessions "several-sessions" "Sessions of a log are taken together.";
    ShortRecording "short-recording" "A recording ends before the study.";
    ShorterSimulation "shorter-simulation" "A simulation ends before its recording.";
    SolverNotExported "solver-not-exported" "A format does not hold the solver's settings.";
    SpeedLimitInvented "speed-limit-invented" "A format asks for a speed limit that the robot does not have.";
    StandIn "stand-in" "A simulator made the recordings.";
    Standstill "standstill" "A recording begins before the robot moves.";
    TiedPlate "tied-plate" "A plate carries as much as its cube, and chance decides which of them slips.";
    Toppled "toppled" "A robot fell over before its run.";
    TrackNotExported "track-not-exported" "A format cannot say which module is tracked.";
    UncertainParameters "uncertain-parameters" "Parameters that tuning left open were drawn.";
    UndefinedHeading "undefined-heading" "A path that goes nowhere has no heading.";
    UnequalMoments "unequal-moments" "Moments of inertia differ where a method takes them as equal.";
    UnlikelyLength "unlikely-length" "Lengths do not fit the robot, or each other.";
    UnlikelyTime "unlikely-time" "Times do not look like seconds.";
    UnmatchedConditions "unmatched-conditions" "A condition stands in one of two logs only.";
    Unresolved "unresolved" "Numerical settings change a score as much as a parameter does.";
    VelocitiesLate "velocities-late" "Recorded velocities belong to an earlier moment.";
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
pub struct Warning {
    /// What it is about.
    pub code: Code,
    /// One sentence for people.
    pub message: String,
}

impl Warning {
    /// A warning about `code`, with one sentence for people.
    pub fn new(code: Code, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
        }
    }
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
