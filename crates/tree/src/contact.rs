//! Contact constraints (rows): a soft normal constraint with restitution, and friction within Coulomb's cone, opposite to the
//! slip; or both within a relaxed cone.

use parry3d_f64::math::Vec3;

use crate::forest::{Forest, Freedom, NONE};
use crate::kinematics::Node;
use crate::model::{Cone, Settings};
use crate::spatial::Spatial;
use crate::touch::{Memory, Touch};

/// Spring and damper of a contact in an implicit time step (Catto 2011, "Soft constraints").
#[derive(Debug, Clone, Copy)]
pub(crate) struct Softness {
    /// Speed of separation per penetration depth, 1/s.
    recovery_1_s: f64,
    most_recovery_m_s: f64,
    /// Compliance of the row, as a fraction of its inverse mass.
    pub slack: f64,
    time_s: f64,
    relaxed: Option<Relaxed>,
}

/// Target velocities of the rows of a relaxed cone: those of a spring and a damper of unit mass, independent of the mass at the
/// contact (the reference acceleration of Todorov 2014), in an implicit step.
#[derive(Debug, Clone, Copy)]
struct Relaxed {
    /// Fraction of a velocity that remains after the step.
    kept: f64,
    /// Speed of separation per penetration depth, 1/s.
    recovery_1_s: f64,
}

impl Softness {
    pub fn new(settings: &Settings, time_s: f64) -> Self {
        let omega = std::f64::consts::TAU * settings.contact_frequency_hz;
        let implicit = time_s * omega + 2.0 * settings.contact_damping_ratio;
        let kept = 1.0 / (1.0 + time_s * omega * implicit);
        let relaxed = (settings.cone == Cone::Relaxed).then_some(Relaxed {
            kept,
            recovery_1_s: time_s * omega * omega * kept,
        });
        Self {
            relaxed,
            recovery_1_s: omega / implicit,
            most_recovery_m_s: settings.most_recovery_m_s,
            slack: 1.0 / (time_s * omega * implicit),
            time_s,
        }
    }

    /// Smallest required speed of separation at this distance. Above the surface it is the speed with which the surfaces just
    /// touch at the end of the step.
    pub(crate) fn wanted_speed(&self, distance: f64) -> f64 {
        if distance > 0.0 {
            -distance / self.time_s
        } else {
            (-distance * self.recovery_1_s).min(self.most_recovery_m_s)
        }
    }
}

/// The part of a contact's rows that belongs to one body: along the normal and two tangents.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Side {
    /// Rows of the Jacobian: they map the body's velocity to the velocity of the contact point.
    pub jacobian: [Spatial; 3],
    /// Change of the body's velocity per unit impulse between the pair of bodies.
    pub response: [Spatial; 3],
}

impl Side {
    /// Rotates the tangents by an angle, of which the cosine and the sine are given.
    pub fn turn(&mut self, [c, s]: [f64; 2]) {
        for rows in [&mut self.jacobian, &mut self.response] {
            let [_, t, u] = *rows;
            (rows[1], rows[2]) = (t * c + u * s, u * c - t * s);
        }
    }
}

/// Jacobi's rotation of the tangents to the principal directions: the inverse masses along these, the larger one first, and the
/// cosine and the sine of the angle.
#[inline]
pub(crate) fn principal(tt: f64, ts: f64, ss: f64) -> ([f64; 2], [f64; 2]) {
    let half = 0.5 * (tt - ss);
    let radius = length_of([half, ts]);
    let mean = 0.5 * (tt + ss);
    let cosine = (0.5 * (1.0 + half.abs() / radius.max(f64::MIN_POSITIVE))).sqrt();
    let sine = 0.5 * ts / (radius * cosine).max(f64::MIN_POSITIVE);
    let turn = if half >= 0.0 {
        [cosine, sine]
    } else {
        [sine.abs(), cosine.copysign(ts)]
    };
    ([mean + radius, mean - radius], turn)
}

