//! A cave from a few choices: the text of a world file, which a player may then edit like any other.

use std::f64::consts::TAU;

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// What a player chooses of a new cave. Shares are 0 … 1.
#[derive(Clone, Debug, PartialEq)]
pub struct NewCave {
    /// Of everything that is left to chance.
    pub seed: u32,
    /// Size of the rooms, as a share of what the world has room for.
    pub rooms: f64,
    /// How rugged walls and floor are.
    pub roughness: f64,
    /// How densely mushrooms grow.
    pub mushrooms: f64,
    /// Lamps that hang from the ceilings.
    pub lamps: u32,
    /// How much of the floor lies under lava.
    pub lava: f64,
}

/// Most lamps that a new cave offers.
pub const MOST_LAMPS: u32 = 48;

impl Default for NewCave {
    fn default() -> Self {
        Self {
            seed: 1,
            rooms: 0.5,
            roughness: 0.5,
            mushrooms: 0.5,
            lamps: 10,
            lava: 0.3,
        }
    }
}

/// Half of the world's extent (voxels).
const HALF: [i32; 3] = [80, 48, 80];
/// Rock ends here; daylight falls through shafts.
const TOP: f64 = 40.0;
/// Radius of the room in the middle at the smallest and the largest choice (voxels).
const RADII: (f64, f64) = (15.0, 30.0);
/// Height of the floor, as a share of the middle room's radius below its centre.
const FLOOR: f64 = 0.45;
/// Most mushrooms for each 1000 columns.
const MUSHROOMS: f64 = 9.0;
/// No mushroom stands this close to the world's middle along both x and z, where the player begins. The
/// widest cap reaches 4 voxels from its stem.
const CLEARING: i32 = 7;

impl NewCave {
    /// The world file, under this title. The first camera stands in the air of the middle room.
    pub fn text(&self, title: &str) -> String {
        let middle = RADII.0 + (RADII.1 - RADII.0) * self.rooms.clamp(0.0, 1.0);
        let rough = self.roughness.clamp(0.0, 1.0);
        let floor = -FLOOR * middle;
        let hills = 1.5 + 4.5 * rough;
        // Above the highest hill, which in small rooms comes up to the middle.
        let eye = (-0.1 * middle).max(floor + hills + 2.0);
        let towards = self.direction();
        let [x, y, z] = HALF;
        // The noise of the floor keeps within its amplitude, mostly within half of it.
        let lava = (floor + hills * (1.3 * self.lava.clamp(0.0, 1.0) - 0.75)).floor();
        let (lava_shape, lava_rule) = if self.lava > 0.0 {
            (
                format!(
                    "        // Lava up to here.\n        Plane(normal: (0, 1, 0), offset: {lava}),\n"
                ),
                format!(
                    "        (material: \"lava\", when: All([Below({lava}), ShallowerThan(3)])),\n"
                ),
            )
        } else {
            Default::default()
        };
        format!(
            r#"(
    title: {title},
    size: ({size_x}, {size_y}, {size_z}),
    origin: (-{x}, -{y}, -{z}),
    seed: {seed},

{NOISES}
    shape: Union([
        // Rooms, tunnels and shafts, taken out of rock up to y = {TOP}.
        Displace(noise: "walls", amplitude: {rugged}, of: SmoothSubtraction(k: 6, of: [
            Plane(normal: (0, 1, 0), offset: {TOP}),
            Union([
{hollows}            ]),
        ])),
        HeightField(noise: "floor", base: {floor}, amplitude: {hills}),
{lava_shape}    ]),

{MATERIALS}
    rules: [
{lava_rule}{RULES}
    ],

    features: (
{MUSHROOM_KINDS}
        place: [
{mushrooms}        ],
    ),

    sky: (zenith: (0.55, 0.75, 1), horizon: (0.9, 0.95, 1), ground: (0.3, 0.3, 0.3)),
    sun: (towards: (0.35, 1, 0.3), irradiance: (9, 7.8, 6.3)),

    lamps: [
{lamps}        (name: "none"),
    ],
    cameras: [
        (name: "start", position: (0, {eye}, 0), look_at: ({look_x}, {look_y}, {look_z}), fov_deg: 75),
    ],
    layouts: [
        (name: "lattice", counts: (15, 9, 15), spacing: 11, centre: (0, 0, 0)),
    ],
)
"#,
            title = quoted(title),
            size_x = 2 * x,
            size_y = 2 * y,
            size_z = 2 * z,
            seed = self.seed,
            rugged = rounded(1.0 + 7.0 * rough),
            hollows = self.hollows(middle),
            floor = rounded(floor),
            hills = rounded(hills),
            mushrooms = self.mushrooms_placed(),
            lamps = self.preset(),
            eye = rounded(eye),
            look_x = rounded(10.0 * towards.cos()),
            look_y = rounded(eye - 1.5),
            look_z = rounded(10.0 * towards.sin()),
        )
    }

    fn mushrooms_placed(&self) -> String {
        if self.mushrooms <= 0.0 {
            return String::new();
        }
        let density = MUSHROOMS * self.mushrooms.min(1.0);
        let [far_x, far_y, far_z] = HALF;
        // Four boxes around the clearing: (least x, least z), (greatest x, greatest z).
        [
            ((-far_x, -far_z), (-CLEARING, far_z)),
            ((CLEARING, -far_z), (far_x, far_z)),
            ((-CLEARING, -far_z), (CLEARING, -CLEARING)),
            ((-CLEARING, CLEARING), (CLEARING, far_z)),
        ]
        .map(|((min_x, min_z), (max_x, max_z))| {
            let place = format!("min: ({min_x}, -{far_y}, {min_z}), max: ({max_x}, {far_y}, {max_z})");
            format!(
                r#"            Scatter(kinds: ["button", "button", "cap", "lantern"], density: {}, clearance: 5, spacing: 3, {place}),
            Scatter(kinds: ["great cap"], density: {}, clearance: 16, spacing: 9, {place}),
"#,
                rounded(density),
                rounded(0.25 * density)
            )
        })
        .concat()
    }

    /// The preset of lamps, which comes before the one without.
    fn preset(&self) -> String {
        if self.lamps == 0 {
            return String::new();
        }
        format!(
            r#"        (name: "lamps", scatter: [(
            lamp: (power: 1800, motion: [Flicker(amount: 0.2, rate: 5)]),
            colours: [(1, 0.55, 0.2), (1, 0.75, 0.4), (0.3, 0.8, 1), (0.9, 0.35, 0.8)],
            count: {}, on: Ceiling, height: 3, clearance: 8, spacing: 7, max: ({}, {TOP}, {}),
        )]),
