//! Forward kinematics: poses and velocities of the bodies from positions and speeds of the joints (Featherstone 2008, section
//! 4.1).

use parry3d_f64::math::{Mat3, Pose, Rot3, Vec3};

use crate::forest::{Body, Forest, Freedom, NONE};
use crate::spatial::{Spatial, Symmetric};

/// Variable state of a body and of the joint to its parent.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Node {
    /// Position of the joint, rad or m.
    pub position: f64,
    /// Speed of the joint, rad/s or m/s.
    pub speed: f64,
    pub rotation: Rot3,
    pub origin_world_m: Vec3,
    /// Reference point of the tree's spatial vectors.
    pub reference_world_m: Vec3,
    /// Vector from the reference point to the centre of mass.
    pub arm_m: Vec3,
    /// Inertia about the centre of mass, world axes.
    pub inertia_world: Mat3,
    /// Motion per speed of the joint: Featherstone's S.
    pub axis: Spatial,
    /// Its product with the difference of the velocities of child and parent is the joint's speed.
    pub reader: Spatial,
    pub velocity: Spatial,
    /// Velocity at which a mounted root is led during the coming step; zero where it is held still.
    pub led: Spatial,
    /// Acceleration of the body due to velocity products alone, in a frame that translates with the root.
    pub swing: Spatial,
    /// Velocity at which velocity products are taken, relative to the root's translation.
    pub relative: Spatial,
    /// Change of velocity over the step due to the motion of the joint axis.
    pub drift: Spatial,
    /// Change of velocity over the step without contacts.
    pub change: Spatial,
    pub speed_change: f64,
    /// Expected change over the step: of the angular velocity (of a root) and of the joint's speed.
    pub coming_turn: Vec3,
    pub coming_speed: f64,
    /// Impulse on the body during the step; accumulates the impulses of its subtree.
    pub impulse: Spatial,
    /// Generalised impulse along the joint.
    pub effort: f64,
    /// Contact impulses of the previous step (warm start).
    pub warm: Spatial,
    /// Articulated inertia Iᴬ. The next two fields are U / D and 1 / D, with Featherstone's U = Iᴬ S and D = Sᵀ U.
    pub articulated: Symmetric,
    pub u_over_d: Spatial,
    pub inverse_d: f64,
    /// Change of the body's velocity per impulse on it while the whole tree responds: J M⁻¹ Jᵀ.
    pub response: Symmetric,
    /// Motion of the parent, with reversed sign, per generalised impulse of the joint; `give` is the joint's speed per
    /// generalised impulse.
    pub recoil: Spatial,
    pub give: f64,
    /// The parent's velocity at the last update of this body.
    pub known_parent_velocity: Spatial,
    /// Impulses in this subtree that have not been passed to the parent yet.
    pub pending: Spatial,
}

impl Node {
    pub fn centre_world_m(&self) -> Vec3 {
        self.reference_world_m + self.arm_m
    }

    /// Acceleration of a point at this arm due to velocity products, with all joint speeds constant. The last part `round_m` of the arm
    /// does not turn with the body: the lowest point of a ball stays below its centre.
    pub(crate) fn swing_at(&self, arm_m: Vec3, round_m: Vec3, root: &Self) -> Vec3 {
        let w = self.velocity.angular();
        let v = self.velocity.linear() - root.velocity.linear();
        self.swing.velocity_at(arm_m) + w.cross(v + w.cross(arm_m - round_m))
    }

    pub fn world_from_body(&self) -> Pose {
        Pose::from_parts(self.origin_world_m, self.rotation)
    }
}

/// Creates the state with every root and every joint at its start position.
pub(crate) fn start(forest: &Forest) -> Vec<Node> {
    let mut nodes: Vec<Node> = Vec::with_capacity(forest.bodies.len());
    for body in &forest.bodies {
        nodes.push(Node {
            position: body.start_position,
            rotation: body.start.rotation.normalize(),
            origin_world_m: body.start.translation,
            ..Node::default()
        });
    }
    update(forest, &mut nodes);
    nodes
}

