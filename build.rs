//! Embeds `shaders/` so that the binary runs from anywhere; `--shaders DIR` and hot reload read the
//! folder instead. Also embeds the commit that was built, for reports.

use std::{env, fmt::Write as _, fs, path::Path, process::Command};

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
    println!("cargo:rustc-env=GROTTO_COMMIT={}", commit());
}

/// The short hash of the checked-out commit, with `+changes` if sources differ from it; `unknown`
/// outside a repository, as in a package.
fn commit() -> String {
    for path in ["src", "Cargo.toml", "Cargo.lock", ".git/HEAD", ".git/index"] {
        if Path::new(path).exists() {
            println!("cargo:rerun-if-changed={path}");
        }
    }
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        output.status.success().then(|| text.trim().to_owned())
    };
    let Some(hash) = git(&["rev-parse", "--short=12", "HEAD"]) else {
        return "unknown".to_owned();
    };
    let sources = ["src", "shaders", "build.rs", "Cargo.toml", "Cargo.lock"];
    let changed = git(&[&["status", "--porcelain", "--"][..], &sources].concat());
    match changed {
        Some(changed) if changed.is_empty() => hash,
        _ => format!("{hash}+changes"),
    }
}

/// Names of the shader modules under `folder`, such as `march/march` for `shaders/march/march.wesl`.
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
