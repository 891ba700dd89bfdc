//! The rules of the house, checked in the sources: which module may import which, one shader per pass,
//! documents that name only what exists, and files that stay readable. Each rule must also find a planted
//! fault.

#[path = "../support/mod.rs"]
mod support;

mod composition;
mod documents;
mod imports;
mod layouts;
mod shaders;
mod source;
mod uniform_branches;
mod world_files;
mod worlds;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use imports::Import;
use support::root;

/// Top-level module → what it may import besides itself and these leaves.
const MAY_IMPORT: [(&str, &[&str]); 13] = [
    ("parameters", &[]),
    ("shared", &[]),
    ("measure", &[]),
    ("gpu", &[]),
    ("world", &[]),
    ("lights", &["world"]),
    ("probes", &["world"]),
    ("reference", &["world", "lights", "probes", "measure"]),
    ("passes", &["world", "lights", "probes", "gpu", "measure"]),
    (
        "frame",
        &["world", "lights", "probes", "gpu", "passes", "measure"],
    ),
    (
        "app",
        &[
            "world",
            "lights",
            "probes",
            "gpu",
            "passes",
            "frame",
            "measure",
            "reference",
        ],
    ),
    (
        "commands",
        &[
            "world",
            "lights",
            "probes",
            "gpu",
            "passes",
            "frame",
            "measure",
            "reference",
            "app",
        ],
    ),
    // src/main.rs: arguments → a command.
    ("main", &["commands"]),
];

/// Modules that every module may import.
const LEAVES: [&str; 2] = ["parameters", "shared"];

/// Tests of a module may use these to judge it, whatever the module itself may import. Tests of the judge
/// itself may import nothing more: the judge never sees what it judges.
const TESTS_MAY_IMPORT: [&str; 2] = ["measure", "reference"];

/// Most lines of a source file or shader; unit tests do not count.
const MOST_LINES: usize = 400;

/// Longer files, each with the reason why it is better not split.
const LONG_FILES: [(&str, &str); 2] = [
    (
        "shaders/scene/voxelise.wesl",
        "the kernels of one pass, which share its bindings",
    ),
    (
        "src/world/file/schema.rs",
        "one key after the other, as worlds/README.md lists them",
    ),
];

/// Paths of all files under `folder` with this extension, relative to the repository, with their
/// contents; sorted.
fn files(folder: &str, extension: &str) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of the repository") {
            let path = entry.expect("an entry of the folder").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|found| found == extension) {
                let text = fs::read_to_string(&path).expect("sources are text");
                let relative = path.strip_prefix(root()).expect("under the root");
                found.push((relative.to_path_buf(), text));
            }
        }
    }
    found.sort();
    found
}

/// Subjects of the passes that measure other subjects, each with those that it may import.
const MEASURES: [(&str, &str); 1] = [("bench", "scene")];

/// The passes that a subject's `mod.rs` declares: its public modules. Private ones are shared helpers.
fn passes(subject_mod: &str) -> BTreeSet<String> {
    let modules = subject_mod
        .lines()
        .filter_map(|line| line.strip_prefix("pub mod "));
    modules
        .filter_map(|line| line.strip_suffix(';'))
        .map(str::to_owned)
        .collect()
}

/// All passes, as `probes/trace`.
fn declared_passes() -> BTreeSet<String> {
    let mut all = BTreeSet::new();
    for (path, text) in files("src/passes", "rs") {
        let inner = path.strip_prefix("src/passes").expect("it lies there");
        let [subject, "mod.rs"] = inner
            .iter()
            .filter_map(|part| part.to_str())
            .collect::<Vec<_>>()[..]
        else {
            continue;
        };
        all.extend(passes(&text).iter().map(|pass| format!("{subject}/{pass}")));
    }
    all
}

/// Why an import of the module `from` is forbidden, if it is.
fn objection(from: &[String], import: &Import, passes: &BTreeSet<String>) -> Option<String> {
    let (own, path) = (&from[0], &import.path);
    let Some(target) = path.first() else {
        return Some("names the whole crate".into());
    };
    if target != own {
        let Some((_, allowed)) = MAY_IMPORT.iter().find(|(module, _)| module == own) else {
            return Some(format!(
                "`{own}` is not in the list of modules of this test"
            ));
        };
        let for_tests = import.in_tests && TESTS_MAY_IMPORT.contains(&target.as_str());
        let fine =
            LEAVES.contains(&target.as_str()) || allowed.contains(&target.as_str()) || for_tests;
        return (!fine).then(|| format!("`{own}` may not import `{target}`"));
    }
    // Within passes/: subjects do not import each other, nor does one pass import another.
    if own != "passes" {
        return None;
    }
    let (Some(subject), Some(target)) = (from.get(1), path.get(1)) else {
        return None;
    };
    if subject != target {
        let measures = MEASURES.contains(&(subject, target));
        return (!measures).then(|| format!("`passes::{subject}` may not import `{target}`"));
    }
    let pass_of = |module: &[String]| {
        let pass = format!("{subject}/{}", module.get(2)?);
        passes.contains(&pass).then_some(pass)
    };
    let sibling = pass_of(path)?;
    match from.get(2) {
        // A re-export in mod.rs would give all modules access to the sibling.
        None => Some(format!(
            "`passes/{subject}/mod.rs` may not re-export `{sibling}`"
        )),
        Some(_) if pass_of(from).as_ref() != Some(&sibling) => Some(format!(
            "`{}` may not import the pass `{sibling}`",
            from.join("::")
        )),
        Some(_) => None,
    }
}

