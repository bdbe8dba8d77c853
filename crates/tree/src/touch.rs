//! Narrow phase of collision detection: contact points of two shapes. Boxes and balls on half-spaces are computed directly, all
//! other pairs by Parry.

use parry3d_f64::math::{Pose, Vec3};
use parry3d_f64::query::details::ContactManifoldsWorkspace;
use parry3d_f64::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry3d_f64::shape::SharedShape;

use crate::turning::TurningFriction;
use crate::tyre::Tyre;

/// A contact point that collision detection found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Touch {
    /// Body towards which the normal points.
    pub a: usize,
    /// The other body; [`NONE`] for a fixture.
    pub b: usize,
    /// Last common ancestor of both bodies; `a` for a fixture.
    pub meeting: usize,
    pub shape_a: usize,
    /// Shape of the other body, or fixture.
    pub shape_b: usize,
    pub point_world_m: Vec3,
    pub normal_world: Vec3,
    pub distance_m: f64,
    pub friction: f64,
    pub restitution: f64,
    /// Vector from the centre of a ball to its lowest point, which is another point of the ball at every time; zero where a point
    /// of the body stays in contact.
    pub round_m: Vec3,
    /// The law of a tyre, and the vector from the middle of its shape to the contact point.
    pub tyre: Option<(Tyre, Vec3)>,
    /// Velocity of the fixture at the contact point.
    pub led_world_m_s: Vec3,
    /// Friction against rolling and spinning.
    pub turning: TurningFriction,
    /// Angular velocity of the fixture.
    pub led_turn_world_rad_s: Vec3,
    /// Impulse of the contact in the previous step.
    pub impulse_world_n_s: Vec3,
    /// Angular impulse against rolling and spinning in the previous step.
    pub couple_world_n_m_s: Vec3,
    pub memory: Memory,
}

/// What is kept of a contact point for the warm start of the next step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Kept {
    pub impulse_world_n_s: Vec3,
    pub couple_world_n_m_s: Vec3,
}

/// Storage location of a contact's impulse for the next step.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Memory {
    /// Corner of a box, or lowest point of a ball, on a half-space.
    Corner { pair: usize, corner: usize },
    /// Point of a manifold.
    Point {
        pair: usize,
        manifold: usize,
        point: usize,
    },
}

/// Kind of a shape; contacts of the first three kinds with a half-space are computed directly.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Form {
    Box(Vec3),
    Ball(f64),
    HalfSpace(Vec3),
    Other,
}

impl Form {
    pub fn of(shape: &SharedShape) -> Self {
        if let Some(cuboid) = shape.as_cuboid() {
            Self::Box(cuboid.half_extents)
        } else if let Some(ball) = shape.as_ball() {
            Self::Ball(ball.radius)
        } else if let Some(plane) = shape.as_halfspace() {
            Self::HalfSpace(plane.normal)
        } else {
            Self::Other
        }
    }
}

/// Two shapes that may be in contact, and the stored data of their contact points.
pub(crate) struct Pair {
    pub shape_a: usize,
    /// Shape, or fixture.
    pub shape_b: usize,
    pub a: usize,
    pub b: usize,
    pub meeting: usize,
    pub seen_at: u64,
    pub friction: f64,
    pub restitution: f64,
    pub turning: TurningFriction,
    pub corners: Vec<Kept>,
    pub manifolds: Vec<ContactManifold<(), Kept>>,
    pub workspace: Option<ContactManifoldsWorkspace>,
}

/// A half-space, and the height above it up to which contacts are reported.
pub(crate) struct Plane {
    pub normal_world: Vec3,
    pub point_world_m: Vec3,
    pub reach_m: f64,
}

impl Pair {
    /// Discards the stored contact points of a pair that was out of reach in the previous step.
    pub fn recall(&mut self, now: u64) {
        if self.seen_at + 1 != now {
            self.corners.fill(Kept::default());
            self.manifolds.clear();
            self.workspace = None;
        }
        self.seen_at = now;
    }

