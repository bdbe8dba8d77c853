//! Programs that each demonstrate one defect of Rapier: `cargo run --release -p realgap-simulation --example upstream NAME`.
//!
//! Every file is independent of the others except for its `pub`, so that it can be sent to Rapier's authors unchanged; the files
//! in docs/upstream explain each defect and its consequences.
#![allow(
    clippy::field_reassign_with_default,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "the programs are sent to Rapier's authors unchanged"
)]

mod contact_stiffness;
mod friction_direction;
mod multibody_root;
mod multibody_swing;
mod restitution;
mod restitution_friction;
mod small_inertia;

fn main() {
    match std::env::args().nth(1).as_deref() {
        Some("contact_stiffness") => contact_stiffness::main(),
        Some("friction_direction") => friction_direction::main(),
        Some("multibody_root") => multibody_root::main(),
        Some("multibody_swing") => multibody_swing::main(),
        Some("restitution") => restitution::main(),
        Some("restitution_friction") => restitution_friction::main(),
        Some("small_inertia") => small_inertia::main(),
        _ => println!(
            "which: contact_stiffness, friction_direction, multibody_root, multibody_swing, restitution, restitution_friction, small_inertia?"
        ),
    }
}
