//! More lamps than a list of a cell holds: nothing that they light is lost or counted twice.

use glam::DVec3;
use grotto::{
    lights::{
        LampShape, LampState, lists,
        table::{KNOWN_LAMPS, LISTED},
    },
    parameters::FinalGather,
    world::View,
};

use crate::{
    lamps::{by_rays, room},
    support::frames::{apart, mean},
};

fn lamp(position_ws: DVec3, watts: f64) -> LampState {
    LampState {
        shape: LampShape::Point,
        position_ws,
        direction_ws: DVec3::ZERO,
        intensity: DVec3::splat(watts / (4.0 * std::f64::consts::PI)),
        radius: 0.5,
        soft_radius: 0.0,
        rhythm: None,
    }
}

/// Places on a lattice all over the room.
fn place(number: usize) -> DVec3 {
    let along = |step: f64| (0.5 + number as f64 * step).fract();
    let (x, y, z) = (
        along(0.8191725134),
        along(0.6710436067),
        along(0.5497004779),
    );
    DVec3::new(30.0 * x - 15.0, 8.0 * y + 1.0, 30.0 * z - 15.0)
}

#[test]
fn the_room_has_several_cells() {
    let size = room(0, FinalGather::On).frame.stage.voxels.size;
    assert!(lists::cells(size).number() > 8);
}

#[test]
fn lamps_without_power_change_nothing() {
    let mut drawn = room(0, FinalGather::On);
    let lit = drawn.lights.lamps.clone();
    let dark = (0..500).map(|number| lamp(place(number), 0.0));
    // Before and behind the lamps that are lit.
    drawn.lights.lamps = dark.clone().chain(lit.clone()).chain(dark).collect();
    drawn.draw(10);
    let kept = drawn.radiance();
    drawn.lights.lamps = lit;
    let different = apart(&kept, &by_rays(&drawn, None));
    assert!(different < 1e-4, "{different}");
}

#[test]
fn lists_follow_lamps_that_move_in_every_frame() {
    let mut drawn = room(0, FinalGather::On);
    // All lamps that are ever lit fit into a list: they rank by the greatest power that they have had.
    let lit = LISTED as usize - 6;
    for step in 0..6 {
        let lamps = (0..2 * KNOWN_LAMPS as usize).map(|number| {
            // Those that are lit change, one in each frame, and a third of the lamps move.
            let moved = if number % 3 == 0 { step } else { 0 };
            let is_lit = (step..step + lit).contains(&number);
            lamp(place(number + 7 * moved), if is_lit { 20.0 } else { 0.0 })
        });
        drawn.lights.lamps = lamps.collect();
        drawn.draw(1);
        let kept = drawn.radiance();
        assert!(mean(&kept) > 0.02, "{}", mean(&kept));
        let different = apart(&kept, &by_rays(&drawn, None));
        assert!(different < 1e-4, "step {step}: {different}");
    }
}

#[test]
fn a_lamp_in_many_pieces_gives_the_light_of_the_whole() {
    let mut whole = room(1, FinalGather::On);
    let mut pieces = room(1, FinalGather::On);
    let only = whole.lights.lamps[0];
    let count = 4 * KNOWN_LAMPS as usize;
    let piece = LampState {
        intensity: only.intensity / count as f64,
        ..only
    };
    pieces.lights.lamps = vec![piece; count];
    for drawn in [&mut whole, &mut pieces] {
        drawn.shot.view = View::Full;
        drawn.draw(60);
    }
    let (whole, pieces) = (whole.radiance(), pieces.radiance());
    let ratio = mean(&pieces) / mean(&whole);
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    // Most of the light comes by samples, which show shadows only as sharp as a quadrant of a face.
    let different = apart(&pieces, &whole);
    assert!(different < 0.1, "{different}");
}
