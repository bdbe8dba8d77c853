//! Internal form of the model: links that are fixed to each other are merged into one body, and bodies are in depth-first order.

use parry3d_f64::math::{Mat3, Pose, Rot3, Vec3};

use crate::model::{Attachment, Joint, JointType, Model, ModelError};
use crate::mount::MountSpring;

/// Index that stands for "no body".
pub(crate) const NONE: usize = usize::MAX;

/// How a body may move relative to its parent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Freedom {
    /// Root of a tree that moves freely: six degrees of freedom.
    Free,
    /// Root of a tree that is mounted or led: no degrees of freedom.
    Mounted,
    /// Turns about its axis.
    Turning,
    /// Slides along its axis.
    Sliding,
}

/// Constant properties of a body and of the joint to its parent.
#[derive(Debug, Clone)]
pub(crate) struct Body {
    pub parent: usize,
    /// Root of its tree.
    pub root: usize,
    pub freedom: Freedom,
    /// Orientation in the parent at position 0.
    pub parent_from_body: Rot3,
    /// Joint axis, in the body's frame.
    pub axis_body: Vec3,
    /// A point of the axis, in the parent's frame …
    pub anchor_parent_m: Vec3,
    /// … and in the body's.
    pub anchor_body_m: Vec3,
    pub limits: Option<(f64, f64)>,
    pub viscous: f64,
    pub dry: f64,
    pub armature: f64,
    pub stiffness: f64,
    pub rest: f64,
    pub mass_kg: f64,
    /// Inverse of the total mass of the moving bodies of its tree, 1/kg; 0 if nothing moves.
    pub tree_inverse_mass: f64,
    pub centre_body_m: Vec3,
    /// Mass whose weight is compensated, kg, and the place of that force relative to the centre of mass, body frame.
    pub compensated: (f64, Vec3),
    /// Inertia about the centre of mass, body frame, kg m².
    pub inertia_body: Mat3,
    /// The spring on which a root stands.
    pub mount: Option<MountSpring>,
    /// Pose at the start, of a root; that of a root on a spring is where the spring carries the weight alone.
    pub start: Pose,
    pub start_position: f64,
}

impl Body {
    pub fn is_root(&self) -> bool {
        self.parent == NONE
    }
}

/// The body that a link belongs to, and the link's pose in that body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub body: usize,
    pub body_from_link: Pose,
    /// Whether the link has a joint of its own to the body's parent (false if it is fixed to another link of the body).
    pub leads: bool,
}

/// One move of a walk around a tree that visits every body (an Euler tour).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Move {
    /// From its parent to this body.
    Down(usize),
    /// From this body to its parent.
    Up(usize),
}

/// All trees of a world.
#[derive(Debug, Clone, Default)]
pub(crate) struct Forest {
    /// In depth-first order: a tree is a range of indices, and so is every subtree.
    pub bodies: Vec<Body>,
    pub places: Vec<Place>,
    /// The ranges of bodies and of moves of each tree.
    pub trees: Vec<Tree>,
    pub tour: Vec<Move>,
}

/// A range of bodies and of moves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tree {
    pub root: usize,
    pub end: usize,
    pub tour_start: usize,
    pub tour_end: usize,
}

impl Forest {
    pub fn new(model: &Model) -> Result<Self, ModelError> {
        model.check()?;
        let (mut bodies, mut places) = (Vec::new(), Vec::<Place>::new());
        for link in &model.links {
            let place = match &link.attachment {
                Attachment::Joint(joint) if joint.kind == JointType::Fixed => {
                    let parent = places[joint.parent];
                    let parent_from_link =
                        joint.parent_from_joint * joint.link_from_joint.inverse();
                    Place {
                        body: parent.body,
                        body_from_link: parent.body_from_link * parent_from_link,
                        leads: false,
                    }
                }
                attachment => {
                    bodies.push(body(attachment, &places));
                    Place {
                        body: bodies.len() - 1,
                        body_from_link: Pose::identity(),
                        leads: true,
                    }
                }
            };
            places.push(place);
        }
        let mut forest = Self::depth_first(bodies, places);
        forest.weigh(model);
        for (index, body) in forest.bodies.iter().enumerate() {
            if body.mass_kg <= 0.0 && body.freedom != Freedom::Mounted {
                let link = forest.places.iter().position(|place| place.body == index);
                return Err(ModelError {
                    message: format!(
                        "link {}: it moves and weighs nothing; give it a mass",
                        link.unwrap_or(index)
                    ),
                });
            }
        }
        Ok(forest)
    }

    /// Sorts bodies depth first and lays out the tour.
    fn depth_first(bodies: Vec<Body>, mut places: Vec<Place>) -> Self {
        let mut order: Vec<usize> = Vec::with_capacity(bodies.len());
        let mut stack: Vec<usize> = Vec::new();
        for root in (0..bodies.len()).filter(|&index| bodies[index].is_root()) {
            stack.push(root);
            while let Some(index) = stack.pop() {
                order.push(index);
                let children = (0..bodies.len()).rev();
                stack.extend(children.filter(|&child| bodies[child].parent == index));
            }
        }
        let mut new_from_old = vec![0; order.len()];
        for (new, &old) in order.iter().enumerate() {
            new_from_old[old] = new;
        }
        for place in &mut places {
            place.body = new_from_old[place.body];
        }
        let mut forest = Self {
            places,
            ..Self::default()
        };
        for (new, &old) in order.iter().enumerate() {
            let mut body = bodies[old].clone();
            if body.is_root() {
                forest.finish_tree(new);
                let tour_start = forest.tour.len();
                forest.trees.push(Tree {
                    root: new,
                    end: new + 1,
                    tour_start,
                    tour_end: tour_start,
                });
                body.root = new;
            } else {
                body.parent = new_from_old[body.parent];
                forest.climb(new - 1, body.parent);
                forest.tour.push(Move::Down(new));
                body.root = forest.bodies[body.parent].root;
            }
            forest.bodies.push(body);
        }
        forest.finish_tree(order.len());
        forest
    }