/// A contact point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    pub a: Side,
    /// Index of the other body's side; [`NONE`] against a fixture.
    pub b: usize,
    pub basis: [Vec3; 3],
    pub arm_b: Vec3,
    /// Velocity of the fixture, in the basis.
    led: [f64; 3],
    /// Inverse masses: normal, and the tangents, the larger one first.
    normal_k: f64,
    tangent_k: [f64; 2],
    /// Inverse mass of both trees, each treated as one rigid body: the inverse mass at a contact with another tree or with a
    /// fixture is never smaller.
    pub whole_k: f64,
    /// Normal velocity per unit impulse along each of the tangents.
    presses: [f64; 2],
    /// Remaining slip velocity per unit friction impulse.
    slip_per_impulse: f64,
    wanted: f64,
    slack: f64,
    friction: f64,
    /// Slip velocity per friction force over load, m/s: 0 unless the shape is a tyre.
    creep_m_s: f64,
    /// Speed of separation per slip velocity, for a relaxed cone.
    lift: f64,
    pub impulse: [f64; 3],
    pub memory: Memory,
    pub touch: usize,
    /// Index of the couple against rolling and spinning; [`NONE`] if there is none.
    pub couple: usize,
    pub is_impact: bool,
}

/// Contacts between the same two bodies, solved one after the other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Group {
    pub a: usize,
    pub b: usize,
    /// Last common ancestor of both bodies; [`NONE`] if they belong to different trees.
    pub meeting: usize,
    pub first: usize,
    pub end: usize,
    /// The next group with the same common ancestor; [`NONE`] after the last.
    pub next: usize,
}

/// The inverse mass of a normal row is at least this fraction of that of the tangents or of the trees as rigid bodies.
const RIGID: f64 = 0.01;

/// Compliance of a row of a relaxed cone as a fraction of its inverse mass, as MuJoCo's at an impedance of 0.97.
const GIVES: f64 = 0.03;

/// Factor by which the compliance of a jamming contact exceeds the pressing effect of friction.
const JAMMING: f64 = 1.1;

/// Data of the step that the rows depend on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    pub time_s: f64,
    pub gravity_world_m_s2: Vec3,
    pub softness: Softness,
}

/// Two tangents of a normal (Duff et al. 2017).
fn basis(normal: Vec3) -> [Vec3; 3] {
    let n = normal;
    let sign = 1.0_f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [
        n,
        Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        Vec3::new(b, sign + n.y * n.y * a, -n.y),
    ]
}

impl Point {
    /// Builds the rows; the responses of the bodies are added later by [`Point::weigh`].
    #[inline(always)]
    pub fn new(touch: &Touch, index: usize, forest: &Forest, nodes: &[Node], step: &Step) -> Self {
        let basis = basis(touch.normal_world);
        let node = &nodes[touch.a];
        let arm_a = touch.point_world_m - node.reference_world_m;
        let mut point = Self {
            a: Side::default(),
            b: NONE,
            basis,
            arm_b: Vec3::ZERO,
            led: basis.map(|axis| touch.led_world_m_s.dot(axis)),
            normal_k: 0.0,
            tangent_k: [0.0; 2],
            whole_k: forest.bodies[touch.a].tree_inverse_mass,
            presses: [0.0; 2],
            slip_per_impulse: 0.0,
            wanted: step.softness.wanted_speed(touch.distance_m),
            slack: step.softness.slack,
            friction: touch.friction,
            creep_m_s: 0.0,
            lift: 0.0,
            impulse: basis.map(|axis| touch.impulse_world_n_s.dot(axis)),
            memory: touch.memory,
            touch: index,
            couple: NONE,
            is_impact: false,
        };
        point.impulse[0] = point.impulse[0].max(0.0);
        point.a.jacobian = basis.map(|axis| Spatial::at(arm_a, axis));
        let root = &nodes[forest.bodies[touch.a].root];
        let mut swing = node.swing_at(arm_a, touch.round_m, root);
        let mut approach = point.led[0] - point.a.jacobian[0].dot(&node.velocity);
        let mut pull = -basis[0].dot(step.gravity_world_m_s2);
        if touch.b != NONE {
            let other = &nodes[touch.b];
            point.whole_k += forest.bodies[touch.b].tree_inverse_mass;
            point.arm_b = touch.point_world_m - other.reference_world_m;
            let root = &nodes[forest.bodies[touch.b].root];
            swing -= other.swing_at(point.arm_b, Vec3::ZERO, root);
            approach += other.velocity.velocity_at(point.arm_b).dot(basis[0]);
            if forest.bodies[forest.bodies[touch.b].root].freedom != Freedom::Mounted {
                pull = 0.0;
            }
        }
        if let Some(relaxed) = step.softness.relaxed {
            point.relax(relaxed, touch, nodes);
            return point;
        }
        point.is_impact = point.bounce(touch, approach, pull, step);
        if let Some((tyre, rim_m)) = touch.tyre {
            let along = |velocity: Vec3| velocity - basis[0] * velocity.dot(basis[0]);
            let over_ground =
                |arm_m: Vec3| along(node.velocity.velocity_at(arm_m) - touch.led_world_m_s);
            let (slip_m_s, hub_m_s) = (over_ground(arm_a), over_ground(arm_a - rim_m));
            point.creep_m_s = tyre.speed_per_force(slip_m_s, hub_m_s, touch.friction);
        }
        // Over the step a point travels by its velocity and by half of the effect of the velocity products.
        for (k, axis) in basis.iter().enumerate() {
            let same_point =
                k > 0 || (matches!(touch.memory, Memory::Corner { .. }) && !point.is_impact);
            if same_point {
                point.led[k] -= 0.5 * step.time_s * swing.dot(*axis);
            }
        }
        point
    }

