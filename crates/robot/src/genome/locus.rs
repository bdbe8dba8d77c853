//! What each of the ten numbers of a gene means: the one table.

use realgap_core::Result;
use realgap_core::file::look_up;

/// The meaning of one number of a gene. Every number is from 0 to 1, whatever it means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Locus {
    /// Passive below [`passive_share`](super::Development::passive_share), active from there on.
    Kind,
    /// Quarter turns of the part built so far about x, before the new module comes.
    RollPart,
    /// Quarter turns of the part built so far about y, after those about x.
    PitchPart,
    /// Which way the driven face of the new module looks.
    FaceModule,
    /// Which of the columns of cubes takes the new module on its top, counted along x.
    PlaceX,
    /// The same along y, among the columns at that x.
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
    /// All ten, in the order of a gene.
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

    /// Name in files and tables.
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

    /// The number of this name.
    ///
    /// # Errors
    /// An unknown name, with the known ones.
    pub fn named(name: &str) -> Result<Self> {
        look_up("number of a gene", name, Self::ALL, |locus| locus.name())
    }

    /// True where 0 and 1 are neighbours: a mutation that leaves at one end comes back at the other.
    pub fn is_periodic(self) -> bool {
        matches!(self, Self::RollPart | Self::PitchPart | Self::Phase)
    }

    /// True where the number describes the body, false where it describes the gait.
    pub fn is_body(self) -> bool {
        !matches!(
            self,
            Self::Amplitude | Self::Frequency | Self::Phase | Self::Offset
        )
    }
}
