//! Bodies in the path tracer: as voxels of the grid where they coincide with them, and by closed forms where they do not.

use std::f32::consts::FRAC_PI_2;
use std::sync::atomic::AtomicBool;

use glam::{DVec3, IVec3, Quat, UVec3, Vec3};
use grotto::measure::metrics::absolute_sum;
use grotto::measure::statistics::MeanEstimate;
use grotto::reference::{FilmOptions, PosedBodies, RenderOptions, render};
use grotto::world::bodies::{Bodies, Body, BodyModel, Pose};
use grotto::world::file::{Overrides, parse};
use grotto::world::generate::generate;
use grotto::world::{Camera, Colour, View};

use super::stage::{
    Cpu, Stage, Tracer as _, flat, options, point_lamp, square_camera, uniform_sky,
};

/// A body whose pivot is at `pivot` of the model.
fn body(size: UVec3, pivot: Vec3, at: Pose, material: impl Fn(UVec3) -> u8) -> (BodyModel, Body) {
    let voxels = 0..size.element_product();
    let voxels = voxels.map(|i| UVec3::new(i % size.x, i / size.x % size.y, i / (size.x * size.y)));
    let model = BodyModel {
        size,
        materials: voxels.map(material).collect(),
    };
    let body = Body {
        name: "body".into(),
        model: 0,
        pivot,
        rest: at,
        motion: Vec::new(),
        put_by: Default::default(),
    };
    (model, body)
}

fn posed(all: Vec<(BodyModel, Body)>, origin: IVec3) -> PosedBodies {
    let mut bodies = Bodies::default();
    for (model, body) in all {
        let model = (model, bodies.models.len());
        bodies.models.push(model.0);
        bodies.bodies.push(Body {
            model: model.1,
            ..body
        });
    }
    PosedBodies::new(&bodies, origin, &bodies.poses(0.0))
}

/// A block with a step, a hole and a glowing corner.
fn block(voxel: IVec3) -> u8 {
    let [x, y, z] = voxel.to_array();
    match (x, y, z) {
        (1, 1, _) => 0,
        (_, 3.., 0) => 0,
        (3, 0, 2) => 3,
        _ => 2,
    }
}
const BLOCK: UVec3 = UVec3::new(4, 5, 3);

/// A lit room of 14³ voxels with a hole in its roof. `solid` says what stands in it.
fn room(origin: IVec3, solid: impl Fn(IVec3) -> u8 + Sync) -> Stage {
    let mut list = vec![flat(0.7, 0.0), flat(0.3, 0.0), flat(0.5, 4.0)];
    list[1].a = Colour::Hash(Vec3::splat(0.1), Vec3::splat(0.9));
    let mut stage = Stage::of(UVec3::splat(16), list, |voxel| {
        let wall = voxel.cmpeq(IVec3::ZERO).any() || voxel.cmpeq(IVec3::splat(15)).any();
        let hole = voxel.y == 15 && voxel.x > 11;
        match u8::from(wall && !hole) {
            0 => solid(voxel),
            wall => wall,
        }
    });
    stage.origin = origin;
    let lamps = [Vec3::new(4.0, 12.0, 4.0), Vec3::new(11.5, 3.0, 12.0)];
    let lamps = lamps.map(|at| point_lamp(at + origin.as_vec3(), 200.0));
    stage.under(uniform_sky(2.0)).lit_by(&lamps, None)
}

/// Looks at the middle of the room from above a corner.
fn camera(origin: IVec3) -> Camera {
    let mut camera = square_camera(DVec3::new(13.0, 10.0, 14.0), 42.0, -28.0);
    camera.position += origin.as_vec3();
    camera
}

const VIEWS: [View; 5] = [
    View::Full,
    View::Direct,
    View::Normal,
    View::Albedo,
    View::Depth,
];