    /// Sets the targets of the rows for a relaxed cone: the remaining fraction of each velocity plus the speed that reduces the
    /// penetration. The normal row also separates the surfaces in proportion to the slip.
    fn relax(&mut self, relaxed: Relaxed, touch: &Touch, nodes: &[Node]) {
        for (k, axis) in self.basis.iter().enumerate() {
            let mut speed = self.a.jacobian[k].dot(&nodes[touch.a].velocity) - self.led[k];
            if touch.b != NONE {
                let other = nodes[touch.b].velocity.velocity_at(self.arm_b);
                speed -= other.dot(*axis);
            }
            self.led[k] += relaxed.kept * speed;
        }
        self.wanted = -touch.distance_m * relaxed.recovery_1_s;
        self.slack = GIVES;
        self.lift = touch.friction;
    }

    /// Newton's restitution, applied if the surfaces meet within the step at a higher speed than gravity produces in four steps.
    /// Returns whether the contact is an impact.
    ///
    /// The rows reverse the velocity at some distance above the surface. Their target is therefore the speed that a body has at
    /// that height after it has fallen to the surface, bounced and risen again; velocities belong to the middle of a step.
    fn bounce(&mut self, touch: &Touch, approach: f64, pull: f64, step: &Step) -> bool {
        let h = step.time_s;
        let threshold = (4.0 * h * step.gravity_world_m_s2.length()).max(1e-6);
        let now = approach + 0.5 * h * pull;
        if now < threshold || touch.distance_m > h * (approach + h * pull) {
            return false;
        }
        if touch.restitution > 0.0 {
            let gained = 2.0 * pull * touch.distance_m;
            let leaves = touch.restitution.powi(2) * (now * now + gained) - gained;
            if leaves > 0.0 {
                self.wanted = leaves.sqrt() - 0.5 * h * pull;
            }
        }
        // An impact has no compliance.
        self.slack = 0.0;
        true
    }

