//! Which shapes come close, and where: Parry's manifolds, and corners of boxes and balls on half-spaces directly.

use parry3d_f64::math::{Pose, Vec3};
use parry3d_f64::query::details::ContactManifoldsWorkspace;
use parry3d_f64::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry3d_f64::shape::SharedShape;

use crate::forest::{Forest, NONE};
use crate::kinematics::Node;
use crate::model::{Collider, Fixture, Model};

/// A contact point as collision detection finds it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Touch {
    /// Body that the normal points to.
    pub a: usize,
    /// The other one; [`NONE`] for a fixture.
    pub b: usize,
    /// Where the paths of both meet; `a` for a fixture.
    pub meeting: usize,
    pub shape_a: usize,
    /// Shape of the other body, or fixture.
    pub shape_b: usize,
    pub point_world_m: Vec3,
    pub normal_world: Vec3,
    pub distance_m: f64,
    pub friction: f64,
    pub restitution: f64,
    /// Velocity of the fixture there.
    pub led_world_m_s: Vec3,
    /// What it did in the step before.
    pub impulse_world_n_s: Vec3,
    pub memory: Memory,
}

/// Where the impulse of a contact is kept for the next step.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Memory {
    /// Corner of a box, or a ball, on a half-space.
    Corner { pair: usize, corner: usize },
    /// Point of a manifold.
    Point {
        pair: usize,
        manifold: usize,
        point: usize,
    },
}

#[derive(Debug, Clone, Copy)]
enum Form {
    Box(Vec3),
    Ball(f64),
    HalfSpace(Vec3),
    Other,
}

