//! Model of a motor behind a gear: duty, torque-speed line, and the friction budget of the gear.
//!
//! The budget depends on the load of the gear. The torque on its motor side is known. The torque on its output side is the motor
//! torque minus friction, so the budget is an equation for the friction itself, which is solved here for both directions of
//! motion. Engines have one friction limit for both directions: they get the mean of the two budgets as friction, and half of
//! their difference as an additional torque. So in each direction the friction is at most the budget of that direction.

use realgap_robot::morphology::{GearFriction, Motor};

/// Motor torque and gear friction at a hinge during one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Speed towards which the motor drives the hinge, rad/s.
    pub target_rad_s: f64,
    /// Torque of the motor per difference to the target speed, N m s/rad.
    pub damping_nm_s_rad: f64,
    /// Largest friction torque against forward motion, without viscous friction, N m.
    pub forwards_nm: f64,
    /// Largest friction torque against backward motion, without viscous friction, N m.
    pub backwards_nm: f64,
    /// Coefficient of viscous friction, N m s/rad.
    pub viscous_nm_s_rad: f64,
    /// Inertia of the rotor at the output, kg m².
    pub armature_kg_m2: f64,
}

impl Effort {
    /// Friction torque for both directions: the mean of the two budgets, N m.
    pub fn dry_nm(&self) -> f64 {
        0.5 * (self.forwards_nm + self.backwards_nm)
    }

    /// Target speed of the motor, shifted so that with this mean friction the total torque in each direction is correct, rad/s.
    pub(crate) fn shifted_target_rad_s(&self) -> f64 {
        if self.damping_nm_s_rad == 0.0 {
            return 0.0;
        }
        self.target_rad_s + 0.5 * (self.backwards_nm - self.forwards_nm) / self.damping_nm_s_rad
    }
}

/// A motor at its torque limit drives towards a speed this far away, rad/s, so that its torque hardly depends on the speed.
const FAR_RAD_S: f64 = 1e4;

/// The duty that the position loop commands.
pub(super) fn position_duty(motor: &Motor, error_rad: f64) -> f64 {
    motor.position_gain * motor.duty_1_rad * error_rad
}

/// The duty that acts when `asked` is commanded; it differs from the previous duty `before` by at most the slew of one step.
pub(super) fn duty(motor: &Motor, asked: f64, before: f64, timestep_s: f64) -> f64 {
    let most = motor.slew_1_s * timestep_s;
    asked.clamp(-1.0, 1.0).clamp(before - most, before + most)
}

/// What drives a motor during one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Supply {
    /// Nothing: only the friction of the gear acts.
    Off,
    /// A share of the full voltage.
    Duty(f64),
    /// A current that gives this torque, N m, as far as the voltage suffices.
    Torque(f64),
}

/// The effort of the motor at a supply and a speed.
pub(super) fn effort(
    motor: &Motor,
    supply: Supply,
    max_torque_nm: f64,
    speed_rad_s: f64,
) -> Effort {
    let friction = &motor.friction;
    let line = |duty: f64| {
        let slope_nm_s_rad = motor.torque_constant_nm_a.powi(2) / motor.resistance_at_ohm(duty);
        let free_rad_s = duty * motor.supply_v / motor.torque_constant_nm_a;
        (
            free_rad_s,
            slope_nm_s_rad,
            slope_nm_s_rad * (free_rad_s - speed_rad_s),
        )
    };
    let constant = |torque_nm: f64| {
        let far_rad_s = speed_rad_s + FAR_RAD_S.copysign(torque_nm);
        (far_rad_s, torque_nm.abs() / FAR_RAD_S, torque_nm)
    };
    let (target_rad_s, damping_nm_s_rad, torque_nm) = match supply {
        Supply::Off => (0.0, 0.0, 0.0),
        Supply::Duty(duty) => {
            let on_line = line(duty);
            match on_line.2.abs() > max_torque_nm {
                true => constant(max_torque_nm.copysign(on_line.2)),
                false => on_line,
            }
        }
        Supply::Torque(asked_nm) => {
            let asked_nm = asked_nm.clamp(-max_torque_nm, max_torque_nm);
            let (backwards, forwards) = (line(-1.0), line(1.0));
            if asked_nm > forwards.2 {
                forwards
            } else if asked_nm < backwards.2 {
                backwards
            } else {
                constant(asked_nm)
            }
        }
    };
    Effort {
        target_rad_s,
        damping_nm_s_rad,
        forwards_nm: budget_nm(friction, torque_nm, speed_rad_s),
        backwards_nm: budget_nm(friction, -torque_nm, speed_rad_s),
        viscous_nm_s_rad: friction.viscous_nm_s_rad,
        armature_kg_m2: motor.armature_kg_m2,
    }
}

