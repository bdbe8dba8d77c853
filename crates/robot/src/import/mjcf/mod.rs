//! Import of MJCF, the format of MuJoCo: a compiler of its own that computes what MuJoCo's compiler computes.
//!
//! Elements become owned values ([`element`]), `<include>`, `<attach>` and `<replicate>` become their contents ([`copies`]), and
//! default classes become attributes ([`defaults`]); then bodies ([`model`]), masses ([`mass`]), and actuators ([`actuator`]) are
//! read. The contract with MuJoCo is stated in docs/validation/compiled.md.

mod actuator;
mod amendment;
mod copies;
mod defaults;
mod element;
mod keyframe;
mod mass;
mod matrix;
mod mesh;
mod model;
mod principal;
mod remark;
mod robot;
mod settings;
mod turning;
mod world;

pub(super) use amendment::amend;
pub(super) use robot::read;
