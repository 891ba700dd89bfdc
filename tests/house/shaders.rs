//! The rules of `shaders/`: which folder may import which, and one shader per pass.

use std::path::Path;

/// Folder → folders that it may import besides itself. `generated` holds the modules that Rust writes for a kernel.
const MAY_IMPORT: [(&str, &[&str]); 12] = [
    ("math", &[]),
    ("frame", &[]),
    ("color", &["math"]),
    ("scene", &["math", "frame", "sdf"]),
    ("sdf", &["math", "scene"]),
    ("march", &["math", "scene"]),
    ("light", &["math", "color", "scene", "march"]),
    ("probes", PURE),
    ("surface_cache", PURE),
    ("view", PURE),
    ("path_trace", PURE),
    // `bench` measures the others.
    ("bench", PURE),
];

/// What every subject may import: it knows no other subject than the scene.
const PURE: &[&str] = &["math", "frame", "color", "scene", "march", "light"];

/// How one subject reads the light of another: subject, the other, and the modules of the other that it may import.
const QUERIES: [(&str, &str, &[&str]); 5] = [
    (
        "surface_cache",
        "probes",
        &[
            "body_faces",
            "body_gather",
            "gather",
            "light",
            "requests",
            "update_schedule",
        ],
    ),
    (
        "view",
        "surface_cache",
        &["query", "footprint", "lamp_visibility"],
    ),
    // Views of the probes themselves read more than their light.
    (
        "view",
        "probes",
        &[
            "atlas",
            "body_gather",
            "field",
            "gather",
            "incident_light",
            "occlusion",
            "occlusion_gather",
            "probe_cube",
            "requests",
            "state_colours",
            "update_schedule",
            "volume",
        ],
    ),
    (
        "bench",
        "probes",
        &["active_list", "field", "occlusion", "update_schedule"],
    ),
    (
        "bench",
        "surface_cache",
        &["rays", "table", "lamp_visibility"],
    ),
];

/// Paths that a shader imports, as `["probes", "gather"]`, with their lines.
fn imports(text: &str) -> Vec<(usize, Vec<String>)> {
    let mut found = Vec::new();
    for (line, text) in text.lines().enumerate() {
        let code = text.split("//").next().unwrap_or_default();
        for path in code.split("package::").skip(1) {
            let end = path.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
            let parts = path[..end.unwrap_or(path.len())].split("::");
            let parts = parts.filter(|part| !part.is_empty());
            found.push((line + 1, parts.map(str::to_owned).collect()));
        }
    }
    found
}

/// `path:line: reason` for each forbidden import of a shader.
pub fn import_faults(path: &Path, text: &str) -> Vec<String> {
    let folder = path.iter().nth(1).unwrap_or_default().to_string_lossy();
    let allowed = MAY_IMPORT.iter().find(|(known, _)| *known == folder);
    let Some((_, allowed)) = allowed else {
        return vec![format!("{}: `{folder}` has no rule", path.display())];
    };
    let is_fine = |import: &[String]| {
        let target = import.first().map_or("", String::as_str);
        let module = import.get(1).map_or("", String::as_str);
        target == folder
            || target == "generated"
            || allowed.contains(&target)
            || QUERIES.iter().any(|(who, whom, modules)| {
                *who == folder && *whom == target && modules.contains(&module)
            })
    };
    let faults = imports(text)
        .into_iter()
        .filter(|(_, import)| !is_fine(import));
    faults
        .map(|(line, import)| {
            let target = import.join("::");
            format!(
                "{}:{line}: `{folder}` may not import `{target}`",
                path.display()
            )
        })
        .collect()
}

#[test]
fn planted_imports_of_shaders_are_found() {
    let faults = |path: &str, text: &str| import_faults(Path::new(path), text);
    for (path, text) in [
        (
            "shaders/math/hash.wesl",
            "import package::scene::voxels::grid;",
        ),
        (
            "shaders/march/march.wesl",
            "import package::light::sky::sky_radiance;",
        ),
        (
            "shaders/probes/trace.wesl",
            "import package::surface_cache::query::query_cache;",
        ),
        (
            "shaders/surface_cache/trace.wesl",
            "import package::probes::blend::mean;",
        ),
        (
            "shaders/view/shade.wesl",
            "fn f() { package::surface_cache::lists::take(); }",
        ),
        (
            "shaders/path_trace/trace.wesl",
            "import package::probes::gather::gather;",
        ),
        ("shaders/novelty/a.wesl", ""),
    ] {
        assert!(!faults(path, text).is_empty(), "{path}: {text}");
    }
    for (path, text) in [
        (
            "shaders/view/shade.wesl",
            "import package::surface_cache::query::query_cache;",
        ),
        (
            "shaders/probes/trace.wesl",
            "import package::probes::{volume::a, field::b};",
        ),
        ("shaders/math/hash.wesl", "// As package::probes::gather."),
        (
            "shaders/scene/voxelise.wesl",
            "import package::generated::shape::{distance};",
        ),
    ] {
        assert_eq!(faults(path, text), Vec::<String>::new(), "{path}: {text}");
    }
}
