//! What is displayed is the picture's linear HDR, tone-mapped or encoded, whichever pass shows it.

use glam::{UVec3, Vec3};
use grotto::{
    gpu::Gpu,
    measure::{picture::Picture, tonemap},
    parameters::{Antialias, ProbeParameters},
    passes::view::{Inspection, ProbeColour, bits::GpuBit},
    world::View,
};

use crate::support::{self, Fault, frames::Drawn, scenes::lattice};

/// Not a multiple of a workgroup.
const SIZE: [u32; 2] = [45, 27];
/// Half a step of rounding, and the half floats in which the picture is kept.
const TOLERANCE: f32 = 1.25 / 255.0;
/// Frames until light has settled, so that a camera at rest sees pictures that are shaded early.
const SETTLING: u32 = 30;

fn drawn_of(gpu: Gpu) -> Drawn {
    let world = support::shipped("cornell");
    let layout = lattice(UVec3::splat(3), Vec3::splat(8.0), Vec3::ZERO);
    let probes = ProbeParameters {
        rays: 16,
        warmup_frames: 1,
        ..ProbeParameters::default()
    };
    let mut drawn = Drawn::new(gpu, world, &layout, probes, SIZE);
    drawn.shot.exposure_ev = 0.7;
    drawn
}

/// How far any channel of the display is from what the picture's light, or the view's data, should look like.
fn worst(drawn: &Drawn) -> f32 {
    let shown = drawn.frame.read_display(&drawn.gpu).expect("reads back");
    let linear = drawn.radiance();
    assert!(linear.rgb.iter().flatten().any(|&value| value > 0.01));
    let as_light = tonemap::tone_mapped(&linear, drawn.shot.exposure_ev);
    let as_data = tonemap::encoded(&linear);
    let apart = |wanted: &Picture, pixel: usize| {
        let channels = wanted.rgb[pixel].iter().zip(&shown.rgb[pixel]);
        channels.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    let pixels = 0..shown.rgb.len();
    let of_pixel = |pixel| match drawn.shot.view.is_data() {
        true => apart(&as_data, pixel),
        false => apart(&as_light, pixel),
    };
    pixels.map(of_pixel).fold(0.0, f32::max)
}

/// The first picture, which waits for its light, and one in settled light, which is shaded early.
fn late_and_early(gpu: Gpu) -> [f32; 2] {
    let mut drawn = drawn_of(gpu);
    drawn.draw(2);
    let late = worst(&drawn);
    drawn.draw(SETTLING);
    [late, worst(&drawn)]
}

fn smoothed(gpu: Gpu) -> f32 {
    let mut drawn = drawn_of(gpu);
    let made = drawn.frame.antialias(&drawn.gpu, Antialias::Temporal);
    made.expect("fits");
    drawn.draw(3);
    worst(&drawn)
}

#[test]
fn each_picture_is_shown_once_it_is_finished() {
    let gpu = support::gpu();
    let [late, early] = late_and_early(gpu.clone());
    let smoothed_apart = smoothed(gpu.clone());
    assert!(late < TOLERANCE && early < TOLERANCE && smoothed_apart < TOLERANCE);
    // Pictures that are shaded early have a pass of their own, others have not.
    let unshown: Fault = (
        "view/shade.wesl",
        "if per_thread(view.is_finished, packed.y) == 1u {",
        "if per_thread(view.is_finished, packed.y) == 2u {",
    );
    let [late, early] = late_and_early(support::with_faults(&gpu, &[unshown]));
    assert!(late > 0.1 && early < TOLERANCE, "{late} {early}");
    let unshown: Fault = ("view/antialias.wesl", "show(pixel, texel);", "");
    let apart = smoothed(support::with_faults(&gpu, &[unshown]));
    assert!(apart > 0.1, "{apart}");
}

#[test]
fn what_is_drawn_over_a_picture_is_shown() {
    let mut drawn = drawn_of(support::gpu());
    for view in [View::Albedo, View::Steps, View::Indirect] {
        drawn.shot.view = view;
        drawn.draw(1);
        assert!(worst(&drawn) < TOLERANCE, "{view:?}");
    }
    drawn.shot.view = View::Full;
    let camera = &drawn.shot.camera;
    let ahead = camera.basis(1.0).forward.normalize();
    let bit = GpuBit {
        centre_ws: (camera.position + 2.0 * ahead.as_vec3()).to_array(),
        half_size: 0.3,
        emission: [2.0, 0.5, 0.1],
        flies: 1,
        ..Default::default()
    };
    let without = {
        drawn.draw(1);
        drawn.radiance()
    };
    drawn.frame.set_bits(&drawn.gpu, &[bit]).expect("fits");
    drawn.draw(1);
    assert!(drawn.radiance() != without, "the bit is in the picture");
    assert!(worst(&drawn) < TOLERANCE, "bits");
    drawn.frame.set_bits(&drawn.gpu, &[]).expect("fits");
    let wanted = Inspection {
        view: View::Full,
        probes: Some(ProbeColour::State),
        atlas: None,
    };
    drawn.frame.inspect(&drawn.gpu, wanted).expect("fits");
    let before = drawn.frame.read_display(&drawn.gpu).expect("reads back");
    drawn.draw(1);
    let shown = drawn.frame.read_display(&drawn.gpu).expect("reads back");
    assert!(shown != before, "probes are data over light");
}