impl Form {
    fn of(shape: &SharedShape) -> Self {
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

/// A shape of a body.
struct Shape {
    body: usize,
    link: usize,
    body_from_shape: Pose,
    collider: Collider,
    form: Form,
    /// Ball around it, in the body's frame.
    ball_body_m: Vec3,
    radius_m: f64,
}

/// A shape of the world.
pub(crate) struct Placed {
    pub fixture: Fixture,
    form: Form,
    world_from_shape: Pose,
}

impl Placed {
    fn place(&mut self) {
        self.world_from_shape =
            self.fixture.world_from_fixture * self.fixture.collider.owner_from_shape;
    }

    pub fn velocity_at(&self, point_world_m: Vec3) -> Vec3 {
        let arm_m = point_world_m - self.fixture.world_from_fixture.translation;
        self.fixture.velocity_world_m_s + self.fixture.angular_velocity_world_rad_s.cross(arm_m)
    }

    /// Puts it elsewhere.
    pub fn put(&mut self, world_from_fixture: Pose) {
        self.fixture.world_from_fixture = world_from_fixture;
        self.place();
    }
}

/// Two shapes that may touch, and what is known of their contact.
struct Pair {
    shape_a: usize,
    /// Shape, or fixture.
    shape_b: usize,
    a: usize,
    b: usize,
    meeting: usize,
    seen_at: u64,
    friction: f64,
    restitution: f64,
    corners: Vec<Vec3>,
    manifolds: Vec<ContactManifold<(), Vec3>>,
    workspace: Option<ContactManifoldsWorkspace>,
}

/// Two bodies, or a body and a fixture, and the range of their pairs of shapes.
struct Couple {
    a: usize,
    b: usize,
    first: usize,
    end: usize,
}

/// Everything that may touch.
pub(crate) struct Collision {
    shapes: Vec<Shape>,
    pub fixtures: Vec<Placed>,
    pairs: Vec<Pair>,
    with_fixtures: Vec<Couple>,
    between_bodies: Vec<Couple>,
    /// Ball around each body, and how far from it surfaces are watched.
    centres: Vec<Vec3>,
    radii: Vec<f64>,
    reaches: Vec<f64>,
    prediction_m: f64,
    now: u64,
}

/// Share of a step's travel by which surfaces are watched ahead.
const AHEAD: f64 = 1.5;

impl Collision {
    pub fn new(model: &Model, forest: &Forest) -> Self {
        let mut shapes = shapes(model, forest);
        shapes.sort_by_key(|shape| shape.body);
        let many = forest.bodies.len();
        let mut collision = Self {
            fixtures: model.fixtures.iter().map(placed).collect(),
            pairs: Vec::new(),
            with_fixtures: Vec::new(),
            between_bodies: Vec::new(),
            centres: vec![Vec3::ZERO; many],
            radii: vec![0.0; many],
            reaches: vec![0.0; many],
            prediction_m: model.settings.prediction_m,
            now: 1,
            shapes,
        };
        for shape in &collision.shapes {
            let far = (shape.ball_body_m - forest.bodies[shape.body].centre_body_m).length();
            let radius = &mut collision.radii[shape.body];
            *radius = radius.max(far + shape.radius_m);
        }
        for fixture in 0..collision.fixtures.len() {
            for body in 0..many {
                collision.meet_fixture(body, fixture, forest);
            }
        }
        for a in 0..many {
            for b in a + 1..many {
                collision.meet_body(a, b, model, forest);
            }
        }
        collision
    }

    fn shapes_of(&self, body: usize) -> std::ops::Range<usize> {
        let first = self.shapes.partition_point(|shape| shape.body < body);
        first..self.shapes.partition_point(|shape| shape.body <= body)
    }

    fn meet_fixture(&mut self, body: usize, fixture: usize, forest: &Forest) {
        if forest.bodies[body].freedom == crate::forest::Freedom::Mounted {
            return;
        }
        let first = self.pairs.len();
        for shape in self.shapes_of(body) {
            let (mine, its) = (
                &self.shapes[shape].collider,
                &self.fixtures[fixture].fixture.collider,
            );
            if mine.group != 0 && mine.group == its.group {
                continue;
            }
            let direct = matches!(self.fixtures[fixture].form, Form::HalfSpace(_))
                && !matches!(self.shapes[shape].form, Form::Other | Form::HalfSpace(_));
            self.pairs.push(Pair {
                shape_a: shape,
                shape_b: fixture,
                a: body,
                b: NONE,
                meeting: body,
                seen_at: 0,
                friction: mine.friction_with(its),
                restitution: mine.restitution * its.restitution,
                corners: vec![Vec3::ZERO; if direct { 8 } else { 0 }],
                manifolds: Vec::new(),
                workspace: None,
            });
        }
        self.with_fixtures.push(Couple {
            a: body,
            b: fixture,
            first,
            end: self.pairs.len(),
        });
    }

    fn meet_body(&mut self, a: usize, b: usize, model: &Model, forest: &Forest) {
        let joined = forest.bodies[b].parent == a || forest.bodies[a].parent == b;
        let mounted = |body: usize| forest.bodies[body].freedom == crate::forest::Freedom::Mounted;
        if joined || (mounted(a) && mounted(b)) {
            return;
        }
        let first = self.pairs.len();
        for shape_a in self.shapes_of(a) {
            for shape_b in self.shapes_of(b) {
                let (one, two) = (&self.shapes[shape_a], &self.shapes[shape_b]);
                let marks = (one.collider.mark, two.collider.mark);
                let apart =
                    model.apart.contains(&marks) || model.apart.contains(&(marks.1, marks.0));
                let grouped = one.collider.group != 0 && one.collider.group == two.collider.group;
                if apart || grouped {
                    continue;
                }
                self.pairs.push(Pair {
                    shape_a,
                    shape_b,
                    a,
                    b,
                    meeting: forest.meeting(a, b),
                    seen_at: 0,
                    friction: one.collider.friction_with(&two.collider),
                    restitution: one.collider.restitution * two.collider.restitution,
                    corners: Vec::new(),
                    manifolds: Vec::new(),
                    workspace: None,
                });
            }
        }
        if self.pairs.len() > first {
            self.between_bodies.push(Couple {
                a,
                b,
                first,
                end: self.pairs.len(),
            });
        }
    }

    /// Finds all contacts of the bodies where they are now.
    pub fn find(&mut self, nodes: &[Node], time_s: f64, touches: &mut Vec<Touch>) {
        self.now += 1;
        for (index, node) in nodes.iter().enumerate() {
            self.centres[index] = node.centre_world_m();
            let speed = node.velocity.velocity_at(node.arm_m).length()
                + node.velocity.angular().length() * self.radii[index];
            self.reaches[index] = AHEAD * time_s * speed;
        }
        for couple in 0..self.with_fixtures.len() {
            let Couple { a, b, first, end } = self.with_fixtures[couple];
            let placed = &self.fixtures[b];
            let led = placed.velocity_at(self.centres[a]).length()
                + placed.fixture.angular_velocity_world_rad_s.length() * self.radii[a];
            let reach = self
                .prediction_m
                .max(self.reaches[a] + AHEAD * time_s * led);
            if placed.distance(self.centres[a]) < self.radii[a] + reach {
                for pair in first..end {
                    self.touch_fixture(pair, nodes, reach, touches);
                }
            }
        }
        for couple in 0..self.between_bodies.len() {
            let Couple { a, b, first, end } = self.between_bodies[couple];
            let reach = self.prediction_m.max(self.reaches[a] + self.reaches[b]);
            let near = self.radii[a] + self.radii[b] + reach;
            if self.centres[a].distance_squared(self.centres[b]) < near * near {
                for pair in first..end {
                    self.touch_body(pair, nodes, reach, touches);
                }
            }
        }
    }

    fn touch_fixture(
        &mut self,
        index: usize,
        nodes: &[Node],
        reach: f64,
        touches: &mut Vec<Touch>,
    ) {
        let pair = &mut self.pairs[index];
        let (shape, placed) = (&self.shapes[pair.shape_a], &self.fixtures[pair.shape_b]);
        let node = &nodes[pair.a];
        let centre_m = node.origin_world_m + node.rotation * shape.ball_body_m;
        if placed.distance(centre_m) > shape.radius_m + reach {
            return;
        }
        let world_from_shape = node.world_from_body() * shape.body_from_shape;
        let first = touches.len();
        if let (Form::HalfSpace(normal), false) = (placed.form, pair.corners.is_empty()) {
            let plane = Plane {
                normal_world: placed.world_from_shape.rotation * normal,
                point_world_m: placed.world_from_shape.translation,
                reach_m: reach,
            };
            pair.recall(self.now);
            pair.touch_plane(index, &plane, shape.form, &world_from_shape, touches);
        } else {
            let other = (&placed.world_from_shape, &placed.fixture.collider.shape);
            let mine = (&world_from_shape, &shape.collider.shape);
            pair.touch_shape(index, self.now, mine, other, reach, touches);
        }
        for touch in &mut touches[first..] {
            touch.led_world_m_s = placed.velocity_at(touch.point_world_m);
        }
    }

    fn touch_body(&mut self, index: usize, nodes: &[Node], reach: f64, touches: &mut Vec<Touch>) {
        let pair = &mut self.pairs[index];
        let (one, two) = (&self.shapes[pair.shape_a], &self.shapes[pair.shape_b]);
        let (node_a, node_b) = (&nodes[pair.a], &nodes[pair.b]);
        let between_m = (node_a.origin_world_m + node_a.rotation * one.ball_body_m)
            - (node_b.origin_world_m + node_b.rotation * two.ball_body_m);
        let near = one.radius_m + two.radius_m + reach;
        if between_m.length_squared() > near * near {
            return;
        }
        let world_from_a = node_a.world_from_body() * one.body_from_shape;
        let world_from_b = node_b.world_from_body() * two.body_from_shape;
        let mine = (&world_from_a, &one.collider.shape);
        let other = (&world_from_b, &two.collider.shape);
        pair.touch_shape(index, self.now, mine, other, reach, touches);
    }

    /// Keeps the impulse of a contact for the next step.
    pub fn remember(&mut self, memory: Memory, impulse_world_n_s: Vec3) {
        match memory {
            Memory::Corner { pair, corner } => self.pairs[pair].corners[corner] = impulse_world_n_s,
            Memory::Point {
                pair,
                manifold,
                point,
            } => self.pairs[pair].manifolds[manifold].points[point].data = impulse_world_n_s,
        }
    }

    /// Forgets all contacts: what was put elsewhere starts anew.
    pub fn forget(&mut self) {
        self.now += 2;
    }

    /// Link and mark of a body's shape.
    pub fn owner(&self, shape: usize) -> (usize, u64) {
        (self.shapes[shape].link, self.shapes[shape].collider.mark)
    }

    /// Moves driven fixtures on.
    pub fn lead(&mut self, time_s: f64) {
        for placed in &mut self.fixtures {
            let (v, w) = (
                placed.fixture.velocity_world_m_s,
                placed.fixture.angular_velocity_world_rad_s,
            );
            if v != Vec3::ZERO || w != Vec3::ZERO {
                let mut pose = placed.fixture.world_from_fixture;
                let turn = parry3d_f64::math::Rot3::from_scaled_axis(w * time_s);
                pose.translation += v * time_s;
                pose.rotation = (turn * pose.rotation).normalize();
                placed.put(pose);
            }
        }
    }
}

impl Placed {
    /// A lower bound of the distance from a point.
    fn distance(&self, point_world_m: Vec3) -> f64 {
        let point_m = self.world_from_shape.inverse_transform_point(point_world_m);
        if let Form::HalfSpace(normal) = self.form {
            return normal.dot(point_m);
        }
        let aabb = self.fixture.collider.shape.compute_local_aabb();
        (point_m - point_m.clamp(aabb.mins, aabb.maxs)).length()
    }
}

struct Plane {
    normal_world: Vec3,
    point_world_m: Vec3,
    reach_m: f64,
}

impl Pair {
    /// Forgets what was known of a contact that has been out of reach.
    fn recall(&mut self, now: u64) {
        if self.seen_at + 1 != now {
            self.corners.fill(Vec3::ZERO);
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
            led_world_m_s: Vec3::ZERO,
            impulse_world_n_s: Vec3::ZERO,
            memory: Memory::Corner { pair: 0, corner: 0 },
        }
    }

    /// Corners of a box and the lowest point of a ball are the contacts.
    fn touch_plane(
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
                self.corners[corner] = Vec3::ZERO;
                continue;
            }
            let point_m = centre_m + axes[0] * x + axes[1] * y + axes[2] * z - normal * below;
            touches.push(Touch {
                impulse_world_n_s: self.corners[corner],
                memory: Memory::Corner {
                    pair: index,
                    corner,
                },
                ..self.touch(point_m, normal, distance_m)
            });
        }
    }