#[test]
fn a_body_on_whole_coordinates_is_as_voxels_of_the_grid() {
    let corner = IVec3::new(5, 1, 4);
    // With the corner at (0, 0, 0) of the world, colours that depend on the place are the same too.
    let origin = -corner;
    let in_grid = room(origin, |voxel| {
        let local = voxel - corner;
        let inside = local.cmpge(IVec3::ZERO).all() && local.cmplt(BLOCK.as_ivec3()).all();
        if inside { block(local) } else { 0 }
    });
    let mut as_body = room(origin, |_| 0);
    let pivot = Vec3::new(1.5, 2.0, 0.5);
    let home = Pose {
        position: pivot,
        rotation: Quat::IDENTITY,
    };
    let one = body(BLOCK, pivot, home, |voxel| block(voxel.as_ivec3()));
    as_body.bodies = posed(vec![one], origin);
    let camera = camera(origin);
    for view in VIEWS {
        let film = FilmOptions {
            view,
            size: [24, 24],
            ..options(&camera)
        };
        let [grid, body] = [&in_grid, &as_body].map(|stage| stage.rendered(&film));
        let error = absolute_sum(&grid, &body).expect("comparable");
        assert!(error.max < 1e-5, "{view:?}: {error:?}");
        let empty = room(origin, |_| 0).rendered(&film);
        let seen = absolute_sum(&grid, &empty).expect("comparable");
        assert!(seen.max > 0.005, "{view:?}: the block is in the picture");
    }
}

#[test]
fn a_quarter_turn_is_as_turned_voxels_of_the_grid() {
    let corner = IVec3::new(5, 1, 4);
    let flat_room = |solid: &(dyn Fn(IVec3) -> u8 + Sync)| {
        let mut stage = room(IVec3::ZERO, solid);
        let list = [(0.7, 0.0), (0.3, 0.0), (0.5, 4.0)].map(|(a, e)| flat(a, e));
        stage.materials = grotto::world::materials::MaterialSet::bake(&list, 0);
        stage
    };
    // About +Y a quarter turn takes (x, z) to (z, −x).
    let turned = |voxel: IVec3| {
        let local = voxel - corner;
        let back = IVec3::new(BLOCK.x as i32 - 1 - local.z, local.y, local.x);
        let inside = back.cmpge(IVec3::ZERO).all() && back.cmplt(BLOCK.as_ivec3()).all();
        if inside { block(back) } else { 0 }
    };
    let in_grid = flat_room(&turned);
    let mut as_body = flat_room(&|_| 0);
    let half = BLOCK.as_vec3() / 2.0;
    let pose = Pose {
        position: corner.as_vec3() + Vec3::new(half.z, half.y, half.x),
        rotation: Quat::from_rotation_y(FRAC_PI_2),
    };
    let one = body(BLOCK, half, pose, |voxel| block(voxel.as_ivec3()));
    as_body.bodies = posed(vec![one], IVec3::ZERO);
    let camera = camera(IVec3::ZERO);
    for view in [View::Direct, View::Normal, View::Albedo, View::Depth] {
        let film = FilmOptions {
            view,
            ..options(&camera)
        };
        let [grid, body] = [&in_grid, &as_body].map(|stage| stage.rendered(&film));
        let error = absolute_sum(&grid, &body).expect("comparable");
        assert!(error.max < 1e-4, "{view:?}: {error:?}");
    }
    // Paths at random differ, for they begin in the body's own axes.
    let light = |stage| Cpu.mean(stage, &camera, View::Indirect, 24, 128);
    let (grid, body) = (light(&in_grid), light(&as_body));
    assert!(body.agrees_with(grid.mean, 4.0, 0.01), "{body:?}, {grid:?}");
}

