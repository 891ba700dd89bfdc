//! `grotto bench SUITE`: one file a suite.

pub mod traversal;
