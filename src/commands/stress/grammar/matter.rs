//! Materials, rules and features.

use super::{
    dice::Dice,
    shape::{self, Ground},
    term::Term,
};

fn record(name: &'static str, keys: Vec<(&'static str, Term)>) -> Term {
    Term::Record(name, keys)
}

fn number(value: f64) -> Term {
    Term::Number(value)
}

fn count(dice: &mut Dice, low: u32, high: u32) -> Term {
    number(f64::from(dice.whole(low, high)))
}

/// Albedo: from black to white, mostly in between.
fn albedo(dice: &mut Dice) -> Term {
    let most = match dice.whole(0, 19) {
        0 => return Term::vector([0.0; 3]),
        // Light in albedo near 1 bounces so often that it does not settle: known, and rare.
        1 => return Term::vector([*dice.pick(&[0.95, 1.0]); 3]),
        2..=4 => 0.2,
        _ => 0.85,
    };
    Term::vector([0; 3].map(|_| dice.number(0.0, most)))
}

fn parts(vector: Term) -> Vec<Term> {
    match vector {
        Term::Tuple(_, of) => of,
        other => vec![other],
    }
}

fn colour(dice: &mut Dice) -> Term {
    match dice.whole(0, 5) {
        0 => Term::Tuple("Hash", vec![albedo(dice), albedo(dice)]),
        1 => {
            let mut tops: Vec<f64> = (0..dice.whole(1, 3))
                .map(|_| dice.number(-16.0, 16.0))
                .collect();
            tops.sort_by(f64::total_cmp);
            tops.dedup();
            let stops = tops.into_iter();
            let stops = stops
                .map(|top| Term::Tuple("", vec![number(top), albedo(dice)]))
                .collect();
            record(
                "Bands",
                vec![("below", Term::List(stops)), ("above", albedo(dice))],
            )
        }
        2 => {
            let from = dice.number(-16.0, 8.0);
            let to = super::dice::rounded(from + dice.number(0.0, 12.0));
            record(
                "DitherX",
                vec![
                    ("from", number(from)),
                    ("to", number(to)),
                    ("low", albedo(dice)),
                    ("high", albedo(dice)),
                ],
            )
        }
        _ => Term::Tuple("Flat", parts(albedo(dice))),
    }
}

fn pattern(dice: &mut Dice) -> Term {
    match dice.whole(0, 8) {
        0 => Term::Word("Plain"),
        1 => record(
            "Stripes",
            vec![
                ("pitch", number(dice.magnitude(0.02, 4.0))),
                ("width", number(dice.number(0.0, 1.0))),
            ],
        ),
        2 => record(
            "Dots",
            vec![
                ("radius", number(dice.number(0.0, 0.5))),
                ("pitch", number(dice.magnitude(0.02, 4.0))),
                ("angle_deg", number(dice.number(-180.0, 180.0))),
            ],
        ),
        3 => record("Checker", vec![("squares", count(dice, 1, 8))]),
        4 => record(
            "Bricks",
            vec![
                ("rows", count(dice, 1, 8)),
                ("joint", number(dice.number(0.0, 0.3))),
            ],
        ),
        5 => record(
            "Worley",
            vec![
                ("cells", count(dice, 1, 6)),
                ("radius", number(dice.number(0.0, 0.6))),
            ],
        ),
        6 => record(
            "Fbm",
            vec![("cells", count(dice, 1, 6)), ("octaves", count(dice, 1, 4))],
        ),
        7 => record(
            "StripesFbm",
            vec![("cells", count(dice, 1, 6)), ("octaves", count(dice, 1, 4))],
        ),
        _ => record("Radial", vec![("rings", count(dice, 1, 6))]),
    }
}

/// `{"m0": (a: …), …}` and the names of the materials.
pub fn materials(dice: &mut Dice) -> (Term, Vec<String>) {
    let names: Vec<String> = (0..dice.whole(1, 5))
        .map(|index| format!("m{index}"))
        .collect();
    let material = |name: &String| {
        let mut keys = vec![("a", colour(dice))];
        if dice.chance(0.4) {
            keys.push(("b", colour(dice)));
        }
        if dice.chance(0.4) {
            keys.push(("pattern", pattern(dice)));
        }
        if dice.chance(0.2) {
            let bright = dice.magnitude(0.05, 20.0);
            let emission = [0; 3].map(|_| dice.number(0.0, bright));
            keys.push(("emission", Term::vector(emission)));
        }
        (name.clone(), record("", keys))
    };
    let all = names.iter().map(material).collect();
    (Term::Map(all), names)
}

