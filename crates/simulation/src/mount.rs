//! The stand of a held robot, where it gives a little.

/// Stiffness and damping of a stand, in all directions alike, at the place where the robot is held. At the start it carries the robot's
/// weight: the robot begins where its file holds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mount {
    /// Force per displacement, N/m.
    pub stiffness_n_m: f64,
    /// Force per velocity, N s/m.
    pub damping_n_s_m: f64,
    /// Torque per rotation, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Torque per angular velocity, N m s/rad.
    pub damping_nm_s_rad: f64,
}

/// A stand so stiff that it hardly gives: what is not stated of a spring.
impl Default for Mount {
    fn default() -> Self {
        Self {
            stiffness_n_m: 1e7,
            damping_n_s_m: 1e4,
            stiffness_nm_rad: 1e6,
            damping_nm_s_rad: 1e3,
        }
    }
}
