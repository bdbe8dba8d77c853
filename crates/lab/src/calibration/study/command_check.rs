//! Checks whether a servo can do what is commanded, and whether it was asked for more than it has all the time.

use realgap_core::{Error, Result};
use realgap_robot::morphology::{Servo, ServoLaw};
use realgap_simulation::Quantity;

/// Commands of which so large a share is beyond the limit of their servo are in another unit, or the limit is wrong.
const SATURATED: f64 = 0.95;
/// Commands at the limit itself, up to rounding, are allowed: a controller may switch between its limits.
const BEYOND: f64 = 1.001;

/// Checks the commands of one joint, given with their joint's name.
///
/// # Errors
/// A law that cannot follow the quantity, a servo that lacks a number that the quantity needs, or commands that are beyond its
/// limit nearly all the time.
pub(super) fn check_commands(
    servo: &Servo,
    quantity: Quantity,
    (hinge, values): (&str, &[f64]),
) -> Result<()> {
    let is_followed = match servo.law {
        ServoLaw::Motor(_) => quantity != Quantity::Velocity,
        ServoLaw::Direct => !matches!(quantity, Quantity::Position | Quantity::Velocity),
        ServoLaw::Throttle => quantity == Quantity::Duty,
        ServoLaw::Velocity { .. } | ServoLaw::Torque { .. } => true,
    };
    if !is_followed {
        return Err(Error::invalid("a servo cannot do what is commanded")
            .found(format!("{quantity:?} for the servo of `{hinge}`"))
            .allowed("Motor: Position, Torque, Current, Duty; Direct: Torque, Current, Duty; Throttle: Duty; Velocity and Torque: all five")
            .hint("give the joint a servo with another law in the robot's file"));
    }
    let is_motor = servo.law.motor().is_some();
    if quantity == Quantity::Current && servo.torque_per_current_nm_a().is_none() {
        return Err(Error::invalid("a commanded current needs the torque constant of its motor")
            .found(format!("the servo of `{hinge}` states none"))
            .hint("add `torque_constant_nm_a: ...` (N m per A at the joint) to `servo` in the robot's file"));
    }
    if quantity == Quantity::Duty && !is_motor && servo.max_speed_rad_s.is_infinite() {
        return Err(Error::invalid("a commanded duty needs the speed at which the full duty exerts no torque")
            .found(format!("the servo of `{hinge}` states no `max_speed_rad_s`"))
            .hint("add `max_speed_rad_s` beside `max_torque_nm`, the torque of the full duty at standstill, or use `law: Motor(...)`"));
    }
    let largest = values
        .iter()
        .fold(0.0_f64, |most, value| most.max(value.abs()));
    if quantity == Quantity::Duty && largest > BEYOND {
        return Err(Error::invalid("a duty is a share of the full voltage")
            .found(format!("up to {largest}"))
            .allowed("-1 to 1")
            .hint("divide percent by 100"));
    }
    let per_command = match quantity {
        Quantity::Torque => 1.0,
        Quantity::Current => servo.torque_per_current_nm_a().unwrap_or(1.0),
        Quantity::Position | Quantity::Velocity | Quantity::Duty => return Ok(()),
    };
    let is_beyond = |value: &&f64| (per_command * **value).abs() > BEYOND * servo.max_torque_nm;
    let beyond = values.iter().filter(is_beyond).count();
    if beyond as f64 >= SATURATED * values.len() as f64 {
        return Err(Error::invalid(
            "commands are beyond the limit of their servo nearly all the time",
        )
        .found(format!(
            "{beyond} of {} commands ask `{hinge}` for more than {} N m, up to {} N m",
            values.len(),
            servo.max_torque_nm,
            per_command * largest
        ))
        .hint(
            "check the unit of the column, and `max_torque_nm` of the servo in the robot's file",
        ));
    }
    Ok(())
}
