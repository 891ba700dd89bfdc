//! Bodies that reach into stone, and through a wall.

use grotto::{
    gpu::Gpu,
    measure::picture::Picture,
    parameters::ProbeParameters,
    world::{View, World},
};

use crate::support::{
    self, Fault,
    frames::{Drawn, mean},
};

/// A lit room and a dark one with a wall of one voxel between them. One body is sunk into the lit room's floor, another goes through the wall.
const ROOMS: &str = "(
    title: \"Two rooms and bodies in their stone.\",
    size: (32, 16, 32),
    shape: Subtraction([
        Box(half: (32, 32, 32)),
        Translate(by: (8.5, 8, 16), of: Box(half: (6.5, 6, 14))),
        Translate(by: (23.5, 8, 16), of: Box(half: (7.1, 6, 14))),
    ]),
    materials: {\"grey\": (a: Flat(0.6, 0.6, 0.6))},
    rules: [(material: \"grey\")],
    sky: (zenith: (0, 0, 0)),
    lamps: [(name: \"one\", lamps: [(position: (24, 12, 10), power: 900)])],
    bodies: [
        (model: Shape(size: (6, 9, 6), shape: Box(half: (3, 4.5, 3))), position: (21, 3.5, 20)),
        (model: Shape(size: (12, 4, 4), shape: Box(half: (6, 2, 2))), position: (15.9, 6, 14), degrees: (0, 20, 0)),
    ],
    cameras: [
        (name: \"above the floor\", position: (21, 3.5, 28), look_at: (21, 3.5, 23), fov_deg: 30),
        (name: \"in the dark\", position: (10, 12, 5), look_at: (13, 6, 15)),
    ],
    layouts: [(name: \"lattice\", counts: (9, 5, 9), spacing: 4)],
)";

/// All rays of a face begin at one of its voxels: for some of the others in stone, or beyond a wall.
const FROM_ONE_VOXEL: Fault = (
    "surface_cache/body_light.wesl",
    "path_from(surface_in(own, sender, number)",
    "path_from(surface_in(own, 3u, number)",
);
/// The light of columns counts for pixels on the other side of a wall.
const FOR_ALL_PIXELS: Fault = ("probes/body_faces.wesl", "attempt == 1u);", "false);");

fn drawn(gpu: Gpu, camera: usize) -> Drawn {
    let world: World = support::parsed(ROOMS);
    let layout = world.layouts[0].clone();
    let mut drawn = Drawn::new(gpu, world, &layout, ProbeParameters::default(), [32, 32]);
    drawn.shot.camera = drawn.world.cameras[camera].clone();
    drawn
}

fn brightest(picture: &Picture) -> f32 {
    let channels = picture.rgb.iter().flatten();
    channels.fold(0.0, |a, b| a.max(*b))
}

#[test]
fn a_body_through_a_wall_carries_no_light_into_the_dark() {
    let light = |faults: &[Fault]| {
        let mut dark = drawn(support::with_faults(&support::gpu(), faults), 1);
        dark.draw(24);
        brightest(&dark.radiance())
    };
    let [right, rays, pixels] = [&[][..], &[FROM_ONE_VOXEL], &[FOR_ALL_PIXELS]].map(light);
    println!("{right}, with faults {rays} and {pixels}");
    assert!(right < 1e-4, "{right}");
    assert!(rays > 3e-4 && pixels > 3e-4, "{rays} {pixels}");
}

#[test]
fn a_body_in_the_floor_is_as_bright_as_for_the_path_tracer() {
    let over_truth = |faults: &[Fault]| {
        let mut lit = drawn(support::with_faults(&support::gpu(), faults), 0);
        lit.shot.view = View::Indirect;
        lit.draw(60);
        mean(&lit.radiance()) / mean(&lit.path_traced(View::Indirect, 256))
    };
    let [right, wrong] = [&[][..], &[FROM_ONE_VOXEL]].map(over_truth);
    println!("{right:.3} of the light, {wrong:.3} if all rays begin at a voxel in stone");
    assert!((right - 1.0).abs() < 0.1, "{right}");
    assert!(wrong < 0.85, "{wrong}");
}