pub fn rules(dice: &mut Dice, ground: &Ground<'_>, centre: [f64; 3], materials: &[String]) -> Term {
    let rule = |dice: &mut Dice| {
        let mut keys = vec![("material", Term::text(dice.pick(materials)))];
        if dice.chance(0.85) {
            keys.push(("when", condition(dice, ground, centre, 2)));
        }
        record("", keys)
    };
    Term::List((0..dice.whole(0, 4)).map(|_| rule(dice)).collect())
}

fn condition(dice: &mut Dice, ground: &Ground<'_>, centre: [f64; 3], depth: u32) -> Term {
    let half = ground.half;
    let height = |dice: &mut Dice| number(dice.number(centre[1] - half[1], centre[1] + half[1]));
    let tuple = |name, of| Term::Tuple(name, vec![of]);
    match dice.whole(0, if depth == 0 { 7 } else { 10 }) {
        0 => tuple("Below", height(dice)),
        1 => tuple("Above", height(dice)),
        2 => {
            let corner = |dice: &mut Dice, sign: f64| {
                let at = [0, 1, 2].map(|axis| centre[axis] + sign * dice.number(0.0, half[axis]));
                Term::vector(at.map(super::dice::rounded))
            };
            record(
                "InBox",
                vec![("min", corner(dice, -1.0)), ("max", corner(dice, 1.0))],
            )
        }
        3 => tuple("Inside", shape::of_rule(dice, ground, centre)),
        4 if !ground.noises.is_empty() => record(
            "NoiseBelow",
            vec![
                ("noise", Term::text(dice.pick(ground.noises))),
                ("value", number(dice.number(-0.5, 0.5))),
            ],
        ),
        4 | 5 => tuple("ShallowerThan", number(dice.number(0.0, 4.0))),
        6 => Term::Word("FacesUp"),
        7 => Term::Word("FacesDown"),
        form @ 8..=9 => {
            let count = dice.whole(1, 3);
            let of = (0..count)
                .map(|_| condition(dice, ground, centre, depth - 1))
                .collect();
            tuple(if form == 8 { "All" } else { "Any" }, Term::List(of))
        }
        _ => tuple("Not", condition(dice, ground, centre, depth - 1)),
    }
}

/// `(kinds: {…}, place: […])`
pub fn features(
    dice: &mut Dice,
    ground: &Ground<'_>,
    centre: [f64; 3],
    materials: &[String],
) -> Term {
    let kinds: Vec<String> = (0..dice.whole(1, 2))
        .map(|index| format!("k{index}"))
        .collect();
    let part = |dice: &mut Dice| {
        let min = [0; 3].map(|_| f64::from(dice.whole(0, 4)) - 2.0);
        let max = min.map(|low| low + f64::from(dice.whole(0, 3)));
        let mut keys = vec![
            ("min", Term::vector(min)),
            ("max", Term::vector(max)),
            ("material", Term::text(dice.pick(materials))),
        ];
        if dice.chance(0.3) {
            keys.push(("without_corners", Term::Word("true")));
        }
        record("", keys)
    };
    let kind = |name: &String| {
        let of = (0..dice.whole(1, 3)).map(|_| part(dice)).collect();
        (name.clone(), Term::List(of))
    };
    let all = kinds.iter().map(kind).collect();
    let place = |dice: &mut Dice| {
        if dice.chance(0.5) {
            let at = |dice: &mut Dice| {
                let at = [0, 1, 2].map(|axis| {
                    (centre[axis] + dice.number(-ground.half[axis], ground.half[axis])).floor()
                });
                Term::vector(at)
            };
            let places = (0..dice.whole(1, 5)).map(|_| at(dice)).collect();
            return record(
                "At",
                vec![
                    ("kind", Term::text(dice.pick(&kinds))),
                    ("places", Term::List(places)),
                ],
            );
        }
        let mut keys = vec![("kinds", Term::List(vec![Term::text(dice.pick(&kinds))]))];
        keys.extend(scattered(dice));
        record("Scatter", keys)
    };
    let place = (0..dice.whole(1, 3)).map(|_| place(dice)).collect();
    record(
        "",
        vec![("kinds", Term::Map(all)), ("place", Term::List(place))],
    )
}

/// Keys that scattered features and lamps share.
pub fn scattered(dice: &mut Dice) -> Vec<(&'static str, Term)> {
    let mut keys = vec![if dice.chance(0.5) {
        ("count", count(dice, 0, 12))
    } else {
        ("density", number(dice.number(0.0, 20.0)))
    }];
    if dice.chance(0.4) {
        keys.push(("on", Term::Word("Ceiling")));
    }
    if dice.chance(0.4) {
        keys.push(("clearance", count(dice, 0, 4)));
    }
    if dice.chance(0.4) {
        keys.push(("spacing", number(dice.number(0.0, 6.0))));
    }
    if dice.chance(0.3) {
        keys.push(("seed", count(dice, 0, 999)));
    }
    keys
}
