//! Scenes whose light is known from a formula. Random results must lie within three standard errors or
//! 1 % of the formula, results without randomness within rounding.

mod emitters;
mod open_air;
mod plates;
pub mod spheres;

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use grotto::measure::picture::Picture;
use grotto::measure::statistics::MeanEstimate;
use grotto::world::View;

use super::stage::{Cpu, Stage, Tracer, all_around, options, point_lamp, square_camera};
use emitters::{a_ball_of_voxels_is_a_sphere_from_afar, a_glowing_box_over_a_floor};
use open_air::{
    a_graded_sky_over_a_plane, a_lamp_over_a_plane, a_long_wall_hides_its_share_of_the_sky,
    a_uniform_sky_over_a_plane, sun_through_a_square_hole,
};
use plates::{an_emissive_plate_over_a_floor, plates_that_light_each_other, two_facing_plates};
use spheres::{
    a_penumbra_behind_a_wall, a_sphere_larger_than_the_room, a_sphere_over_a_plane,
    a_sphere_that_the_horizon_cuts,
};

#[track_caller]
fn assert_agrees(estimate: MeanEstimate, truth: f64) {
    assert!(
        estimate.agrees_with(truth, 3.0, 0.01),
        "{estimate:?}, truth {truth}"
    );
    // A wide error bar must not make the test pass.
    assert!(
        estimate.standard_error <= 0.02 * truth,
        "too noisy: {estimate:?}"
    );
}

/// Mean over the pixels of radiance divided by the formula's radiance for the point at the pixel's centre.
/// `truth` takes that centre as shares of the picture's width and height, from its top left.
fn ratio(picture: &Picture, truth: impl Fn(f64, f64) -> f64) -> MeanEstimate {
    let ratios = picture.rgb.iter().enumerate().map(|(index, rgb)| {
        let index = index as u32;
        let share = |at: u32, of: u32| (f64::from(at) + 0.5) / f64::from(of);
        let x = share(index % picture.width, picture.width);
        let y = share(index / picture.width, picture.height);
        f64::from(rgb[0]) / truth(x, y)
    });
    MeanEstimate::of(ratios).expect("a picture with pixels")
}

/// In a closed box with walls that emit e everywhere, L = e + a·L.
fn white_furnace(tracer: &dyn Tracer) {
    for albedo in [0.0, 0.5, 0.9] {
        let stage = Stage::closed_box(7, albedo, 2.0);
        let truth = 2.0 / (1.0 - f64::from(albedo));
        for camera in [
            square_camera(DVec3::splat(4.5), 30.0, -20.0),
            square_camera(DVec3::new(1.01, 7.99, 2.0), 200.0, 35.0),
        ] {
            assert_agrees(tracer.mean(&stage, &camera, View::Full, 16, 128), truth);
        }
    }
}

/// Without light of its own a closed box cannot gain any, at any albedo below 1; and a furnace
/// of albedo ½ doubles what is emitted, bounce after bounce, and never more.
#[test]
fn no_loop_gains_energy() {
    let camera = square_camera(DVec3::splat(4.5), 10.0, 10.0);
    for albedo in [0.5, 0.9, 0.99] {
        let dark = Stage::closed_box(7, albedo, 0.0);
        assert_eq!(Cpu.mean(&dark, &camera, View::Full, 8, 4).mean, 0.0);
    }
    let furnace = Stage::closed_box(7, 0.5, 1.0);
    let mut options = options(&camera);
    options.samples = 64;
    let mut last = 0.0;
    for bounces in 0..6 {
        options.max_bounces = bounces;
        let picture = furnace.rendered(&options);
        let mean = MeanEstimate::of(picture.rgb.iter().map(|rgb| f64::from(rgb[0])));
        let estimate = mean.expect("a picture with pixels");
        let truth = 2.0 - 0.5f64.powi(bounces as i32);
        assert!(
            estimate.agrees_with(truth, 3.0, 0.01),
            "{bounces} bounces: {estimate:?}"
        );
        assert!(estimate.mean > last && estimate.mean < 2.02);
        last = estimate.mean;
    }
}

/// A lamp of W watts in a closed box of albedo a: what the walls absorb is what the lamp gives,
/// (1 − a)·E·A = W, wherever the lamp is.
fn the_walls_absorb_the_power_of_the_lamp(tracer: &dyn Tracer) {
    let (inner, albedo, power) = (6u32, 0.7f32, 50.0);
    let lamp = point_lamp(Vec3::new(2.5, 4.8, 3.1), power);
    let stage = Stage::closed_box(inner, albedo, 0.0).lit_by(&[lamp], None);
    let centre = DVec3::splat(1.0 + f64::from(inner) / 2.0);
    let faces = all_around(centre).map(|camera| tracer.mean(&stage, &camera, View::Full, 24, 48));
    let radiance = MeanEstimate {
        mean: faces.iter().map(|face| face.mean).sum::<f64>() / 6.0,
        standard_error: faces
            .iter()
            .map(|face| face.standard_error.powi(2))
            .sum::<f64>()
            .sqrt()
            / 6.0,
    };
    let area = f64::from(6 * inner * inner);
    let albedo = f64::from(albedo);
    assert_agrees(
        radiance,
        albedo / PI * f64::from(power) / ((1.0 - albedo) * area),
    );
}

/// Each closed form is a test of its own on the CPU.
macro_rules! on_the_cpu {
    ($($form:ident)*) => {
        pub const FORMS: &[(&str, fn(&dyn Tracer))] = &[$((stringify!($form), $form)),*];

        mod on_the_cpu {
            $(#[test] fn $form() { super::$form(&super::Cpu); })*
        }
    };
}

on_the_cpu! {
    white_furnace
    the_walls_absorb_the_power_of_the_lamp
    a_lamp_over_a_plane
    a_uniform_sky_over_a_plane
    a_graded_sky_over_a_plane
    a_long_wall_hides_its_share_of_the_sky
    sun_through_a_square_hole
    two_facing_plates
    plates_that_light_each_other
    an_emissive_plate_over_a_floor
    a_glowing_box_over_a_floor
    a_ball_of_voxels_is_a_sphere_from_afar
    a_sphere_over_a_plane
    a_sphere_that_the_horizon_cuts
    a_sphere_larger_than_the_room
    a_penumbra_behind_a_wall
}

/// The comparison above can fail: it notices 3 % too little light.
#[test]
fn a_lost_bounce_would_be_noticed() {
    let furnace = Stage::closed_box(7, 0.5, 2.0);
    let camera = square_camera(DVec3::splat(4.5), 30.0, -20.0);
    let estimate = Cpu.mean(&furnace, &camera, View::Full, 16, 128);
    assert!(!estimate.agrees_with(4.0 * 1.03, 3.0, 0.01), "{estimate:?}");
    assert!(!estimate.agrees_with(4.0 * 0.97, 3.0, 0.01), "{estimate:?}");
}
