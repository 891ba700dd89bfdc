//! The path tracers of the CPU and the GPU against closed forms and against each other.

#[path = "../support/mod.rs"]
mod support;

mod bodies;
mod closed_forms;
mod marching;
mod on_gpu;
mod pictures;
mod stage;
