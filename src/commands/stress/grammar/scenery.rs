//! Lamps, sky, cameras and probe layouts.

use super::{dice::Dice, matter, shape::Ground, spheres::Spheres, term::Term};

fn record(name: &'static str, keys: Vec<(&'static str, Term)>) -> Term {
    Term::Record(name, keys)
}

fn number(value: f64) -> Term {
    Term::Number(value)
}

/// A position: in a room, in air, in solid voxels, at a face, an edge or a corner of the world, or outside.
pub(super) fn place(dice: &mut Dice, ground: &Ground<'_>, centre: [f64; 3]) -> [f64; 3] {
    if !ground.rooms.is_empty() && dice.chance(0.7) {
        let room = *dice.pick(&ground.rooms);
        return [0, 1, 2].map(|axis| {
            let along = room.at[axis] + 0.8 * dice.number(-1.0, 1.0) * room.half[axis];
            super::dice::rounded(centre[axis] + along)
        });
    }
    let form = dice.whole(0, 9);
    [0, 1, 2].map(|axis| {
        let half = ground.half[axis];
        let along = match form {
            0 => *dice.pick(&[-half, half]),
            1 => dice.number(-1.5, 1.5) * half,
            // On the border between two voxels.
            2 => dice.number(-half, half).round(),
            _ => dice.number(-0.95, 0.95) * half,
        };
        super::dice::rounded(centre[axis] + along)
    })
}

fn direction(dice: &mut Dice) -> Term {
    // The length must not be 0.
    let down = if dice.chance(0.8) { -1.0 } else { 1.0 };
    let aside = [dice.number(-1.0, 1.0), dice.number(-1.0, 1.0)];
    Term::vector([aside[0], down * dice.number(0.05, 1.0), aside[1]])
}

fn colour(dice: &mut Dice) -> Term {
    Term::vector([0; 3].map(|_| dice.number(0.0, 1.0)))
}

fn lamp(
    dice: &mut Dice,
    spheres: &mut Spheres,
    ground: &Ground<'_>,
    centre: [f64; 3],
    is_scattered: bool,
) -> Term {
    let mut keys = Vec::new();
    let directional = dice.chance(0.08);
    if directional {
        keys.push((
            "kind",
            record("Directional", vec![("direction", direction(dice))]),
        ));
    } else if dice.chance(0.3) {
        let outer = dice.number(1.0, 180.0);
        let inner = super::dice::rounded(outer * dice.number(0.0, 1.0));
        let of = vec![
            ("direction", direction(dice)),
            ("inner_deg", number(inner)),
            ("outer_deg", number(outer)),
        ];
        keys.push(("kind", record("Spot", of)));
    }
    if !is_scattered && !directional {
        keys.push(("position", Term::vector(place(dice, ground, centre))));
    }
    if dice.chance(0.5) {
        keys.push(("colour", colour(dice)));
    }
    let power = if directional {
        dice.magnitude(0.1, 10.0)
    } else {
        dice.magnitude(1.0, 3000.0)
    };
    keys.push(("power", number(power)));
    if dice.chance(0.4) {
        keys.push(("radius", number(dice.magnitude(0.05, 3.0))));
    }
    if dice.chance(0.5) {
        let count = dice.whole(1, 3);
        let all = (0..count)
            .map(|_| motion(dice, ground, centre, is_scattered))
            .collect();
        keys.push(("motion", Term::List(all)));
    }
    if !directional {
        keys.extend(spheres.soft_radius());
    }
    record("", keys)
}

/// A motion that lamps and bodies share, by its number.
pub(super) fn motion_of_place(
    dice: &mut Dice,
    ground: &Ground<'_>,
    centre: [f64; 3],
    form: u32,
) -> Term {
    let rate = |dice: &mut Dice| ("rate", number(dice.number(-6.0, 6.0)));
    match form % 3 {
        0 => record("Orbit", vec![("radius", dice.within([6.0; 3])), rate(dice)]),
        1 => record(
            "Bob",
            vec![("amplitude", dice.within([6.0; 3])), rate(dice)],
        ),
        _ => {
            let count = dice.whole(2, 4);
            let points = (0..count).map(|_| Term::vector(place(dice, ground, centre)));
            let points = Term::List(points.collect());
            record(
                "Path",
                vec![
                    ("points", points),
                    ("speed", number(dice.number(0.0, 20.0))),
                ],
            )
        }
    }
}