    fn touch(&self, point_world_m: Vec3, normal_world: Vec3, distance_m: f64) -> Touch {
        Touch {
            a: self.a,
            b: self.b,
            meeting: self.meeting,
            shape_a: self.shape_a,
            shape_b: self.shape_b,
            point_world_m,
            normal_world,
            distance_m,
            friction: self.friction,
            restitution: self.restitution,
            round_m: Vec3::ZERO,
            tyre: None,
            led_world_m_s: Vec3::ZERO,
            turning: self.turning,
            led_turn_world_rad_s: Vec3::ZERO,
            impulse_world_n_s: Vec3::ZERO,
            couple_world_n_m_s: Vec3::ZERO,
            memory: Memory::Corner { pair: 0, corner: 0 },
        }
    }

    /// Adds contacts with a half-space: the corners of a box, or the lowest point of a ball.
    pub(crate) fn touch_plane(
        &mut self,
        index: usize,
        plane: &Plane,
        form: Form,
        world_from_shape: &Pose,
        touches: &mut Vec<Touch>,
    ) {
        let normal = plane.normal_world;
        let centre_m = world_from_shape.translation;
        let height_m = normal.dot(centre_m - plane.point_world_m);
        let (half, below) = match form {
            Form::Box(half) => (half, 0.0),
            Form::Ball(radius) => (Vec3::ZERO, radius),
            Form::HalfSpace(_) | Form::Other => return,
        };
        let axes = [
            world_from_shape.rotation * Vec3::X * half.x,
            world_from_shape.rotation * Vec3::Y * half.y,
            world_from_shape.rotation * Vec3::Z * half.z,
        ];
        let rises = axes.map(|axis| normal.dot(axis));
        let corners = if below > 0.0 { 1 } else { 8 };
        for corner in 0..corners {
            let sign = |bit: usize| if corner >> bit & 1 == 0 { 1.0 } else { -1.0 };
            let (x, y, z) = (sign(0), sign(1), sign(2));
            let rise = rises[0] * x + rises[1] * y + rises[2] * z;
            let distance_m = height_m + rise - below;
            if distance_m > plane.reach_m {
                self.corners[corner] = Kept::default();
                continue;
            }
            let point_m = centre_m + axes[0] * x + axes[1] * y + axes[2] * z - normal * below;
            touches.push(Touch {
                impulse_world_n_s: self.corners[corner].impulse_world_n_s,
                couple_world_n_m_s: self.corners[corner].couple_world_n_m_s,
                memory: Memory::Corner {
                    pair: index,
                    corner,
                },
                round_m: normal * -below,
                ..self.touch(point_m, normal, distance_m)
            });
        }
    }

    /// Adds the contacts of any two shapes, computed by Parry.
    pub(crate) fn touch_shape(
        &mut self,
        index: usize,
        now: u64,
        mine: (&Pose, &SharedShape),
        other: (&Pose, &SharedShape),
        reach: f64,
        touches: &mut Vec<Touch>,
    ) {
        self.recall(now);
        let between = mine.0.inv_mul(other.0);
        let found = DefaultQueryDispatcher.contact_manifolds(
            &between,
            mine.1.as_ref(),
            other.1.as_ref(),
            reach,
            &mut self.manifolds,
            &mut self.workspace,
        );
        if found.is_err() {
            return;
        }
        for (number, manifold) in self.manifolds.iter().enumerate() {
            let part_1 = manifold.subshape_pos1().copied().unwrap_or_default();
            let part_2 = manifold.subshape_pos2().copied().unwrap_or_default();
            let (world_from_1, world_from_2) = (*mine.0 * part_1, *other.0 * part_2);
            // Parry's normal points away from the first shape.
            let normal = -(world_from_1.rotation * manifold.local_n1);
            // Shapes at the same position have no defined normal.
            let upright = (normal.length_squared() - 1.0).abs() < 1e-6 && normal.is_finite();
            for (point_number, point) in manifold.points.iter().enumerate() {
                if point.dist > reach || !upright {
                    continue;
                }
                let one = world_from_1 * point.local_p1;
                let two = world_from_2 * point.local_p2;
                touches.push(Touch {
                    impulse_world_n_s: point.data.impulse_world_n_s,
                    couple_world_n_m_s: point.data.couple_world_n_m_s,
                    memory: Memory::Point {
                        pair: index,
                        manifold: number,
                        point: point_number,
                    },
                    ..self.touch((one + two) * 0.5, normal, point.dist)
                });
            }
        }
    }
}
