//! What the engine asks about contacts: which modules pass through each other, and how contacts rub.

use std::collections::BTreeSet;

use super::driven::Driven;
use super::friction::Friction;
use rapier3d_f64::geometry::{ColliderHandle, SolverFlags};
use rapier3d_f64::pipeline::{ContactModificationContext, PairFilterContext, PhysicsHooks};

/// Number of a module as a collider carries it; 0 is for all others.
pub(super) fn module_mark(module: usize) -> u128 {
    module as u128 + 1
}

/// Answers to the engine's questions about contacts.
#[derive(Default)]
pub(super) struct Hooks {
    /// Turns sliding friction opposite to slip; only where every contact has a cone of its own.
    pub friction: Option<Friction>,
    /// Pairs of modules that never touch.
    pub collision_exclude: BTreeSet<(usize, usize)>,
    /// Friction of pairs with these colliders, whatever the other one is.
    pub pair_friction: Vec<(ColliderHandle, f64)>,
    /// Bodies that are driven along tracks.
    pub driven: Vec<Driven>,
}

impl PhysicsHooks for Hooks {
    fn filter_contact_pair(&self, context: &PairFilterContext<'_>) -> Option<SolverFlags> {
        let module = |handle: ColliderHandle| {
            let mark = context.colliders.get(handle).map(|c| c.user_data)?;
            // What is not of a module has no number.
            usize::try_from(mark).ok()?.checked_sub(1)
        };
        let is_excluded = match (module(context.collider1), module(context.collider2)) {
            (Some(a), Some(b)) => {
                self.collision_exclude.contains(&(a, b)) || self.collision_exclude.contains(&(b, a))
            }
            _ => false,
        };
        (!is_excluded).then_some(SolverFlags::default())
    }

    fn modify_solver_contacts(&self, context: &mut ContactModificationContext<'_>) {
        let colliders = [context.collider1, context.collider2];
        let own = self
            .pair_friction
            .iter()
            .find(|(collider, _)| colliders.contains(collider));
        if let (Some((_, friction)), Some(manifold)) = (own, context.rigid_mut()) {
            *manifold.friction = *friction;
        }
        if let Some(friction) = &self.friction {
            friction.oppose_slip(context, &self.driven);
        }
    }
}
