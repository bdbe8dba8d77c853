//! Random numbers: one kind of generator (ChaCha8), and a named stream for everything that draws.
//!
//! All streams stand in the tables of this file, so that two things that must not depend on each
//! other never draw the same numbers by accident: a test compares every stream with every other.
//! A stream's number is part of every published result and never changes.
//!
//! Optimizers are the one exception: libraries bring generators of their own, which get the seed of
//! their brief and nothing else.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The generator behind every stream.
pub type Generator = ChaCha8Rng;

/// Streams that are drawn anew for every numbered repeat or step: number k is the same whatever the
/// others are, so that any one can be replayed alone.
///
/// ```
/// use rand::Rng;
/// use realgap_core::random::Numbered;
///
/// let first = |stream: Numbered, repeat| stream.generator(7, repeat).next_u64();
/// assert_eq!(first(Numbered::Camera, 3), first(Numbered::Camera, 3));
/// assert_ne!(first(Numbered::Camera, 3), first(Numbered::Camera, 4));
/// assert_ne!(first(Numbered::Camera, 3), first(Numbered::ModuleMass, 3));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Numbered {
    /// Start position, height, tilt and heading of a repeat, and the zeros of its servos.
    Start,
    /// Velocity and spin of a repeat's start.
    StartMotion,
    /// Errors of a camera that records a repeat: positions and orientations.
    Camera,
    /// Errors of the times of that camera.
    CameraTime,
    /// Gain of each servo.
    ServoGain,
    /// Phase of each servo's command.
    ServoPhase,
    /// Age of the command that each servo acts on.
    ServoLatency,
    /// Mass of each module.
    ModuleMass,
    /// Friction of each module.
    ModuleFriction,
    /// Friction of all modules of a repeat.
    RunFriction,
    /// Friction of each plate on top of its module's.
    PlateFriction,
    /// What a search draws in one of its steps: parents, operators, children.
    SearchStep,
    /// Values of parameters that are only known to be in a range, for one repeat.
    UncertainParameter,
    /// Which point of a sweep is simulated again.
    Refinement,
    /// What a sensor reads.
    SensorReading,
    /// Errors of wheels: how far a command goes, how far it turns.
    Actuator,
    /// What places add to the strength of a radio signal.
    Shadowing,
    /// What happens to a message: fading, loss, latency.
    Message,
    /// Photons and electrons of one row of a picture.
    PictureNoise,
    /// Where the camera of a picture really stands.
    CameraPlace,
}

impl Numbered {
    /// Every stream.
    pub const ALL: [Self; 20] = [
        Self::Start,
        Self::StartMotion,
        Self::Camera,
        Self::CameraTime,
        Self::ServoGain,
        Self::ServoPhase,
        Self::ServoLatency,
        Self::ModuleMass,
        Self::ModuleFriction,
        Self::RunFriction,
        Self::PlateFriction,
        Self::SearchStep,
        Self::UncertainParameter,
        Self::Refinement,
        Self::SensorReading,
        Self::Actuator,
        Self::Shadowing,
        Self::Message,
        Self::PictureNoise,
        Self::CameraPlace,
    ];

    fn number(self) -> u64 {
        match self {
            Self::Start => 1,
            Self::Camera => 2,
            Self::ServoGain => 3,
            Self::ServoPhase => 4,
            Self::ServoLatency => 5,
            Self::ModuleMass => 6,
            Self::ModuleFriction => 7,
            Self::RunFriction => 8,
            Self::PlateFriction => 9,
            Self::SearchStep => 10,
            Self::UncertainParameter => 101,
            Self::Refinement => 11,
            Self::CameraTime => 12,
            Self::StartMotion => 13,
            Self::SensorReading => 30,
            Self::Actuator => 31,
            Self::Shadowing => 40,
            Self::Message => 41,
            Self::PictureNoise => 50,
            Self::CameraPlace => 51,
        }
    }

    /// The generator of this stream for repeat or step number `index`.
    pub fn generator(self, seed: u64, index: u64) -> Generator {
        let mut key = [0_u8; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8..16].copy_from_slice(&index.to_le_bytes());
        let mut generator = Generator::from_seed(key);
        generator.set_stream(self.number());
        generator
    }
}

