//! Shapes and noises: trees over every primitive and operator of a world file.

use super::{
    dice::{Dice, rounded},
    term::Term,
};

/// The space and the names that a shape can use.
pub struct Ground<'a> {
    /// Half of the world's extent, voxels.
    pub half: [f64; 3],
    /// Names of noises.
    pub noises: &'a [String],
    /// Hollows of the shape, known once it is made: lamps and cameras are often put there.
    pub rooms: Vec<Room>,
}

/// A hollow box: its centre, relative to that of the world, and half of its extent.
#[derive(Clone, Copy)]
pub struct Room {
    pub at: [f64; 3],
    pub half: [f64; 3],
}

fn record(name: &'static str, keys: Vec<(&'static str, Term)>) -> Term {
    Term::Record(name, keys)
}

fn number(value: f64) -> Term {
    Term::Number(value)
}

/// `{"n0": (basis: …), …}` and the names of the noises.
pub fn noises(dice: &mut Dice) -> (Term, Vec<String>) {
    let count = *dice.pick(&[0, 0, 1, 1, 2, 3]);
    let names: Vec<String> = (0..count).map(|index| format!("n{index}")).collect();
    let all = names.iter().map(|name| (name.clone(), noise(dice)));
    (Term::Map(all.collect()), names)
}

fn noise(dice: &mut Dice) -> Term {
    let basis = *dice.pick(&["Perlin", "OpenSimplex", "Worley", "Value"]);
    let mut keys = vec![("basis", Term::Word(basis))];
    if dice.chance(0.6) {
        let form = *dice.pick(&["Fbm", "Ridged", "Billow"]);
        let octaves = if dice.chance(0.03) {
            24
        } else {
            dice.whole(1, 4)
        };
        let mut of = vec![("octaves", number(f64::from(octaves)))];
        if dice.chance(0.4) {
            of.push(("lacunarity", number(dice.number(1.0, 3.0))));
        }
        if dice.chance(0.4) {
            of.push(("persistence", number(dice.number(0.1, 1.0))));
        }
        keys.push(("fractal", record(form, of)));
    }
    let frequency = if dice.chance(0.7) {
        number(dice.magnitude(0.01, 0.4))
    } else {
        let mut axis = || {
            if dice.chance(0.2) {
                0.0
            } else {
                dice.magnitude(0.01, 0.4)
            }
        };
        Term::vector([axis(), axis(), axis()])
    };
    keys.push(("frequency", frequency));
    if dice.chance(0.3) {
        keys.push(("offset", dice.within([9.0; 3])));
    }
    if dice.chance(0.3) {
        keys.push(("seed", number(f64::from(dice.whole(0, 999)))));
    }
    record("", keys)
}

/// The shape of a world with this centre.
pub fn world_shape(dice: &mut Dice, ground: &mut Ground<'_>, centre: [f64; 3]) -> Term {
    let shape = match dice.whole(0, 9) {
        0..=3 => rooms(dice, ground),
        4 => cavern(dice, ground),
        _ => shape(dice, ground, ground.half, 3),
    };
    moved(centre, shape)
}

fn moved(by: [f64; 3], of: Term) -> Term {
    if by == [0.0; 3] {
        return of;
    }
    record("Translate", vec![("by", Term::vector(by)), ("of", of)])
}

fn many(name: &'static str, of: Vec<Term>) -> Term {
    Term::Tuple(name, vec![Term::List(of)])
}

fn cuboid(half: [f64; 3]) -> Term {
    record("Box", vec![("half", Term::vector(half))])
}

