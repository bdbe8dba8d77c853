//! Why a genome does not become a robot.

use std::fmt;

use realgap_core::Error;

/// Why a genome does not develop. Modules are counted from 0, in the order of building.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum DevelopmentError {
    /// More genes than the settings allow.
    TooManyModules {
        /// How many.
        found: usize,
        /// The most that are allowed.
        allowed: usize,
    },
    /// The driven face of the new module looks at a neighbour that it would not be glued to: its plate has no room.
    NoRoomForPlate {
        /// The new module.
        module: usize,
        /// The module in the way.
        neighbour: usize,
    },
    /// The new module would stand where an older one has its plate.
    PlateInTheWay {
        /// The new module.
        module: usize,
        /// The module whose plate is in the way.
        neighbour: usize,
    },
    /// The plates of the new module and of an older one would stick out into the same cell from two sides.
    PlateOnPlate {
        /// The new module.
        module: usize,
        /// The module with the other plate.
        neighbour: usize,
    },
    /// The driven faces of the new module and of the one below would be glued onto each other.
    ServoOnServo {
        /// The new module.
        module: usize,
        /// The module below.
        below: usize,
    },
    /// Everything stands in its place, but no robot of these sizes can be built so.
    Refused(Error),
}

impl DevelopmentError {
    /// A stable short name, for tables and counts.
    pub fn code(&self) -> &'static str {
        match self {
            Self::TooManyModules { .. } => "too-many-modules",
            Self::NoRoomForPlate { .. } => "no-room-for-plate",
            Self::PlateInTheWay { .. } => "plate-in-the-way",
            Self::PlateOnPlate { .. } => "plate-on-plate",
            Self::ServoOnServo { .. } => "servo-on-servo",
            Self::Refused(_) => "refused",
        }
    }
}

impl fmt::Display for DevelopmentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooManyModules { found, allowed } => {
                write!(f, "{found} modules, where at most {allowed} are allowed")
            }
            Self::NoRoomForPlate { module, neighbour } => write!(
                f,
                "the driven face of module {module} looks at module {neighbour} and has no room for its plate"
            ),
            Self::PlateInTheWay { module, neighbour } => write!(
                f,
                "module {module} would stand where module {neighbour} has its plate"
            ),
            Self::PlateOnPlate { module, neighbour } => write!(
                f,
                "the plates of module {module} and module {neighbour} would be in the same place"
            ),
            Self::ServoOnServo { module, below } => write!(
                f,
                "module {module} would be glued with its driven face onto the driven face of module {below}"
            ),
            Self::Refused(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for DevelopmentError {}

impl From<DevelopmentError> for Error {
    fn from(misfit: DevelopmentError) -> Self {
        match misfit {
            DevelopmentError::Refused(error) => error,
            other => Self::invalid("the genome does not develop into a robot")
                .found(&other)
                .hint("change the gene of that module, or draw another genome"),
        }
    }
}
