//! Bodies: small shapes that move and turn, anywhere in the world and beyond it.

use super::{
    dice::Dice,
    scenery::{motion_of_place, place},
    shape::{self, Ground},
    term::Term,
};

fn record(name: &'static str, keys: Vec<(&'static str, Term)>) -> Term {
    Term::Record(name, keys)
}

fn number(value: f64) -> Term {
    Term::Number(value)
}

/// Share of the worlds that have bodies: most worlds are to be judged without what a body may hide.
const SHARE: f64 = 0.25;

/// The bodies of a world; most worlds have none.
pub fn bodies(
    dice: &mut Dice,
    ground: &Ground<'_>,
    centre: [f64; 3],
    materials: &[String],
) -> Option<Term> {
    if !dice.chance(SHARE) {
        return None;
    }
    let count = *dice.pick(&[1, 1, 2, 4, 12]);
    let mut before = None;
    let all = (0..count).map(|index| {
        let mut at = place(dice, ground, centre);
        // One in another.
        if let Some(other) = before
            && dice.chance(0.2)
        {
            at = other;
        }
        before = Some(at);
        let mut keys = vec![
            ("name", Term::text(format!("b{index}"))),
            ("model", model(dice, ground, index, materials)),
            ("position", Term::vector(at)),
        ];
        if dice.chance(0.5) {
            keys.push(("degrees", dice.within([180.0; 3])));
        }
        if dice.chance(0.3) {
            keys.push(("pivot", dice.within([4.0; 3])));
        }
        let motions = *dice.pick(&[0, 1, 1, 1, 2]);
        let motions = (0..motions).map(|_| motion(dice, ground, centre));
        keys.push(("motion", Term::List(motions.collect())));
        record("", keys)
    });
    Some(Term::List(all.collect()))
}

fn model(dice: &mut Dice, ground: &Ground<'_>, index: u32, materials: &[String]) -> Term {
    if index > 0 && dice.chance(0.3) {
        let other = dice.whole(0, index - 1);
        return record("Like", vec![("body", Term::text(format!("b{other}")))]);
    }
    let size = match dice.whole(0, 5) {
        // One voxel, plates and bars.
        0 => [1; 3],
        1 => [dice.whole(2, 9), 1, dice.whole(2, 9)],
        2 => [1, dice.whole(4, 20), dice.whole(1, 2)],
        _ => [0; 3].map(|_| dice.whole(2, 12)),
    };
    let size = size.map(f64::from);
    let mut keys = vec![
        ("size", Term::vector(size)),
        (
            "shape",
            shape::of_body(dice, ground, size.map(|edge| edge / 2.0)),
        ),
    ];
    if dice.chance(0.7) {
        keys.push(("material", Term::text(dice.pick(materials))));
    }
    record("Shape", keys)
}

fn motion(dice: &mut Dice, ground: &Ground<'_>, centre: [f64; 3]) -> Term {
    let axis = |dice: &mut Dice| {
        let axis = *dice.pick(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let slant = if dice.chance(0.5) { 0.6 } else { 0.0 };
        let axis = axis.map(|length| super::dice::rounded(length + slant * dice.unit()));
        ("axis", Term::vector(axis))
    };
    let degrees = |dice: &mut Dice| ("degrees", number(dice.number(-400.0, 400.0)));
    let cycle = |dice: &mut Dice| {
        let period_s = dice.magnitude(0.3, 20.0);
        let rest_s = super::dice::rounded(dice.number(0.0, 0.45) * period_s);
        vec![
            ("period_s", number(period_s)),
            ("rest_s", number(rest_s)),
            ("phase_s", number(dice.number(-9.0, 9.0))),
        ]
    };
    match dice.whole(0, 7) {
        0 => {
            let rate = number(dice.number(-6.0, 6.0));
            record("Turn", vec![axis(dice), ("rate", rate)])
        }
        1 => {
            let start_s = dice.number(-2.0, 5.0);
            let end_s = super::dice::rounded(start_s + dice.magnitude(0.01, 5.0));
            let mut keys = vec![axis(dice), degrees(dice)];
            keys.extend([("start_s", number(start_s)), ("end_s", number(end_s))]);
            if dice.chance(0.5) {
                let ease = *dice.pick(&["Smooth", "Linear"]);
                keys.push(("ease", Term::Word(ease)));
            }
            record("TurnBetween", keys)
        }
        2 => {
            let mut keys = vec![axis(dice), degrees(dice)];
            keys.extend(cycle(dice));
            record("Swing", keys)
        }
        3 => {
            let mut keys = vec![("by", dice.within([12.0; 3]))];
            keys.extend(cycle(dice));
            record("Lift", keys)
        }
        // Farther in each frame than bodies are long, or round more than once.
        4 if dice.chance(0.5) => {
            let most = if dice.chance(0.5) { 30.0 } else { 1000.0 };
            let rate = number(dice.number(-most, most));
            match dice.chance(0.5) {
                true => record("Turn", vec![axis(dice), ("rate", rate)]),
                false => record(
                    "Bob",
                    vec![("amplitude", dice.within([30.0; 3])), ("rate", rate)],
                ),
            }
        }
        4 => {
            let points = [0; 2].map(|_| Term::vector(place(dice, ground, centre)));
            let speed = number(dice.magnitude(200.0, 5000.0));
            record(
                "Path",
                vec![("points", Term::List(points.to_vec())), ("speed", speed)],
            )
        }
        form => motion_of_place(dice, ground, centre, form),
    }
}
