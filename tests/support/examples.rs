//! The examples of shapes in `worlds/README.md`: one per shape, so that every new shape is tested.

use grotto::world::World;
use grotto::world::file::{self, Overrides};
use grotto::world::sdf::Sdf;

/// Worlds of one shape each, with its text.
pub fn shapes() -> Vec<(String, World)> {
    let readme = include_str!("../../worlds/README.md");
    let (_, section) = readme.split_once("\n## Shape\n").expect("the shapes");
    let (section, _) = section.split_once("\n## ").expect("the next section");
    let rows = section.lines().filter_map(|line| line.strip_prefix("| `"));
    let examples = rows.filter_map(|row| {
        let (example, _) = row.split_once('`').expect("the end of the example");
        let name = example.split('(').next().expect("a name");
        let known = Sdf::FORMS.iter().any(|(form, _)| *form == name);
        known.then(|| with_sub_trees(example))
    });
    examples.map(|text| (text.clone(), world(&text))).collect()
}

/// Puts shapes in place of the README's sub-trees a and b, and removes the `…` for keys with defaults.
fn with_sub_trees(example: &str) -> String {
    let (a, b) = (
        "Sphere(radius: 6)",
        "Translate(by: (4, 1, 0), of: Sphere(radius: 5))",
    );
    example
        .replace(", …", "")
        .replace("of: a", &format!("of: {a}"))
        .replace("[a, b]", &format!("[{a}, {b}]"))
}

fn world(shape: &str) -> World {
    let text = format!(
        "(
            title: \"One shape.\",
            size: (64, 64, 64),
            origin: (-32, -32, -32),
            noises: {{\"floor\": (basis: Perlin, fractal: Fbm(octaves: 4), frequency: 0.05)}},
            shape: {shape},
        )"
    );
    file::parse(&text, "README.md", None, &Overrides::default())
        .unwrap_or_else(|report| panic!("{shape}: {report:?}"))
}