/// Bodies at any pose, in each other and in the walls, neither gain nor lose light in a furnace.
#[test]
fn a_furnace_keeps_its_radiance_with_turned_bodies_inside() {
    for albedo in [0.5, 0.9] {
        let mut stage = Stage::closed_box(7, albedo, 2.0);
        let poses = [
            (Vec3::new(3.3, 2.9, 4.1), Vec3::new(0.3, 0.5, 0.2)),
            (Vec3::new(5.2, 4.4, 3.0), Vec3::new(-1.1, 0.2, 0.9)),
            (Vec3::new(1.4, 6.0, 6.6), Vec3::new(0.0, 0.7, 0.0)),
        ];
        let bodies = poses.map(|(position, turn)| {
            let rotation = Quat::from_scaled_axis(turn);
            let size = UVec3::new(3, 2, 2);
            let pose = Pose { position, rotation };
            // Without two opposite corners, so that bodies light themselves.
            body(size, size.as_vec3() / 2.0, pose, |voxel| {
                u8::from(voxel != UVec3::ZERO && voxel != size - 1)
            })
        });
        stage.bodies = posed(bodies.to_vec(), IVec3::ZERO);
        let truth = 2.0 / (1.0 - f64::from(albedo));
        let camera = square_camera(DVec3::new(6.5, 2.0, 7.0), 30.0, 20.0);
        let normals = stage.rendered(&FilmOptions {
            view: View::Normal,
            ..options(&camera)
        });
        let is_turned = |rgb: &&[f32; 3]| rgb.iter().all(|c| (c - 0.5).abs() < 0.49);
        assert!(
            normals.rgb.iter().filter(is_turned).count() > 40,
            "bodies are seen"
        );
        let estimate = Cpu.mean(&stage, &camera, View::Full, 16, 128);
        assert!(estimate.agrees_with(truth, 3.0, 0.005), "{estimate:?}");
    }
}

/// A square plate under a lamp: its shadow on the floor is the plate's top from the lamp's point of view.
#[test]
fn a_turned_plate_casts_the_shadow_of_its_outline() {
    let mut stage = Stage::new(UVec3::new(40, 24, 40), &[(0.5, 0.0)], |voxel| {
        u8::from(voxel.y == 0)
    });
    let lamp = Vec3::new(20.0, 16.0, 20.0);
    stage = stage.lit_by(&[point_lamp(lamp, 500.0)], None);
    let turn = 0.4f32;
    let size = UVec3::new(6, 1, 6);
    let pose = Pose {
        position: Vec3::new(20.0, 8.5, 20.0),
        rotation: Quat::from_rotation_y(turn),
    };
    stage.bodies = posed(
        vec![body(size, size.as_vec3() / 2.0, pose, |_| 1)],
        IVec3::ZERO,
    );
    // Straight down from below the plate, 7 voxels above the floor, over one of the shadow's edges.
    let camera = square_camera(DVec3::new(25.0, 8.0, 20.0), 0.0, -90.0);
    let pixels = 64;
    let picture = stage.rendered(&FilmOptions {
        view: View::Direct,
        size: [pixels; 2],
        ..options(&camera)
    });
    let width = 2.0 * 7.0 * (f64::from(camera.fov_deg) / 2.0).to_radians().tan();
    // The top of the plate is 7 below the lamp, the floor 15.
    let half = 3.0 * 15.0 / 7.0;
    let (mut dark, mut lit) = (0, 0);
    for (index, rgb) in picture.rgb.iter().enumerate() {
        let share = |at: u32| (f64::from(at) + 0.5) / f64::from(pixels) - 0.5;
        let (column, row) = (index as u32 % pixels, index as u32 / pixels);
        // The top of the picture is −Z.
        let at = DVec3::new(5.0 + share(column) * width, 0.0, share(row) * width);
        let (sin, cos) = f64::from(turn).sin_cos();
        // Into the axes of the plate.
        let own = [at.x * cos - at.z * sin, at.x * sin + at.z * cos];
        let beyond = own[0].abs().max(own[1].abs()) - half;
        if beyond.abs() < 1e-4 {
            continue;
        }
        let is_dark = beyond < 0.0;
        assert_eq!(rgb[0] == 0.0, is_dark, "{at}: {beyond} beyond the outline");
        dark += u32::from(is_dark);
        lit += u32::from(!is_dark);
    }
    assert!(dark > 300 && lit > 300, "{dark} dark, {lit} lit");
}

#[test]
fn a_body_outside_of_a_closed_room_changes_nothing_in_it() {
    let lit = || {
        let lamp = point_lamp(Vec3::new(2.5, 4.8, 3.1), 50.0);
        Stage::closed_box(6, 0.7, 0.0).lit_by(&[lamp], None)
    };
    let camera = square_camera(DVec3::splat(4.0), 20.0, -10.0);
    let mut with_body = lit();
    let size = UVec3::splat(5);
    let pose = Pose {
        position: Vec3::new(12.0, 4.0, 4.0),
        rotation: Quat::from_scaled_axis(Vec3::new(0.2, 0.9, 0.4)),
    };
    let one = || body(size, size.as_vec3() / 2.0, pose, |_| 1);
    with_body.bodies = posed(vec![one()], IVec3::ZERO);
    let film = options(&camera);
    assert_eq!(with_body.rendered(&film), lit().rendered(&film));
    // And all of it is dark around a camera that is in the body.
    let inside = square_camera(DVec3::new(12.0, 4.0, 4.0), 20.0, -10.0);
    let picture = with_body.rendered(&options(&inside));
    assert!(picture.rgb.iter().all(|rgb| *rgb == [0.0; 3]));
}