    /// Appends the moves from a body up to one of its ancestors.
    fn climb(&mut self, mut from: usize, to: usize) {
        while from != to {
            self.tour.push(Move::Up(from));
            from = self.bodies[from].parent;
        }
    }

    fn finish_tree(&mut self, end: usize) {
        let Some(mut tree) = self.trees.pop() else {
            return;
        };
        self.climb(end - 1, tree.root);
        tree.end = end;
        tree.tour_end = self.tour.len();
        self.trees.push(tree);
    }

    /// Computes mass, centre of mass and inertia of each body from its links.
    fn weigh(&mut self, model: &Model) {
        for (link, place) in model.links.iter().zip(&self.places) {
            let body = &mut self.bodies[place.body];
            body.mass_kg += link.mass_kg;
            body.centre_body_m += place.body_from_link * link.centre_link_m * link.mass_kg;
        }
        for body in self.bodies.iter_mut().filter(|body| body.mass_kg > 0.0) {
            body.centre_body_m /= body.mass_kg;
        }
        for tree in &self.trees {
            let bodies = &mut self.bodies[tree.root..tree.end];
            let moving = bodies
                .iter()
                .filter(|body| body.freedom != Freedom::Mounted);
            let mass_kg: f64 = moving.map(|body| body.mass_kg).sum();
            for body in bodies.iter_mut().filter(|_| mass_kg > 0.0) {
                body.tree_inverse_mass = 1.0 / mass_kg;
            }
        }
        for (link, place) in model.links.iter().zip(&self.places) {
            let body = &mut self.bodies[place.body];
            let arm = place.body_from_link * link.centre_link_m - body.centre_body_m;
            let turn = Mat3::from_quat(place.body_from_link.rotation);
            // Parallel-axis theorem (Huygens and Steiner).
            let outer = Mat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
            let shifted = (Mat3::IDENTITY * arm.length_squared() - outer) * link.mass_kg;
            body.inertia_body += turn * link.inertia_link_kg_m2 * turn.transpose() + shifted;
            let (mass_kg, centre_link_m) = link.compensated;
            body.compensated.0 += mass_kg;
            let away_m = place.body_from_link * centre_link_m - body.centre_body_m;
            body.compensated.1 += away_m * mass_kg;
        }
        for body in self
            .bodies
            .iter_mut()
            .filter(|body| body.compensated.0 != 0.0)
        {
            body.compensated.1 /= body.compensated.0;
        }
    }

    /// The last common ancestor of two bodies (which may be one of them); [`NONE`] if their trees differ.
    pub fn meeting(&self, mut a: usize, mut b: usize) -> usize {
        // A parent's index is smaller than its children's.
        while a != b {
            let higher = if a > b { &mut a } else { &mut b };
            *higher = self.bodies[*higher].parent;
            if *higher == NONE {
                return NONE;
            }
        }
        a
    }
}

/// A body with this attachment; its mass is added later.
fn body(attachment: &Attachment, places: &[Place]) -> Body {
    let mut body = Body {
        parent: NONE,
        root: NONE,
        freedom: Freedom::Mounted,
        parent_from_body: Rot3::IDENTITY,
        axis_body: Vec3::X,
        anchor_parent_m: Vec3::ZERO,
        anchor_body_m: Vec3::ZERO,
        limits: None,
        viscous: 0.0,
        dry: 0.0,
        armature: 0.0,
        stiffness: 0.0,
        rest: 0.0,
        mass_kg: 0.0,
        tree_inverse_mass: 0.0,
        centre_body_m: Vec3::ZERO,
        compensated: (0.0, Vec3::ZERO),
        inertia_body: Mat3::ZERO,
        mount: None,
        start: Pose::identity(),
        start_position: 0.0,
    };
    match attachment {
        Attachment::Free { world_from_link } => {
            body.freedom = Freedom::Free;
            body.start = *world_from_link;
        }
        Attachment::Mounted { world_from_link } => body.start = *world_from_link,
        Attachment::Sprung {
            world_from_link,
            spring,
        } => {
            body.freedom = Freedom::Free;
            body.start = *world_from_link;
            body.mount = Some(*spring);
        }
        Attachment::Joint(joint) => hang(&mut body, joint, &places[joint.parent]),
    }
    body
}

fn hang(body: &mut Body, joint: &Joint, parent: &Place) {
    let parent_from_joint = parent.body_from_link * joint.parent_from_joint;
    body.parent = parent.body;
    body.freedom = match joint.kind {
        JointType::Prismatic => Freedom::Sliding,
        _ => Freedom::Turning,
    };
    body.parent_from_body = parent_from_joint.rotation * joint.link_from_joint.rotation.inverse();
    body.axis_body = joint.link_from_joint.rotation * joint.axis_joint;
    body.anchor_parent_m = parent_from_joint.translation;
    body.anchor_body_m = joint.link_from_joint.translation;
    body.limits = joint.limits.filter(|_| joint.kind != JointType::Continuous);
    body.viscous = joint.viscous_friction;
    body.dry = joint.dry_friction;
    body.armature = joint.armature;
    body.stiffness = joint.stiffness;
    body.rest = joint.rest;
    body.start_position = joint.start;
}
