//! CPU marching and CPU path tracer: the independent judge.

pub mod march;