/// Streams that are drawn once for a whole analysis.
///
/// Their keys are made from the seed in another way than those of [`Numbered`], so that no number
/// of one table can meet a number of the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Once {
    /// Resampling of recordings or repeats with replacement ([`crate::statistics::resamples`]).
    Resampling,
    /// Which recordings are held out.
    Split,
    /// Where the best point lies when scores vary.
    BestPoint,
    /// Where within its cell of a grid a best point lies.
    WithinCell,
    /// Which of two samples each run is put into ([`crate::statistics::energy_test`]).
    Permutation,
    /// Which readings of a log a smaller log would hold.
    Subset,
    /// Guesses that know nothing, for others to be better than.
    RandomGuess,
    /// Where a robot that walks at random turns.
    RandomWalk,
}

impl Once {
    /// Every stream.
    pub const ALL: [Self; 8] = [
        Self::Resampling,
        Self::Split,
        Self::BestPoint,
        Self::WithinCell,
        Self::Permutation,
        Self::Subset,
        Self::RandomGuess,
        Self::RandomWalk,
    ];

    fn number(self) -> u64 {
        match self {
            Self::Resampling => 0,
            Self::BestPoint => 1,
            Self::Split => 2,
            Self::WithinCell => 3,
            Self::Permutation => 4,
            Self::Subset => 30,
            Self::RandomGuess => 31,
            Self::RandomWalk => 32,
        }
    }

    /// The generator of this stream.
    pub fn generator(self, seed: u64) -> Generator {
        let mut generator = Generator::seed_from_u64(seed);
        generator.set_stream(self.number());
        generator
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    /// Names of streams with the same first numbers.
    fn sharing(streams: &[(String, [u64; 4])]) -> Vec<(&str, &str)> {
        let mut sharing = Vec::new();
        for (index, (name, numbers)) in streams.iter().enumerate() {
            for (other, same) in &streams[index + 1..] {
                if numbers == same {
                    sharing.push((name.as_str(), other.as_str()));
                }
            }
        }
        sharing
    }

    #[test]
    fn no_two_streams_draw_the_same_numbers() {
        let first = |mut generator: Generator| std::array::from_fn(|_| generator.next_u64());
        for (seed, index) in [(1, 0), (1, 1), (42, 7), (0, 0)] {
            let numbered = Numbered::ALL
                .map(|stream| (format!("{stream:?}"), first(stream.generator(seed, index))));
            let once =
                Once::ALL.map(|stream| (format!("{stream:?}"), first(stream.generator(seed))));
            let streams: Vec<_> = numbered.into_iter().chain(once).collect();
            assert_eq!(sharing(&streams), [], "seed {seed}, index {index}");
        }
    }

    /// What earlier releases drew; a published result can be drawn again only while these hold.
    #[test]
    fn streams_draw_what_they_always_drew() {
        let mut key = [0_u8; 32];
        key[..8].copy_from_slice(&5_u64.to_le_bytes());
        key[8..16].copy_from_slice(&9_u64.to_le_bytes());
        for (stream, number) in [
            (Numbered::Start, 1),
            (Numbered::Camera, 2),
            (Numbered::RunFriction, 8),
            (Numbered::PlateFriction, 9),
            (Numbered::SearchStep, 10),
            (Numbered::UncertainParameter, 101),
        ] {
            let mut known = ChaCha8Rng::from_seed(key);
            known.set_stream(number);
            assert_eq!(stream.generator(5, 9).next_u64(), known.next_u64());
        }
        let known = ChaCha8Rng::seed_from_u64(5);
        assert_eq!(
            Once::Resampling.generator(5).next_u64(),
            known.clone().next_u64()
        );
        for (stream, number) in [(Once::BestPoint, 1), (Once::Split, 2)] {
            let mut known = known.clone();
            known.set_stream(number);
            assert_eq!(stream.generator(5).next_u64(), known.next_u64());
        }
    }
}
