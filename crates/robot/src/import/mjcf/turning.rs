//! Torsional and rolling friction of an MJCF: MuJoCo uses the second and third number of `friction` where `condim` is 4 or 6.
//!
//! In MuJoCo one shape of a pair decides, or the larger number; here those of both add up. The floor gets the smallest number that
//! any shape has on it, and each shape the rest, so that each has on the floor what it has in MuJoCo.

use super::model::{Geom, GeomType};
use super::robot::Robot;
use super::world::{meet, pair_friction, plane};
use crate::morphology::TurningFriction;

/// The larger numbers of a file are cut, metres.
const MOST_M: f64 = TurningFriction::COEFFICIENTS_M.1;

fn of_pair(geom: &Geom, other: &Geom) -> TurningFriction {
    let [_, torsional_m, rolling_m] = pair_friction(geom, other);
    TurningFriction {
        rolling_m: rolling_m.clamp(0.0, MOST_M),
        torsional_m: torsional_m.clamp(0.0, MOST_M),
    }
}

impl Robot<'_> {
    /// The shapes of the robot that can touch another shape.
    fn touching<'a>(&'a self, other: &'a Geom) -> impl Iterator<Item = &'a Geom> {
        let beside = self.ids_beside();
        let bodies = self.model.bodies.iter().enumerate().skip(1);
        let bodies = bodies.filter(move |(id, _)| !beside.contains(id));
        let geoms = bodies.flat_map(|(_, body)| &body.geoms);
        geoms.filter(|geom| geom.kind != GeomType::Plane && meet(geom, other))
    }

    /// The smallest torsional and rolling friction of the robot's shapes on a plane.
    fn least_on(&self, plane: &Geom) -> TurningFriction {
        let all = self.touching(plane).map(|geom| of_pair(geom, plane));
        let least = all.reduce(|a, b| TurningFriction {
            rolling_m: a.rolling_m.min(b.rolling_m),
            torsional_m: a.torsional_m.min(b.torsional_m),
        });
        least.unwrap_or_default()
    }

    /// Friction of a shape beyond that of the floor; of a robot without a floor, its own.
    pub(super) fn turning_of(&self, geom: &Geom) -> TurningFriction {
        let mut geoms = self.model.bodies.iter().flat_map(|body| &body.geoms);
        if geoms.all(|geom| geom.condim < 4) {
            return TurningFriction::default();
        }
        let Some(plane) = plane(self.model) else {
            return of_pair(geom, geom);
        };
        if !meet(geom, plane) {
            return TurningFriction::default();
        }
        let (whole, floor) = (of_pair(geom, plane), self.least_on(plane));
        TurningFriction {
            rolling_m: (whole.rolling_m - floor.rolling_m).max(0.0),
            torsional_m: (whole.torsional_m - floor.torsional_m).max(0.0),
        }
    }

    /// States the floor's friction against rolling and spinning, and says it.
    pub(super) fn turning_of_floor(&mut self, plane: &Geom) -> Option<String> {
        let all = || self.touching(plane).map(|geom| of_pair(geom, plane));
        let (rolls, spins) = (
            all().any(|turning| turning.rolling_m > 0.0),
            all().any(|turning| turning.torsional_m > 0.0),
        );
        let floor = self.least_on(plane);
        let mut said = Vec::new();
        if spins {
            self.structure.world.floor_torsional_m = Some(floor.torsional_m);
            said.push(format!("torsional friction {} m", floor.torsional_m));
        }
        if rolls {
            self.structure.world.floor_rolling_m = Some(floor.rolling_m);
            said.push(format!("rolling friction {} m", floor.rolling_m));
        }
        (!said.is_empty()).then(|| {
            format!(
                "with {} (condim 4 and 6; shapes with more state the rest in `turning`; those of two shapes add up here, where MuJoCo takes the larger one)",
                said.join(" and ")
            )
        })
    }
}
