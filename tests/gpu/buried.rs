//! Lamps that glide into stone and out of it.

use grotto::{parameters::ProbeParameters, world::World};

use crate::support::{
    self,
    frames::{Drawn, mean},
};

/// A closed room beside thick stone.
const ROOM: &str = "(
    title: \"A room beside stone.\",
    size: (32, 16, 16),
    shape: Subtraction([Box(half: (40, 40, 40)), Translate(by: (8, 8, 8), of: Box(half: (6, 6, 6)))]),
    materials: {\"grey\": (a: Flat(0.6, 0.6, 0.6))},
    rules: [(material: \"grey\")],
    sky: (zenith: (0, 0, 0)),
    lamps: [(name: \"two\", lamps: [(position: (10, 8.5, 8.5), power: 300), (position: (4, 4, 12), power: 3)])],
    cameras: [(name: \"corner\", position: (2.5, 10, 2.5), look_at: (12, 6, 11), fov_deg: 80)],
    layouts: [(name: \"lattice\", counts: (8, 4, 4), spacing: 4)],
)";
/// Voxels that the lamp glides in a frame.
const STEP: f64 = 0.1;
/// Where the stone begins.
const WALL: f64 = 14.0;

/// What ends the lamp's light.
#[derive(Clone, Copy, PartialEq)]
enum End {
    Stone,
    Switch,
}

/// The mean of the picture 6, 12 and 18 frames after the light of the first of so many lamps has ended, over the mean before.
fn left(lamps: usize, end: End) -> [f64; 3] {
    let mut world: World = support::parsed(ROOM);
    world.lamp_presets[0].lamps.truncate(lamps);
    let layout = world.layouts[0].clone();
    let probes = ProbeParameters::default();
    let mut drawn = Drawn::new(support::gpu(), world, &layout, probes, [32, 24]);
    drawn.draw(60);
    let mut glide = |frames: u32| {
        for _ in 0..frames {
            drawn.lights.lamps[0].position_ws.x += STEP;
            if end == End::Switch && drawn.lights.lamps[0].position_ws.x > WALL {
                drawn.lights.lamps[0].intensity *= 0.0;
            }
            drawn.draw(1);
        }
        mean(&drawn.radiance())
    };
    let lit = glide(39);
    [6; 3].map(|frames| glide(frames) / lit)
}

/// Light that a switch ends is a great change of light at once. If it were none here, 0.21 would be left after 6 frames, 0.05 after 12.
#[test]
fn light_goes_with_a_lamp_that_glides_into_stone_as_with_a_switch() {
    let [stone, switch] = [End::Stone, End::Switch].map(|end| left(2, end));
    println!("{stone:.4?} in stone, {switch:.4?} if switched off");
    for (stone, switch) in stone.into_iter().zip(switch) {
        assert!((stone - switch).abs() < 0.01, "{stone} {switch}");
    }
}

#[test]
fn a_lone_lamp_in_stone_leaves_the_world_black() {
    assert_eq!(left(1, End::Stone), [0.0; 3]);
}
