//! Broad phase of collision detection: finds the pairs of shapes that are close enough for a contact.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::{Pose, Rot3, Vec3};

use crate::forest::{Forest, Freedom, NONE};
use crate::kinematics::Node;
use crate::model::{Collider, Fixture, Model, Spot};
use crate::touch::{Form, Kept, Memory, Pair, Plane, Touch};

/// A shape of a body.
struct Shape {
    body: usize,
    link: usize,
    body_from_shape: Pose,
    collider: Collider,
    form: Form,
    /// Centre of the bounding ball, in the body's frame.
    ball_body_m: Vec3,
    radius_m: f64,
}

/// A fixture's shape with its pose in the world.
pub(crate) struct PlacedFixture {
    pub fixture: Fixture,
    form: Form,
    world_from_shape: Pose,
    /// Bounding box of the shape, in the shape's own frame.
    around: Aabb,
}

impl PlacedFixture {
    fn place(&mut self) {
        self.world_from_shape =
            self.fixture.world_from_fixture * self.fixture.collider.owner_from_shape;
    }

    pub fn velocity_at(&self, point_world_m: Vec3) -> Vec3 {
        let arm_m = point_world_m - self.fixture.world_from_fixture.translation;
        self.fixture.velocity_world_m_s + self.fixture.angular_velocity_world_rad_s.cross(arm_m)
    }

    /// Sets the pose of the fixture.
    pub fn put(&mut self, world_from_fixture: Pose) {
        self.fixture.world_from_fixture = world_from_fixture;
        self.place();
    }
}

/// Two bodies, or a body and a fixture, and the range of their pairs of shapes in the list of pairs.
struct BodyPair {
    a: usize,
    b: usize,
    first: usize,
    end: usize,
}

/// All shapes, and all pairs of shapes that may be in contact.
pub(crate) struct Collision {
    shapes: Vec<Shape>,
    pub fixtures: Vec<PlacedFixture>,
    pairs: Vec<Pair>,
    with_fixtures: Vec<BodyPair>,
    between_bodies: Vec<BodyPair>,
    /// Bounding ball of each body, and the distance within which contacts of the body are searched.
    centres: Vec<Vec3>,
    radii: Vec<f64>,
    reaches: Vec<f64>,
    prediction_m: f64,
    now: u64,
}

