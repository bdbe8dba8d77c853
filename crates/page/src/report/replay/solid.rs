//! Shapes of a replay, what each shape is and its colour, and the shapes of a robot.

use nalgebra::Isometry3;

use realgap_robot::morphology::{Drive, Morphology, Role, Shape};
use realgap_simulation::part_from_solid;

/// A colour: red, green, blue.
pub(in crate::report) type Colour = [u8; 3];

/// What a shape stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::report) enum Kind {
    Passive,
    Active,
    Plate,
    Floor,
    /// A body beside the robot.
    Other,
    /// A run of which only a path is known.
    Run,
    /// A recording.
    Recorded,
}

impl Kind {
    /// The colour: recordings are green everywhere, simulated runs are blue.
    pub(in crate::report) fn colour(self) -> Colour {
        match self {
            Self::Passive => [217, 211, 197],
            Self::Active => [120, 178, 216],
            Self::Plate => [213, 94, 0],
            Self::Floor => [238, 238, 234],
            Self::Other => [169, 163, 154],
            Self::Run => [0, 114, 178],
            Self::Recorded => [0, 138, 100],
        }
    }

    /// The colour in linear light, as glTF and cameras use it.
    pub(in crate::report) fn light(self) -> [f64; 3] {
        self.colour().map(|channel| {
            let share = f64::from(channel) / 255.0;
            if share <= 0.04045 {
                share / 12.92
            } else {
                ((share + 0.055) / 1.055).powf(2.4)
            }
        })
    }
}

/// A shape in the frame of the body that carries it.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::report) struct Solid {
    pub(in crate::report) shape: Shape,
    pub(in crate::report) pose: Isometry3<f64>,
    pub(in crate::report) kind: Kind,
}

/// A solid of a robot, in the frame of its part.
pub(in crate::report) struct RobotSolid<'a> {
    pub(in crate::report) part: usize,
    pub(in crate::report) solid: Solid,
    /// The name of the module for its first cube; empty for other solids.
    pub(in crate::report) name: &'a str,
    pub(in crate::report) drive: Option<Drive>,
    pub(in crate::report) is_tracked: bool,
}

/// The solids of a robot that have a surface, in the frames of their parts.
pub(in crate::report) fn robot_solids(robot: &Morphology) -> Vec<RobotSolid<'_>> {
    let assembly = robot.assemble();
    let mut all = Vec::new();
    for (part, cluster) in assembly.parts.iter().enumerate() {
        // A plate with a module glued onto it is inside of that module.
        for solid in cluster.solids.iter().filter(|solid| solid.has_surface()) {
            let module = &robot.modules()[solid.module];
            let is_first = solid.number == 0 && solid.role == Role::Cube;
            let drive = module.drive.filter(|_| is_first);
            let shown = Solid {
                shape: solid.shape.clone(),
                pose: part_from_solid(&assembly, part, solid),
                kind: match solid.role {
                    Role::Plate => Kind::Plate,
                    Role::Cube if drive.is_some() || assembly.drives(part) => Kind::Active,
                    Role::Cube => Kind::Passive,
                },
            };
            all.push(RobotSolid {
                part,
                solid: shown,
                name: if is_first { &module.name } else { "" },
                drive,
                is_tracked: solid.module == robot.track() && solid.role == Role::Cube,
            });
        }
    }
    all
}
