//! Lamps that a player places: their light is that of a lamp of the world file, from the next frame on.

use glam::IVec3;
use grotto::{
    lights::{LampKinds, Lights, table::KNOWN_LAMPS},
    parameters::ProbeParameters,
    world::{
        PlacedLamp, View,
        placed::{self, LampBlock, LampColour, LampForm, LampMotion},
    },
};

use crate::support::{
    self,
    frames::{Drawn, apart, mean},
};

/// A sealed dark room with a pillar. Its floor's upper faces lie at y = 0.
const ROOM: &str = "(
    title: \"A dark room.\",
    size: (32, 20, 32),
    origin: (-16, -4, -16),
    shape: Union([
        Subtraction([
            Translate(by: (0, 5, 0), of: Box(half: (14, 7, 14))),
            Translate(by: (0, 5, 0), of: Box(half: (12, 5, 12))),
        ]),
        Translate(by: (2, 5, 0), of: Box(half: (1, 5, 2))),
    ]),
    materials: {\"plaster\": (a: Flat(0.6, 0.6, 0.6))},
    sky: (zenith: (0, 0, 0)),
    LAMPS
    cameras: [(name: \"down\", position: (8, 8, 10), look_at: (-3, 1, -2), fov_deg: 75)],
    layouts: [(name: \"fine\", counts: (6, 3, 6), spacing: 5, centre: (0.5, 5.5, 0.5))],
)";

const SIZE: [u32; 2] = [80, 60];

/// The room under lamps of its own, as RON.
fn room(lamps: &str) -> Drawn {
    let lamps = format!("lamps: [(name: \"own\", lamps: [{lamps}])],");
    let world = support::parsed(&ROOM.replace("LAMPS", &lamps));
    let layout = world.layouts[0].clone();
    let probes = ProbeParameters {
        rays: 48,
        warmup_frames: 8,
        face_pixels: 0.5,
        ..Default::default()
    };
    Drawn::new(support::gpu(), world, &layout, probes, SIZE)
}

/// As RON.
fn of_file(lamp: &PlacedLamp) -> String {
    let lamp = lamp.lamp(1.0);
    let (at, colour) = (lamp.position, lamp.colour);
    let kind = match lamp.kind {
        grotto::world::LampKind::Spot {
            direction: to,
            inner_deg,
            outer_deg,
        } => format!(
            "kind: Spot(direction: ({}, {}, {}), inner_deg: {inner_deg}, outer_deg: {outer_deg}), ",
            to.x, to.y, to.z
        ),
        _ => String::new(),
    };
    format!(
        "({kind}position: ({}, {}, {}), colour: ({}, {}, {}), power: {}, radius: {}, \
         soft_radius: {}),",
        at.x, at.y, at.z, colour.x, colour.y, colour.z, lamp.power, lamp.radius, lamp.soft_radius
    )
}

fn lamp(voxel: [i32; 3], form: LampForm) -> PlacedLamp {
    PlacedLamp {
        voxel: IVec3::from(voxel),
        block: LampBlock {
            form,
            colour: LampColour::Amber,
            power: 400.0,
            radius: 0.25,
            soft_radius: 0.0,
            motion: LampMotion::Still,
        },
        towards: IVec3::NEG_Y,
        is_on: true,
    }
}

/// Sets the lamps that are placed from the next frame on.
fn place(drawn: &mut Drawn, lamps: &[PlacedLamp]) {
    drawn.world.restored.lamps.clear();
    for lamp in lamps {
        placed::put(&mut drawn.world.restored.lamps, lamp.voxel, Some(*lamp));
    }
    drawn.lights = Lights::at(&drawn.world, &drawn.world.lamp_presets[0], 0.0);
    let kinds = LampKinds::of(&drawn.lights);
    let allowed = drawn.frame.allow_lamps(&drawn.gpu, kinds);
    allowed.expect("the passes fit");
}

#[test]
fn the_next_frame_has_the_direct_light_of_a_lamp_of_the_world_file() {
    for lamps in [
        vec![lamp([-6, 6, 3], LampForm::Point)],
        vec![
            lamp([-6, 9, 3], LampForm::Spot),
            lamp([6, 0, 4], LampForm::Point),
        ],
    ] {
        let mut drawn = room("");
        drawn.shot.view = View::Direct;
        drawn.draw(20);
        assert_eq!(mean(&drawn.radiance()), 0.0, "the room is dark");
        place(&mut drawn, &lamps);
        drawn.draw(1);
        let mut expected = room(&lamps.iter().map(of_file).collect::<String>());
        expected.shot.view = View::Direct;
        expected.draw(1);
        let expected = expected.radiance();
        assert!(mean(&expected) > 0.01, "{}", mean(&expected));
        assert_eq!(drawn.radiance().rgb, expected.rgb, "to the bit");
        // And once it is known which faces see the lamps.
        drawn.draw(12);
        let different = apart(&drawn.radiance(), &expected);
        assert!(different < 1e-4, "{different}");
    }
}

/// The room has points alone until then, so its kernels know no spheres.
#[test]
fn a_sphere_is_placed_into_a_world_of_points_and_has_its_soft_shadows() {
    let mut sphere = lamp([-6, 6, 3], LampForm::Point);
    sphere.block.soft_radius = 1.25;
    let mut drawn = room("");
    drawn.shot.view = View::Direct;
    place(&mut drawn, &[lamp([6, 0, 4], LampForm::Point)]);
    drawn.draw(4);
    assert!(!drawn.frame.stage.lamp_kinds.spheres);
    place(&mut drawn, &[]);
    drawn.draw(1);
    place(&mut drawn, &[sphere]);
    assert!(drawn.frame.stage.lamp_kinds.spheres);
    let seen = drawn.path_traced(View::Direct, 256);
    drawn.draw(12);
    let different = apart(&drawn.radiance(), &seen);
    // On a software device 0.0044, most of it noise.
    assert!(different < 0.006, "{different}");
    // Sharp shadows are farther away than soft ones, 0.0064: the test could fail.
    let mut sharp = room(&of_file(&lamp([-6, 6, 3], LampForm::Point)));
    sharp.shot.view = View::Direct;
    sharp.draw(12);
    let sharp = apart(&sharp.radiance(), &seen);
    assert!(sharp > 1.25 * different, "{sharp} and {different}");
}

/// The first lamp of a dark room is a new lamp: what faces knew about one that was there before does not hold.
#[test]
fn a_lamp_in_the_place_of_one_that_was_dug_has_shadows_of_its_own() {
    let mut drawn = room("");
    drawn.shot.view = View::Direct;
    place(&mut drawn, &[lamp([-6, 6, 3], LampForm::Point)]);
    drawn.draw(12);
    place(&mut drawn, &[]);
    drawn.draw(1);
    assert_eq!(mean(&drawn.radiance()), 0.0);
    let other = lamp([7, 2, 0], LampForm::Point);
    place(&mut drawn, &[other]);
    let mut expected = room(&of_file(&other));
    expected.shot.view = View::Direct;
    expected.draw(1);
    for frame in 0..8 {
        drawn.draw(1);
        let different = apart(&drawn.radiance(), &expected.radiance());
        assert!(different < 1e-4, "frame {frame}: {different}");
    }
}

#[test]
fn indirect_light_follows_a_lamp_that_is_placed_and_one_that_is_switched_off() {
    let lamp = lamp([-6, 6, 3], LampForm::Point);
    let mut drawn = room("");
    drawn.shot.view = View::Indirect;
    drawn.draw(40);
    assert_eq!(mean(&drawn.radiance()), 0.0, "the room is dark");
    let mut expected = room(&of_file(&lamp));
    expected.shot.view = View::Indirect;
    expected.draw(100);
    let settled = expected.radiance();
    place(&mut drawn, &[lamp]);
    drawn.draw(12);
    let early = mean(&drawn.radiance()) / mean(&settled);
    assert!((early - 1.0).abs() < 0.1, "{early} after 12 frames");
    drawn.draw(88);
    let late = mean(&drawn.radiance()) / mean(&settled);
    assert!((late - 1.0).abs() < 0.01, "{late} after 100 frames");
    let different = apart(&drawn.radiance(), &settled);
    assert!(different < 0.03, "{different}");

    let off = PlacedLamp {
        is_on: false,
        ..lamp
    };
    place(&mut drawn, &[off]);
    assert_eq!(drawn.lights.lamps.len(), 1, "a switch moves no other lamp");
    drawn.draw(1);
    assert_eq!(mean(&drawn.radiance()), 0.0, "it was the only light");
    place(&mut drawn, &[lamp]);
    drawn.draw(1);
    let back = mean(&drawn.radiance()) / mean(&settled);
    assert!((back - 1.0).abs() < 0.01, "{back} in the first frame");
}

#[test]
fn a_hundred_lamps_placed_at_once_light_the_next_frame() {
    // No two in one voxel; some in the pillar.
    let at = |number: i32| {
        let (x, z) = (number % 10, number / 10);
        [2 * x - 10, 1 + (3 * number) % 8, 2 * z - 10]
    };
    let lamps: Vec<PlacedLamp> = (0..100)
        .map(|number| lamp(at(number), LampForm::Point))
        .collect();
    let mut drawn = room("");
    drawn.shot.view = View::Direct;
    drawn.draw(4);
    assert!(!drawn.frame.stage.lamp_kinds.lists);
    place(&mut drawn, &lamps);
    assert!(drawn.frame.stage.lamp_kinds.lists);
    let count = drawn.lights.lamps.len();
    assert!(count == 100 && count > KNOWN_LAMPS as usize, "{count}");
    let mut expected = room(&lamps.iter().map(of_file).collect::<String>());
    expected.shot.view = View::Direct;
    drawn.draw(1);
    expected.draw(1);
    // What is not in the list of a cell comes with the light of faces, which follows.
    let first = mean(&drawn.radiance()) / mean(&expected.radiance());
    assert!((0.95..1.001).contains(&first), "{first}");
    for drawn in [&mut drawn, &mut expected] {
        drawn.shot.view = View::Full;
        // One room comes from below and one from above: 0.973 after 40 frames, 0.986 after 60, 0.9992 after 100.
        drawn.draw(100);
    }
    let settled = mean(&drawn.radiance()) / mean(&expected.radiance());
    assert!((settled - 1.0).abs() < 0.01, "{settled}");
}
