//! Callbacks of Rapier for contacts: collision filtering of modules, friction of pairs, and the direction of friction.

use std::collections::BTreeSet;

use super::driven::Driven;
use super::friction::Friction;
use rapier3d_f64::geometry::{ColliderHandle, SolverFlags};
use rapier3d_f64::pipeline::{ContactModificationContext, PairFilterContext, PhysicsHooks};

/// Number that marks a collider as part of a module; 0 stands for all other colliders.
pub(super) fn module_mark(module: usize) -> u128 {
    module as u128 + 1
}

/// Data for the contact callbacks of the engine.
#[derive(Default)]
pub(super) struct Hooks {
    /// Correction of sliding friction; `None` for the simplified friction model, in which contacts have no friction cones of
    /// their own.
    pub friction: Option<Friction>,
    /// Pairs of modules between which no contacts are computed.
    pub collision_exclude: BTreeSet<(usize, usize)>,
    /// Friction coefficients of all pairs with these colliders, independent of the other collider.
    pub pair_friction: Vec<(ColliderHandle, f64)>,
    /// Bodies that are driven along tracks.
    pub driven: Vec<Driven>,
}

impl PhysicsHooks for Hooks {
    fn filter_contact_pair(&self, context: &PairFilterContext<'_>) -> Option<SolverFlags> {
        let module = |handle: ColliderHandle| {
            let mark = context.colliders.get(handle).map(|c| c.user_data)?;
            // Colliders that do not belong to a module have no module number.
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
