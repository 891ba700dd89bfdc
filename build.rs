//! Embeds `shaders/` so that the binary runs from anywhere; `--shaders DIR` and hot reload read the
//! folder instead.

use std::{env, fmt::Write as _, fs, path::Path};

fn main() {
    println!("cargo:rerun-if-changed=shaders");
    let root = Path::new(&env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("shaders");
    let mut names = Vec::new();
    collect(&root, "", &mut names);
    names.sort();
    let mut list = String::from("&[\n");
    for name in &names {
        let path = root.join(format!("{name}.wesl"));
        writeln!(list, "    ({name:?}, include_str!({path:?})),").expect("writing to a string");
    }
    list.push(']');
    let out = Path::new(&env::var("OUT_DIR").expect("cargo sets it")).join("shaders.rs");
    fs::write(out, list).expect("OUT_DIR is writable");
}

/// Names of the shader modules under `folder`, as `march/march` for `shaders/march/march.wesl`.
fn collect(folder: &Path, prefix: &str, names: &mut Vec<String>) {
    println!("cargo:rerun-if-changed={}", folder.display());
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let file = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_dir() {
            collect(&entry.path(), &format!("{prefix}{file}/"), names);
        } else if let Some(stem) = file.strip_suffix(".wesl") {
            names.push(format!("{prefix}{stem}"));
        }
    }
}
