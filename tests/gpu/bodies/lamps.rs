//! Which lamps the cells around bodies see: sending a ray to every lamp in place of that changes no pixel.

use glam::{IVec3, Vec3};
use grotto::{
    gpu::Gpu,
    lights::Lights,
    measure::picture::Picture,
    parameters::ProbeParameters,
    world::{Travel, View, bodies::BodyMotion},
};

use super::{
    SIZE, differing, scattered,
    shafts::{YARD, yard},
};
use crate::support::{self, Fault, frames::Drawn, scenes::flat};

const CELLS: &str = "surface_cache/lamp_visibility.wesl";
const FOUND: &str = "return KnownLamps(head.y, facts_from(first + 2u), vec3f(cell << vec3u(shift)) + half, half - 0.5, 0u);";
const LAMPS: &str = "surface_cache/body_lamps.wesl";
const LIST: &str = "surface_cache/body_cells.wesl";
const LISTED: &str = "is_listed = is_touched(near);";

/// Direct light while bodies turn on their ways and a lamp orbits; then it and they rest, and a wall is built between.
fn pictures(gpu: Gpu) -> Vec<Picture> {
    // Light of a lamp that is a sphere is exact or by rays that are random.
    let mut world = yard(&YARD.replace(", soft_radius: 2.5", ""));
    world.materials = vec![flat(0.6, 0.0)];
    let mut state = 11;
    world.bodies = scattered(6, Vec3::new(60.0, 34.0, 60.0), &mut state);
    for body in &mut world.bodies.bodies {
        body.rest.position += Vec3::new(-30.0, -14.0, -30.0);
        body.motion = vec![
            BodyMotion::Turn {
                axis: Vec3::Y,
                rate: 1.5,
            },
            BodyMotion::Travel(Travel::Bob {
                amplitude: Vec3::new(4.0, 2.0, 0.0),
                rate: 2.0,
                phase: 0.0,
            }),
        ];
    }
    let layout = world.layouts[0].clone();
    // Probes have no part in direct light.
    let probes = ProbeParameters {
        rays: 8,
        ..ProbeParameters::default()
    };
    let mut drawn = Drawn::new(gpu, world, &layout, probes, SIZE);
    drawn.shot.view = View::Direct;
    let mut all = Vec::new();
    for moment in 0..3 {
        let time_s = f64::from(moment) * 0.4;
        drawn.shot.time_s = time_s;
        drawn.lights = Lights::at(&drawn.world, &drawn.world.lamp_presets[0], time_s);
        drawn.draw(3);
        all.push(drawn.radiance());
    }
    drawn.draw(6);
    all.push(drawn.radiance());
    let mut voxels = drawn.frame.stage.read_back(&drawn.gpu).expect("reads back");
    let (low, high) = (IVec3::new(20, 30, 24), IVec3::new(44, 31, 40));
    let edit = voxels.edit(low, high, |_, _| 1);
    let applied = drawn.frame.apply(&drawn.gpu, &voxels, &edit);
    applied.expect("fits");
    drawn.draw(1);
    all.push(drawn.radiance());
    all
}

fn shares(a: &[Picture], b: &[Picture]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| differing(a, b)).collect()
}

#[test]
fn what_cells_know_changes_no_pixel() {
    let gpu = support::gpu();
    let with = |faults: &[Fault]| pictures(support::with_faults(&gpu, faults));
    let found = pictures(gpu.clone());
    let differs = |faults: &[Fault]| shares(&found, &with(faults));
    let by_rays = differs(&[
        (CELLS, FOUND, "return KnownLamps();"),
        (
            "scene/bodies.wesl",
            "return fact(fact_of_cell(cells.x * cells.y * cells.z + number));",
            "return vec2u(0xffffffffu);",
        ),
    ]);
    assert_eq!(
        by_rays, [0.0; 5],
        "pixels that differ from those that send a ray to every lamp"
    );

    // In whatever cell a pixel knows, all lamps are hidden.
    let hidden = |listed| {
        let hides = (CELLS, "facts_from(first + 2u)", "vec4u(0xaaaaaaaau)");
        with(&[hides, (LIST, LISTED, listed)])
    };
    let known = hidden(LISTED);
    let dark = shares(&found, &known);
    assert!(
        dark.iter().all(|share| *share > 0.02),
        "cells are known: {dark:?}"
    );
    let of_all = shares(&known, &hidden("is_listed = true;"));
    assert_eq!(
        of_all, [0.0; 5],
        "pixels whose cells are not listed, though a body touches them"
    );
    let of_half = shares(
        &known,
        &hidden("is_listed = is_touched(near) && (place & 1u) == 0u;"),
    );
    assert!(
        of_half.iter().all(|share| *share > 0.0),
        "cells that are not listed are found: {of_half:?}"
    );
    let most = |shares: Vec<f64>| shares.into_iter().fold(0.0, f64::max);
    let alone = most(differs(&[(
        "scene/bodies.wesl",
        "return fact(fact_of_cell(cells.x * cells.y * cells.z + number));",
        "return vec2u(0u);",
    )]));
    assert!(alone > 0.0, "other bodies hide lamps");
    let narrow = most(differs(&[(
        "surface_cache/hull.wesl",
        "let high_gs = low_gs + size;",
        "let high_gs = low_gs;",
    )]));
    assert!(narrow > 0.0, "hulls that are too narrow are found");
    let few = most(differs(&[(
        LAMPS,
        "FIELDS_PER_WORD], field <<",
        "FIELDS_PER_WORD], select(HIDDEN, field, slot < 32u) <<",
    )]));
    assert!(few > 0.0, "lamps with large numbers count, too");
    let old = differs(&[
        (
            LAMPS,
            "|| is_outdated(examined, vec3f(voxel) + 0.5 * size, 0.5 * size - 0.5, lamp));",
            ");",
        ),
        (
            "surface_cache/lamp_visibility.wesl",
            "|| is_outdated(known.examined, known.centre_gs, known.reach, lamp) {",
            "{",
        ),
    ]);
    assert!(old[4] > 0.0, "what an edit makes unknown is found: {old:?}");
}