"#,
            self.lamps.min(MOST_LAMPS),
            HALF[0],
            HALF[2],
        )
    }

    /// The direction from the middle room to the first of the others (radians).
    fn direction(&self) -> f64 {
        ChaCha8Rng::seed_from_u64(u64::from(self.seed)).random::<f64>() * TAU
    }

    /// The middle room, rooms around it with a tunnel to each, and shafts to the sky: shapes, one to a
    /// line.
    fn hollows(&self, middle: f64) -> String {
        let mut rng = ChaCha8Rng::seed_from_u64(u64::from(self.seed));
        let first = rng.random::<f64>() * TAU;
        let mut between = |low: f64, high: f64| low + (high - low) * rng.random::<f64>();
        let mut shapes = vec![sphere([0.0; 3], middle)];
        let rooms = 5 + (between(0.0, 3.0) as u32);
        for room in 0..rooms {
            let angle = first + TAU * (f64::from(room) + between(-0.2, 0.2)) / f64::from(rooms);
            let radius = middle * between(0.5, 0.85);
            // Rock stays between a room and the world's edge.
            let farthest = f64::from(HALF[0]) - radius - 8.0;
            let away = (middle + radius * between(0.7, 1.5)).min(farthest);
            let at = [
                away * angle.cos(),
                between(-0.25, 0.15) * middle,
                away * angle.sin(),
            ];
            shapes.push(sphere(at, radius));
            let width = middle * between(0.22, 0.34);
            let low = -FLOOR * middle + 0.7 * width;
            shapes.push(capsule([0.0, low, 0.0], [at[0], low, at[2]], width));
            // A shaft over every other room.
            if room % 2 == 0 {
                let shaft = radius * between(0.25, 0.45);
                shapes.push(capsule(at, [at[0], TOP + 20.0, at[2]], shaft));
            }
        }
        let lines = shapes
            .iter()
            .map(|shape| format!("                {shape},\n"));
        lines.collect()
    }
}

fn sphere(at: [f64; 3], radius: f64) -> String {
    let [x, y, z] = at.map(rounded);
    format!(
        "Translate(by: ({x}, {y}, {z}), of: Sphere(radius: {}))",
        rounded(radius)
    )
}

fn capsule(from: [f64; 3], to: [f64; 3], radius: f64) -> String {
    let ([ax, ay, az], [bx, by, bz]) = (from.map(rounded), to.map(rounded));
    format!(
        "Capsule(from: ({ax}, {ay}, {az}), to: ({bx}, {by}, {bz}), radius: {})",
        rounded(radius)
    )
}

/// Two decimals: short in a file.
fn rounded(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

/// A text as RON writes it.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            letter if letter.is_control() => quoted.push(' '),
            letter => quoted.push(letter),
        }
    }
    quoted.push('"');
    quoted
}

const NOISES: &str = r#"    noises: {
        "walls": (basis: Perlin, fractal: Fbm(octaves: 3), frequency: 0.045),
        "floor": (basis: Perlin, fractal: Fbm(octaves: 3), frequency: (0.03, 0, 0.03)),
        "moss": (basis: Perlin, fractal: Fbm(octaves: 2), frequency: 0.06),
    },
"#;

