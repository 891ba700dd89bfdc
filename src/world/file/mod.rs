//! World files: RON text in, a checked [`World`](super::World) out, or one message with a place and
//! a remedy.

mod diagnostics;
mod leaf;
pub mod schema;