/// Largest friction torque of the gear against a motion, without viscous friction, N m; `along_nm` is the motor's torque in the
/// direction of that motion.
///
/// F = own + output load · |along − F|, where `own` contains all terms that do not depend on the output torque.
pub(super) fn budget_nm(friction: &GearFriction, along_nm: f64, speed_rad_s: f64) -> f64 {
    let still =
        (-(speed_rad_s.abs() / friction.stribeck_speed_rad_s).powf(friction.stribeck_shape)).exp();
    let motor_nm = along_nm.abs();
    let share = friction.motor_load + still * friction.stribeck_load;
    let viscous_nm = friction.viscous_nm_s_rad * speed_rad_s.abs();
    let own_nm = friction.dry_nm
        + still * friction.stribeck_nm
        + viscous_nm
        + share * motor_nm
        + friction.quadratic_1_nm * motor_nm.powi(2);
    let output = (friction.output_load + still * friction.stribeck_load).min(MOST_OUTPUT);
    let all_nm = if own_nm <= along_nm {
        // The motor drives the output with the rest of its torque.
        (own_nm + output * along_nm) / (1.0 + output)
    } else {
        // An external load drives the output, against the friction and possibly against the motor.
        (own_nm - output * along_nm) / (1.0 - output)
    };
    (all_nm - viscous_nm).max(0.0)
}

/// Largest fraction of the output torque that is lost; with a fraction of 1 the gear would be self-locking.
const MOST_OUTPUT: f64 = realgap_robot::morphology::MOST_LOAD;

#[cfg(test)]
mod tests {
    use super::*;

    fn motor(friction: GearFriction) -> Motor {
        Motor {
            position_gain: 400.0,
            duty_1_rad: 0.0028,
            supply_v: 7.3,
            torque_constant_nm_a: 0.4,
            resistance_ohm: 3.5,
            ripple_ohm: 0.0,
            armature_kg_m2: 0.001,
            slew_1_s: f64::INFINITY,
            friction,
        }
    }

    fn loaded() -> GearFriction {
        GearFriction {
            dry_nm: 0.01,
            motor_load: 0.2,
            output_load: 0.3,
            ..GearFriction::default()
        }
    }

    #[test]
    fn the_budget_solves_its_own_equation_on_either_side_of_the_gear() {
        for along_nm in [-0.5, -0.1, 0.0, 0.005, 0.012, 0.1, 0.8] {
            let friction = loaded();
            let budget = budget_nm(&friction, along_nm, 0.0);
            let output_nm = (along_nm - budget).abs();
            let equation = 0.01 + 0.2 * f64::abs(along_nm) + 0.3 * output_nm;
            assert!((budget - equation).abs() < 1e-12, "{along_nm}: {budget}");
        }
    }

    #[test]
    fn a_gear_with_load_dependent_friction_is_harder_to_drive_backwards_than_forwards() {
        let friction = GearFriction {
            motor_load: 0.3,
            output_load: 0.3,
            ..GearFriction::default()
        };
        // Forwards, (1 − m) / (1 + m) of the motor's torque arrives at the output; backwards, the output needs (1 + m) / (1 − m)
        // of it.
        let arrives = 0.2 - budget_nm(&friction, 0.2, 0.0);
        let needed = 0.2 + budget_nm(&friction, -0.2, 0.0);
        assert!((arrives - 0.2 * 0.7 / 1.3).abs() < 1e-12);
        assert!((needed - 0.2 * 1.3 / 0.7).abs() < 1e-12);
    }

