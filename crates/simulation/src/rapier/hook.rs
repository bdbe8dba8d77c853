//! Callbacks of Rapier for contacts: collision filtering of modules, friction of pairs, and the direction of friction.

use std::collections::BTreeSet;

use super::driven::Driven;
use super::friction::Friction;
use super::from_vector;
use crate::ground::GroundMap;
use rapier3d_f64::geometry::{ColliderHandle, SolverFlags};
use rapier3d_f64::pipeline::{ContactModificationContext, PairFilterContext, PhysicsHooks};

/// Number that marks a collider as part of a module, together with the factor on its friction; 0 stands for all other colliders.
pub(super) fn module_mark(module: usize, friction_factor: f64) -> u128 {
    u128::from(friction_factor.to_bits()) << 64 | (module as u128 + 1)
}

/// The module of a mark.
fn module_of(mark: u128) -> Option<usize> {
    // Colliders that do not belong to a module have no module number.
    usize::try_from(mark & u128::from(u64::MAX))
        .ok()?
        .checked_sub(1)
}

/// A collider of the ground. Rapier has one friction for all contacts of two colliders, so that each region has a collider of the same
/// shape as the floor (or the height field), of which only the contacts within the region are kept.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layer {
    pub collider: ColliderHandle,
    /// Whether it is the flat floor, not the height field.
    pub is_flat: bool,
    /// Its region; `None` for everything outside of regions.
    pub region: Option<usize>,
    /// Friction and restitution of the region, where it has its own.
    pub friction: Option<f64>,
    pub restitution: Option<f64>,
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
    /// What lies where on the ground, and its colliders.
    pub ground: Option<(GroundMap, Vec<Layer>)>,
}

impl Hooks {
    /// Keeps the contacts of the ground that are in the region of its collider, and sets their friction.
    fn split(&self, context: &mut ContactModificationContext<'_>) {
        let Some((map, layers)) = &self.ground else {
            return;
        };
        let colliders = [context.collider1, context.collider2];
        let layer = layers
            .iter()
            .find(|layer| colliders.contains(&layer.collider));
        let Some(layer) = layer else {
            return;
        };
        let other = colliders.into_iter().find(|one| *one != layer.collider);
        let mark = other.and_then(|other| context.colliders.get(other));
        let mark = mark.map_or(0, |collider| collider.user_data);
        let Some(manifold) = context.rigid_mut() else {
            return;
        };
        manifold.solver_contacts.retain(|contact| {
            let point = from_vector((contact.anchor1 + contact.anchor2) * 0.5);
            map.region_at(&point) == layer.region && !(layer.is_flat && map.is_hole(&point))
        });
        // Bodies of the scene have a friction of their own with everything.
        if let (Some(friction), Some(_)) = (layer.friction, module_of(mark)) {
            *manifold.friction = friction * f64::from_bits((mark >> 64) as u64);
        }
        if let Some(restitution) = layer.restitution {
            *manifold.restitution = restitution;
        }
    }
}

impl PhysicsHooks for Hooks {
    fn filter_contact_pair(&self, context: &PairFilterContext<'_>) -> Option<SolverFlags> {
        let module =
            |handle: ColliderHandle| module_of(context.colliders.get(handle).map(|c| c.user_data)?);
        let is_excluded = match (module(context.collider1), module(context.collider2)) {
            (Some(a), Some(b)) => {
                self.collision_exclude.contains(&(a, b)) || self.collision_exclude.contains(&(b, a))
            }
            _ => false,
        };
        (!is_excluded).then_some(SolverFlags::default())
    }

    fn modify_solver_contacts(&self, context: &mut ContactModificationContext<'_>) {
        self.split(context);
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
