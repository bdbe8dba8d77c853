//! From a genome to a robot: by development, or as a given robot with the genome's gait.

use realgap_core::{Error, Result};
use realgap_robot::genome::{Development, DevelopmentError, Gene, Genome, Locus};
use realgap_robot::morphology::{Gait, Morphology};

/// How genomes become robots.
#[derive(Debug, Clone, PartialEq)]
pub enum Body {
    /// By development: body and gait.
    Developed(Development),
    /// A given robot: gene k gives the gait of module k (or of the joint that moves it), and the genes' numbers of the body are
    /// not used.
    Fixed(Box<Morphology>, Development),
}

/// The numbers of the gait.
pub(super) const GAIT: [Locus; 4] = [
    Locus::Amplitude,
    Locus::Frequency,
    Locus::Phase,
    Locus::Offset,
];

impl Body {
    /// The robot of a genome, or the reason why there is none.
    ///
    /// # Errors
    /// As [`Development::develop`]; for a given robot, a genome with another number of modules.
    pub fn build(
        &self,
        name: &str,
        genome: &Genome,
    ) -> std::result::Result<Morphology, DevelopmentError> {
        let (robot, ranges) = match self {
            Self::Developed(development) => return development.develop(name, genome),
            Self::Fixed(robot, ranges) => (robot, ranges),
        };
        if genome.len() != robot.modules().len() {
            return Err(DevelopmentError::Refused(
                Error::invalid("the genome has the wrong length")
                    .found(format!("{} genes", genome.len()))
                    .allowed(format!("one per module, {}", robot.modules().len())),
            ));
        }
        let gaits = robot.gaits();
        let searched = gaits.iter().zip(genome.genes()).map(|(own, gene)| {
            own.map(|_| Gait {
                offset_rad: gene.within(Locus::Offset, ranges.offset_rad),
                amplitude_rad: gene.within(Locus::Amplitude, ranges.amplitude_rad),
                frequency_hz: gene.within(Locus::Frequency, ranges.frequency_hz),
                phase_rad: gene.within(Locus::Phase, ranges.phase_rad),
            })
        });
        let searched: Vec<_> = searched.collect();
        let description = format!("{} with a gait that was searched for", robot.name());
        robot
            .with_gaits(name, &description, &searched)
            .map_err(DevelopmentError::Refused)
    }

    /// Edge length of the modules, metres.
    pub fn length_m(&self) -> f64 {
        match self {
            Self::Developed(development) => development.side_m,
            Self::Fixed(robot, _) => robot.summary().body_length_m,
        }
    }

    /// The settings of development; for a given robot only its ranges of the gait are used.
    pub fn development(&self) -> &Development {
        match self {
            Self::Developed(development) | Self::Fixed(_, development) => development,
        }
    }
}

/// The genome whose gait is the robot's own. Numbers in `searched` may lie outside of their range, because they are searched
/// anyway.
pub(super) fn genome_of(
    robot: &Morphology,
    ranges: &Development,
    searched: &[Locus],
) -> Result<Genome> {
    let mut genes = Vec::with_capacity(robot.modules().len());
    for (module, gait) in robot.modules().iter().zip(robot.gaits()) {
        let mut values = [0.0; Gene::LEN];
        if let Some(gait) = gait {
            for (locus, value, (low, high)) in [
                (Locus::Amplitude, gait.amplitude_rad, ranges.amplitude_rad),
                (Locus::Frequency, gait.frequency_hz, ranges.frequency_hz),
                (Locus::Phase, gait.phase_rad, ranges.phase_rad),
                (Locus::Offset, gait.offset_rad, ranges.offset_rad),
            ] {
                let inside = (low..=high).contains(&value);
                if !inside && !searched.contains(&locus) {
                    return Err(Error::invalid(format!(
                        "the {} of `{}` is outside the range of the genes",
                        locus.name(),
                        module.name
                    ))
                    .field("development")
                    .found(value)
                    .allowed(format!("{low} to {high}"))
                    .hint("widen the range in `development`, or search this number, too"));
                }
                let span = high - low;
                let share = if span > 0.0 {
                    (value - low) / span
                } else {
                    0.0
                };
                values[locus.index()] = share;
            }
        }
        genes.push(Gene::clamped(values));
    }
    Genome::new(genes)
}

/// Which modules have a gait.
pub(super) fn driven(robot: &Morphology) -> Vec<usize> {
    let gaits = robot.gaits().into_iter().enumerate();
    gaits
        .filter(|(_, gait)| gait.is_some())
        .map(|(index, _)| index)
        .collect()
}