/// `path:line: reason` for each forbidden import of a source file under src/.
fn import_faults(path: &Path, text: &str, passes: &BTreeSet<String>) -> Vec<String> {
    let Some(module) = imports::module_of(path) else {
        return Vec::new();
    };
    let objections = imports::of_source(&module, text);
    let faults = objections.iter().filter_map(|import| {
        let reason = objection(&module, import, passes)?;
        Some(format!("{}:{}: {reason}", path.display(), import.line))
    });
    faults.collect()
}

/// Lines of a file without the unit tests at its end.
fn counted_lines(text: &str) -> usize {
    let tests = text.find("\n#[cfg(test)]\nmod tests {");
    text[..tests.map_or(text.len(), |at| at + 1)]
        .lines()
        .count()
}

#[test]
fn imports_run_one_way() {
    let passes = declared_passes();
    let faults: Vec<String> = files("src", "rs")
        .iter()
        .flat_map(|(path, text)| import_faults(path, text, &passes))
        .collect();
    assert!(
        faults.is_empty(),
        "forbidden imports:\n{}",
        faults.join("\n")
    );
}

#[test]
fn shaders_import_one_way() {
    let faults: Vec<String> = files("shaders", "wesl")
        .iter()
        .flat_map(|(path, text)| shaders::import_faults(path, text))
        .collect();
    assert!(
        faults.is_empty(),
        "forbidden imports:\n{}",
        faults.join("\n")
    );
}

#[test]
fn every_pass_has_one_file_and_one_shader_of_its_name() {
    let declared = declared_passes();
    assert!(declared.len() > 15, "{declared:?}");
    let is_kernel = |text: &str| text.contains("@compute") || text.contains("@fragment");
    let kernels: BTreeSet<String> = files("shaders", "wesl")
        .into_iter()
        .filter(|(_, text)| is_kernel(text))
        .map(|(path, _)| {
            let name = path.with_extension("");
            let name = name.strip_prefix("shaders").expect("it lies there");
            name.to_string_lossy().into_owned()
        })
        .collect();
    assert_eq!(declared, kernels, "passes and their shaders");
    let missing: Vec<_> = declared
        .iter()
        .filter(|pass| !root().join(format!("src/passes/{pass}.rs")).exists())
        .collect();
    assert!(missing.is_empty(), "passes without a file: {missing:?}");
}

#[test]
fn files_stay_readable() {
    let all = [("src", "rs"), ("benches", "rs"), ("shaders", "wesl")];
    let long: Vec<(String, usize)> = all
        .iter()
        .flat_map(|(folder, extension)| files(folder, extension))
        .filter(|(path, _)| !path.ends_with("tests.rs"))
        .map(|(path, text)| (path.to_string_lossy().into_owned(), counted_lines(&text)))
        .filter(|(_, lines)| *lines > MOST_LINES)
        .collect();
    let excused = |path: &str| LONG_FILES.iter().any(|(known, _)| *known == path);
    let grown: Vec<_> = long.iter().filter(|(path, _)| !excused(path)).collect();
    assert!(
        grown.is_empty(),
        "files over {MOST_LINES} lines without a reason: {grown:?}"
    );
    for (known, reason) in LONG_FILES {
        assert!(
            long.iter().any(|(path, _)| path == known),
            "{known} no longer needs a reason"
        );
        assert!(reason.len() > 20, "{known}: say why");
    }
}

/// The benchmarks of Cargo.toml that the test suite does not run: criterion's own harness runs each once
/// where they count as tests.
fn benches_not_run(cargo_toml: &str) -> Vec<&str> {
    let benches = cargo_toml.split("[[bench]]").skip(1);
    let entries = benches.map(|rest| rest.split("\n[").next().unwrap_or(rest));
    entries
        .filter(|entry| {
            let has = |line: &str| entry.lines().any(|known| known == line);
            !(has("harness = false") && has("test = true"))
        })
        .collect()
}

