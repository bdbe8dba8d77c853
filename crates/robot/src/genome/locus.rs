//! Names and meanings of the ten numbers of a gene.

use realgap_core::Result;
use realgap_core::file::look_up;

/// The meaning of one number of a gene. Every number is between 0 and 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Locus {
    /// Kind of module: passive below [`passive_share`](super::Development::passive_share), active at and above it.
    Kind,
    /// Quarter turns of the already built part about x, before the new module is added.
    RollPart,
    /// Quarter turns of the already built part about y, after those about x.
    PitchPart,
    /// Direction of the driven face of the new module.
    FaceModule,
    /// The column of cubes on top of which the new module is placed, counted along x.
    PlaceX,
    /// The column's position along y, among the columns at that x.
    PlaceY,
    /// Amplitude of the gait.
    Amplitude,
    /// Frequency of the gait.
    Frequency,
    /// Phase of the gait.
    Phase,
    /// Mean angle of the gait.
    Offset,
}

impl Locus {
    /// All ten numbers, in the order of a gene.
    pub const ALL: [Self; 10] = [
        Self::Kind,
        Self::RollPart,
        Self::PitchPart,
        Self::FaceModule,
        Self::PlaceX,
        Self::PlaceY,
        Self::Amplitude,
        Self::Frequency,
        Self::Phase,
        Self::Offset,
    ];

    /// Position in a gene.
    pub fn index(self) -> usize {
        self as usize
    }

    /// Name of the number in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kind => "kind",
            Self::RollPart => "roll_part",
            Self::PitchPart => "pitch_part",
            Self::FaceModule => "face_module",
            Self::PlaceX => "place_x",
            Self::PlaceY => "place_y",
            Self::Amplitude => "amplitude",
            Self::Frequency => "frequency",
            Self::Phase => "phase",
            Self::Offset => "offset",
        }
    }

    /// Finds a number by its name.
    ///
    /// # Errors
    /// An unknown name; the error lists the known names.
    pub fn named(name: &str) -> Result<Self> {
        look_up("number of a gene", name, Self::ALL, |locus| locus.name())
    }

    /// True if the number is periodic: 0 and 1 mean the same, and a mutation beyond one end continues at the other end.
    pub fn is_periodic(self) -> bool {
        matches!(self, Self::RollPart | Self::PitchPart | Self::Phase)
    }

    /// True if the number describes the body, false if it describes the gait.
    pub fn is_body(self) -> bool {
        !matches!(
            self,
            Self::Amplitude | Self::Frequency | Self::Phase | Self::Offset
        )
    }
}
