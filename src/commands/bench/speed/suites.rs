//! The rows of each suite.

use super::{
    super::super::{Failure, dynamics::Edited},
    spec::{BenchScene, Condition, RowSpec, Work},
};
use crate::world::{Camera, Lamp, LampPreset, LayoutSpec, Motion, Travel};

/// The user's options, as far as rows depend on them.
pub struct Wanted<'a> {
    pub scenes: &'a [BenchScene],
    /// Indices of the scenes that the suite measures.
    pub only: Vec<usize>,
    /// Only these cameras and layouts; all if empty.
    pub cameras: &'a [String],
    pub layouts: &'a [String],
    /// Width and height in pixels, unless the suite varies them.
    pub size: [u32; 2],
    /// Measure less of everything.
    pub quick: bool,
}

type Rows = Result<Vec<RowSpec>, Failure>;

impl Wanted<'_> {
    /// The named camera of a scene, or its first.
    pub fn camera<'s>(&self, scene: &'s BenchScene) -> Option<&'s Camera> {
        let named = |camera: &&Camera| self.cameras.contains(&camera.name);
        let cameras = &scene.world.cameras;
        match self.cameras {
            [] => cameras.first(),
            _ => cameras.iter().find(named),
        }
    }

    /// The named layouts of a scene, or all, in the order of their names' numbers.
    pub fn layouts<'s>(&self, scene: &'s BenchScene) -> Vec<&'s LayoutSpec> {
        let wanted =
            |layout: &&LayoutSpec| self.layouts.is_empty() || self.layouts.contains(&layout.name);
        let mut found: Vec<&LayoutSpec> = scene.world.layouts.iter().filter(wanted).collect();
        found.sort_by(|a, b| a.name.cmp(&b.name));
        found
    }

    /// The layout of suites that vary something else: the first that was named, or the world's first.
    fn layout<'s>(&self, scene: &'s BenchScene) -> Option<&'s LayoutSpec> {
        let layouts = &scene.world.layouts;
        match self.layouts {
            [] => layouts.first(),
            named => layouts.iter().find(|layout| named.contains(&layout.name)),
        }
    }

    /// Scenes that have the named camera and layout, with their index.
    pub fn scenes(&self) -> impl Iterator<Item = (usize, &BenchScene, &Camera, &LayoutSpec)> {
        self.only.iter().filter_map(|&index| {
            let scene = self.scenes.get(index)?;
            Some((index, scene, self.camera(scene)?, self.layout(scene)?))
        })
    }

    /// All values of a list, or every second one with `--quick`.
    fn some<'v, T>(&self, values: &'v [T]) -> impl Iterator<Item = &'v T> {
        values.iter().step_by(if self.quick { 2 } else { 1 })
    }
}

/// Every layout in every condition.
pub fn layouts(wanted: &Wanted<'_>) -> Rows {
    let mut rows = Vec::new();
    for (index, scene, camera, _) in wanted.scenes() {
        for layout in wanted.layouts(scene) {
            for condition in Condition::ALL {
                let work = Work::Frames(condition);
                let spec =
                    RowSpec::new("layouts", (index, scene), camera, layout, wanted.size, work)?;
                rows.push(spec);
            }
        }
    }
    Ok(rows)
}