const MATERIALS: &str = r#"    materials: {
        "rock": (a: Hash((0.26, 0.22, 0.27), (0.38, 0.33, 0.38)), b: Flat(0.16, 0.15, 0.2), pattern: Fbm(cells: 2, octaves: 4)),
        "gravel": (a: Hash((0.24, 0.19, 0.17), (0.42, 0.35, 0.3))),
        "moss": (a: Hash((0.07, 0.3, 0.16), (0.16, 0.46, 0.18)), b: Flat(0.3, 0.6, 0.2), pattern: Fbm(cells: 3, octaves: 3)),
        "grass": (a: Hash((0.12, 0.36, 0.06), (0.24, 0.5, 0.1)), b: Flat(0.34, 0.56, 0.12), pattern: Fbm(cells: 3, octaves: 3)),
        "lava": (a: Hash((0.3, 0.08, 0.02), (0.45, 0.12, 0.04)), emission: (2.8, 0.6, 0.06)),
        "stem": (a: Flat(0.36, 0.24, 0.34), b: Flat(0.82, 0.78, 0.72), pattern: StripesFbm(cells: 2, octaves: 3)),
        "red cap": (a: Flat(0.78, 0.03, 0.03), b: Flat(0.9, 0.85, 0.7), pattern: Worley(cells: 1, radius: 0.24)),
        "amber cap": (a: Flat(0.9, 0.3, 0.03), b: Flat(0.95, 0.7, 0.2), pattern: Dots(radius: 0.05, pitch: 0.36, angle_deg: 45)),
        "glowing cap": (a: Flat(0.1, 0.5, 0.7), emission: (0.05, 0.6, 1)),
    },
"#;

const RULES: &str = r#"        (material: "grass", when: All([Above(30), FacesUp])),
        (material: "moss", when: All([ShallowerThan(3), NoiseBelow(noise: "moss", value: 0), FacesUp])),
        (material: "gravel", when: All([ShallowerThan(3), FacesUp])),
        (material: "rock"),"#;

const MUSHROOM_KINDS: &str = r#"        kinds: {
            "button": [
                (min: (0, -1, 0), max: (0, 1, 0), material: "stem"),
                (min: (-1, 2, -1), max: (1, 2, 1), material: "amber cap"),
            ],
            "lantern": [
                (min: (0, -1, 0), max: (0, 1, 0), material: "stem"),
                (min: (-1, 2, -1), max: (1, 2, 1), material: "glowing cap"),
            ],
            "cap": [
                (min: (0, -2, 0), max: (0, 2, 0), material: "stem"),
                (min: (-1, 3, -1), max: (1, 4, 1), material: "red cap"),
                (min: (-2, 3, -2), max: (2, 3, 2), material: "amber cap", without_corners: true),
            ],
            "great cap": [
                (min: (0, -3, 0), max: (0, 9, 0), material: "stem"),
                (min: (-3, 10, -3), max: (3, 12, 3), material: "red cap", without_corners: true),
                (min: (-4, 10, -4), max: (4, 11, 4), material: "red cap", without_corners: true),
            ],
        },"#;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::world::{
        World,
        file::{self, Overrides},
        generate,
    };

    fn built(cave: &NewCave) -> World {
        let text = cave.text("a \"new\" cave \\ of mine");
        file::parse(&text, "new", None, &Overrides::default())
            .unwrap_or_else(|error| panic!("{error:?}\n{text}"))
    }

    #[test]
    fn the_title_is_kept() {
        assert_eq!(
            built(&NewCave::default()).title,
            "a \"new\" cave \\ of mine"
        );
    }

    #[test]
    fn each_choice_changes_the_world() {
        let plain = NewCave::default();
        let text = plain.text("");
        for other in [
            NewCave {
                seed: 2,
                ..plain.clone()
            },
            NewCave {
                rooms: 0.9,
                ..plain.clone()
            },
            NewCave {
                roughness: 0.9,
                ..plain.clone()
            },
            NewCave {
                mushrooms: 0.9,
                ..plain.clone()
            },
            NewCave {
                lamps: 11,
                ..plain.clone()
            },
            NewCave {
                lava: 0.9,
                ..plain.clone()
            },
        ] {
            assert_ne!(other.text(""), text);
        }
    }

    /// The material where the first camera stands; 0 is air.
    fn material_at_the_eye(cave: &NewCave) -> u8 {
        let world = built(cave);
        let voxels = generate::generate(&world);
        voxels.material(world.cameras[0].position.floor().as_ivec3() - world.origin)
    }

    #[test]
    fn no_mushroom_grows_where_the_player_begins() {
        let cave = NewCave {
            seed: 649036507,
            rooms: 0.9879532145920894,
            roughness: 0.0,
            mushrooms: 0.9049570031377925,
            lamps: 0,
            lava: 0.0,
        };
        assert_eq!(material_at_the_eye(&cave), 0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn every_choice_gives_a_world_whose_camera_stands_in_air(
            seed: u32,
            shares in [0.0..=1.0f64, 0.0..=1.0f64, 0.0..=1.0f64, 0.0..=1.0f64],
            lamps in 0..=MOST_LAMPS,
        ) {
            let [rooms, roughness, mushrooms, lava] = shares;
            let cave = NewCave { seed, rooms, roughness, mushrooms, lamps, lava };
            prop_assert_eq!(material_at_the_eye(&cave), 0);
        }
    }
}
