//! The type of trajectories: poses over time, with optional velocities, joints and signals; validated once, immutable afterwards.

use nalgebra::{UnitQuaternion, Vector3};

use realgap_core::error::{Error, Result};

/// Pose and velocity at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Position of the tracked point in the world frame, metres, z up.
    pub position_world_m: Vector3<f64>,
    /// Orientation, world from body.
    pub orientation_world_from_body: UnitQuaternion<f64>,
    /// Linear velocity of the tracked point in the world frame, m/s.
    pub velocity_world_m_s: Vector3<f64>,
    /// Angular velocity in the BODY frame, rad/s.
    pub angular_velocity_body_rad_s: Vector3<f64>,
}

impl State {
    /// The same state with all lengths, and therefore all linear velocities, multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            position_world_m: self.position_world_m * factor,
            velocity_world_m_s: self.velocity_world_m_s * factor,
            ..*self
        }
    }
}

/// The angles of one joint over the samples of a trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct JointTrack {
    /// Name of the robot's hinge.
    pub name: String,
    /// Angles, radians, not wrapped.
    pub angles_rad: Vec<f64>,
    /// Angular speeds, rad/s, if recorded.
    pub speeds_rad_s: Option<Vec<f64>>,
}

impl JointTrack {
    /// The same joint with `of` applied to its angles and its speeds.
    #[must_use]
    pub fn map(&self, of: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        Self {
            name: self.name.clone(),
            angles_rad: of(&self.angles_rad),
            speeds_rad_s: self.speeds_rad_s.as_deref().map(of),
        }
    }
}

/// A recorded quantity over the samples of a trajectory that is not an angle: commanded speeds and torques, switches.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Name of the column, with its unit.
    pub name: String,
    /// One value per sample.
    pub values: Vec<f64>,
}

impl Signal {
    /// The same signal with `of` applied to its values.
    #[must_use]
    pub fn map(&self, of: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        Self {
            name: self.name.clone(),
            values: of(&self.values),
        }
    }
}

/// Time-stamped poses of one run, simulated or real.
///
/// Invariants: at least two samples, strictly increasing finite times, finite positions, and
/// every optional column exactly as long as the times.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    times_s: Vec<f64>,
    positions_world_m: Vec<Vector3<f64>>,
    orientations_world_from_body: Option<Vec<UnitQuaternion<f64>>>,
    velocities_world_m_s: Option<Vec<Vector3<f64>>>,
    angular_velocities_body_rad_s: Option<Vec<Vector3<f64>>>,
    joints: Vec<JointTrack>,
    signals: Vec<Signal>,
    planar: bool,
}

impl Trajectory {
    /// A trajectory of positions only.
    ///
    /// # Errors
    /// Fewer than two samples, unequal lengths, times that do not increase, or non-finite numbers.
    pub fn new(times_s: Vec<f64>, positions_world_m: Vec<Vector3<f64>>) -> Result<Self> {
        if times_s.len() < 2 {
            return Err(Error::invalid("too few points for a trajectory")
                .found(times_s.len())
                .allowed("at least 2 samples"));
        }
        if times_s.len() != positions_world_m.len() {
            return Err(
                Error::invalid("times and positions differ in number").found(format!(
                    "{} times, {} positions",
                    times_s.len(),
                    positions_world_m.len()
                )),
            );
        }
        for (index, (t, p)) in times_s.iter().zip(&positions_world_m).enumerate() {
            if !t.is_finite() || !p.iter().all(|v| v.is_finite()) {
                return Err(Error::invalid("a sample is not a finite number")
                    .field(format!("sample {index}")));
            }
            if index > 0 && *t <= times_s[index - 1] {
                return Err(Error::invalid("time does not increase")
                    .field(format!("sample {index}"))
                    .found(format!("{t} after {}", times_s[index - 1]))
                    .allowed("strictly increasing seconds"));
            }
        }
        Ok(Self {
            times_s,
            positions_world_m,
            orientations_world_from_body: None,
            velocities_world_m_s: None,
            angular_velocities_body_rad_s: None,
            joints: Vec::new(),
            signals: Vec::new(),
            planar: false,
        })
    }

    /// The same trajectory with orientations (world from body), one per sample.
    ///
    /// # Errors
    /// A number of orientations that differs from the number of samples, or non-finite ones.
    pub fn with_orientations(mut self, world_from_body: Vec<UnitQuaternion<f64>>) -> Result<Self> {
        self.check_column(
            "orientations",
            world_from_body.len(),
            world_from_body
                .iter()
                .all(|q| q.coords.iter().all(|v| v.is_finite())),
        )?;
        self.orientations_world_from_body = Some(world_from_body);
        Ok(self)
    }

