//! Simulates the rotation of parts joined by passive hinges in free flight.
//!
//! In flight the centre of mass of the whole robot moves on a parabola whatever the parts do, so the remaining motion is a rotation
//! about it. With p = M(q) v, v = (angular velocity of the tracked part in its own frame, joint speeds) and M the inertia that
//! remains when the common velocity is subtracted, Hamilton's equations are dp_w/dt = -w x p_w, dp_q/dt = ½ vᵀ ∂M/∂q v - friction
//! (Featherstone 2008, *Rigid Body Dynamics Algorithms*, section 9.3, of a floating base).

use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Translation3, Unit, UnitQuaternion, Vector3};

use realgap_robot::morphology::{Assembly, Bearing};

/// A rigid part, in the tracked frame at zero angles.
#[derive(Debug, Clone, PartialEq)]
struct Link {
    mass_kg: f64,
    centre_m: Vector3<f64>,
    inertia_kg_m2: Matrix3<f64>,
}

/// A passive hinge, in the tracked frame at zero angles; hinge number k moves link number k + 1.
#[derive(Debug, Clone, PartialEq)]
struct PassiveHinge {
    name: String,
    parent: usize,
    anchor_m: Vector3<f64>,
    axis: Unit<Vector3<f64>>,
    bearing: Bearing,
}

/// Parts joined by passive hinges, the tracked part first.
#[derive(Debug, Clone, PartialEq)]
pub struct Linkage {
    links: Vec<Link>,
    hinges: Vec<PassiveHinge>,
}

/// Orientation, angular velocity and joint state of a linkage at one moment.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Attitude {
    /// Orientation of the tracked part, world from body.
    pub world_from_body: UnitQuaternion<f64>,
    /// Angular velocity of the tracked part, body frame, rad/s.
    pub rate_body_rad_s: Vector3<f64>,
    /// Angles of the joints, radians.
    pub angles_rad: Vec<f64>,
    /// Speeds of the joints, rad/s.
    pub speeds_rad_s: Vec<f64>,
}

/// Range of speeds over which dry friction reverses its sign, rad/s; the reversal is smooth so that fits can be differentiated.
const REVERSAL_RAD_S: f64 = 0.05;
/// Half the change of an angle by which inertia is differentiated, radians.
const STEP_RAD: f64 = 1e-5;

/// The state of the integration: orientation, joint angles and their momenta.
#[derive(Debug, Clone)]
struct Phase {
    turn: UnitQuaternion<f64>,
    angles: DVector<f64>,
    momenta: DVector<f64>,
}

impl Linkage {
    /// The linkage of a robot whose root is tracked; `None` if another part is tracked, if a servo drives a hinge, or if the robot
    /// has no hinges.
    pub(super) fn new(robot: &Assembly) -> Option<Self> {
        let driven = robot.hinges.iter().any(|hinge| hinge.actuator.is_some());
        if driven || robot.hinges.is_empty() || robot.track_part != 0 {
            return None;
        }
        let track_from_robot = robot.robot_from_track.inverse();
        let links = robot.parts.iter().map(|part| {
            let mass = part.mass(&track_from_robot);
            Link {
                mass_kg: mass.mass_kg,
                centre_m: mass.centre_m,
                inertia_kg_m2: mass.inertia_kg_m2,
            }
        });
        let hinges = robot.hinges.iter().map(|hinge| PassiveHinge {
            name: hinge.name.clone(),
            parent: hinge.parent_part,
            anchor_m: (track_from_robot * nalgebra::Point3::from(hinge.anchor_robot_m)).coords,
            axis: Unit::new_unchecked(track_from_robot.rotation * hinge.axis_robot.into_inner()),
            bearing: hinge.bearing,
        });
        Some(Self {
            links: links.collect(),
            hinges: hinges.collect(),
        })
    }

    /// Names of the joints, in the order of the hinges.
    pub(super) fn joint_names(&self) -> impl Iterator<Item = &str> {
        self.hinges.iter().map(|hinge| hinge.name.as_str())
    }