/// What shines through the air is found by hitting it: a glowing body lights a room as glowing voxels do.
#[test]
fn a_glowing_body_lights_as_glowing_voxels_do() {
    let corner = IVec3::splat(3);
    let size = UVec3::new(2, 1, 2);
    let camera = square_camera(DVec3::new(6.5, 6.5, 6.5), 45.0, -30.0);
    let glow = |in_grid: bool| {
        Stage::new(UVec3::splat(9), &[(0.5, 0.0), (0.2, 3.0)], move |voxel| {
            let wall = voxel.cmpeq(IVec3::ZERO).any() || voxel.cmpeq(IVec3::splat(8)).any();
            let local = voxel - corner;
            let inside = local.cmpge(IVec3::ZERO).all() && local.cmplt(size.as_ivec3()).all();
            u8::from(wall) + 2 * u8::from(inside && in_grid)
        })
    };
    let mut as_body = glow(false);
    // A quarter turn leaves the plate where it is, with other axes.
    let pose = Pose {
        position: corner.as_vec3() + size.as_vec3() / 2.0,
        rotation: Quat::from_rotation_y(FRAC_PI_2),
    };
    let one = body(size, size.as_vec3() / 2.0, pose, |_| 2);
    as_body.bodies = posed(vec![one], IVec3::ZERO);
    let light =
        |stage: &Stage| -> MeanEstimate { Cpu.mean(stage, &camera, View::Indirect, 24, 256) };
    let (grid, body) = (light(&glow(true)), light(&as_body));
    assert!(grid.mean > 0.02, "{grid:?}");
    assert!(body.agrees_with(grid.mean, 4.0, 0.01), "{body:?}, {grid:?}");
}

/// From a world's file: the picture at a time shows bodies where they are then.
#[test]
fn bodies_are_where_the_time_says() {
    let world = |rest: &str| {
        let text = format!(
            "(title: \"A turning block.\", size: (16, 16, 16), origin: (-8, -8, -8),
                shape: Plane(normal: (0, 1, 0), offset: -7),
                bodies: [(model: Shape(size: (6, 6, 6), shape: Box(half: (9, 9, 9))), {rest})],
                lamps: [(name: \"a\", lamps: [(position: (3, 7, 5), power: 100)])],
                cameras: [(name: \"c\", position: (0, 2, 7.9), look_at: (0, -2, 0))])"
        );
        parse(&text, "test", None, &Overrides::default()).unwrap_or_else(|e| panic!("{e:?}"))
    };
    let picture = |rest: &str, time_s: f64| {
        let world = world(rest);
        let options = RenderOptions {
            lamps: &world.lamp_presets[0],
            time_s,
            lamp_time_s: 0.0,
            textures: true,
            film: options(&world.cameras[0]),
        };
        let cancel = AtomicBool::new(false);
        render(&world, &generate(&world), &options, &|_, _| {}, &cancel)
    };
    let moves = "position: (0, -4, 0), motion: [
        TurnBetween(axis: (0, 1, 0), degrees: 45, start_s: 3.3, end_s: 5.8),
        Lift(by: (0, 3, 0), period_s: 100, rest_s: 20),
    ]";
    let early = picture(moves, 0.0);
    assert_eq!(early, picture("position: (0, -4, 0)", 0.0));
    let late = picture(moves, 50.0);
    let there = picture("position: (0, -1, 0), degrees: (0, 45, 0)", 0.0);
    assert!(absolute_sum(&late, &there).expect("comparable").max < 1e-4);
    assert!(absolute_sum(&late, &early).expect("comparable").max > 0.05);
}