    /// The same trajectory with other positions, one per sample; everything else is kept.
    ///
    /// # Errors
    /// A number of positions that differs from the number of samples, or non-finite ones.
    pub fn with_positions(mut self, positions_world_m: Vec<Vector3<f64>>) -> Result<Self> {
        let finite = positions_world_m
            .iter()
            .all(|p| p.iter().all(|v| v.is_finite()));
        self.check_column("positions", positions_world_m.len(), finite)?;
        self.positions_world_m = positions_world_m;
        Ok(self)
    }

    /// The same trajectory with velocities: linear in the world frame (m/s), angular in the body frame (rad/s).
    ///
    /// # Errors
    /// A number of velocities that differs from the number of samples, or non-finite ones.
    pub fn with_velocities(
        mut self,
        linear_world_m_s: Vec<Vector3<f64>>,
        angular_body_rad_s: Vec<Vector3<f64>>,
    ) -> Result<Self> {
        let finite = |v: &[Vector3<f64>]| v.iter().all(|v| v.iter().all(|x| x.is_finite()));
        self.check_column(
            "linear velocities",
            linear_world_m_s.len(),
            finite(&linear_world_m_s),
        )?;
        self.check_column(
            "angular velocities",
            angular_body_rad_s.len(),
            finite(&angular_body_rad_s),
        )?;
        self.velocities_world_m_s = Some(linear_world_m_s);
        self.angular_velocities_body_rad_s = Some(angular_body_rad_s);
        Ok(self)
    }

    /// The same trajectory with the angles of joints, one per sample.
    ///
    /// # Errors
    /// A number of angles or speeds that differs from the number of samples, non-finite ones, or two joints of one name.
    pub fn with_joints(mut self, joints: Vec<JointTrack>) -> Result<Self> {
        for (index, joint) in joints.iter().enumerate() {
            let columns = [Some(&joint.angles_rad), joint.speeds_rad_s.as_ref()];
            for column in columns.into_iter().flatten() {
                let what = format!("values of the joint `{}`", joint.name);
                let finite = column.iter().all(|value| value.is_finite());
                self.check_column(&what, column.len(), finite)?;
            }
            if joints[..index].iter().any(|other| other.name == joint.name) {
                return Err(Error::invalid("two joints have the same name")
                    .found(format!("`{}`", joint.name)));
            }
        }
        self.joints = joints;
        Ok(self)
    }

    /// The same trajectory with signals, one value per sample.
    ///
    /// # Errors
    /// A number of values that differs from the number of samples, or non-finite ones.
    pub fn with_signals(mut self, signals: Vec<Signal>) -> Result<Self> {
        for signal in &signals {
            let finite = signal.values.iter().all(|value| value.is_finite());
            let what = format!("values of `{}`", signal.name);
            self.check_column(&what, signal.values.len(), finite)?;
        }
        self.signals = signals;
        Ok(self)
    }

    /// The same trajectory with all lengths, and therefore all linear velocities, multiplied by `factor`.
    ///
    /// # Errors
    /// A factor that is not a positive number, or that is so large that a length is no longer finite.
    pub fn scaled(&self, factor: f64) -> Result<Self> {
        let all =
            |v: &[Vector3<f64>]| -> Vec<Vector3<f64>> { v.iter().map(|v| v * factor).collect() };
        let largest_m = self
            .positions_world_m
            .iter()
            .map(|p| p.amax())
            .fold(0.0, f64::max);
        if !(factor > 0.0 && factor.is_finite() && (largest_m * factor).is_finite()) {
            return Err(Error::invalid("lengths cannot be scaled by this")
                .found(factor)
                .allowed("a finite factor above 0"));
        }
        Ok(Self {
            positions_world_m: all(&self.positions_world_m),
            velocities_world_m_s: self.velocities_world_m_s.as_deref().map(all),
            ..self.clone()
        })
    }

    /// The same trajectory with times that are `by_s` seconds later.
    ///
    /// # Errors
    /// A shift so large that times are no longer finite or no longer differ from each other.
    pub fn later(&self, by_s: f64) -> Result<Self> {
        let times_s: Vec<f64> = self.times_s.iter().map(|time_s| time_s + by_s).collect();
        let increases = times_s.windows(2).all(|pair| pair[0] < pair[1]);
        if !(increases && times_s.iter().all(|time_s| time_s.is_finite())) {
            return Err(Error::invalid("times cannot be shifted by this")
                .found(format!("{by_s} s"))
                .allowed("a shift that keeps the times apart"));
        }
        Ok(Self {
            times_s,
            ..self.clone()
        })
    }

    /// Marks the trajectory as planar: z was not recorded, and is 0 everywhere.
    #[must_use]
    pub fn planar(mut self) -> Self {
        self.planar = true;
        self
    }

    /// Marks the trajectory as planar if another trajectory is planar.
    pub(super) fn planar_like(self, other: &Self) -> Self {
        Self {
            planar: other.planar,
            ..self
        }
    }