    /// For each part, the displacement in the tracked frame from its pose at zero angles to its pose at these angles.
    pub(super) fn moved(&self, angles_rad: &[f64]) -> Vec<Isometry3<f64>> {
        let mut moved = vec![Isometry3::identity(); self.links.len()];
        for (index, (hinge, angle_rad)) in self.hinges.iter().zip(angles_rad).enumerate() {
            let there = Translation3::from(hinge.anchor_m);
            let turn = UnitQuaternion::from_axis_angle(&hinge.axis, *angle_rad);
            moved[index + 1] = moved[hinge.parent] * (there * turn * there.inverse());
        }
        moved
    }

    /// Centre of mass of the whole robot in the tracked frame, metres.
    pub(super) fn centre_m(&self, angles_rad: &[f64]) -> Vector3<f64> {
        let moved = self.moved(angles_rad);
        let mut mass_kg = 0.0;
        let mut moment = Vector3::zeros();
        for (link, pose) in self.links.iter().zip(&moved) {
            mass_kg += link.mass_kg;
            moment += (pose * nalgebra::Point3::from(link.centre_m)).coords * link.mass_kg;
        }
        moment / mass_kg
    }

    /// Velocity of the centre of mass in the tracked frame that is due to the turning joints, m/s.
    pub(super) fn centre_velocity_m_s(&self, attitude: &Attitude) -> Vector3<f64> {
        let step_s = 1e-6;
        let at = |sign: f64| {
            let angles = attitude.angles_rad.iter().zip(&attitude.speeds_rad_s);
            let moved: Vec<f64> = angles.map(|(q, v)| q + sign * step_s * v).collect();
            self.centre_m(&moved)
        };
        (at(1.0) - at(-1.0)) / (2.0 * step_s)
    }

    /// Inertia matrix of the angular velocity and the joint speeds, without the translation of the centre of mass.
    fn inertia(&self, angles_rad: &[f64]) -> DMatrix<f64> {
        let size = 3 + self.hinges.len();
        let moved = self.moved(angles_rad);
        let total_kg: f64 = self.links.iter().map(|link| link.mass_kg).sum();
        let mut common = DMatrix::<f64>::zeros(3, size);
        let mut linear = Vec::with_capacity(self.links.len());
        let mut angular = Vec::with_capacity(self.links.len());
        for (part, (link, pose)) in self.links.iter().zip(&moved).enumerate() {
            let centre = (pose * nalgebra::Point3::from(link.centre_m)).coords;
            let mut j = DMatrix::<f64>::zeros(3, size);
            let mut w = DMatrix::<f64>::zeros(3, size);
            j.fixed_view_mut::<3, 3>(0, 0)
                .copy_from(&-centre.cross_matrix());
            w.fixed_view_mut::<3, 3>(0, 0)
                .copy_from(&Matrix3::identity());
            let mut on = part;
            while on > 0 {
                let hinge = &self.hinges[on - 1];
                let frame = &moved[hinge.parent];
                let axis = frame.rotation * hinge.axis.into_inner();
                let anchor = (frame * nalgebra::Point3::from(hinge.anchor_m)).coords;
                j.fixed_view_mut::<3, 1>(0, 2 + on)
                    .copy_from(&axis.cross(&(centre - anchor)));
                w.fixed_view_mut::<3, 1>(0, 2 + on).copy_from(&axis);
                on = hinge.parent;
            }
            common += &j * (link.mass_kg / total_kg);
            linear.push(j);
            angular.push(w);
        }
        let mut inertia = DMatrix::<f64>::zeros(size, size);
        for (((link, pose), j), w) in self.links.iter().zip(&moved).zip(linear).zip(angular) {
            let j = j - &common;
            let turn = pose.rotation.to_rotation_matrix();
            let own = turn * link.inertia_kg_m2 * turn.transpose();
            inertia += j.transpose() * &j * link.mass_kg + w.transpose() * own * &w;
        }
        inertia
    }

    fn velocities(&self, phase: &Phase) -> Option<DVector<f64>> {
        self.inertia(phase.angles.as_slice())
            .cholesky()
            .map(|factors| factors.solve(&phase.momenta))
    }