/// Varies one parameter of the first layout, still and moving.
fn over(
    wanted: &Wanted<'_>,
    suite: &'static str,
    settings: &[Vec<(&'static str, String)>],
    conditions: &[Condition],
) -> Rows {
    let mut rows = Vec::new();
    for (index, scene, camera, layout) in wanted.scenes() {
        for &condition in conditions {
            for setting in wanted.some(settings) {
                let work = Work::Frames(condition);
                let mut spec =
                    RowSpec::new(suite, (index, scene), camera, layout, wanted.size, work)?;
                let mut name = String::new();
                for (key, value) in setting {
                    spec = spec.with(key, value)?;
                    let short = key.trim_start_matches("probes.");
                    let short = short.trim_end_matches(".enabled");
                    name += &format!("{short} {value}/");
                }
                name += condition.name();
                rows.push(spec.called(&scene.world.name, &name));
            }
        }
    }
    Ok(rows)
}

const STILL_AND_MOVING: [Condition; 2] = [Condition::Still, Condition::Moving];

/// Rays per probe: powers of two, and the counts of the source's chart.
const RAYS: [u32; 13] = [
    8, 16, 32, 64, 128, 144, 256, 400, 512, 900, 1024, 1600, 2025,
];

pub fn rays(wanted: &Wanted<'_>) -> Rows {
    let settings = RAYS.map(|rays| vec![("probes.rays", rays.to_string())]);
    over(wanted, "rays", &settings, &STILL_AND_MOVING)
}

/// Sizes of the maps. Distances are stored only for Chebyshev's test.
pub fn maps(wanted: &Wanted<'_>) -> Rows {
    let pairs = [
        (4, 8),
        (4, 16),
        (8, 8),
        (8, 16),
        (8, 32),
        (16, 16),
        (16, 32),
    ];
    let settings = pairs.map(|(irradiance, distance)| {
        vec![
            ("probes.visibility", "chebyshev".to_owned()),
            ("probes.irradiance_texels", irradiance.to_string()),
            ("probes.distance_texels", distance.to_string()),
        ]
    });
    over(wanted, "maps", &settings, &STILL_AND_MOVING)
}

pub fn textures(wanted: &Wanted<'_>) -> Rows {
    let settings = ["on", "off"].map(|value| vec![("textures.enabled", value.to_owned())]);
    let whole = Wanted {
        quick: false,
        only: wanted.only.clone(),
        ..*wanted
    };
    over(&whole, "textures", &settings, &STILL_AND_MOVING)
}

/// Rows with sleeping probes and without, by layout and rays.
pub fn states(wanted: &Wanted<'_>) -> Rows {
    let mut rows = Vec::new();
    for (index, scene, camera, _) in wanted.scenes() {
        for layout in wanted.some(&wanted.layouts(scene)) {
            for rays in ["64", "400"] {
                for states in ["on", "off"] {
                    let work = Work::Frames(Condition::Moving);
                    let scene_of = (index, scene);
                    let spec = RowSpec::new("states", scene_of, camera, layout, wanted.size, work)?;
                    let spec = spec
                        .with("probes.states", states)?
                        .with("probes.rays", rays)?;
                    let name = format!("{}/rays {rays}/states {states}/moving", layout.name);
                    rows.push(spec.called(&scene.world.name, &name));
                }
            }
        }
    }
    Ok(rows)
}

const SIZES: [[u32; 2]; 6] = [
    [640, 352],
    [960, 540],
    [1280, 720],
    [1920, 1080],
    [2560, 1440],
    [3840, 2160],
];

pub fn resolution(wanted: &Wanted<'_>) -> Rows {
    let mut rows = Vec::new();
    for (index, scene, camera, layout) in wanted.scenes() {
        for size in wanted.some(&SIZES) {
            let work = Work::Frames(Condition::Moving);
            let spec = RowSpec::new("resolution", (index, scene), camera, layout, *size, work)?;
            let pixels = u64::from(size[0]) * u64::from(size[1]);
            let name = format!("{}x{}/moving", size[0], size[1]);
            let spec = spec.varying("pixels", &pixels.to_string());
            rows.push(spec.called(&scene.world.name, &name));
        }
    }
    Ok(rows)
}

/// One to four levels of a layout that follows the camera, where a world has such a layout.
pub fn cascades(wanted: &Wanted<'_>) -> Rows {
    let mut rows = Vec::new();
    for (index, scene, camera, _) in wanted.scenes() {
        let mut layouts = wanted.layouts(scene).into_iter();
        let Some(layout) = layouts.find(|layout| layout.cascades > 1) else {
            continue;
        };
        for levels in 1..=4 {
            for condition in [Condition::Moving, Condition::Flight] {
                let layout = LayoutSpec {
                    cascades: levels,
                    ..layout.clone()
                };
                let work = Work::Frames(condition);
                let scene_of = (index, scene);
                let spec = RowSpec::new("cascades", scene_of, camera, &layout, wanted.size, work)?;
                let name = format!("levels {levels}/{}", condition.name());
                let spec = spec.varying("levels", &levels.to_string());
                rows.push(spec.called(&scene.world.name, &name));
            }
        }
    }
    Ok(rows)
}

const LAMPS: [usize; 9] = [0, 1, 2, 4, 8, 16, 32, 64, 128];

/// Lamps of the world's largest preset: still, flickering, moving.
pub fn lights(wanted: &Wanted<'_>) -> Rows {
    lamps(wanted, &["still", "flickering", "moving"])
}

/// The same lamps at rest, in worlds whose lamps are spheres.
pub fn spheres(wanted: &Wanted<'_>) -> Rows {
    lamps(wanted, &[SPHERES])
}

/// The condition of rows whose lamps stand still and have a radius.
const SPHERES: &str = "spheres";

fn lamps(wanted: &Wanted<'_>, conditions: &[&str]) -> Rows {
    let mut rows = Vec::new();
    for (index, scene, camera, layout) in wanted.scenes() {
        let lamps = scene.most_lamps();
        let mut counts: Vec<usize> = LAMPS
            .into_iter()
            .filter(|count| *count <= lamps.len())
            .collect();
        if counts.last() != Some(&lamps.len()) {
            counts.push(lamps.len());
        }
        for &condition in conditions {
            for &count in &counts {
                let work = match condition {
                    "still" | SPHERES => Work::Frames(Condition::Still),
                    _ => Work::Frames(Condition::Moving),
                };
                let scene_of = (index, scene);
                let mut spec = RowSpec::new("lights", scene_of, camera, layout, wanted.size, work)?;
                spec.lamps = LampPreset {
                    name: format!("first {count}"),
                    lamps: lamps[..count]
                        .iter()
                        .map(|lamp| animated(lamp, condition))
                        .collect(),
                };
                condition.clone_into(&mut spec.condition);
                let name = format!("lamps {count}/{condition}");
                let spec = spec.varying("lamps", &count.to_string());
                rows.push(spec.called(&scene.world.name, &name));
            }
        }
    }
    Ok(rows)
}

/// What is edited at once, beside the same frames without edits.
pub fn edits(wanted: &Wanted<'_>) -> Rows {
    let mut rows = Vec::new();
    for (index, scene, camera, layout) in wanted.scenes() {
        let of_edits = [Edited::Ball, Edited::Box, Edited::Crumbs].map(Some);
        for edited in [None].into_iter().chain(of_edits) {
            let condition = edited.map_or(Condition::Moving, Condition::Edits);
            let work = Work::Frames(condition);
            let spec = RowSpec::new("edits", (index, scene), camera, layout, wanted.size, work)?;
            let edit = edited.map_or("none", Edited::name);
            let spec = spec.varying("edit", edit);
            rows.push(spec.called(
                &scene.world.name,
                &format!("edit {edit}/{}", condition.name()),
            ));
        }
    }
    Ok(rows)
}

/// From the start of a process to its first frame and beyond.
pub fn start(wanted: &Wanted<'_>) -> Rows {
    let mut rows = Vec::new();
    for (index, scene, camera, layout) in wanted.scenes() {
        let of = (index, scene);
        let spec = RowSpec::new("start", of, camera, layout, wanted.size, Work::Start)?;
        rows.push(spec.called(&scene.world.name, "start"));
    }
    Ok(rows)
}

/// Rays alone, compared with plain DDA.
pub fn traversal(wanted: &Wanted<'_>) -> Rows {
    let mut rows = Vec::new();
    for (index, scene, camera, layout) in wanted.scenes() {
        let of = (index, scene);
        let work = Work::Traversal;
        let spec = RowSpec::new("traversal", of, camera, layout, wanted.size, work)?;
        rows.push(spec.called(&scene.world.name, "rays"));
    }
    Ok(rows)
}

/// Voxelising: one row for each scene. The scenes are one world at several sizes and with several seeds.
pub fn world(wanted: &Wanted<'_>) -> Rows {
    let mut rows = Vec::new();
    for (index, scene, camera, layout) in wanted.scenes() {
        let of = (index, scene);
        let spec = RowSpec::new("world", of, camera, layout, wanted.size, Work::Build)?;
        let [x, y, z] = scene.world.size.to_array();
        let voxels = u64::from(x) * u64::from(y) * u64::from(z);
        let name = format!("{x}x{y}x{z}/seed {}", scene.world.seed);
        let spec = spec.varying("voxels", &voxels.to_string());
        rows.push(spec.called(&scene.world.name, &name));
    }
    Ok(rows)
}

/// A lamp with one animation: it stands still, flickers, or moves. It moves as the world says or else on a
/// circle of two voxels.
fn animated(lamp: &Lamp, condition: &str) -> Lamp {
    let motion = match condition {
        "still" | SPHERES => Vec::new(),
        "flickering" => vec![Motion::Flicker {
            amount: 0.3,
            rate: 5.0,
        }],
        _ => {
            let goes = |motion: &&Motion| matches!(motion, Motion::Travel(_));
            let own: Vec<Motion> = lamp.motion.iter().filter(goes).cloned().collect();
            match own.is_empty() {
                true => vec![Motion::Travel(Travel::Orbit {
                    radius: glam::Vec3::new(2.0, 0.0, 2.0),
                    rate: 2.0,
                    phase: 0.0,
                })],
                false => own,
            }
        }
    };
    Lamp {
        motion,
        ..lamp.clone()
    }
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeSet, path::Path};

    use super::{super::occlusion::with_spheres, *};
    use crate::parameters::Parameters;

    fn scenes() -> Vec<BenchScene> {
        let load = |name: &str| {
            let path = Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("worlds")
                .join(name);
            BenchScene::load(&path, &Parameters::default()).expect("a world of the repository")
        };
        vec![load("cave.ron"), load("cornell.ron"), load("cavern.ron")]
    }

    fn wanted(scenes: &[BenchScene]) -> Wanted<'_> {
        Wanted {
            scenes,
            only: (0..scenes.len()).collect(),
            cameras: &[],
            layouts: &[],
            size: [64, 36],
            quick: false,
        }
    }

    #[test]
    fn every_row_has_a_name_of_its_own() {
        let scenes = scenes();
        let wanted = wanted(&scenes);
        let mut names = BTreeSet::new();
        for suite in [
            layouts, rays, maps, textures, states, resolution, cascades, lights, edits,
        ] {
            let rows = suite(&wanted).expect("sound");
            assert!(!rows.is_empty());
            for row in rows {
                assert!(names.insert(row.id.clone()), "{} is there twice", row.id);
                assert!(row.id.starts_with(row.suite), "{}", row.id);
            }
        }
    }

    #[test]
    fn every_layout_comes_in_every_condition() {
        let scenes = scenes();
        let rows = layouts(&wanted(&scenes[..2])).expect("sound");
        assert_eq!(rows.len(), (5 + 5) * 4);
        let ids: Vec<&str> = rows.iter().map(|row| row.id.as_str()).collect();
        assert!(ids.contains(&"layouts/cave/layout3/edits"), "{ids:?}");
    }

    #[test]
    fn lamps_do_what_their_condition_says() {
        let scenes = scenes();
        let rows = lights(&wanted(&scenes[2..])).expect("sound");
        let of = |condition: &str| {
            let row = rows
                .iter()
                .find(|row| row.id == format!("lights/cavern/lamps 16/{condition}"));
            row.expect("a row of 16 lamps").lamps.lamps.clone()
        };
        assert!(of("still").iter().all(|lamp| lamp.motion.is_empty()));
        let flickers = |lamp: &Lamp| matches!(lamp.motion[..], [Motion::Flicker { .. }]);
        assert!(of("flickering").iter().all(flickers));
        let moves =
            |lamp: &Lamp| matches!(lamp.motion[..], [Motion::Travel(Travel::Orbit { .. }), ..]);
        assert!(of("moving").iter().all(moves), "no lamp of the world moves");
        let with_spheres = [with_spheres(&scenes[2])];
        let rows_of_spheres = spheres(&wanted(&with_spheres)).expect("sound");
        assert_eq!(rows_of_spheres.len(), rows.len() / 3);
        let lit = |row: &&RowSpec| row.id == "lights/cavern/lamps 16/spheres";
        let row = rows_of_spheres.iter().find(lit);
        let row = row.expect("a row of 16 spheres");
        let is_still = |lamp: &Lamp| lamp.is_sphere() && lamp.motion.is_empty();
        assert!(row.lamps.lamps.iter().all(is_still) && row.lamps.lamps.len() == 16);
        assert!(
            rows.iter()
                .all(|row| !row.lamps.lamps.iter().any(Lamp::is_sphere))
        );
        let all = scenes[2].most_lamps().len();
        assert!(rows.iter().any(|row| row.lamps.lamps.len() == all));
    }
}