    /// Linear velocities in the world frame and angular velocities in the body frame, if both are known.
    pub(super) fn velocities(&self) -> Option<[&[Vector3<f64>]; 2]> {
        let linear = self.velocities_world_m_s.as_deref()?;
        Some([linear, self.angular_velocities_body_rad_s.as_deref()?])
    }

    fn check_column(&self, what: &str, found: usize, finite: bool) -> Result<()> {
        if found != self.len() {
            return Err(Error::invalid(format!("{what} and times differ in number"))
                .found(found)
                .allowed(self.len()));
        }
        if !finite {
            return Err(Error::invalid(format!(
                "{what} contain a number that is not finite"
            )));
        }
        Ok(())
    }

    /// Number of samples, at least 2.
    #[allow(clippy::len_without_is_empty)]
    pub fn len(&self) -> usize {
        self.times_s.len()
    }

    /// Sample times, seconds, strictly increasing.
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// Positions of the tracked point in the world frame, metres.
    pub fn positions_world_m(&self) -> &[Vector3<f64>] {
        &self.positions_world_m
    }

    /// Orientations (world from body), if recorded.
    pub fn orientations_world_from_body(&self) -> Option<&[UnitQuaternion<f64>]> {
        self.orientations_world_from_body.as_deref()
    }

    /// Linear velocities in the world frame, m/s, if recorded.
    pub fn velocities_world_m_s(&self) -> Option<&[Vector3<f64>]> {
        self.velocities_world_m_s.as_deref()
    }

    /// Angular velocities in the body frame, rad/s, if recorded.
    pub fn angular_velocities_body_rad_s(&self) -> Option<&[Vector3<f64>]> {
        self.angular_velocities_body_rad_s.as_deref()
    }

    /// True if only joints or signals were recorded: there are no orientations, and all positions are the origin.
    pub fn is_of_joints(&self) -> bool {
        (!self.joints.is_empty() || !self.signals.is_empty())
            && self.orientations_world_from_body.is_none()
            && self
                .positions_world_m
                .iter()
                .all(|p| *p == Vector3::zeros())
    }

    /// Joints in the order of the file; empty if none were recorded.
    pub fn joints(&self) -> &[JointTrack] {
        &self.joints
    }

    /// The joint of this name.
    pub fn joint(&self, name: &str) -> Option<&JointTrack> {
        self.joints.iter().find(|joint| joint.name == name)
    }

    /// The recorded signals, in the order of the file.
    pub fn signals(&self) -> &[Signal] {
        &self.signals
    }

    /// The signal of this name, unit included.
    pub fn signal(&self, name: &str) -> Option<&Signal> {
        self.signals.iter().find(|signal| signal.name == name)
    }

    /// True if z was not recorded.
    pub fn is_planar(&self) -> bool {
        self.planar
    }

    /// Time, position and orientation of every sample; the identity rotation if orientations are unknown.
    pub(super) fn poses(
        &self,
    ) -> impl Iterator<Item = (f64, Vector3<f64>, UnitQuaternion<f64>)> + '_ {
        let turn = |index: usize| {
            let all = self.orientations_world_from_body();
            all.map_or_else(UnitQuaternion::identity, |all| all[index])
        };
        let places = self.times_s.iter().zip(&self.positions_world_m).enumerate();
        places.map(move |(index, (time_s, place_m))| (*time_s, *place_m, turn(index)))
    }

    /// Last time minus first time, seconds, more than 0.
    pub fn duration_s(&self) -> f64 {
        self.times_s[self.len() - 1] - self.times_s[0]
    }

    /// Sum of the distances between consecutive positions in the x-y plane, metres.
    pub fn path_length_xy_m(&self) -> f64 {
        self.positions_world_m
            .windows(2)
            .map(|w| (w[1] - w[0]).xy().norm())
            .sum()
    }

    /// Largest distance from the first position, metres.
    pub fn extent_m(&self) -> f64 {
        let start = self.positions_world_m[0];
        let distances = self.positions_world_m.iter().map(|p| (p - start).norm());
        distances.fold(0.0, f64::max)
    }

    /// Accumulated change of the body's heading about the world z axis, radians; `None` without orientations.
    pub fn turned_rad(&self) -> Option<f64> {
        let world_from_body = self.orientations_world_from_body()?;
        let step = |w: &[UnitQuaternion<f64>]| {
            let q = w[1] * w[0].inverse();
            2.0 * q.k.atan2(q.w)
        };
        let wrap =
            |angle: f64| angle - std::f64::consts::TAU * (angle / std::f64::consts::TAU).round();
        Some(world_from_body.windows(2).map(|w| wrap(step(w))).sum())
    }

    /// Last position minus first position, metres.
    pub fn net_displacement_world_m(&self) -> Vector3<f64> {
        self.positions_world_m[self.len() - 1] - self.positions_world_m[0]
    }
}
