//! Random worlds over the whole schema of `worlds/README.md`, each from one seed.
//!
//! A world is built as a tree of choices ([`term`]) and passed on as the text of a world file, so the reader of
//! all other world files reads it.

mod dice;
mod matter;
mod scenery;
mod shape;
pub mod term;

pub use dice::Dice;
use dice::rounded;
use shape::Ground;
use term::Term;

/// Streams of random numbers of one seed, by purpose.
const WORLD: u64 = 0;
const PARAMETERS: u64 = 1;
/// For the script that plays a scene.
pub const SCRIPT: u64 = 2;
/// What came later has a stream of its own: the other things of a seed stay as they were.
const OCTREES: u64 = 3;

/// A generated world, and the parameters that it is rendered with.
#[derive(Clone, Debug, PartialEq)]
pub struct Generated {
    pub world: Term,
    /// `KEY=VALUE`, as `--set` takes them.
    pub set: Vec<String>,
}

/// The scene of a seed.
pub fn generate(seed: u32) -> Generated {
    Generated {
        world: world(
            &mut Dice::new(seed, WORLD),
            &mut Dice::new(seed, OCTREES),
            seed,
        ),
        set: parameters(&mut Dice::new(seed, PARAMETERS)),
    }
}

/// Sizes: tiny, flat, thin, odd, and whole cells of 8.
fn size(dice: &mut Dice) -> [f64; 3] {
    let edge = |dice: &mut Dice, low, high| f64::from(dice.whole(low, high));
    match dice.whole(0, 9) {
        0 => [0; 3].map(|_| edge(dice, 1, 9)),
        1 => {
            let flat = dice.whole(0, 2) as usize;
            let mut size = [0; 3].map(|_| edge(dice, 8, 48));
            size[flat] = edge(dice, 1, 3);
            size
        }
        2 => {
            let long = dice.whole(0, 2) as usize;
            let mut size = [0; 3].map(|_| edge(dice, 1, 10));
            size[long] = edge(dice, 24, 80);
            size
        }
        3 => [0; 3].map(|_| 8.0 * edge(dice, 1, 5)),
        _ => [0; 3].map(|_| edge(dice, 9, 36)),
    }
}

fn world(dice: &mut Dice, octrees: &mut Dice, seed: u32) -> Term {
    let size = size(dice);
    let half = size.map(|edge| edge / 2.0);
    let origin = match dice.whole(0, 5) {
        0 => None,
        1 => Some([0; 3].map(|_| dice.number(-2000.0, 2000.0).round())),
        _ => Some(half.map(|half| -half.floor())),
    };
    let corner = origin.unwrap_or_default();
    let centre = [0, 1, 2].map(|axis| rounded(corner[axis] + half[axis]));
    let mut keys = vec![
        (
            "title",
            Term::Text(format!("Scene {seed} of grotto stress.")),
        ),
        ("size", Term::vector(size)),
    ];
    keys.extend(origin.map(|origin| ("origin", Term::vector(origin))));
    if dice.chance(0.2) {
        keys.push(("voxel_m", Term::Number(dice.magnitude(0.2, 4.0))));
    }
    keys.push(("seed", Term::Number(f64::from(dice.whole(0, 9999)))));
    let (noises, noise_names) = shape::noises(dice);
    let mut ground = Ground {
        half,
        noises: &noise_names,
        rooms: Vec::new(),
    };
    keys.push(("noises", noises));
    keys.push(("shape", shape::world_shape(dice, &mut ground, centre)));
    let (materials, names) = matter::materials(dice);
    keys.push(("materials", materials));
    keys.push(("rules", matter::rules(dice, &ground, centre, &names)));
    if dice.chance(0.4) {
        keys.push(("features", matter::features(dice, &ground, centre, &names)));
    }
    keys.push(("lamps", scenery::lamps(dice, &ground, centre)));
    keys.extend(scenery::sky(dice));
    keys.push(("cameras", scenery::cameras(dice, &ground, centre)));
    keys.push(("layouts", scenery::layouts(dice, octrees, &ground, centre)));
    if dice.chance(0.1) {
        let voxel = centre.map(f64::floor);
        let wall = vec![
            ("min", Term::vector(voxel)),
            ("max", Term::vector(voxel)),
            ("material", Term::text(dice.pick(&names))),
        ];
        keys.push((
            "response",
            Term::Record("", vec![("wall", Term::Record("", wall))]),
        ));
    }
    Term::Record("", keys)
}