fn motion(dice: &mut Dice, ground: &Ground<'_>, centre: [f64; 3], is_scattered: bool) -> Term {
    let rate = |dice: &mut Dice| ("rate", number(dice.number(-6.0, 6.0)));
    let share = |dice: &mut Dice| ("amount", number(dice.number(0.0, 1.0)));
    match dice.whole(0, 5) {
        form @ (0 | 1) => motion_of_place(dice, ground, centre, form),
        2 => record("Flicker", vec![share(dice), rate(dice)]),
        3 => record(
            "Pulse",
            vec![
                share(dice),
                rate(dice),
                ("phase", number(dice.number(-3.0, 3.0))),
            ],
        ),
        4 if !is_scattered => motion_of_place(dice, ground, centre, 2),
        _ => record("HueCycle", vec![("rate", number(dice.number(-1.0, 1.0)))]),
    }
}

/// Lamp presets; the first one is used.
pub fn lamps(
    dice: &mut Dice,
    spheres: &mut Spheres,
    ground: &Ground<'_>,
    centre: [f64; 3],
) -> Term {
    let mut preset = |dice: &mut Dice, index: u32| {
        let count = *dice.pick(&[0, 1, 1, 1, 2, 3, 5]);
        let count = if dice.chance(0.04) { 52 } else { count };
        let all = (0..count)
            .map(|_| lamp(dice, spheres, ground, centre, false))
            .collect();
        let mut keys = vec![
            ("name", Term::text(format!("p{index}"))),
            ("lamps", Term::List(all)),
        ];
        if dice.chance(0.25) {
            let mut of = vec![("lamp", lamp(dice, spheres, ground, centre, true))];
            if dice.chance(0.4) {
                of.push(("colours", Term::List(vec![colour(dice), colour(dice)])));
            }
            of.push(("count", number(f64::from(dice.whole(0, 12)))));
            of.extend(matter::scattered(dice).split_off(1));
            if dice.chance(0.4) {
                of.push(("height", number(dice.number(0.0, 4.0))));
            }
            keys.push(("scatter", Term::List(vec![record("", of)])));
        }
        record("Preset", keys)
    };
    let count = *dice.pick(&[0, 1, 1, 1, 2]);
    Term::List((0..count).map(|index| preset(dice, index)).collect())
}

/// The keys `sun` and `sky`.
pub fn sky(dice: &mut Dice) -> Vec<(&'static str, Term)> {
    let radiance = |dice: &mut Dice| {
        let bright = dice.magnitude(0.05, 4.0);
        Term::vector([0; 3].map(|_| dice.number(0.0, bright)))
    };
    let mut keys = Vec::new();
    if dice.chance(0.3) {
        let towards = match direction(dice) {
            Term::Tuple(_, of) => Term::Tuple("", of),
            other => other,
        };
        keys.push((
            "sun",
            record(
                "",
                vec![("towards", towards), ("irradiance", radiance(dice))],
            ),
        ));
    }
    match dice.whole(0, 3) {
        // The default, a dim grey.
        0 => {}
        1 => keys.push(("sky", record("", vec![("zenith", Term::vector([0.0; 3]))]))),
        _ => {
            let mut of = vec![("zenith", radiance(dice))];
            if dice.chance(0.5) {
                of.push(("horizon", radiance(dice)));
            }
            if dice.chance(0.5) {
                of.push(("ground", radiance(dice)));
            }
            keys.push(("sky", record("", of)));
        }
    }
    keys
}