    #[test]
    fn a_motor_stalls_at_its_stall_torque_and_is_free_at_its_free_speed() {
        let motor = motor(GearFriction::default());
        let effort = effort(&motor, Supply::Duty(1.0), 10.0, 0.0);
        let stall_nm = effort.damping_nm_s_rad * effort.target_rad_s;
        assert!((stall_nm - 0.4 * 7.3 / 3.5).abs() < 1e-12);
        assert!((effort.target_rad_s - 7.3 / 0.4).abs() < 1e-12);
    }

    #[test]
    fn a_torque_limit_binds_and_a_slew_limit_delays() {
        let mut motor = motor(GearFriction::default());
        let effort = effort(&motor, Supply::Duty(-1.0), 0.1, 3.0);
        let torque_nm = effort.damping_nm_s_rad * (effort.target_rad_s - 3.0);
        assert!((torque_nm + 0.1).abs() < 1e-9);
        motor.slew_1_s = 10.0;
        assert!((duty(&motor, position_duty(&motor, 1.0), 0.2, 0.01) - 0.3).abs() < 1e-12);
        assert!((duty(&motor, position_duty(&motor, -1.0), 0.2, 0.1) + 0.8).abs() < 1e-12);
    }

    #[test]
    fn the_effort_has_the_torque_line_and_the_friction_budgets_of_both_directions() {
        let motor = motor(loaded());
        let (duty, speed) = (0.3, 2.0);
        let effort = effort(&motor, Supply::Duty(duty), 10.0, speed);
        let torque_nm = 0.4 / 3.5 * (7.3 * duty - 0.4 * speed);
        let pulled_nm = effort.damping_nm_s_rad * (effort.shifted_target_rad_s() - speed);
        let forwards_nm = torque_nm - budget_nm(&motor.friction, torque_nm, speed);
        let backwards_nm = torque_nm + budget_nm(&motor.friction, -torque_nm, speed);
        assert!((pulled_nm - effort.dry_nm() - forwards_nm).abs() < 1e-12);
        assert!((pulled_nm + effort.dry_nm() - backwards_nm).abs() < 1e-12);
    }

    #[test]
    fn supply_ripple_reduces_torque_at_half_duty_and_not_at_full_duty() {
        let mut motor = motor(GearFriction::default());
        motor.ripple_ohm = 4.0;
        let share = |duty: f64| {
            let effort = effort(&motor, Supply::Duty(duty), 10.0, 0.0);
            effort.damping_nm_s_rad * effort.target_rad_s / (duty * motor.stall_nm())
        };
        assert!((share(1.0) - 1.0).abs() < 1e-12);
        // Expected value: i = u (V − ripple i u (1 − u)) / R at u = 1/2 gives i = V / (2 R + ripple / 4).
        assert!((share(0.5) - 2.0 * 3.5 / (2.0 * 3.5 + 1.0)).abs() < 1e-12);
    }

    #[test]
    fn a_commanded_torque_acts_as_far_as_the_voltage_suffices() {
        let motor = motor(GearFriction::default());
        let exerted = |asked_nm: f64, speed_rad_s: f64| {
            let effort = effort(&motor, Supply::Torque(asked_nm), 10.0, speed_rad_s);
            effort.damping_nm_s_rad * (effort.target_rad_s - speed_rad_s)
        };
        assert!((exerted(0.3, 4.0) - 0.3).abs() < 1e-12);
        assert!((exerted(-0.3, 4.0) + 0.3).abs() < 1e-12);
        let line_nm = 0.4 / 3.5 * (7.3 - 0.4 * 15.0);
        assert!((exerted(0.3, 15.0) - line_nm).abs() < 1e-12);
    }

    #[test]
    fn a_switched_off_motor_has_gear_friction_only() {
        let effort = effort(&motor(loaded()), Supply::Off, 10.0, 5.0);
        assert_eq!((effort.target_rad_s, effort.damping_nm_s_rad), (0.0, 0.0));
        assert!((effort.dry_nm() - 0.01 / 0.7).abs() < 1e-12);
    }
}
