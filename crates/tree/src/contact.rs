//! Contact rows: a soft normal with restitution, and friction within Coulomb's cone, opposite to slip; or both within a relaxed one.

use parry3d_f64::math::Vec3;

use crate::forest::{Forest, Freedom, NONE};
use crate::kinematics::Node;
use crate::model::{Cone, Settings};
use crate::spatial::Spatial;
use crate::touch::{Memory, Touch};

/// Spring and damper as an implicit step sees them (Catto 2011, "Soft constraints").
#[derive(Debug, Clone, Copy)]
pub(crate) struct Softness {
    /// Speed that undoes a depth, 1/s.
    recovery_1_s: f64,
    most_recovery_m_s: f64,
    /// How much the row gives, as a share of its inverse mass.
    pub slack: f64,
    time_s: f64,
    relaxed: Option<Relaxed>,
}

/// What rows of a relaxed cone aim at: accelerations of a spring and a damper of unit mass, whatever the contact feels (the reference
/// of Todorov 2014), in an implicit step.
#[derive(Debug, Clone, Copy)]
struct Relaxed {
    /// Share of a velocity that is left after the step.
    kept: f64,
    /// Speed that undoes a depth, 1/s.
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

    /// Least speed apart at this distance: above the surface, what just touches it at the end of the step.
    pub fn wanted_speed(&self, distance: f64) -> f64 {
        if distance > 0.0 {
            -distance / self.time_s
        } else {
            (-distance * self.recovery_1_s).min(self.most_recovery_m_s)
        }
    }
}

/// The rows of a contact as one body sees them: along the normal and two tangents.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Side {
    /// Reads the velocity of the point.
    pub reads: [Spatial; 3],
    /// Change of the body's velocity per impulse of the pair.
    pub gives: [Spatial; 3],
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
    /// Inverse mass of both trees, each as if it were one piece: outside contacts never give less.
    whole_k: f64,
    /// Normal speed per impulse along the tangents.
    presses: [f64; 2],
    /// Slip left per impulse of friction.
    slip_per_impulse: f64,
    wanted: f64,
    slack: f64,
    friction: f64,
    /// Speed apart per slip, within a relaxed cone.
    lift: f64,
    pub impulse: [f64; 3],
    pub memory: Memory,
    pub touch: usize,
    pub is_impact: bool,
}

/// Contacts between the same two bodies, solved one after the other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Group {
    pub a: usize,
    pub b: usize,
    /// Where their paths meet; [`NONE`] for different trees.
    pub meeting: usize,
    pub first: usize,
    pub end: usize,
    /// The next group of the same meeting; [`NONE`] after the last.
    pub next: usize,
}

/// A normal gives at least this share of what the tangents or the trees as a whole would.
const RIGID: f64 = 0.01;

/// Share of its inverse mass that a row of a relaxed cone gives, as MuJoCo's do at an impedance of 0.97.
const GIVES: f64 = 0.03;

/// How much more than friction may press together a contact gives where it jams.
const JAMMING: f64 = 1.1;

