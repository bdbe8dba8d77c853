//! The contract of the import of MJCF: every number that decides the motion is that of the model that MuJoCo compiles.

mod compare;
mod features;
mod wheels;