    /// Angular velocity and joint speeds, and the time derivative of the momenta.
    fn change(&self, phase: &Phase) -> Option<(DVector<f64>, DVector<f64>)> {
        let v = self.velocities(phase)?;
        let mut force = DVector::zeros(v.len());
        let rate = Vector3::new(v[0], v[1], v[2]);
        let spin = Vector3::new(phase.momenta[0], phase.momenta[1], phase.momenta[2]);
        force.fixed_rows_mut::<3>(0).copy_from(&-rate.cross(&spin));
        for (index, hinge) in self.hinges.iter().enumerate() {
            let energy = |step: f64| {
                let mut angles = phase.angles.clone();
                angles[index] += step;
                0.5 * v.dot(&(self.inertia(angles.as_slice()) * &v))
            };
            let slope = (energy(STEP_RAD) - energy(-STEP_RAD)) / (2.0 * STEP_RAD);
            let speed = v[3 + index];
            let dry = hinge.bearing.dry_nm * speed / speed.hypot(REVERSAL_RAD_S);
            force[3 + index] = slope - hinge.bearing.viscous_nm_s_rad * speed - dry;
        }
        Some((v, force))
    }

    fn step(&self, phase: &Phase, dt_s: f64) -> Option<Phase> {
        let ahead = |k: &(DVector<f64>, DVector<f64>), share: f64| {
            let (v, force) = k;
            let h = share * dt_s;
            Phase {
                turn: phase.turn
                    * UnitQuaternion::from_scaled_axis(Vector3::new(v[0], v[1], v[2]) * h),
                angles: &phase.angles + v.rows(3, v.len() - 3) * h,
                momenta: &phase.momenta + force * h,
            }
        };
        // Runge-Kutta of fourth order in momenta and angles. The turn composes small rotations by Simpson's rule with the
        // first commutator (Magnus expansion, Iserles & Nørsett 1999, section 3), which is of fourth order, too.
        let k1 = self.change(phase)?;
        let k2 = self.change(&ahead(&k1, 0.5))?;
        let k3 = self.change(&ahead(&k2, 0.5))?;
        let k4 = self.change(&ahead(&k3, 1.0))?;
        let mean = |a: &DVector<f64>, b: &DVector<f64>, c: &DVector<f64>, d: &DVector<f64>| {
            (a + (b + c) * 2.0 + d) / 6.0
        };
        let v = mean(&k1.0, &k2.0, &k3.0, &k4.0);
        let force = mean(&k1.1, &k2.1, &k3.1, &k4.1);
        let rate = |k: &(DVector<f64>, DVector<f64>)| Vector3::new(k.0[0], k.0[1], k.0[2]);
        let turn = Vector3::new(v[0], v[1], v[2]) * dt_s
            + rate(&k1).cross(&rate(&k4)) * (dt_s * dt_s / 12.0);
        Some(Phase {
            turn: phase.turn * UnitQuaternion::from_scaled_axis(turn),
            angles: &phase.angles + v.rows(3, v.len() - 3) * dt_s,
            momenta: &phase.momenta + force * dt_s,
        })
    }

    /// The attitudes at increasing times, in seconds after `start`; `None` if the integration fails.
    pub(super) fn fly(&self, start: &Attitude, times_s: &[f64]) -> Option<Vec<Attitude>> {
        let mut v = DVector::zeros(3 + self.hinges.len());
        v.fixed_rows_mut::<3>(0).copy_from(&start.rate_body_rad_s);
        for (index, speed) in start.speeds_rad_s.iter().enumerate() {
            v[3 + index] = *speed;
        }
        let mut phase = Phase {
            turn: start.world_from_body,
            angles: DVector::from_column_slice(&start.angles_rad),
            momenta: self.inertia(&start.angles_rad) * v,
        };
        let mut now_s = 0.0;
        let mut flown = Vec::with_capacity(times_s.len());
        for &time_s in times_s {
            if time_s > now_s {
                phase = self.step(&phase, time_s - now_s)?;
                now_s = time_s;
            }
            let v = self.velocities(&phase)?;
            flown.push(Attitude {
                world_from_body: phase.turn,
                rate_body_rad_s: Vector3::new(v[0], v[1], v[2]),
                angles_rad: phase.angles.as_slice().to_vec(),
                speeds_rad_s: v.as_slice()[3..].to_vec(),
            });
        }
        let is_finite = flown
            .iter()
            .all(|a| a.world_from_body.coords.iter().all(|x| x.is_finite()));
        is_finite.then_some(flown)
    }
}
