//! Lamps, sun and sky over open ground.

use std::f64::consts::PI;

use glam::{DVec2, DVec3, IVec3, UVec3, Vec3};
use grotto::world::{Sky, Sun, View};

use super::super::stage::{Stage, Tracer, options, point_lamp, square_camera, uniform_sky};
use super::assert_agrees;

/// A floor of one voxel at the bottom of empty space; its top is y = 1.
pub fn floor(extent: u32, albedo: f32) -> Stage {
    Stage::new(UVec3::new(extent, 16, extent), &[(albedo, 0.0)], |voxel| {
        u8::from(voxel.y == 0)
    })
}

/// E = I·cos θ/d² on a floor under a point lamp; the reflected radiance is a/π·E.
pub fn a_lamp_over_a_plane(tracer: &dyn Tracer) {
    let lamp_ws = DVec3::new(20.25, 7.5, 19.5);
    let stage = floor(40, 0.6).lit_by(&[point_lamp(lamp_ws.as_vec3(), 200.0)], None);
    let camera = square_camera(DVec3::new(20.0, 11.0, 20.0), 0.0, -90.0);
    let options = options(&camera);
    let picture = tracer.rendered(&stage, &options);
    for (index, rgb) in picture.rgb.iter().enumerate() {
        // The camera stands 10 above the floor and sees a square of 20 by 20; the top of the
        // picture is −z.
        let pixel = DVec2::new((index % 16) as f64, (index / 16) as f64) + 0.5;
        let point = DVec3::new(10.0 + pixel.x * 1.25, 1.0, 10.0 + pixel.y * 1.25);
        let distance = lamp_ws.distance(point);
        let irradiance = 200.0 / (4.0 * PI) * (lamp_ws.y - point.y) / distance.powi(3);
        let truth = f64::from(0.6f32) / PI * irradiance;
        assert!(
            (f64::from(rgb[1]) - truth).abs() < tracer.rounding() * truth,
            "{index}: {rgb:?} {truth}"
        );
    }
}

/// An open floor under a uniform sky of radiance L reflects a·L, and light bounces only once.
pub fn a_uniform_sky_over_a_plane(tracer: &dyn Tracer) {
    let stage = floor(64, 0.25).under(uniform_sky(3.0));
    let camera = square_camera(DVec3::new(32.0, 9.0, 32.0), 0.0, -90.0);
    let estimate = tracer.mean(&stage, &camera, View::Full, 8, 16);
    assert!(
        (estimate.mean - 0.75).abs() < 0.1 * tracer.rounding(),
        "{estimate:?}"
    );
}

/// Radiance h + (z − h)(1 − (1 − y)³) by the height y of the direction: E/π = ∫ 2y·L dy
/// = z − (z − h)/10.
pub fn a_graded_sky_over_a_plane(tracer: &dyn Tracer) {
    let sky = Sky {
        zenith: Vec3::splat(4.0),
        horizon: Vec3::splat(1.0),
        ground: Vec3::splat(100.0),
    };
    let stage = floor(64, 0.5).under(sky);
    let camera = square_camera(DVec3::new(32.0, 9.0, 32.0), 0.0, -90.0);
    assert_agrees(
        tracer.mean(&stage, &camera, View::Full, 16, 64),
        0.5 * (4.0 - 3.0 / 10.0),
    );
}

/// A wall of infinite height hides half of the sky: the point at its foot reflects a·L/2.
/// (A wall of height h at distance d leaves ½(1 + cos θ) with tan θ = h/d for an endless wall.)
pub fn a_long_wall_hides_its_share_of_the_sky(tracer: &dyn Tracer) {
    // A wall of height 8 along z; black, so that it reflects nothing. The floor pixel that is seen
    // lies around distance 6: the 2D view factor to the sky is ½(1 + d/√(d² + h²)).
    let size = UVec3::new(64, 16, 2048);
    let stage = Stage::new(size, &[(1.0, 0.0), (0.0, 0.0)], |voxel| match voxel {
        IVec3 { y: 0, .. } => 1,
        IVec3 {
            x: 20, y: 1..=8, ..
        } => 2,
        _ => 0,
    })
    .under(uniform_sky(1.0));
    let mut camera = square_camera(DVec3::new(27.0, 6.0, 1024.0), 0.0, -90.0);
    camera.fov_deg = 0.1;
    let (d, h) = (6.0f64, 8.0f64);
    let truth = 0.5 * (1.0 + d / d.hypot(h));
    assert_agrees(tracer.mean(&stage, &camera, View::Full, 16, 128), truth);
}

/// A slanted sun through a square hole lights a square of the floor, moved by the slant, with
/// E·cos θ; the rest of the floor is dark.
pub fn sun_through_a_square_hole(tracer: &dyn Tracer) {
    let roof = 11;
    let stage = Stage::new(UVec3::new(40, 12, 40), &[(0.5, 0.0)], |voxel| {
        let hole = (18..22).contains(&voxel.x) && (18..22).contains(&voxel.z);
        u8::from(voxel.y == 0 || (voxel.y == roof && !hole))
    });
    let towards = Vec3::new(0.3, 0.9, -0.2).normalize();
    let stage = stage.lit_by(
        &[],
        Some(Sun {
            towards,
            irradiance: Vec3::splat(6.0),
        }),
    );
    // 32 by 32 pixels over a square of 16 by 16 around the floor's middle.
    let camera = square_camera(DVec3::new(20.0, 9.0, 20.0), 0.0, -90.0);
    let mut options = options(&camera);
    options.size = [32, 32];
    options.view = View::Direct;
    let picture = tracer.rendered(&stage, &options);
    let towards = towards.as_dvec3();
    let lit_radiance = 0.5 / PI * 6.0 * towards.y;
    let mut lit = 0;
    for (index, rgb) in picture.rgb.iter().enumerate() {
        let pixel = DVec2::new((index % 32) as f64, (index / 32) as f64) + 0.5;
        let point = DVec3::new(12.0 + pixel.x / 2.0, 1.0, 12.0 + pixel.y / 2.0);
        // The roof is one voxel thick: the ray must be in the hole at its bottom and at its top.
        let open = [f64::from(roof), f64::from(roof + 1)].iter().all(|height| {
            let at = point + towards * ((height - point.y) / towards.y);
            (18.0..22.0).contains(&at.x) && (18.0..22.0).contains(&at.z)
        });
        let truth = if open { lit_radiance } else { 0.0 };
        assert!(
            (f64::from(rgb[0]) - truth).abs() < 0.1 * tracer.rounding(),
            "{point}: {rgb:?}, truth {truth}"
        );
        lit += u32::from(open);
    }
    assert!(
        (40..64).contains(&lit),
        "the patch lies in the picture: {lit}"
    );
}