/// Contacts are searched within this multiple of the distance that a body travels in a step.
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
                collision.add_fixture_pairs(body, fixture, forest);
            }
        }
        for a in 0..many {
            for b in a + 1..many {
                collision.add_body_pairs(a, b, model, forest);
            }
        }
        collision
    }

    fn shapes_of(&self, body: usize) -> std::ops::Range<usize> {
        let first = self.shapes.partition_point(|shape| shape.body < body);
        first..self.shapes.partition_point(|shape| shape.body <= body)
    }

    fn add_fixture_pairs(&mut self, body: usize, fixture: usize, forest: &Forest) {
        if forest.bodies[body].freedom == Freedom::Mounted {
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
                turning: mine.turning.with(&its.turning),
                corners: vec![Kept::default(); if direct { 8 } else { 0 }],
                manifolds: Vec::new(),
                workspace: None,
            });
        }
        self.with_fixtures.push(BodyPair {
            a: body,
            b: fixture,
            first,
            end: self.pairs.len(),
        });
    }

    fn add_body_pairs(&mut self, a: usize, b: usize, model: &Model, forest: &Forest) {
        let joined = forest.bodies[b].parent == a || forest.bodies[a].parent == b;
        let mounted = |body: usize| forest.bodies[body].freedom == Freedom::Mounted;
        if joined || (mounted(a) && mounted(b)) {
            return;
        }
        let first = self.pairs.len();
        for shape_a in self.shapes_of(a) {
            for shape_b in self.shapes_of(b) {
                let (one, two) = (&self.shapes[shape_a], &self.shapes[shape_b]);
                let marks = (one.collider.mark, two.collider.mark);
                let excluded = model.collision_exclude.contains(&marks)
                    || model.collision_exclude.contains(&(marks.1, marks.0));
                let grouped = one.collider.group != 0 && one.collider.group == two.collider.group;
                if excluded || grouped {
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
                    turning: one.collider.turning.with(&two.collider.turning),
                    corners: Vec::new(),
                    manifolds: Vec::new(),
                    workspace: None,
                });
            }
        }
        if self.pairs.len() > first {
            self.between_bodies.push(BodyPair {
                a,
                b,
                first,
                end: self.pairs.len(),
            });
        }
    }

    /// Finds all contacts of the bodies at their present poses.
    pub fn find(&mut self, nodes: &[Node], time_s: f64, touches: &mut Vec<Touch>) {
        self.now += 1;
        for (index, node) in nodes.iter().enumerate() {
            self.centres[index] = node.centre_world_m();
            let speed = node.velocity.velocity_at(node.arm_m).length()
                + node.velocity.angular().length() * self.radii[index];
            self.reaches[index] = AHEAD * time_s * speed;
        }
        for couple in 0..self.with_fixtures.len() {
            let BodyPair { a, b, first, end } = self.with_fixtures[couple];
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
            let BodyPair { a, b, first, end } = self.between_bodies[couple];
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
            touch.led_turn_world_rad_s = placed.fixture.angular_velocity_world_rad_s;
            let rim_m = touch.point_world_m - world_from_shape.translation;
            touch.tyre = shape.collider.tyre.map(|tyre| (tyre, rim_m));
        }
        let Some(spots) = placed.fixture.spots.clone() else {
            return;
        };
        let (factor, is_stated) = (
            shape.collider.spot_factor,
            shape.collider.pair_friction.is_some(),
        );
        for mut touch in touches.split_off(first) {
            match spots(touch.point_world_m) {
                Spot::Plain => {}
                Spot::Own {
                    friction,
                    restitution,
                } => {
                    if !is_stated {
                        touch.friction = factor * friction;
                    }
                    touch.restitution = restitution.unwrap_or(touch.restitution);
                }
                Spot::Hole => {
                    self.remember(touch.memory, Kept::default());
                    continue;
                }
            }
            touches.push(touch);
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

    /// Stores what is kept of a contact for the warm start of the next step.
    pub(crate) fn remember(&mut self, memory: Memory, kept: Kept) {
        match memory {
            Memory::Corner { pair, corner } => self.pairs[pair].corners[corner] = kept,
            Memory::Point {
                pair,
                manifold,
                point,
            } => self.pairs[pair].manifolds[manifold].points[point].data = kept,
        }
    }

    /// Discards the stored impulses of all contacts, because a body or fixture was moved.
    pub fn forget(&mut self) {
        self.now += 2;
    }

    /// Link and caller's mark of a body's shape.
    pub fn owner(&self, shape: usize) -> (usize, u64) {
        (self.shapes[shape].link, self.shapes[shape].collider.mark)
    }

    /// Advances moving fixtures by a time.
    pub fn lead(&mut self, time_s: f64) {
        for placed in &mut self.fixtures {
            let (v, w) = (
                placed.fixture.velocity_world_m_s,
                placed.fixture.angular_velocity_world_rad_s,
            );
            if v != Vec3::ZERO || w != Vec3::ZERO {
                let mut pose = placed.fixture.world_from_fixture;
                let turn = Rot3::from_scaled_axis(w * time_s);
                pose.translation += v * time_s;
                pose.rotation = (turn * pose.rotation).normalize();
                placed.put(pose);
            }
        }
    }
}

impl PlacedFixture {
    /// A lower bound of the distance of the fixture from a point.
    fn distance(&self, point_world_m: Vec3) -> f64 {
        let point_m = self.world_from_shape.inverse_transform_point(point_world_m);
        if let Form::HalfSpace(normal) = self.form {
            return normal.dot(point_m);
        }
        (point_m - point_m.clamp(self.around.mins, self.around.maxs)).length()
    }
}

fn placed(fixture: &Fixture) -> PlacedFixture {
    let mut placed = PlacedFixture {
        form: Form::of(&fixture.collider.shape),
        around: fixture.collider.shape.compute_local_aabb(),
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
