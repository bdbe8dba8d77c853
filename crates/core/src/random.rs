//! Random numbers: one generator (ChaCha8), with a named stream for every use of random numbers.
//!
//! All streams are listed in the tables of this file, so that two quantities that must be
//! independent never get the same random numbers by accident: a test compares every stream with
//! every other. A stream's number is part of every published result and never changes.
//!
//! Optimizers are the one exception: their libraries have generators of their own, which are seeded
//! only with the seed of the optimization problem.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The random number generator behind every stream.
pub type Generator = ChaCha8Rng;

/// Declares an enum of streams with their numbers.
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
    /// Streams with a separate generator for every numbered repeat or step: the numbers of repeat k do not depend
    /// on the other repeats, so that any repeat can be replayed alone.
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
    /// Start position, height, tilt and heading of a repeat, and the zero offsets of its servos.
    Start = 1;
    /// Linear and angular velocity at the start of a repeat.
    StartMotion = 13;
    /// Errors of a camera that records a repeat: positions and orientations.
    Camera = 2;
    /// Errors of the timestamps of that camera.
    CameraTime = 12;
    /// Gain of each servo.
    ServoGain = 3;
    /// Phase of each servo's command.
    ServoPhase = 4;
    /// Latency of each servo: the age of the command that it follows.
    ServoLatency = 5;
    /// Additional delay of each command after its recorded time.
    CommandJitter = 14;
    /// Mass of each module.
    ModuleMass = 6;
    /// Friction of each module.
    ModuleFriction = 7;
    /// Friction of all modules of a repeat.
    RunFriction = 8;
    /// Friction of each plate, in addition to that of its module.
    PlateFriction = 9;
    /// Random choices of a search in one of its steps: parents, operators, children.
    SearchStep = 10;
    /// Values of parameters of which only a range is known, for one repeat.
    UncertainParameter = 101;
    /// Which point of a sweep is simulated again.
    Refinement = 11;
    /// Readings of a sensor.
    SensorReading = 30;
    /// Offset that one session of a sensor adds to all its readings.
    SensorSession = 32;
    /// Readings of a sensor that is mounted on a simulated robot.
    MountedSensor = 33;
    /// False alarms of a sensor.
    FalseAlarm = 34;
    /// Errors of wheels: the distance and the angle that a command moves the vehicle.
    Actuator = 31;
    /// Shadowing of a radio signal: the part of its strength that depends on the place.
    Shadowing = 40;
    /// Fading, loss and latency of a radio message.
    Message = 41;
    /// Photon and electron noise of one row of a picture.
    PictureNoise = 50;
    /// The true position of the camera of a picture.
    CameraPlace = 51;
    /// Errors of measurement of an imitated recording.
    ImitatedRecording = 60;
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
    /// Streams that have one generator for a whole analysis.
    ///
    /// Their keys are derived from the seed in another way than those of [`Numbered`], so that equal
    /// stream numbers in both tables still give different random numbers.
    Once:
    /// Resampling of recordings or repeats with replacement ([`crate::statistics::resamples`]).
    Resampling = 0;
    /// Selection of the recordings that are held out.
    Split = 2;
    /// Variation of the scores, to see where the best point then lies.
    BestPoint = 1;
    /// Position of a best point within its cell of a grid.
    WithinCell = 3;
    /// Permutation of runs between two samples ([`crate::statistics::energy_test`]).
    Permutation = 4;
    /// Random subset of the readings of a log.
    Subset = 30;
    /// Random numbers that serve as the simplest baseline of a prediction.
    RandomGuess = 31;
    /// Turns of a robot that walks at random.
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

    /// Pairs of streams with the same first numbers.
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

    /// A published result can be reproduced only while every stream gives the same numbers as in earlier releases.
    #[test]
    fn streams_give_the_same_numbers_as_earlier_releases() {
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
