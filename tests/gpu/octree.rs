//! An octree of probes in whole frames: it lights as a lattice as fine does, and follows edits without losing light.

use glam::{IVec3, UVec3, Vec3};
use grotto::{
    measure::picture::Picture,
    parameters::{FinalGather, ProbeParameters},
    probes::Layout as _,
    world::{
        LayoutSpec, View,
        scenery::{OctreeSpec, Split},
    },
};

use crate::support::{
    self,
    frames::{Drawn, apart, mean},
    scenes::lattice,
};

/// A room with a pillar under one lamp.
const ROOM: &str = "(
    title: \"A room with a pillar.\",
    size: (32, 32, 32),
    origin: (-16, -16, -16),
    shape: Union([
        Subtraction([Box(half: (13, 13, 13)), Box(half: (11, 11, 11))]),
        Translate(by: (4, -4, 2), of: Box(half: (2, 7, 2))),
    ]),
    materials: {\"plaster\": (a: Flat(0.7, 0.6, 0.5))},
    lamps: [(name: \"one\", lamps: [(position: (-4, 7, -4), power: 2000)])],
    cameras: [(name: \"inside\", position: (-8, 2, -9), look_at: (4, -4, 6), fov_deg: 80)],
    sky: (zenith: (0, 0, 0)),
)";

const SIZE: [u32; 2] = [48, 32];

fn octree(depth: u32, divide_at: f32) -> LayoutSpec {
    LayoutSpec {
        octree: Some(OctreeSpec {
            depth,
            divide_at,
            ..OctreeSpec::default()
        }),
        ..lattice(UVec3::splat(2), Vec3::splat(24.0), Vec3::ZERO)
    }
}

fn room(layout: &LayoutSpec) -> Drawn {
    let probes = ProbeParameters {
        rays: 64,
        final_gather: FinalGather::Off,
        ..ProbeParameters::default()
    };
    let world = support::parsed(ROOM);
    let mut drawn = Drawn::new(support::gpu(), world, layout, probes, SIZE);
    drawn.shot.view = View::Irradiance;
    drawn
}

fn lit(layout: &LayoutSpec) -> Picture {
    let mut room = room(layout);
    room.draw(50);
    room.radiance()
}

#[test]
fn it_lights_as_a_lattice_as_fine() {
    let fine = lit(&lattice(UVec3::splat(5), Vec3::splat(6.0), Vec3::ZERO));
    let coarse = lit(&lattice(UVec3::splat(2), Vec3::splat(24.0), Vec3::ZERO));
    let tree = apart(&lit(&octree(2, 0.0)), &fine);
    assert!(tree < 0.04, "{tree}");
    // The comparison sees a difference where there is one.
    let coarse = apart(&coarse, &fine);
    assert!(coarse > 2.0 * tree, "{coarse} {tree}");
}

#[test]
fn an_edit_divides_cells_and_keeps_the_light() {
    let layout = octree(3, 0.6);
    let mut room = room(&layout);
    room.draw(30);
    let (before, light) = (room.frame.field().volume().probes(), mean(&room.radiance()));
    let mut voxels = room.frame.stage.read_back(&room.gpu).expect("reads back");
    let edit = voxels.fill_box(IVec3::new(7, 7, 19), IVec3::new(12, 12, 24), 1);
    room.frame.apply(&room.gpu, &voxels, &edit).expect("fits");
    assert!(room.frame.field().volume().probes() > before);
    assert!(room.frame.field().fresh() > 0);
    room.draw(1);
    let kept = mean(&room.radiance());
    assert!((kept / light - 1.0).abs() < 0.2, "{kept} {light}");
    room.draw(1);
    assert_eq!(room.frame.field().fresh(), 0, "new for one frame");
    room.draw(50);
    // A tree of the edited world from the start.
    let mut anew = Drawn {
        frame: grotto::frame::Frame::new(
            &room.gpu,
            grotto::frame::Stage::upload(&room.gpu, &room.world, &voxels).expect("fits"),
            &layout,
            &room.probes,
            SIZE,
        )
        .expect("fits"),
        gpu: support::gpu(),
        world: support::parsed(ROOM),
        lights: room.lights.clone(),
        probes: room.probes.clone(),
        shot: room.shot.clone(),
    };
    anew.gpu = room.gpu.clone();
    anew.draw(50);
    assert_eq!(
        anew.frame.field().volume().probes(),
        room.frame.field().volume().probes()
    );
    let off = apart(&room.radiance(), &anew.radiance());
    assert!(off < 0.05, "{off}");
}

#[test]
fn air_alone_has_a_picture_too() {
    let air = ROOM.replace(
        "Union([",
        "Intersection([Translate(by: (90, 0, 0), of: Box(half: (1, 1, 1))), ",
    );
    let probes = ProbeParameters::default();
    let world = support::parsed(&air);
    let mut drawn = Drawn::new(support::gpu(), world, &octree(3, 0.0), probes, SIZE);
    assert_eq!(drawn.frame.field().volume().probes(), 8);
    assert!(drawn.frame.field().volume().slots() >= 8);
    drawn.draw(2);
    assert!(mean(&drawn.radiance()) == 0.0);
}

/// The published way: probes in the middles of leaves, all of which a gather visits.
fn published(depth: u32) -> LayoutSpec {
    LayoutSpec {
        octree: Some(OctreeSpec {
            depth,
            split: Split::Hits,
            divide_at: 0.5,
            source: true,
            ..OctreeSpec::default()
        }),
        ..lattice(UVec3::splat(2), Vec3::splat(32.0), Vec3::ZERO)
    }
}

#[test]
fn the_published_way_lights_the_room_and_follows_edits() {
    let fine = lit(&lattice(UVec3::splat(5), Vec3::splat(6.0), Vec3::ZERO));
    let layout = published(2);
    let mut room = room(&layout);
    room.draw(30);
    let off = apart(&room.radiance(), &fine);
    assert!(off < 0.5, "{off}");
    let light = mean(&room.radiance()) / mean(&fine);
    assert!((0.7..1.4).contains(&light), "{light}");
    let before = room.frame.field().volume().probes();
    let mut voxels = room.frame.stage.read_back(&room.gpu).expect("reads back");
    let edit = voxels.fill_box(IVec3::new(7, 7, 19), IVec3::new(12, 12, 24), 1);
    room.frame.apply(&room.gpu, &voxels, &edit).expect("fits");
    assert_ne!(room.frame.field().volume().probes(), before);
    room.draw(30);
    let stage = grotto::frame::Stage::upload(&room.gpu, &room.world, &voxels).expect("fits");
    let frame = grotto::frame::Frame::new(&room.gpu, stage, &layout, &room.probes, SIZE);
    let edited = std::mem::replace(&mut room.frame, frame.expect("fits"));
    let followed = edited.read_radiance(&room.gpu).expect("reads back");
    room.draw(30);
    let off = apart(&followed, &room.radiance());
    assert!(off < 0.05, "{off}");
}

/// The published gather asks each probe by a ray, so that no light passes a wall.
#[test]
fn the_published_way_leaks_nothing_through_walls() {
    const WALL: &str = "Box(half: (1, 12, 12)), ";
    let walled = ROOM.replace("Union([", &format!("Union([{WALL}")).replace(
        "(-8, 2, -9), look_at: (4, -4, 6)",
        "(8, 2, -9), look_at: (5, -4, 9)",
    );
    assert!(walled.contains(WALL) && walled.contains("(8, 2, -9)"));
    let dark = |gpu: grotto::gpu::Gpu| {
        let probes = ProbeParameters {
            rays: 64,
            final_gather: FinalGather::Off,
            ..ProbeParameters::default()
        };
        let world = support::parsed(&walled);
        let mut drawn = Drawn::new(gpu, world, &published(2), probes, SIZE);
        drawn.shot.view = View::Irradiance;
        drawn.draw(20);
        mean(&drawn.radiance())
    };
    assert_eq!(dark(support::gpu()), 0.0);
    let test = "facing <= 0.0 || !sees(from_gs, place.position_ws - grid_info.origin_ws)";
    let blind = [("probes/gather.wesl", test, "facing <= 0.0")];
    let leaks = dark(support::with_faults(&support::gpu(), &blind));
    assert!(leaks > 0.01, "without the rays there is light: {leaks}");
}