/// Solid material with hollows, most of them closed: light must not reach them through thin walls.
fn rooms(dice: &mut Dice, ground: &mut Ground<'_>) -> Term {
    let half = ground.half;
    let wall = f64::from(dice.whole(1, 2));
    let count = dice.whole(1, 3);
    if dice.chance(0.6) {
        // In a row, with walls of equal thickness between them.
        let axis = dice.whole(0, 2) as usize;
        let each = (2.0 * half[axis] - wall * f64::from(count + 1)) / f64::from(count);
        for index in 0..count {
            let mut room = Room {
                at: [0.0; 3],
                half: half.map(|half| rounded((half - wall).max(0.5))),
            };
            room.half[axis] = rounded((each / 2.0).max(0.5));
            let start = -half[axis] + wall + f64::from(index) * (each + wall);
            room.at[axis] = rounded(start + each / 2.0);
            ground.rooms.push(room);
        }
    } else {
        for _ in 0..count {
            let half = half.map(|half| (half * (0.1 + 0.5 * dice.unit())).round().max(0.5));
            let at = [0, 1, 2].map(|axis| {
                let room = (ground.half[axis] - half[axis] - 1.0).max(0.0);
                dice.number(-room, room).round()
            });
            ground.rooms.push(Room { at, half });
        }
    }
    let rock = cuboid(half.map(|half| half + f64::from(dice.whole(0, 1))));
    let hollows = ground
        .rooms
        .iter()
        .map(|room| moved(room.at, cuboid(room.half)));
    let hollow = many("Subtraction", [rock].into_iter().chain(hollows).collect());
    if dice.chance(0.3) {
        let inside = ground.half.map(|half| half * 0.5);
        many("Union", vec![hollow, shape(dice, ground, inside, 1)])
    } else {
        hollow
    }
}

/// A cave with an uneven wall.
fn cavern(dice: &mut Dice, ground: &Ground<'_>) -> Term {
    let hollow = shape(dice, ground, ground.half.map(|half| half * 0.7), 2);
    let rock = cuboid(ground.half.map(|half| half + 4.0));
    record(
        "SmoothSubtraction",
        vec![
            ("k", number(dice.number(0.0, 4.0))),
            ("of", Term::List(vec![rock, hollow])),
        ],
    )
}

/// A tree of at most `depth` nested operators.
fn shape(dice: &mut Dice, ground: &Ground<'_>, half: [f64; 3], depth: u32) -> Term {
    if depth == 0 || dice.chance(0.15) {
        return leaf(dice, ground, half);
    }
    let below = |dice: &mut Dice| shape(dice, ground, half, depth - 1);
    match dice.whole(0, 13) {
        form @ 0..=2 => {
            let name = ["Union", "Intersection", "Subtraction"][form as usize];
            let count = dice.whole(1, 4);
            many(name, (0..count).map(|_| below(dice)).collect())
        }
        form @ 3..=5 => {
            let name =
                ["SmoothUnion", "SmoothIntersection", "SmoothSubtraction"][form as usize - 3];
            let k = dice.number(0.0, 5.0);
            let count = dice.whole(1, 3);
            let of = (0..count).map(|_| below(dice)).collect();
            record(name, vec![("k", number(k)), ("of", Term::List(of))])
        }
        6..=7 => {
            let by = dice.within(half);
            record("Translate", vec![("by", by), ("of", below(dice))])
        }
        8 => {
            let degrees = dice.within([180.0; 3]);
            record("Rotate", vec![("degrees", degrees), ("of", below(dice))])
        }
        9 => {
            let by = dice.magnitude(0.3, 3.0);
            record("Scale", vec![("by", number(by)), ("of", below(dice))])
        }
        10 => repeat(dice),
        11 => scatter(dice, half),
        form => match named_noise(dice, ground) {
            Some(noise) => {
                let amplitude = dice.number(-4.0, 4.0);
                let keys = vec![
                    ("noise", noise),
                    ("amplitude", number(amplitude)),
                    ("of", below(dice)),
                ];
                record(if form == 12 { "Displace" } else { "Warp" }, keys)
            }
            None => below(dice),
        },
    }
}

fn named_noise(dice: &mut Dice, ground: &Ground<'_>) -> Option<Term> {
    (!ground.noises.is_empty()).then(|| Term::text(dice.pick(ground.noises)))
}

/// Copies that each stay within half of a period.
fn repeat(dice: &mut Dice) -> Term {
    let reach = dice.number(1.0, 6.0);
    let axis = |dice: &mut Dice| {
        if dice.chance(0.3) {
            0.0
        } else {
            dice.number(2.0, 4.0) * reach
        }
    };
    let period = [axis(dice), axis(dice), axis(dice)].map(rounded);
    record(
        "Repeat",
        vec![
            ("period", Term::vector(period)),
            ("of", bounded(dice, reach)),
        ],
    )
}