pub fn cameras(dice: &mut Dice, ground: &Ground<'_>, centre: [f64; 3]) -> Term {
    let camera = |dice: &mut Dice, index: u32| {
        let mut keys = vec![
            ("name", Term::text(format!("c{index}"))),
            ("position", Term::vector(place(dice, ground, centre))),
        ];
        if dice.chance(0.6) {
            // Not at the position of the camera.
            let at = place(dice, ground, centre).map(|along| super::dice::rounded(along + 0.037));
            keys.push(("look_at", Term::vector(at)));
        } else {
            keys.push(("yaw_deg", number(dice.number(-180.0, 180.0))));
            keys.push(("pitch_deg", number(dice.number(-90.0, 90.0))));
        }
        if dice.chance(0.5) {
            keys.push(("fov_deg", number(dice.number(20.0, 120.0))));
        }
        record("", keys)
    };
    let count = *dice.pick(&[0, 1, 1, 2, 3]);
    Term::List((0..count).map(|index| camera(dice, index)).collect())
}

/// Over the whole world, divided by either measure.
fn octree(dice: &mut Dice) -> Term {
    let mut keys = vec![("depth", number(f64::from(dice.whole(1, 4))))];
    let (split, most) = *dice.pick(&[("Surface", 2.0), ("Hits", 1.0)]);
    keys.push(("split", Term::Word(split)));
    if dice.chance(0.7) {
        keys.push(("divide_at", number(dice.number(0.0, most))));
    }
    if dice.chance(0.2) {
        keys.push(("source", Term::Word("true")));
    }
    record("", keys)
}

/// Volumes of all kinds: covering the world, too small, beside the world, following the camera, nested. Some give way
/// to octrees, by numbers of their own.
pub fn layouts(dice: &mut Dice, octrees: &mut Dice, ground: &Ground<'_>, centre: [f64; 3]) -> Term {
    let layout = |dice: &mut Dice, index: u32| {
        let mut keys = vec![("name", Term::text(format!("l{index}")))];
        let follow = dice.chance(0.25);
        let cascades = if dice.chance(0.25) {
            dice.whole(2, 6)
        } else {
            1
        };
        let nested = follow || cascades > 1;
        let (low, high) = if nested {
            (4, if cascades > 3 { 4 } else { 6 })
        } else {
            (1, 6)
        };
        let counts = [0; 3].map(|_| f64::from(dice.whole(low, high)));
        keys.push(("counts", Term::vector(counts)));
        // The spacing that makes the volume as wide as the world.
        let fitting = [0, 1, 2].map(|axis| 2.0 * ground.half[axis] / counts[axis]);
        let factor = *dice.pick(&[1.0, 1.0, 1.0, 0.9, 0.5, 0.2, 2.0]);
        let spacing = fitting.map(|fitting| super::dice::rounded((fitting * factor).max(0.25)));
        keys.push((
            "spacing",
            if dice.chance(0.7) {
                Term::vector(spacing)
            } else {
                number(spacing.into_iter().fold(0.25, f64::max))
            },
        ));
        if dice.chance(0.25) {
            let about = if follow { [0.0; 3] } else { centre };
            let off = *dice.pick(&[0.3, 1.0, 4.0]);
            let at = [0, 1, 2]
                .map(|axis| about[axis] + off * dice.number(-1.0, 1.0) * ground.half[axis]);
            keys.push(("centre", Term::vector(at.map(super::dice::rounded))));
        }
        if follow {
            keys.push(("follow", Term::Word("true")));
        }
        if cascades > 1 {
            keys.push(("cascades", number(f64::from(cascades))));
        }
        record("", keys)
    };
    let count = *dice.pick(&[0, 1, 1, 1, 2]);
    let layouts = (0..count).map(|index| {
        let volume = layout(dice, index);
        if octrees.chance(0.2) {
            let name = Term::text(format!("l{index}"));
            record("", vec![("name", name), ("octree", octree(octrees))])
        } else {
            volume
        }
    });
    Term::List(layouts.collect())
}
