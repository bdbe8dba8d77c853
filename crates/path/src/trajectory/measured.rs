//! Columns of sensors beside angles: torques and currents of motors, and the gyroscope and accelerometer of a body.

/// What a measured column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeasuredQuantity {
    /// Torque of a joint's motor, N m; for a slide its force, N.
    Torque,
    /// Current of a joint's motor, A.
    Current,
    /// Angular velocity of a body about its own axis of this index, rad/s.
    TurnRate(usize),
    /// What an accelerometer measures along the body's own axis of this index (acceleration minus gravity), m/s².
    SpecificForce(usize),
}

/// Endings of measured columns.
const ENDINGS: [(&str, MeasuredQuantity); 11] = [
    ("_torque_nm", MeasuredQuantity::Torque),
    ("_measured_nm", MeasuredQuantity::Torque),
    ("_effort_nm", MeasuredQuantity::Torque),
    ("_load_nm", MeasuredQuantity::Torque),
    ("_current_a", MeasuredQuantity::Current),
    ("_gyro_x_rad_s", MeasuredQuantity::TurnRate(0)),
    ("_gyro_y_rad_s", MeasuredQuantity::TurnRate(1)),
    ("_gyro_z_rad_s", MeasuredQuantity::TurnRate(2)),
    ("_accel_x_m_s2", MeasuredQuantity::SpecificForce(0)),
    ("_accel_y_m_s2", MeasuredQuantity::SpecificForce(1)),
    ("_accel_z_m_s2", MeasuredQuantity::SpecificForce(2)),
];

impl MeasuredQuantity {
    /// The joint or body that a column names, and what was measured there; `None` for a column of another kind.
    pub fn of_column(column: &str) -> Option<(&str, Self)> {
        ENDINGS.iter().find_map(|(ending, quantity)| {
            let owner = column.strip_suffix(ending)?;
            (!owner.is_empty()).then_some((owner, *quantity))
        })
    }

    /// What this is called, without its unit.
    pub fn word(self) -> &'static str {
        match self {
            Self::Torque => "torque",
            Self::Current => "current",
            Self::TurnRate(_) => "turn rate",
            Self::SpecificForce(_) => "acceleration",
        }
    }

    /// Symbol of the unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Torque => "N m",
            Self::Current => "A",
            Self::TurnRate(_) => "rad/s",
            Self::SpecificForce(_) => "m/s²",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_names_its_joint_and_what_was_measured() {
        use MeasuredQuantity::{Current, SpecificForce, Torque, TurnRate};
        for (column, known) in [
            ("elbow_torque_nm", Some(("elbow", Torque))),
            ("left_knee_measured_nm", Some(("left_knee", Torque))),
            ("elbow_current_a", Some(("elbow", Current))),
            ("trunk_gyro_z_rad_s", Some(("trunk", TurnRate(2)))),
            ("imu_accel_x_m_s2", Some(("imu", SpecificForce(0)))),
            ("elbow_command_nm", None),
            ("elbow_torque", None),
            ("_torque_nm", None),
        ] {
            assert_eq!(MeasuredQuantity::of_column(column), known, "{column}");
        }
    }
}