/// Parameters that may be set, with their possible values; each key is set at most once.
const VALUES: [(&str, &[&str]); 19] = [
    ("probes.visibility", &["exact", "chebyshev", "chebyshev"]),
    ("probes.relocation", &["off", "off"]),
    ("probes.states", &["off"]),
    ("probes.final_gather", &["off", "off"]),
    ("probes.method", &["source", "source"]),
    ("source.relocation", &["clear"]),
    ("source.weights", &["adjusted", "visibility"]),
    ("probes.face_samples", &["16", "64"]),
    ("probes.irradiance_texels", &["4", "6"]),
    ("probes.distance_texels", &["8"]),
    ("source.depth", &["reject"]),
    ("probes.hysteresis", &["0", "0.5", "0.999"]),
    ("probes.warmup_frames", &["0", "4"]),
    ("probes.face_pixels", &["0.5", "20"]),
    ("probes.alive_frames", &["1"]),
    ("probes.normal_bias", &["0", "1"]),
    ("probes.firefly_clamp", &["8"]),
    ("textures.enabled", &["off"]),
    ("lights.animate", &["off"]),
];

fn parameters(dice: &mut Dice) -> Vec<String> {
    // Fewer rays than by default: scenes are small, and there are many.
    let rays = *dice.pick(&["8", "24", "32", "32", "64"]);
    let mut set = vec![format!("probes.rays={rays}")];
    if dice.chance(0.35) {
        return set;
    }
    for (key, values) in VALUES {
        if dice.chance(0.1) {
            set.push(format!("{key}={}", dice.pick(values)));
        }
    }
    set
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        parameters::Parameters,
        world::file::{Overrides, parse},
    };

    #[test]
    fn every_generated_world_is_one_that_check_accepts() {
        for seed in 0..400 {
            let scene = generate(seed);
            let text = scene.world.file();
            if let Err(report) = parse(&text, "scene", None, &Overrides::default()) {
                panic!("seed {seed}: {report:?}\n{text}");
            }
            for assignment in &scene.set {
                Parameters::default().set(assignment).expect(assignment);
            }
        }
    }

    #[test]
    fn every_form_of_the_schema_comes_up() {
        let all: String = (0..400).map(|seed| generate(seed).world.file()).collect();
        let forms = [
            "Empty",
            "Sphere",
            "Box(",
            "RoundedBox",
            "Capsule",
            "Cylinder",
            "Torus",
            "Plane",
            "HeightField",
            "Union(",
            "Intersection(",
            "Subtraction(",
            "SmoothUnion",
            "SmoothIntersection",
            "SmoothSubtraction",
            "Translate",
            "Rotate",
            "Scale",
            "Repeat",
            "Displace",
            "Warp",
            "Scatter",
            "Perlin",
            "OpenSimplex",
            "Worley",
            "Value",
            "Fbm",
            "Ridged",
            "Billow",
            "Flat",
            "Hash",
            "Bands",
            "DitherX",
            "Plain",
            "Stripes",
            "Dots",
            "Checker",
            "Bricks",
            "StripesFbm",
            "Radial",
            "emission",
            "Below",
            "Above",
            "InBox",
            "Inside",
            "NoiseBelow",
            "ShallowerThan",
            "FacesUp",
            "FacesDown",
            "All",
            "Any",
            "Not",
            "kinds",
            "At(",
            "without_corners",
            "Preset",
            "Spot",
            "Directional",
            "Orbit",
            "Bob",
            "Flicker",
            "Pulse",
            "Path",
            "HueCycle",
            "Ceiling",
            "colours",
            "sun",
            "horizon",
            "ground",
            "look_at",
            "pitch_deg",
            "fov_deg",
            "follow",
            "cascades: 6",
            "octree",
            "voxel_m",
            "origin",
            "response",
        ];
        for form in forms {
            assert!(all.contains(form), "{form} is never generated");
        }
        assert!(generate(3) == generate(3) && generate(3) != generate(4));
    }
}
