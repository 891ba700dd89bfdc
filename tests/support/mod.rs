//! What the test binaries share. Each of them includes this folder as its module `support`.
#![allow(dead_code, reason = "each binary uses a part of it")]

pub mod binary;
pub mod examples;
pub mod frames;
pub mod scenes;

use std::path::{Path, PathBuf};

use grotto::{
    gpu::{Gpu, ShaderChecks, ShaderLibrary},
    world::{
        LayoutSpec, World,
        file::{self, Overrides},
    },
};
use tempfile::TempDir;

/// Root of the repository: commands run here, and `worlds/` lies in it.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A temporary folder, deleted at the end of the test.
pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// The entries of a folder, sorted.
pub fn listing(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    paths
}

/// Copies a folder with all that is in it.
pub fn copy_folder(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("writable");
    for path in listing(from) {
        let target = to.join(path.file_name().expect("a name"));
        if path.is_dir() {
            copy_folder(&path, &target);
        } else {
            std::fs::copy(path, target).expect("writable");
        }
    }
}

thread_local! {
    /// The device of a test: each test runs in a thread of its own.
    static GPU: Gpu = gpu_with(ShaderChecks::Checked);
}

/// The default adapter, with checked shaders: reads beyond an array's end give zero on every driver. A test opens it
/// once, and compiles each kernel once.
pub fn gpu() -> Gpu {
    GPU.with(Gpu::clone)
}

pub fn gpu_with(checks: ShaderChecks) -> Gpu {
    Gpu::open(None, checks).expect("the tests need a Vulkan device")
}

/// A file below `shaders/`, a text in it, and the text that replaces every occurrence.
pub type Fault<'a> = (&'a str, &'a str, &'a str);

/// The same device with faults planted into its shaders.
pub fn with_faults(gpu: &Gpu, faults: &[Fault]) -> Gpu {
    let folder = folder();
    copy_folder(&root().join("shaders"), folder.path());
    for (file, sound, faulty) in faults {
        let path = folder.path().join(file);
        let text = std::fs::read_to_string(&path).expect("readable");
        assert!(text.contains(sound), "{file} no longer has `{sound}`");
        std::fs::write(&path, text.replace(sound, faulty)).expect("writable");
    }
    let shaders = ShaderLibrary::from_folder(folder.path()).expect("a folder of shaders");
    gpu.with_shaders(shaders)
}

/// `worlds/NAME.ron`.
pub fn world_path(name: &str) -> PathBuf {
    root().join(format!("worlds/{name}.ron"))
}

/// A world that comes with grotto.
pub fn shipped(name: &str) -> World {
    file::load(&world_path(name), &Overrides::default())
        .unwrap_or_else(|report| panic!("{report:?}"))
}

/// A world from the text of its file.
pub fn parsed(text: &str) -> World {
    file::parse(text, "test.ron", None, &Overrides::default())
        .unwrap_or_else(|report| panic!("{report:?}"))
}

/// The layout of this name.
pub fn layout_of<'a>(world: &'a World, name: &str) -> &'a LayoutSpec {
    let found = world.layouts.iter().find(|layout| layout.name == name);
    found.unwrap_or_else(|| panic!("{} has no layout {name}", world.name))
}
