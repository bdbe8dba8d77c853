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

/// Writes a table of streams and their numbers.
macro_rules! streams {
    ($(#[$doc:meta])* $name:ident: $($(#[$about:meta])* $stream:ident = $number:literal;)*) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $name {
            $($(#[$about])* $stream = $number,)*
        }

        impl $name {
            /// Every stream.
            pub const ALL: &[Self] = &[$(Self::$stream),*];
        }
    };
}

streams! {
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
    Numbered:
    /// Start position, height, tilt and heading of a repeat, and the zeros of its servos.
    Start = 1;
    /// Velocity and spin of a repeat's start.
    StartMotion = 13;
    /// Errors of a camera that records a repeat: positions and orientations.
    Camera = 2;
    /// Errors of the times of that camera.
    CameraTime = 12;
    /// Gain of each servo.
    ServoGain = 3;
    /// Phase of each servo's command.
    ServoPhase = 4;
    /// Age of the command that each servo acts on.
    ServoLatency = 5;
    /// How much later than recorded each command arrives.
    CommandJitter = 14;
    /// Mass of each module.
    ModuleMass = 6;
    /// Friction of each module.
    ModuleFriction = 7;
    /// Friction of all modules of a repeat.
    RunFriction = 8;
    /// Friction of each plate on top of its module's.
    PlateFriction = 9;
    /// What a search draws in one of its steps: parents, operators, children.
    SearchStep = 10;
    /// Values of parameters that are only known to be in a range, for one repeat.
    UncertainParameter = 101;
    /// Which point of a sweep is simulated again.
    Refinement = 11;
    /// What a sensor reads.
    SensorReading = 30;
    /// What one session of a sensor adds to all its readings.
    SensorSession = 32;
    /// What a sensor on a robot in an engine's hands reads.
    MountedSensor = 33;
    /// When a sensor warns of what is not there.
    FalseAlarm = 34;
    /// Errors of wheels: how far a command goes, how far it turns.
    Actuator = 31;
    /// What places add to the strength of a radio signal.
    Shadowing = 40;
    /// What happens to a message: fading, loss, latency.
    Message = 41;
    /// Photons and electrons of one row of a picture.
    PictureNoise = 50;
    /// Where the camera of a picture really stands.
    CameraPlace = 51;
}

impl Numbered {
    /// The generator of this stream for repeat or step number `index`.
    pub fn generator(self, seed: u64, index: u64) -> Generator {
        let mut key = [0_u8; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8..16].copy_from_slice(&index.to_le_bytes());
        let mut generator = Generator::from_seed(key);
        generator.set_stream(self as u64);
        generator
    }
}

streams! {
    /// Streams that are drawn once for a whole analysis.
    ///
    /// Their keys are made from the seed in another way than those of [`Numbered`], so that no number
    /// of one table can meet a number of the other.
    Once:
    /// Resampling of recordings or repeats with replacement ([`crate::statistics::resamples`]).
    Resampling = 0;
    /// Which recordings are held out.
    Split = 2;
    /// Where the best point lies when scores vary.
    BestPoint = 1;
    /// Where within its cell of a grid a best point lies.
    WithinCell = 3;
    /// Which of two samples each run is put into ([`crate::statistics::energy_test`]).
    Permutation = 4;
    /// Which readings of a log a smaller log would hold.
    Subset = 30;
    /// Guesses that know nothing, for others to be better than.
    RandomGuess = 31;
    /// Where a robot that walks at random turns.
    RandomWalk = 32;
}

impl Once {
    /// The generator of this stream.
    pub fn generator(self, seed: u64) -> Generator {
        let mut generator = Generator::seed_from_u64(seed);
        generator.set_stream(self as u64);
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
                .iter()
                .map(|stream| (format!("{stream:?}"), first(stream.generator(seed, index))));
            let once = Once::ALL
                .iter()
                .map(|stream| (format!("{stream:?}"), first(stream.generator(seed))));
            let streams: Vec<_> = numbered.chain(once).collect();
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