/// What a row needs to know about the step.
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
    /// Rows without what bodies give.
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
            lift: 0.0,
            impulse: basis.map(|axis| touch.impulse_world_n_s.dot(axis)),
            memory: touch.memory,
            touch: index,
            is_impact: false,
        };
        point.impulse[0] = point.impulse[0].max(0.0);
        point.a.reads = basis.map(|axis| Spatial::at(arm_a, axis));
        let mut swing = node.swing_at(arm_a, &nodes[forest.bodies[touch.a].root]);
        let mut approach = point.led[0] - point.a.reads[0].dot(&node.velocity);
        let mut pull = -basis[0].dot(step.gravity_world_m_s2);
        if touch.b != NONE {
            let other = &nodes[touch.b];
            point.whole_k += forest.bodies[touch.b].tree_inverse_mass;
            point.arm_b = touch.point_world_m - other.reference_world_m;
            swing -= other.swing_at(point.arm_b, &nodes[forest.bodies[touch.b].root]);
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
        // Over the step a point travels by its velocity and by half of what velocity products do to it.
        for (k, axis) in basis.iter().enumerate() {
            let same_point =
                k > 0 || (matches!(touch.memory, Memory::Corner { .. }) && !point.is_impact);
            if same_point {
                point.led[k] -= 0.5 * step.time_s * swing.dot(*axis);
            }
        }
        point
    }

    /// Rows of a relaxed cone: what is left of every velocity and what undoes the depth are what the rows aim at, and the normal takes
    /// its share of the slip beyond that.
    fn relax(&mut self, relaxed: Relaxed, touch: &Touch, nodes: &[Node]) {
        for (k, axis) in self.basis.iter().enumerate() {
            let mut speed = self.a.reads[k].dot(&nodes[touch.a].velocity) - self.led[k];
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

    /// Restitution (Newton's), where the surfaces meet within the step faster than gravity makes them in four.
    ///
    /// The rows turn the velocity round at a distance above the surface. So they aim at the speed that a body has there which has
    /// fallen on, bounced and risen again; velocities belong to the middle of a step.
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
        // An impact is hard.
        self.slack = 0.0;
        true
    }

    /// Completes the rows once it is known what both bodies give, and turns the tangents to where one does not feel the other.
    pub fn weigh(&mut self, mut other: Option<&mut Side>) {
        let give = |other: &Option<&mut Side>, a: &Side, i: usize, j: usize| {
            let its = other.as_ref().map_or(0.0, |b| b.reads[i].dot(&b.gives[j]));
            a.reads[i].dot(&a.gives[j]) + its
        };
        self.normal_k = give(&other, &self.a, 0, 0);
        self.slack *= self.normal_k;
        self.presses = [give(&other, &self.a, 0, 1), give(&other, &self.a, 0, 2)];
        let (tt, ts, ss) = (
            give(&other, &self.a, 1, 1),
            give(&other, &self.a, 2, 1),
            give(&other, &self.a, 2, 2),
        );
        // Jacobi's rotation.
        let half = 0.5 * (tt - ss);
        let radius = length_of([half, ts]);
        let mean = 0.5 * (tt + ss);
        let least = 1e-6 * self.whole_k;
        self.tangent_k = [(mean + radius).max(least), (mean - radius).max(least)];
        // Where the bodies cannot part along the normal, a joint or a mount holds already: a hard row would do it again, with any
        // impulse.
        self.slack = self
            .slack
            .max(RIGID * self.whole_k.max(mean) - self.normal_k);
        let cosine = (0.5 * (1.0 + half.abs() / radius.max(f64::MIN_POSITIVE))).sqrt();
        let sine = 0.5 * ts / (radius * cosine).max(f64::MIN_POSITIVE);
        let (c, s) = if half >= 0.0 {
            (cosine, sine)
        } else {
            (sine.abs(), cosine.copysign(ts))
        };
        if s == 0.0 {
            return;
        }
        let turned = |t: f64, u: f64| (c * t + s * u, c * u - s * t);
        let [_, t, u] = self.basis;
        (self.basis[1], self.basis[2]) = (t * c + u * s, u * c - t * s);
        (self.led[1], self.led[2]) = turned(self.led[1], self.led[2]);
        (self.impulse[1], self.impulse[2]) = turned(self.impulse[1], self.impulse[2]);
        (self.presses[0], self.presses[1]) = turned(self.presses[0], self.presses[1]);
        let turn = |side: &mut Side| {
            for rows in [&mut side.reads, &mut side.gives] {
                let [_, t, u] = *rows;
                (rows[1], rows[2]) = (t * c + u * s, u * c - t * s);
            }
        };
        turn(&mut self.a);
        if let Some(side) = &mut other {
            turn(side);
        }
    }

    /// The impulse on the first body.
    pub fn impulse_world(&self) -> Vec3 {
        let [n, t, s] = self.basis;
        n * self.impulse[0] + t * self.impulse[1] + s * self.impulse[2]
    }

    /// One visit of a sweep; changes the velocities and returns the change of the impulse.
    #[inline(always)]
    pub fn solve(&mut self, a: &mut Spatial, mut b: Option<(&Side, &mut Spatial)>) -> [f64; 3] {
        let reads = |point: &Self, i: usize, a: &Spatial, b: &Option<(&Side, &mut Spatial)>| {
            let mut speed = point.a.reads[i].dot(a) - point.led[i];
            if let Some((side, velocity)) = b {
                speed += side.reads[i].dot(velocity);
            }
            speed
        };
        let slack = self.slack.max(self.jam());
        let mut residual = reads(self, 0, a, &b) - self.wanted + slack * self.impulse[0];
        if self.lift > 0.0 {
            residual -= self.lift * length_of([reads(self, 1, a, &b), reads(self, 2, a, &b)]);
        }
        let normal = (self.impulse[0] - residual / (self.normal_k + slack)).max(0.0);
        let mut more = [normal - self.impulse[0], 0.0, 0.0];
        self.impulse[0] = normal;
        if more[0] != 0.0 {
            a.add_scaled(&self.a.gives[0], more[0]);
            if let Some((side, velocity)) = &mut b {
                velocity.add_scaled(&side.gives[0], more[0]);
            }
        }
        let most = self.friction * normal;
        let before = [self.impulse[1], self.impulse[2]];
        if most == 0.0 && before == [0.0; 2] {
            return more;
        }
        let slip = [reads(self, 1, a, &b), reads(self, 2, a, &b)];
        let k = self.tangent_k;
        let wish = [k[0] * before[0] - slip[0], k[1] * before[1] - slip[1]];
        let now = friction(&k, wish, most, &mut self.slip_per_impulse);
        for k in 0..2 {
            let change = now[k] - before[k];
            more[k + 1] = change;
            self.impulse[k + 1] = now[k];
            a.add_scaled(&self.a.gives[k + 1], change);
            if let Some((side, velocity)) = &mut b {
                velocity.add_scaled(&side.gives[k + 1], change);
            }
        }
        more
    }

    /// Work of the impulse at these mean velocities, beyond what undoing depth or bouncing takes.
    pub fn work(&self, a: &Spatial, b: Option<(&Side, Spatial)>) -> f64 {
        let mut work = -0.5 * self.impulse[0] * self.wanted.max(0.0);
        for (k, impulse) in self.impulse.iter().enumerate() {
            let its = b
                .as_ref()
                .map_or(0.0, |(side, velocity)| side.reads[k].dot(velocity));
            work += impulse * (self.a.reads[k].dot(a) + its - self.led[k]);
        }
        work
    }

    /// Where friction presses the surfaces together faster than the normal impulse parts them, a sliding contact jams without bound
    /// (Painlevé's paradox): there it gives as much as it takes for an answer to exist.
    #[inline]
    fn jam(&self) -> f64 {
        let [n, t, u] = self.impulse;
        let most = self.friction * n;
        if t * t + u * u < 0.999 * most * most || n == 0.0 {
            return 0.0;
        }
        JAMMING * -(self.presses[0] * t + self.presses[1] * u) / n - self.normal_k
    }

    /// How fast a change of impulse moves the point, m/s.
    pub fn speed_of(&self, change: &[f64; 3]) -> f64 {
        (change[0] * self.normal_k).abs()
            + (change[1] * self.tangent_k[0]).abs()
            + (change[2] * self.tangent_k[1]).abs()
    }
}

/// Friction within Coulomb's cone: what stops the slip, or else an impulse of length `most` that is opposite to the slip left.
///
/// `wish` is K · before − slip along the principal tangents. What is left, K · new − wish = −s · new, has the solution
/// new = wish / (K + s); s by Newton's method on the secular equation 1 / |new| = 1 / most (Moré and Sorensen 1983), starting from
/// where it was in the sweep before.
#[inline(always)]
fn friction(k: &[f64; 2], wish: [f64; 2], most: f64, start: &mut f64) -> [f64; 2] {
    let sticks = [wish[0] / k[0], wish[1] / k[1]];
    if sticks[0] * sticks[0] + sticks[1] * sticks[1] <= most * most {
        return sticks;
    }
    if most <= 0.0 {
        return [0.0; 2];
    }
    // Between these s lies, as K stretches nothing by more than its larger and less than its smaller value.
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

/// The value between bounds that mostly hold: a branch, so that nothing waits for them.
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