#[test]
fn every_bench_is_run_by_the_test_suite() {
    let text = fs::read_to_string(root().join("Cargo.toml")).expect("the manifest");
    assert!(text.contains("[[bench]]"), "the benches have entries");
    assert_eq!(benches_not_run(&text), Vec::<&str>::new());
    let planted = "[[bench]]\nname = \"a\"\nharness = false\n\n[profile.dev]\ntest = true\n";
    assert_eq!(benches_not_run(planted).len(), 1, "a planted one is found");
}

#[test]
fn planted_imports_are_found() {
    let passes = BTreeSet::from(["view/shade".to_owned(), "view/tonemap".to_owned()]);
    let faults = |path: &str, text: &str| import_faults(Path::new(path), text, &passes);
    for (path, text) in [
        ("src/world/sdf/mod.rs", "use crate::lights::Lights;"),
        ("src/lights/lamp.rs", "use crate::probes::Volume;"),
        ("src/reference/march.rs", "use crate::passes::View;"),
        (
            "src/reference/render.rs",
            "#[cfg(test)]\nmod tests {\n    use crate::gpu::Gpu;\n}",
        ),
        (
            "src/reference/render.rs",
            "fn f() -> f64 { crate::gpu::device::limit() }",
        ),
        (
            "src/measure/metrics.rs",
            "use crate::{measure::picture, world::{self, World}};",
        ),
        ("src/gpu/kernel.rs", "use super::super::world::World;"),
        (
            "src/gpu/mod.rs",
            "pub(crate) use super::world::voxels::{CELL, Voxels as V};",
        ),
        ("src/parameters/mod.rs", "use crate::world::World;"),
        ("src/passes/view/shade.rs", "use super::tonemap::Tonemap;"),
        (
            "src/passes/view/shade.rs",
            "use crate::{gpu::Gpu, passes::view::{View, tonemap}};",
        ),
        ("src/passes/view/mod.rs", "pub use self::shade::Shade;"),
        ("src/passes/view/mod.rs", "pub use shade::{Shade, Other};"),
        ("src/passes/view/inspection.rs", "use super::shade::Shade;"),
        (
            "src/passes/view/shade.rs",
            "use super::super::probes::ProbeField;",
        ),
        (
            "src/passes/scene/voxels.rs",
            "use crate::passes::bench::rays;",
        ),
        ("src/passes/view/shade.rs", "use crate::frame::Frame;"),
        ("src/passes/view/shade.rs", "use crate::reference::march;"),
        ("src/frame/mod.rs", "use crate::commands::Cli;"),
        ("src/world/file.rs", "use crate::*;"),
        ("src/novelty.rs", "use crate::world::World;"),
        ("src/main.rs", "use grotto::gpu::Gpu;"),
    ] {
        assert!(!faults(path, text).is_empty(), "{path}: {text}");
    }
    for (path, text) in [
        (
            "src/lights/lamp.rs",
            "use crate::world::{Lamp, Sun};\nuse super::motion;",
        ),
        (
            "src/passes/view/shade.rs",
            "use super::{View, shade::Own};\nuse crate::parameters::Light;",
        ),
        (
            "src/passes/view/shade.rs",
            "#[cfg(test)]\nmod tests { use super::*; use crate::reference::A; }",
        ),
        (
            "src/world/sdf/mod.rs",
            "// use crate::gpu::Gpu;\n/* crate::gpu */ pub(crate) fn f() {}",
        ),
        (
            "src/world/sdf/mod.rs",
            "const HELP: &str = \"use crate::gpu::Gpu;\";",
        ),
        (
            "src/world/sdf/mod.rs",
            "const A: &str = r#\"\" crate::gpu::A \"#; const C: char = '\"';",
        ),
        ("src/main.rs", "use grotto::commands::Cli;"),
        (
            "src/passes/bench/rays.rs",
            "use super::super::scene::GpuVoxels;",
        ),
    ] {
        assert_eq!(faults(path, text), Vec::<String>::new(), "{path}: {text}");
    }
}

#[test]
fn the_counter_of_lines_leaves_out_unit_tests_only() {
    let code = "fn f() {}\n".repeat(401);
    assert_eq!(counted_lines(&code), 401);
    let tested = format!(
        "{}#[cfg(test)]\nmod tests {{\n{code}}}\n",
        "fn f() {}\n".repeat(9)
    );
    assert_eq!(counted_lines(&tested), 9);
}

#[test]
fn private_modules_of_passes_are_no_passes() {
    let text = "mod view;\npub mod shade;\npub use view::View;\n// pub mod gone;\n";
    assert_eq!(passes(text), BTreeSet::from(["shade".to_owned()]));
}
