//! Random worlds over the whole schema of `worlds/README.md`, each from one seed.
//!
//! A world is built as a tree of choices ([`term`]) and passed on as the text of a world file, so the reader of
//! all other world files reads it.

mod bodies;
mod dice;
mod matter;
mod scenery;
mod shape;
mod spheres;
pub mod term;

pub use dice::Dice;
use dice::rounded;
use shape::Ground;
use spheres::Spheres;
use term::Term;

/// Streams of random numbers of one seed, by purpose.
const WORLD: u64 = 0;
const PARAMETERS: u64 = 1;
/// For the script that plays a scene.
pub const SCRIPT: u64 = 2;
/// What came later has a stream of its own: the other things of a seed stay as they were.
const OCTREES: u64 = 3;
/// Of these two the numbers are chosen so that scenes which tests name by their seeds have neither, and stay as they were.
const BODIES: u64 = 102;
const SPHERES: u64 = 11;

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
        world: world(seed),
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

fn world(seed: u32) -> Term {
    let dice = &mut Dice::new(seed, WORLD);
    let octrees = &mut Dice::new(seed, OCTREES);
    let bodies = &mut Dice::new(seed, BODIES);
    let spheres = &mut Spheres::new(Dice::new(seed, SPHERES));
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
    let bodies = bodies::bodies(bodies, &ground, centre, &names);
    keys.extend(bodies.map(|bodies| ("bodies", bodies)));
    keys.push(("lamps", scenery::lamps(dice, spheres, &ground, centre)));
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
        world::bodies::Pose,
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

    /// Without what was added to scenes since the tests name them by their seeds.
    fn without_later_parts(term: Term) -> Term {
        let all = |of: Vec<Term>| of.into_iter().map(without_later_parts).collect();
        match term {
            Term::Record(name, keys) => {
                let keys = keys.into_iter();
                let kept = keys.filter(|(key, _)| !["bodies", "soft_radius"].contains(key));
                let kept = kept.map(|(key, of)| (key, without_later_parts(of)));
                Term::Record(name, kept.collect())
            }
            Term::List(of) => Term::List(all(of)),
            Term::Tuple(name, of) => Term::Tuple(name, all(of)),
            other => other,
        }
    }

    #[test]
    fn older_seeds_keep_everything_but_bodies_and_spheres() {
        let mut crc = crc32fast::Hasher::new();
        for seed in 0..400 {
            let scene = generate(seed);
            let text = without_later_parts(scene.world).file() + &scene.set.join(" ");
            crc.update(text.as_bytes());
        }
        // That of the grammar without them (d433e02).
        assert_eq!(crc.finalize(), 0xc7eb_1850);
    }

    /// The known failures, and the scenes that faults are planted into (`tests/cli/stress`).
    #[test]
    fn scenes_that_tests_name_have_no_later_parts() {
        let known = [89, 264, 278, 323, 352, 501, 536, 606, 740, 821, 975, 1048];
        for seed in known.into_iter().chain([2, 3, 65]) {
            let world = generate(seed).world;
            assert!(world == without_later_parts(world.clone()), "seed {seed}");
        }
    }

    /// How fast bodies go, how large they are, what they are made of: by the worlds that are read.
    #[test]
    fn some_bodies_glow_and_some_go_farther_in_a_frame_than_they_are_long() {
        let (mut glow, mut fast, mut crowded) = (0, 0, 0);
        for seed in 0..200 {
            let text = generate(seed).world.file();
            let world = parse(&text, "scene", None, &Overrides::default()).expect("sound");
            let bodies = &world.bodies;
            let [before, after] = [1.0, 1.0 + 1.0 / 60.0].map(|time_s| bodies.poses(time_s));
            for (body, (before, after)) in bodies.bodies.iter().zip(before.iter().zip(&after)) {
                let model = &bodies.models[body.model];
                let shines = |material: u8| {
                    let emission = world.materials[usize::from(material) - 1].emission;
                    emission.max_element() > 0.0
                };
                let mut solid = model.solid();
                glow += u32::from(solid.any(|voxel| shines(model.material(voxel))));
                let way = before.position.distance(after.position);
                fast += u32::from(way > model.size.max_element() as f32);
                let is_here = |other: &Pose| other.position.distance(before.position) < 1e-3;
                let here = bodies
                    .poses(1.0)
                    .iter()
                    .filter(|other| is_here(other))
                    .count();
                crowded += u32::from(here > 1);
            }
        }
        assert!(
            glow > 20 && fast > 1 && crowded > 5,
            "{glow}, {fast}, {crowded}"
        );
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
            "bodies",
            "Shape(",
            "Like",
            "pivot",
            "Turn(",
            "TurnBetween",
            "ease",
            "Swing",
            "Lift",
            "soft_radius",
            "split: Surface",
            "split: Hits",
            "source: true",
        ];
        for form in forms {
            assert!(all.contains(form), "{form} is never generated");
        }
        assert!(generate(3) == generate(3) && generate(3) != generate(4));
    }
}
