//! Lamps that are spheres.

use std::f64::consts::PI;

use glam::{DVec3, IVec3, UVec3, Vec3};
use grotto::measure::picture::Picture;
use grotto::reference::FilmOptions;
use grotto::world::{Lamp, View};

use super::super::stage::{Stage, Tracer, options, point_lamp, square_camera};
use super::open_air::floor;
use super::{assert_agrees, ratio};

/// A white lamp of this power (W) and radius (voxels).
pub fn sphere_lamp(position: Vec3, power: f32, soft_radius: f32) -> Lamp {
    Lamp {
        soft_radius,
        ..point_lamp(position, power)
    }
}

/// Direct light through pixel centres.
fn direct(tracer: &dyn Tracer, stage: &Stage, film: &FilmOptions, samples: u32) -> Picture {
    let film = FilmOptions {
        samples: samples.div_ceil(tracer.haste()),
        view: View::Direct,
        ..*film
    };
    tracer.rendered(stage, &film)
}

/// Above the horizon a sphere lights a floor as a point lamp of the same power does: E = W/(4π) · cos θ/d².
pub fn a_sphere_over_a_plane(tracer: &dyn Tracer) {
    let lamp_ws = DVec3::new(20.25, 5.5, 19.5);
    let stage = floor(40, 0.6).lit_by(&[sphere_lamp(lamp_ws.as_vec3(), 200.0, 2.5)], None);
    let camera = square_camera(DVec3::new(20.0, 11.0, 20.0), 0.0, -90.0);
    let picture = direct(tracer, &stage, &options(&camera), 256);
    let truth = |x: f64, y: f64| {
        let point = DVec3::new(10.0 + x * 20.0, 1.0, 10.0 + y * 20.0);
        let cosine_over_square = (lamp_ws.y - point.y) / lamp_ws.distance(point).powi(3);
        f64::from(0.6f32) / PI * 200.0 / (4.0 * PI) * cosine_over_square
    };
    assert_agrees(ratio(&picture, truth), 1.0);
}

/// Half of a sphere whose middle lies in a floor's plane is below the floor's horizon. The other half, at distance d from
/// the middle, gives E = I/R² · (atan(1/c) − c/(1 + c²))/π with c² = d²/R² − 1 (Snyder 1996, for a cosine of 0).
pub fn a_sphere_that_the_horizon_cuts(tracer: &dyn Tracer) {
    let (lamp_ws, radius) = (DVec3::new(20.0, 1.0, 20.0), 3.0);
    let stage = floor(40, 0.6).lit_by(&[sphere_lamp(lamp_ws.as_vec3(), 200.0, 3.0)], None);
    // Floor from 25 to 35 along x, at least 2 voxels away from the sphere.
    let camera = square_camera(DVec3::new(30.0, 6.0, 20.0), 0.0, -90.0);
    let picture = direct(tracer, &stage, &options(&camera), 512);
    let truth = |x: f64, y: f64| {
        let point = DVec3::new(25.0 + x * 10.0, 1.0, 15.0 + y * 10.0);
        let cot = ((lamp_ws.distance(point) / radius).powi(2) - 1.0).sqrt();
        let share = ((1.0 / cot).atan() - cot / (1.0 + cot * cot)) / PI;
        f64::from(0.6f32) / PI * 200.0 / (4.0 * PI) * share / (radius * radius)
    };
    assert_agrees(ratio(&picture, truth), 1.0);
}

/// Where the whole room is inside the lamp, every wall sees a hemisphere full of light around the lamp's middle:
/// E = I/R² · (1 + cos θ)/2.
pub fn a_sphere_larger_than_the_room(tracer: &dyn Tracer) {
    let middle = DVec3::new(3.0, 2.5, 3.25);
    let stage =
        Stage::closed_box(4, 0.5, 0.0).lit_by(&[sphere_lamp(middle.as_vec3(), 900.0, 12.0)], None);
    // The wall at z = 1, from x and y 1 to 5.
    let camera = square_camera(DVec3::new(3.0, 3.0, 3.0), 0.0, 0.0);
    let picture = direct(tracer, &stage, &options(&camera), 256);
    let truth = |x: f64, y: f64| {
        let point = DVec3::new(1.0 + x * 4.0, 5.0 - y * 4.0, 1.0);
        let towards = (middle - point).normalize();
        0.5 / PI * 900.0 / (4.0 * PI) / 144.0 * (1.0 + towards.z) / 2.0
    };
    assert_agrees(ratio(&picture, truth), 1.0);
}