    /// Completes the rows once the responses of both bodies are known, and rotates the tangents to the principal directions, in
    /// which they are decoupled.
    pub fn weigh(&mut self, mut other: Option<&mut Side>) {
        let give = |other: &Option<&mut Side>, a: &Side, i: usize, j: usize| {
            let its = other
                .as_ref()
                .map_or(0.0, |b| b.jacobian[i].dot(&b.response[j]));
            a.jacobian[i].dot(&a.response[j]) + its
        };
        self.normal_k = give(&other, &self.a, 0, 0);
        self.slack *= self.normal_k;
        self.presses = [give(&other, &self.a, 0, 1), give(&other, &self.a, 0, 2)];
        let (tt, ts, ss) = (
            give(&other, &self.a, 1, 1),
            give(&other, &self.a, 2, 1),
            give(&other, &self.a, 2, 2),
        );
        let ([most, fewest], [c, s]) = principal(tt, ts, ss);
        let mean = 0.5 * (tt + ss);
        let least = 1e-6 * self.whole_k;
        self.tangent_k = [most.max(least), fewest.max(least)];
        // If a joint or a mount prevents the bodies from separating along the normal, a hard row would constrain the same motion
        // twice, and its impulse could become arbitrarily large.
        self.slack = self
            .slack
            .max(RIGID * self.whole_k.max(mean) - self.normal_k);
        if s == 0.0 {
            return;
        }
        let turned = |t: f64, u: f64| (c * t + s * u, c * u - s * t);
        let [_, t, u] = self.basis;
        (self.basis[1], self.basis[2]) = (t * c + u * s, u * c - t * s);
        (self.led[1], self.led[2]) = turned(self.led[1], self.led[2]);
        (self.impulse[1], self.impulse[2]) = turned(self.impulse[1], self.impulse[2]);
        (self.presses[0], self.presses[1]) = turned(self.presses[0], self.presses[1]);
        self.a.turn([c, s]);
        if let Some(side) = &mut other {
            side.turn([c, s]);
        }
    }

    /// The impulse on the first body, world frame, N s.
    pub(crate) fn impulse_world(&self) -> Vec3 {
        let [n, t, s] = self.basis;
        n * self.impulse[0] + t * self.impulse[1] + s * self.impulse[2]
    }

    /// Solves the rows once within a sweep; changes the velocities and returns the change of the impulse.
    #[inline(always)]
    pub fn solve(&mut self, a: &mut Spatial, mut b: Option<(&Side, &mut Spatial)>) -> [f64; 3] {
        let relative_speed =
            |point: &Self, i: usize, a: &Spatial, b: &Option<(&Side, &mut Spatial)>| {
                let mut speed = point.a.jacobian[i].dot(a) - point.led[i];
                if let Some((side, velocity)) = b {
                    speed += side.jacobian[i].dot(velocity);
                }
                speed
            };
        let slack = self.slack.max(self.jam());
        let mut residual = relative_speed(self, 0, a, &b) - self.wanted + slack * self.impulse[0];
        if self.lift > 0.0 {
            residual -= self.lift
                * length_of([
                    relative_speed(self, 1, a, &b),
                    relative_speed(self, 2, a, &b),
                ]);
        }
        let normal = (self.impulse[0] - residual / (self.normal_k + slack)).max(0.0);
        let mut more = [normal - self.impulse[0], 0.0, 0.0];
        self.impulse[0] = normal;
        if more[0] != 0.0 {
            a.add_scaled(&self.a.response[0], more[0]);
            if let Some((side, velocity)) = &mut b {
                velocity.add_scaled(&side.response[0], more[0]);
            }
        }
        let most = self.friction * normal;
        let before = [self.impulse[1], self.impulse[2]];
        if most == 0.0 && before == [0.0; 2] {
            return more;
        }
        let slip = [
            relative_speed(self, 1, a, &b),
            relative_speed(self, 2, a, &b),
        ];
        let [t, u] = self.tangent_k;
        let wish = [t * before[0] - slip[0], u * before[1] - slip[1]];
        // The impulse of a tyre is proportional to the slip that remains: a compliance.
        let creep = match most > 0.0 && self.creep_m_s > 0.0 {
            true => self.creep_m_s / normal,
            false => 0.0,
        };
        let k = [t + creep, u + creep];
        let now = friction(&k, wish, most, &mut self.slip_per_impulse);
        for k in 0..2 {
            let change = now[k] - before[k];
            more[k + 1] = change;
            self.impulse[k + 1] = now[k];
            a.add_scaled(&self.a.response[k + 1], change);
            if let Some((side, velocity)) = &mut b {
                velocity.add_scaled(&side.response[k + 1], change);
            }
        }
        more
    }

