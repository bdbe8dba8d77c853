//! How far two assemblies of one robot are apart in their numbers.

use nalgebra::Isometry3;

use super::super::assembly::{Assembly, Hinge};
use super::Stated;
use super::number::{command, drive, gait, servo, tyre};

/// The largest relative difference between the numbers of two assemblies of one robot: those of joints and servos, masses of rigid parts,
/// tyres, and the world as far as both state it. Infinite for robots of different parts.
pub fn largest_difference(found: &Assembly, asked: &Assembly) -> f64 {
    let is_alike =
        found.hinges.len() == asked.hinges.len() && found.parts.len() == asked.parts.len();
    if !is_alike {
        return f64::INFINITY;
    }
    let hinges = found.hinges.iter().zip(&asked.hinges);
    let of_hinges = hinges.map(|(found, asked)| of_hinge(found, asked));
    let parts = found.parts.iter().zip(&asked.parts);
    let of_parts = parts.map(|(found, asked)| {
        let solids = found.solids.iter().zip(&asked.solids);
        let tyres = solids.filter_map(|(found, asked)| {
            Some(of_numbers(tyre(found.tyre.as_ref()?, asked.tyre.as_ref()?)))
        });
        let [found, asked] = [found, asked].map(|part| part.mass(&Isometry3::identity()));
        let size_m = (asked.inertia_kg_m2.trace() / asked.mass_kg.max(f64::MIN_POSITIVE)).sqrt();
        let inertia = (found.inertia_kg_m2 - asked.inertia_kg_m2).norm();
        tyres
            .fold(0.0, f64::max)
            .max(relative(found.mass_kg, asked.mass_kg))
            .max(relative(
                size_m + (found.centre_m - asked.centre_m).norm(),
                size_m,
            ))
            .max(inertia / asked.inertia_kg_m2.norm().max(f64::MIN_POSITIVE))
    });
    let world = [&found.surroundings, &asked.surroundings].map(|world| {
        [
            world.gravity_m_s2,
            world.floor_friction,
            world.floor_rolling_m,
            world.floor_torsional_m,
            world.floor_height_m,
            world.floor_slope_rad,
        ]
    });
    let of_world = world[0]
        .iter()
        .zip(world[1])
        .filter_map(|(found, asked)| Some(relative((*found)?, asked?)));
    of_hinges
        .chain(of_parts)
        .chain(of_world)
        .fold(0.0, f64::max)
}

fn of_hinge(found: &Hinge, asked: &Hinge) -> f64 {
    let mut all = drive(found, asked, true);
    if let (Some(found), Some(asked)) = (&found.actuator, &asked.actuator) {
        all.extend(servo(&found.servo, &asked.servo));
        all.extend(gait(&found.gait, &asked.gait));
        all.extend(command(&found.command, &asked.command));
    }
    of_numbers(all)
}

fn of_numbers(all: Vec<(String, Stated, Stated)>) -> f64 {
    let each = all.iter().map(|(_, found, asked)| match (found, asked) {
        (Stated::Number(found), Stated::Number(asked)) => relative(*found, *asked),
        _ => 0.0,
    });
    each.fold(0.0, f64::max)
}

fn relative(found: f64, asked: f64) -> f64 {
    match found == asked {
        true => 0.0,
        false => (found - asked).abs() / asked.abs().max(f64::MIN_POSITIVE),
    }
}