/// Poses, axes and velocities of all bodies, from roots outwards.
pub(crate) fn update(forest: &Forest, nodes: &mut [Node]) {
    for (index, body) in forest.bodies.iter().enumerate() {
        let (above, below) = nodes.split_at_mut(index);
        let node = &mut below[0];
        if body.parent == NONE {
            place_root(body, node);
        } else {
            place_child(body, &above[body.parent], node);
            let together = Spatial::new(Vec3::ZERO, above[body.root].velocity.linear());
            let own = node.axis * node.speed;
            node.swing = above[body.parent].swing + (node.velocity - together).cross_motion(&own);
        }
        let turn = Mat3::from_quat(node.rotation);
        node.inertia_world = turn * body.inertia_body * turn.transpose();
    }
}

/// The reference point of a free tree is its root's centre of mass, so that a freely moving body rotates about its centre of
/// mass; that of a mounted tree is its root's origin, with which it is led.
fn place_root(body: &Body, node: &mut Node) {
    let centre_m = node.rotation * body.centre_body_m;
    if body.freedom == Freedom::Free {
        node.reference_world_m = node.origin_world_m + centre_m;
        node.arm_m = Vec3::ZERO;
    } else {
        node.reference_world_m = node.origin_world_m;
        node.arm_m = centre_m;
    }
}

fn place_child(body: &Body, parent: &Node, node: &mut Node) {
    let at_zero = parent.rotation * body.parent_from_body;
    let anchor_m = parent.origin_world_m + parent.rotation * body.anchor_parent_m;
    node.reference_world_m = parent.reference_world_m;
    if body.freedom == Freedom::Turning {
        let turned = at_zero * Rot3::from_axis_angle(body.axis_body, node.position);
        node.rotation = turned.normalize();
        node.origin_world_m = anchor_m - node.rotation * body.anchor_body_m;
        let axis = node.rotation * body.axis_body;
        node.axis = Spatial::new(axis, (anchor_m - node.reference_world_m).cross(axis));
        node.reader = Spatial::new(axis, Vec3::ZERO);
    } else {
        node.rotation = at_zero.normalize();
        let axis = node.rotation * body.axis_body;
        let slid_m = anchor_m + axis * node.position;
        node.origin_world_m = slid_m - node.rotation * body.anchor_body_m;
        node.axis = Spatial::new(Vec3::ZERO, axis);
        node.reader = node.axis;
    }
    let centre_world_m = node.origin_world_m + node.rotation * body.centre_body_m;
    node.arm_m = centre_world_m - node.reference_world_m;
    node.velocity = parent.velocity;
    node.velocity.add_scaled(&node.axis, node.speed);
}

/// Advances all positions by a time at the present speeds (exact for a rotation about a fixed axis).
pub(crate) fn advance(forest: &Forest, nodes: &mut [Node], time_s: f64) {
    for (body, node) in forest.bodies.iter().zip(nodes.iter_mut()) {
        match body.freedom {
            Freedom::Mounted if node.velocity == Spatial::ZERO => {}
            Freedom::Mounted => {
                let turn = Rot3::from_scaled_axis(node.velocity.angular() * time_s);
                node.rotation = (turn * node.rotation).normalize();
                node.origin_world_m += node.velocity.linear() * time_s;
            }
            Freedom::Free => {
                let centre_m = node.reference_world_m + node.velocity.linear() * time_s;
                let turn = Rot3::from_scaled_axis(node.velocity.angular() * time_s);
                node.rotation = (turn * node.rotation).normalize();
                node.origin_world_m = centre_m - node.rotation * body.centre_body_m;
            }
            Freedom::Turning | Freedom::Sliding => node.position += node.speed * time_s,
        }
    }
    update(forest, nodes);
}

/// Largest angular speed of any body relative to the world or to its parent, rad/s.
pub(crate) fn fastest_turn(forest: &Forest, nodes: &[Node]) -> f64 {
    let mut fastest = 0.0_f64;
    for (body, node) in forest.bodies.iter().zip(nodes) {
        fastest = fastest.max(node.velocity.angular().length_squared());
        if body.freedom == Freedom::Turning {
            fastest = fastest.max(node.speed * node.speed);
        }
    }
    fastest.sqrt()
}

/// Kinetic energy of bodies and rotors, J.
pub(crate) fn kinetic_energy(body: &Body, node: &Node, armature: f64) -> f64 {
    let w = node.velocity.angular();
    let v = node.velocity.velocity_at(node.arm_m);
    let rotor = armature * node.speed * node.speed;
    0.5 * (body.mass_kg * v.length_squared() + w.dot(node.inertia_world * w) + rotor)
}
