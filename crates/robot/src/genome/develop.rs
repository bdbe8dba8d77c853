//! Development: builds a robot from a genome, one module per gene.

use super::development::Development;
use super::development_error::DevelopmentError;
use super::lattice::{Cell, Placed, add, direction, face, top_of_column};
use super::locus::Locus;
use super::sequence::{Gene, Genome};
use crate::morphology::{Attachment, Blueprint, Face, Gait, Module, Morphology};
use realgap_core::Error;

impl Development {
    /// Builds the robot of a genome, or returns the reason why it cannot be built. The same genome and settings give the same
    /// robot.
    ///
    /// Module k of the robot is named `m<k>`; `m0` is the root and is tracked. All axes are those of the
    /// finished robot as it stands on the floor.
    ///
    /// # Errors
    /// The first [`DevelopmentError`] that occurs while the modules are added in order.
    pub fn develop(&self, name: &str, genome: &Genome) -> Result<Morphology, DevelopmentError> {
        self.check().map_err(DevelopmentError::Refused)?;
        if genome.len() > self.max_modules {
            return Err(DevelopmentError::TooManyModules {
                found: genome.len(),
                allowed: self.max_modules,
            });
        }
        let (body, parents) = self.build(genome)?;
        let blueprint = self
            .blueprint(name, genome, &body, &parents)
            .ok_or_else(|| {
                DevelopmentError::Refused(Error::invalid(
                    "a module is not on top of its parent; this is a defect of realgap: please report it",
                ))
            })?;
        Morphology::new(blueprint).map_err(DevelopmentError::Refused)
    }

    /// The cell of every module, and the index of the module below it (`None` for the first).
    fn build(
        &self,
        genome: &Genome,
    ) -> Result<(Vec<Placed>, Vec<Option<usize>>), DevelopmentError> {
        let mut body: Vec<Placed> = Vec::with_capacity(genome.len());
        let mut parents = Vec::with_capacity(genome.len());
        for (module, gene) in genome.genes().iter().enumerate() {
            let roll = gene.choice(Locus::RollPart, 4);
            let pitch = gene.choice(Locus::PitchPart, 4);
            body = body.into_iter().map(|p| p.turned(roll, pitch)).collect();
            let below = top_of_column(
                &body,
                |count| gene.choice(Locus::PlaceX, count),
                |count| gene.choice(Locus::PlaceY, count),
            );
            let new = Placed {
                cell: below.map_or([0; 3], |b| add(body[b].cell, UP)),
                driven: self
                    .is_active(gene)
                    .then(|| direction(Face::ALL[gene.choice(Locus::FaceModule, Face::ALL.len())])),
            };
            check_clearance(&body, &new, module, below)?;
            body.push(new);
            parents.push(below);
        }
        Ok((body, parents))
    }

    fn is_active(&self, gene: &Gene) -> bool {
        gene.get(Locus::Kind) >= self.passive_share && self.passive_share < 1.0
    }

    fn gait(&self, gene: &Gene) -> Gait {
        Gait {
            offset_rad: gene.within(Locus::Offset, self.offset_rad),
            amplitude_rad: gene.within(Locus::Amplitude, self.amplitude_rad),
            frequency_hz: gene.within(Locus::Frequency, self.frequency_hz),
            phase_rad: gene.within(Locus::Phase, self.phase_rad),
        }
    }

    fn blueprint(
        &self,
        name: &str,
        genome: &Genome,
        body: &[Placed],
        parents: &[Option<usize>],
    ) -> Option<Blueprint> {
        let mut modules = Vec::with_capacity(body.len());
        for (index, (placed, gene)) in body.iter().zip(genome.genes()).enumerate() {
            let name = format!("m{index}");
            modules.push(match placed.driven {
                None => Module::passive(name, self.side_m, self.passive_mass_kg),
                Some(towards) => {
                    let drive = self.drive(face(towards)?, self.gait(gene));
                    Module::active(name, self.side_m, self.active_mass_kg, drive)
                }
            });
        }
        let mut attachments = Vec::with_capacity(body.len());
        for (child, parent) in parents.iter().enumerate() {
            let Some(parent) = *parent else { continue };
            let (from, to) = (body[parent].cell, body[child].cell);
            let face = face([to[0] - from[0], to[1] - from[1], to[2] - from[2]])?;
            attachments.push(Attachment {
                parent,
                face,
                child,
                child_face: face.opposite(),
                quarter_turns: 0,
            });
        }
        Some(Blueprint {
            name: name.to_owned(),
            description: format!("developed from a genome of {} modules", body.len()),
            modules,
            attachments,
            pivots: Vec::new(),
            collision_exclude: Vec::new(),
            mount_world_m: None,
            track: Some(0),
        })
    }
}

const UP: Cell = [0, 0, 1];

/// Checks that the cell in front of every driven face is free, or holds a neighbour that is attached to that face.
fn check_clearance(
    body: &[Placed],
    new: &Placed,
    module: usize,
    below: Option<usize>,
) -> Result<(), DevelopmentError> {
    let faced = new.faced_cell();
    for (neighbour, placed) in body.iter().enumerate() {
        let faces_neighbour = faced == Some(placed.cell);
        let is_faced_by_neighbour = placed.faced_cell() == Some(new.cell);
        if Some(neighbour) == below {
            if faces_neighbour && is_faced_by_neighbour {
                return Err(DevelopmentError::ServoOnServo {
                    module,
                    below: neighbour,
                });
            }
        } else if faces_neighbour {
            return Err(DevelopmentError::NoRoomForPlate { module, neighbour });
        } else if is_faced_by_neighbour {
            return Err(DevelopmentError::PlateInTheWay { module, neighbour });
        }
        // Two plates in the same cell touch at the edges of the cell, unless they are on opposite sides of it.
        if let (Some(cell), Some(new), Some(old)) = (faced, new.driven, placed.driven)
            && placed.faced_cell() == Some(cell)
            && add(new, old) != [0; 3]
        {
            return Err(DevelopmentError::PlateOnPlate { module, neighbour });
        }
    }
    Ok(())
}