    /// Any two shapes, by Parry.
    fn touch_shape(
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
            // Parry's normal leaves the first shape.
            let normal = -(world_from_1.rotation * manifold.local_n1);
            for (point_number, point) in manifold.points.iter().enumerate() {
                if point.dist > reach {
                    continue;
                }
                let one = world_from_1 * point.local_p1;
                let two = world_from_2 * point.local_p2;
                touches.push(Touch {
                    impulse_world_n_s: point.data,
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

fn placed(fixture: &Fixture) -> Placed {
    let mut placed = Placed {
        form: Form::of(&fixture.collider.shape),
        fixture: fixture.clone(),
        world_from_shape: Pose::identity(),
    };
    placed.place();
    placed
}

fn shapes(model: &Model, forest: &Forest) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for (link, place) in forest.places.iter().enumerate() {
        for collider in &model.links[link].colliders {
            let body_from_shape = place.body_from_link * collider.owner_from_shape;
            let ball = collider.shape.compute_local_bounding_sphere();
            shapes.push(Shape {
                body: place.body,
                link,
                body_from_shape,
                form: Form::of(&collider.shape),
                ball_body_m: body_from_shape * ball.center(),
                radius_m: ball.radius(),
                collider: collider.clone(),
            });
        }
    }
    shapes
}
