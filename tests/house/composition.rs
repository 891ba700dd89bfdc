//! Composed shaders are the same bytes in every run, and so is the list of their sources.

use std::collections::BTreeSet;

use grotto::{gpu::ShaderLibrary, world::sdf::shape_module};

use crate::support::shipped;

/// Number of compositions of each shader. Every new hash map has another order, within one process too.
const TIMES: usize = 20;

/// The shaders of all passes that compute.
pub fn kernels(library: &ShaderLibrary) -> Vec<&str> {
    let names = library.names();
    let kernels: Vec<&str> = names
        .filter(|name| {
            library
                .text(name)
                .is_some_and(|text| text.contains("@compute"))
        })
        .collect();
    assert!(kernels.len() > 15, "{kernels:?}");
    kernels
}

#[test]
fn every_shader_is_composed_to_the_same_bytes() {
    let shape = shape_module(&shipped("cave"));
    let library = ShaderLibrary::embedded();
    let compose = |name: &str| {
        let composed = library.compose(name, &[("shape", &shape)]);
        composed.unwrap_or_else(|error| panic!("{error}")).wgsl
    };
    for name in kernels(&library) {
        let texts: BTreeSet<String> = (0..TIMES).map(|_| compose(name)).collect();
        assert_eq!(texts.len(), 1, "{name}");
    }
}

/// `judge` identifies a tracer's version by these sources.
#[test]
fn the_sources_of_a_shader_are_the_modules_that_it_is_composed_of() {
    let library = ShaderLibrary::embedded();
    let sources = || {
        let composed = library.compose("path_trace/trace", &[]);
        composed.unwrap_or_else(|error| panic!("{error}")).sources
    };
    let first = sources();
    assert!(first.is_sorted());
    for name in [
        "path_trace/trace",
        "light/emitters",
        "march/march",
        "scene/voxels",
        "math/hash",
    ] {
        assert!(first.iter().any(|source| source == name), "{first:?}");
    }
    assert!(
        !first.iter().any(|source| source.starts_with("probes/")),
        "{first:?}"
    );
    assert!(first.iter().all(|name| library.text(name).is_some()));
    for _ in 1..TIMES {
        assert_eq!(sources(), first);
    }
}