fn scatter(dice: &mut Dice, half: [f64; 3]) -> Term {
    let reach = dice.number(1.0, 5.0);
    let most = dice.number(1.0, 2.0);
    let jitter = dice.number(0.0, 0.4);
    // `reach` · most + `jitter` · `cell` must not exceed `cell`.
    let cell = (reach * most / (1.0 - jitter) + 0.1).ceil();
    let mut keys = vec![("cell", number(cell)), ("reach", number(reach))];
    if dice.chance(0.5) {
        keys.push(("min", Term::vector(half.map(|half| -half))));
        keys.push(("max", Term::vector(half)));
    }
    if dice.chance(0.6) {
        keys.push(("probability", number(dice.number(0.0, 1.0))));
    }
    keys.push(("jitter", number(jitter)));
    keys.push((
        "scale",
        Term::Tuple("", vec![number(dice.number(0.4, 1.0)), number(most)]),
    ));
    if dice.chance(0.4) {
        keys.push(("seed", number(f64::from(dice.whole(0, 999)))));
    }
    keys.push(("of", bounded(dice, reach)));
    record("Scatter", keys)
}

/// A primitive that stays within this distance of the origin.
fn bounded(dice: &mut Dice, reach: f64) -> Term {
    let part = rounded(reach * 0.5);
    match dice.whole(0, 3) {
        0 => record(
            "Sphere",
            vec![("radius", number(dice.number(0.3 * reach, reach)))],
        ),
        1 => cuboid([part; 3]),
        2 => record(
            "Torus",
            vec![
                ("major", number(part)),
                ("minor", number(rounded(part * 0.6))),
            ],
        ),
        _ => record(
            "Cylinder",
            vec![("radius", number(part)), ("half_height", number(part))],
        ),
    }
}

fn leaf(dice: &mut Dice, ground: &Ground<'_>, half: [f64; 3]) -> Term {
    let least = half.into_iter().fold(f64::MAX, f64::min).max(1.0);
    let length = |dice: &mut Dice| number(dice.number(0.3, 1.2 * least).max(0.3));
    let extent = |dice: &mut Dice| half.map(|half| dice.number(0.1, 1.1 * half).max(0.1));
    match dice.whole(0, 11) {
        0 => Term::Word("Empty"),
        1 | 2 => record("Sphere", vec![("radius", length(dice))]),
        3 | 4 => cuboid(extent(dice)),
        5 => record(
            "RoundedBox",
            vec![
                ("half", Term::vector(extent(dice))),
                ("radius", number(dice.number(0.0, 3.0))),
            ],
        ),
        6 => record(
            "Capsule",
            vec![
                ("from", dice.within(half)),
                ("to", dice.within(half)),
                ("radius", number(dice.number(0.3, 0.5 * least + 0.3))),
            ],
        ),
        7 => record(
            "Cylinder",
            vec![("radius", length(dice)), ("half_height", length(dice))],
        ),
        8 => record(
            "Torus",
            vec![
                ("major", length(dice)),
                ("minor", number(dice.number(0.3, 3.0))),
            ],
        ),
        9 => {
            let normal = [
                dice.number(-1.0, 1.0),
                dice.number(0.1, 1.0),
                dice.number(-1.0, 1.0),
            ];
            let offset = dice.number(-0.8 * half[1], 0.3 * half[1]);
            record(
                "Plane",
                vec![("normal", Term::vector(normal)), ("offset", number(offset))],
            )
        }
        _ => match named_noise(dice, ground) {
            Some(noise) => {
                let mut keys = vec![
                    ("noise", noise),
                    ("base", number(dice.number(-half[1], 0.2 * half[1]))),
                    ("amplitude", number(dice.number(0.0, 6.0))),
                ];
                if dice.chance(0.4) {
                    keys.push(("step", number(dice.number(0.0, 3.0))));
                }
                record("HeightField", keys)
            }
            None => cuboid(extent(dice)),
        },
    }
}

/// A small shape, for a rule.
pub fn of_rule(dice: &mut Dice, ground: &Ground<'_>, centre: [f64; 3]) -> Term {
    moved(centre, leaf(dice, ground, ground.half))
}

/// A shape about (0, 0, 0), for a body. It has voxels whatever its size, for a box in the middle belongs to it.
pub fn of_body(dice: &mut Dice, ground: &Ground<'_>, half: [f64; 3]) -> Term {
    let middle = cuboid([0.6; 3]);
    Term::Tuple(
        "Union",
        vec![Term::List(vec![middle, leaf(dice, ground, half)])],
    )
}
