//! CPU marching and CPU path tracer: the independent judge.
//!
//! Everything here is f64 and written from the papers, not from the shaders. It shares with the
//! renderer what a world *is* (`world`) and what its lamps emit (`lights`), but no code that makes
//! pictures; it never imports `gpu` or `passes`.

pub mod bodies;
pub mod flight_path;
pub mod march;
pub mod path_trace;
pub mod random;
pub mod render;
pub mod sphere_lamp;

pub use bodies::PosedBodies;
pub use path_trace::TracedWorld;
pub use render::{FilmOptions, RenderOptions, render, render_scene};