    /// Work of the impulse at these mean velocities, without the work for reducing penetration and for bouncing.
    pub fn work(&self, a: &Spatial, b: Option<(&Side, Spatial)>) -> f64 {
        let mut work = -0.5 * self.impulse[0] * self.wanted.max(0.0);
        for (k, impulse) in self.impulse.iter().enumerate() {
            let its = b
                .as_ref()
                .map_or(0.0, |(side, velocity)| side.jacobian[k].dot(velocity));
            work += impulse * (self.a.jacobian[k].dot(a) + its - self.led[k]);
        }
        work
    }

    /// Additional compliance for a jamming contact: if friction presses the surfaces together faster than the normal impulse
    /// separates them, the impulse of a sliding contact grows without bound (Painlevé's paradox). The compliance is just large
    /// enough for a solution to exist.
    #[inline]
    fn jam(&self) -> f64 {
        let [n, t, u] = self.impulse;
        let most = self.friction * n;
        if t * t + u * u < 0.999 * most * most || n == 0.0 {
            return 0.0;
        }
        JAMMING * -(self.presses[0] * t + self.presses[1] * u) / n - self.normal_k
    }

    /// Speed of the contact point due to a change of the impulse, m/s.
    pub(crate) fn speed_of(&self, change: &[f64; 3]) -> f64 {
        (change[0] * self.normal_k).abs()
            + (change[1] * self.tangent_k[0]).abs()
            + (change[2] * self.tangent_k[1]).abs()
    }
}

/// Friction within Coulomb's cone: the impulse that stops the slip, or, if that is too large, an impulse of length `most`
/// opposite to the remaining slip.
///
/// `wish` is K · before − slip along the principal tangents. The remaining slip satisfies K · new − wish = −s · new, with the
/// solution new = wish / (K + s); s is found by Newton's method on the secular equation 1 / |new| = 1 / most (Moré and Sorensen
/// 1983), starting from the value of the previous sweep.
#[inline(always)]
pub(crate) fn friction(k: &[f64; 2], wish: [f64; 2], most: f64, start: &mut f64) -> [f64; 2] {
    let sticks = [wish[0] / k[0], wish[1] / k[1]];
    if sticks[0] * sticks[0] + sticks[1] * sticks[1] <= most * most {
        return sticks;
    }
    if most <= 0.0 {
        return [0.0; 2];
    }
    // Bounds of s: K scales a vector by at least its smaller and at most its larger value.
    let whole = length_of(wish) / most;
    let (least, greatest) = ((whole - k[0]).max(0.0), whole - k[1]);
    let mut s = within(*start, least, greatest);
    let mut now = sticks;
    let mut length = most;
    for _ in 0..8 {
        let (x, y) = (1.0 / (k[0] + s), 1.0 / (k[1] + s));
        now = [wish[0] * x, wish[1] * y];
        let squares = [now[0] * now[0], now[1] * now[1]];
        length = (squares[0] + squares[1]).sqrt();
        let over = length / most - 1.0;
        if over.abs() < 1e-5 {
            break;
        }
        s += over * length * length / (squares[0] * x + squares[1] * y);
        s = within(s, least, greatest);
    }
    *start = s;
    let scale = most / length;
    [now[0] * scale, now[1] * scale]
}

/// Clamps a value to bounds that it rarely exceeds; the branch is usually predicted, so that the following operations need not
/// wait for the clamp.
#[inline(always)]
fn within(s: f64, least: f64, greatest: f64) -> f64 {
    #[cold]
    #[inline(never)]
    fn clamped(s: f64, least: f64, greatest: f64) -> f64 {
        s.clamp(least, greatest.max(least))
    }
    if s < least || s > greatest {
        clamped(s, least, greatest)
    } else {
        s
    }
}

#[inline]
fn length_of(v: [f64; 2]) -> f64 {
    (v[0] * v[0] + v[1] * v[1]).sqrt()
}
