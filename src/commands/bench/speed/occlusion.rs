//! The rows of suite `occlusion`: the occlusion field, and shadow rays to the same lamps, which are spheres.

use glam::{UVec3, Vec3};

use super::{
    super::super::Failure,
    spec::{BenchScene, Condition, RowSpec, Work},
    suites::Wanted,
};
use crate::world::{LampPreset, LayoutSpec, World};

const SUITE: &str = "occlusion";
/// Probes of the table that the rows are compared with.
const COUNTS: UVec3 = UVec3::new(32, 16, 32);
/// Rays per probe.
const RAYS: [&str; 2] = ["64", "512"];
/// Lamps that are lit, and kept by the field. The last is the most that it can keep.
const LAMPS: [usize; 4] = [1, 2, 4, 8];
/// Radius (voxels) of lamps that the world says are points.
const RADIUS: f32 = 1.0;

/// Without a field, and with one in place of the shadow rays, by rays per probe and lamps. No probe sleeps. Worlds with
/// fewer lamps have fewer rows.
pub fn rows(wanted: &Wanted<'_>) -> Result<Vec<RowSpec>, Failure> {
    let mut rows = Vec::new();
    for (index, scene, camera, _) in wanted.scenes() {
        let Some(layout) = lattice(&scene.world, COUNTS) else {
            continue;
        };
        let lamps = scene.most_lamps();
        for rays in RAYS {
            for count in LAMPS {
                let Some(lit) = lamps.get(..count) else {
                    continue;
                };
                for shadows in ["rays", "field"] {
                    let of = (index, scene);
                    let work = Work::Frames(Condition::Still);
                    let spec = RowSpec::new(SUITE, of, camera, &layout, wanted.size, work)?;
                    let kept = if shadows == "field" { count } else { 0 };
                    let mut spec = spec
                        .with("probes.rays", rays)?
                        .with("probes.states", "off")?
                        .with("occlusion.lamps", &kept.to_string())?
                        .with("lights.shadows", shadows)?
                        .varying("lamps", &count.to_string());
                    spec.lamps = LampPreset {
                        name: format!("first {count}"),
                        lamps: lit.to_vec(),
                    };
                    let name = format!("rays {rays}/lamps {count}/{shadows}");
                    rows.push(spec.called(&scene.world.name, &name));
                }
            }
        }
    }
    Ok(rows)
}

/// The scene with a sphere for each lamp that can be one.
pub fn with_spheres(scene: &BenchScene) -> BenchScene {
    let mut world = scene.world.clone();
    let presets = world.lamp_presets.iter_mut();
    for lamp in presets.flat_map(|preset| &mut preset.lamps) {
        if lamp.soft_radius == 0.0 {
            lamp.soft_radius = RADIUS;
        }
    }
    BenchScene::of(&scene.path, world, &scene.parameters)
}

/// So many probes in the space of the layout of the world that reaches farthest. `None` for a world without layouts.
pub fn lattice(world: &World, counts: UVec3) -> Option<LayoutSpec> {
    let reach = |layout: &&LayoutSpec| {
        let span = (layout.counts - 1).as_vec3() * layout.spacing;
        span.element_product()
    };
    let layouts = world.layouts.iter();
    let widest = layouts.max_by(|a, b| reach(a).total_cmp(&reach(b)))?;
    let span = (widest.counts - 1).as_vec3() * widest.spacing;
    let gaps = (counts - 1).max(UVec3::ONE).as_vec3();
    // Rounded down to a quarter of a voxel.
    let spacing = ((span / gaps) * 4.0).floor() / 4.0;
    Some(LayoutSpec {
        name: format!("{}×{}×{}", counts.x, counts.y, counts.z),
        counts,
        spacing: spacing.max(Vec3::splat(1.0)),
        cascades: 1,
        octree: None,
        follow: false,
        ..widest.clone()
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::parameters::{Parameters, Shadows};

    fn scene(name: &str) -> BenchScene {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("worlds")
            .join(name);
        BenchScene::load(&path, &Parameters::default()).expect("a world of the repository")
    }

    fn rows_of(scene: BenchScene) -> Vec<RowSpec> {
        let wanted = Wanted {
            scenes: &[scene],
            only: vec![0],
            cameras: &[],
            layouts: &[],
            size: [64, 36],
            quick: false,
        };
        rows(&wanted).expect("sound")
    }

    #[test]
    fn the_field_keeps_every_lamp_that_is_lit_and_all_are_spheres() {
        let rows = rows_of(with_spheres(&scene("cave.ron")));
        assert_eq!(rows.len(), RAYS.len() * LAMPS.len() * 2);
        for row in &rows {
            assert_eq!(row.layout.counts.element_product(), 16_384);
            assert!(row.lamps.lamps.iter().all(|lamp| lamp.soft_radius > 0.0));
            row.parameters.check().expect("values go together");
            let kept = match row.parameters.lights.shadows {
                Shadows::Field => row.lamps.lamps.len() as u32,
                Shadows::Rays => 0,
            };
            assert_eq!(row.parameters.probes.occlusion.lamps, kept, "{}", row.id);
        }
    }

    #[test]
    fn worlds_with_few_lamps_have_fewer_rows() {
        // Two lamps, one of which is a sphere already.
        let scene = with_spheres(&scene("soft_shadows.ron"));
        let radii = scene
            .most_lamps()
            .iter()
            .map(|lamp| lamp.soft_radius)
            .collect::<Vec<_>>();
        assert_eq!(radii, [1.5, 1.0]);
        assert_eq!(rows_of(scene).len(), RAYS.len() * 2 * 2);
    }
}