/// The share of a sphere's light on a floor that passes over the edge of an endless wall, in small steps over the cone.
/// `edge`: of the wall, relative to the point, x towards the lamp.
fn share_over_edge(to_lamp: DVec3, radius: f64, edge: DVec3) -> f64 {
    let axis = to_lamp.normalize();
    let (u, v) = axis.any_orthonormal_pair();
    let depth = 1.0 - (1.0 - (radius / to_lamp.length()).powi(2)).sqrt();
    let (mut passed, mut all) = (0.0, 0.0);
    for step in 0..80 {
        let cosine = 1.0 - depth * (f64::from(step) + 0.5) / 80.0;
        let sine = (1.0 - cosine * cosine).sqrt();
        for turn in 0..160 {
            let angle = 2.0 * PI * (f64::from(turn) + 0.5) / 160.0;
            let ray = axis * cosine + (u * angle.cos() + v * angle.sin()) * sine;
            all += ray.y;
            if ray.y * edge.x > edge.y * ray.x {
                passed += ray.y;
            }
        }
    }
    passed / all
}

/// The penumbra of a sphere behind a wall: from column to column of a floor, the light that passes over the wall's edge.
pub fn a_penumbra_behind_a_wall(tracer: &dyn Tracer) {
    let (lamp_ws, radius) = (DVec3::new(13.0, 9.0, 20.0), 1.5);
    // The wall's edge on the floor's side lies at x = 21, y = 6.
    let stage = Stage::new(UVec3::new(44, 16, 40), &[(0.5, 0.0)], |voxel| match voxel {
        IVec3 { y: 0, .. } => 1,
        IVec3 {
            x: 20, y: 1..=5, ..
        } => 1,
        _ => 0,
    })
    .lit_by(
        &[sphere_lamp(lamp_ws.as_vec3(), 400.0, radius as f32)],
        None,
    );
    let camera = square_camera(DVec3::new(33.0, 11.0, 20.0), 0.0, -90.0);
    let picture = direct(tracer, &stage, &options(&camera), 1024);
    let mut partly = 0;
    let mut last = -1.0;
    for column in 0..16 {
        let (mut light, mut truth, mut unshadowed) = (0.0, 0.0, 0.0);
        for row in 0..16 {
            let place = |pixel: u32| (f64::from(pixel) + 0.5) / 16.0 * 20.0;
            let point = DVec3::new(23.0 + place(column), 1.0, 10.0 + place(row));
            let to_lamp = lamp_ws - point;
            let open = 0.5 / PI * 400.0 / (4.0 * PI) * to_lamp.y / to_lamp.length().powi(3);
            // x is mirrored, so that it grows towards the lamp.
            let mirrored = DVec3::new(-to_lamp.x, to_lamp.y, to_lamp.z);
            let edge = DVec3::new(point.x - 21.0, 5.0, 0.0);
            unshadowed += open;
            truth += open * share_over_edge(mirrored, radius, edge);
            light += f64::from(picture.rgb[(row * 16 + column) as usize][1]);
        }
        let (found, wanted) = (light / unshadowed, truth / unshadowed);
        assert!(
            (found - wanted).abs() < 0.03,
            "column {column}: {found}, not {wanted}"
        );
        assert!(wanted > last - 1e-9, "light grows away from the wall");
        last = wanted;
        partly += u32::from((0.05..0.95).contains(&wanted));
    }
    assert!(
        partly >= 4 && last > 0.9,
        "{partly} columns in the penumbra, {last}"
    );
}
