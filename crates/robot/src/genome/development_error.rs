//! Error type of development: the reasons why a genome cannot be built as a robot.

use std::fmt;

use realgap_core::Error;

/// Reason why a genome cannot be built as a robot. Modules are counted from 0, in the order in which they are added.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum DevelopmentError {
    /// The genome has more genes than the settings allow.
    TooManyModules {
        /// Number of genes.
        found: usize,
        /// Largest allowed number of genes.
        allowed: usize,
    },
    /// The driven face of the new module points at a neighbour to which it would not be attached: there is no space for its
    /// plate.
    NoRoomForPlate {
        /// The new module.
        module: usize,
        /// The module in the way.
        neighbour: usize,
    },
    /// The new module would occupy the cell that holds the plate of an older module.
    PlateInTheWay {
        /// The new module.
        module: usize,
        /// The module whose plate is in the way.
        neighbour: usize,
    },
    /// The plates of the new module and of an older module would extend into the same cell from two sides.
    PlateOnPlate {
        /// The new module.
        module: usize,
        /// The module with the other plate.
        neighbour: usize,
    },
    /// The driven faces of the new module and of the module below it would be attached to each other.
    ServoOnServo {
        /// The new module.
        module: usize,
        /// The module below.
        below: usize,
    },
    /// The modules fit together, but the robot is refused for another reason, for example its sizes.
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
                "the driven face of module {module} points at module {neighbour}, which leaves no space for its plate"
            ),
            Self::PlateInTheWay { module, neighbour } => write!(
                f,
                "module {module} would be in the cell that holds the plate of module {neighbour}"
            ),
            Self::PlateOnPlate { module, neighbour } => write!(
                f,
                "the plates of module {module} and module {neighbour} would be in the same place"
            ),
            Self::ServoOnServo { module, below } => write!(
                f,
                "module {module} would be attached with its driven face to the driven face of module {below}"
            ),
            Self::Refused(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for DevelopmentError {}

impl From<DevelopmentError> for Error {
    fn from(error: DevelopmentError) -> Self {
        match error {
            DevelopmentError::Refused(error) => error,
            other => Self::invalid("the genome does not develop into a robot")
                .found(&other)
                .hint("change the gene of that module, or draw another genome"),
        }
    }
}
