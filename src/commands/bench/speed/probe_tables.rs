//! The rows of the suites `probes` and `hits`: ways to place probes and to find their light, side by side in one world.

use glam::{UVec3, Vec3};

use super::{
    super::super::Failure,
    spec::{BenchScene, RowSpec, Work},
    suites::Wanted,
};
use crate::world::{
    LayoutSpec, World,
    scenery::{LEAST_COUNT, OctreeSpec, Split},
};

/// Depths of the octrees that are made up.
const DEPTHS: std::ops::RangeInclusive<u32> = 2..=6;
/// Depths of the published octree, whose gather visits all probes.
const SOURCE_DEPTHS: [u32; 2] = [2, 3];
const LATTICES: [&str; 2] = ["fibonacci", "latlong"];
const RAYS: [&str; 2] = ["64", "128"];
/// Sets of kept hits: a fixed pattern, and several that are taken in turn.
const SETS: [&str; 2] = ["1", "8"];
/// Cascades of a world that has none.
const CASCADES: u32 = 3;

/// Where a world has probes that stay where they are.
struct Region {
    centre: Vec3,
    /// Extent in voxels.
    span: Vec3,
    /// Voxels between the probes of the finest lattice.
    finest: f32,
}

impl Region {
    /// That of the widest layout; of the whole world where every layout follows the camera.
    fn of(world: &World) -> Self {
        let span = |layout: &LayoutSpec| (layout.counts - 1).as_vec3() * layout.spacing;
        let plain = |layout: &&LayoutSpec| is_uniform(layout);
        let volume = |layout: &&LayoutSpec| span(layout).element_product();
        let layouts = || world.layouts.iter().filter(plain);
        let widest = layouts().max_by(|a, b| volume(a).total_cmp(&volume(b)));
        let Some(widest) = widest else {
            let span = world.size.as_vec3();
            return Self {
                centre: world.origin.as_vec3() + span / 2.0,
                span,
                finest: (span.max_element() / 32.0).ceil(),
            };
        };
        let spacings = layouts().map(|layout| layout.spacing.max_element());
        Self {
            centre: widest.centre,
            span: span(widest).max(Vec3::ONE),
            finest: spacings.fold(f32::INFINITY, f32::min),
        }
    }

    /// One root around all of it, divided `depth` times. `None` where the tree would be no finer than one of a depth
    /// less.
    fn octree(&self, name: String, depth: u32, octree: OctreeSpec) -> Option<LayoutSpec> {
        let longest = self.span.max_element().ceil();
        let cells = (1u32 << depth) as f32;
        if cells >= 2.0 * longest {
            return None;
        }
        Some(LayoutSpec {
            name,
            counts: UVec3::splat(2),
            spacing: Vec3::splat((longest / cells).ceil() * cells),
            centre: self.centre,
            follow: false,
            cascades: 1,
            octree: Some(OctreeSpec { depth, ..octree }),
        })
    }

    /// The published octree.
    fn source(&self, depth: u32) -> Option<LayoutSpec> {
        let octree = OctreeSpec {
            split: Split::Hits,
            divide_at: 0.5,
            source: true,
            ..OctreeSpec::default()
        };
        self.octree(format!("source depth {depth}"), depth, octree)
    }

    /// Nested volumes, the coarsest as wide as the region.
    fn cascades(&self) -> LayoutSpec {
        let coarsest = self.finest * (1u32 << (CASCADES - 1)) as f32;
        let cells = (self.span / coarsest).ceil().as_uvec3();
        LayoutSpec {
            name: format!("cascades {CASCADES}"),
            counts: (cells + 1).max(UVec3::splat(LEAST_COUNT)),
            spacing: Vec3::splat(self.finest),
            centre: self.centre,
            follow: false,
            cascades: CASCADES,
            octree: None,
        }
    }
}

/// The octree of a world: its own, or one that is made up with cells as fine as the world's finest uniform layout, or as
/// fine as can be. `None` for a world too small for any.
pub fn octree_of(world: &World) -> Option<LayoutSpec> {
    if let Some(own) = world.layouts.iter().find(|layout| layout.octree.is_some()) {
        return Some(own.clone());
    }
    let region = Region::of(world);
    let mut coarser = None;
    for depth in DEPTHS {
        let Some(octree) = region.octree("octree".to_owned(), depth, OctreeSpec::default()) else {
            break;
        };
        if octree.spacing.x <= region.finest * (1u32 << depth) as f32 {
            return Some(octree);
        }
        coarser = Some(octree);
    }
    coarser
}

pub fn is_uniform(layout: &LayoutSpec) -> bool {
    !layout.follow && layout.cascades == 1 && layout.octree.is_none()
}

/// Every kind of layout with its own name and kind in the table.
fn layouts(world: &World) -> Vec<(&'static str, LayoutSpec)> {
    let region = Region::of(world);
    let mut named: Vec<&LayoutSpec> = world.layouts.iter().collect();
    named.sort_by(|a, b| a.name.cmp(&b.name));
    let uniform = named.iter().filter(|layout| is_uniform(layout));
    let mut all: Vec<_> = uniform
        .map(|layout| ("uniform", (*layout).clone()))
        .collect();
    let nested: Vec<_> = named.iter().filter(|layout| layout.cascades > 1).collect();
    match nested[..] {
        [] => all.push(("cascades", region.cascades())),
        _ => all.extend(nested.iter().map(|layout| ("cascades", (**layout).clone()))),
    }
    all.extend(DEPTHS.filter_map(|depth| {
        let octree = region.octree(format!("depth {depth}"), depth, OctreeSpec::default());
        Some(("octree", octree?))
    }));
    let source = SOURCE_DEPTHS.into_iter();
    all.extend(source.filter_map(|depth| Some(("source", region.source(depth)?))));
    all
}

/// Uniform layouts, cascades, octrees, the published octree; then traced and kept hits in the world's first layout.
pub fn probes(wanted: &Wanted<'_>) -> Result<Vec<RowSpec>, Failure> {
    const SUITE: &str = "probes";
    let mut rows = Vec::new();
    for (index, scene, camera, first) in wanted.scenes() {
        let of = (index, scene);
        let row = |layout: &LayoutSpec| {
            RowSpec::new(SUITE, of, camera, layout, wanted.size, Work::Probes)
        };
        for (kind, layout) in layouts(&scene.world) {
            let spec = row(&layout)?.varying("kind", kind);
            let name = match layout.name.strip_prefix(kind) {
                Some(_) => layout.name.clone(),
                None => format!("{kind} {}", layout.name),
            };
            rows.push(spec.called(&scene.world.name, &name));
        }
        for lattice in LATTICES {
            for rays in RAYS {
                let with = |kind: &str| {
                    row(first)?
                        .varying("kind", kind)
                        .with("probes.lattice", lattice)?
                        .with("probes.rays", rays)
                };
                let name = format!("traced {lattice} {rays}");
                rows.push(with("traced")?.called(&scene.world.name, &name));
                for sets in SETS {
                    let spec = with("kept")?
                        .with("probes.hits", "kept")?
                        .with("probes.hit_sets", sets)?;
                    let name = format!("kept {lattice} {rays} sets {sets}");
                    rows.push(spec.called(&scene.world.name, &name));
                }
            }
        }
    }
    Ok(rows)
}

/// The published octree over time: how many probes it has, and how many of their rays hit.
pub fn hits(wanted: &Wanted<'_>) -> Result<Vec<RowSpec>, Failure> {
    let mut rows = Vec::new();
    for (index, scene, camera, _) in wanted.scenes() {
        let scene: &BenchScene = scene;
        let region = Region::of(&scene.world);
        for depth in SOURCE_DEPTHS {
            let Some(layout) = region.source(depth) else {
                continue;
            };
            for lattice in LATTICES {
                for rays in RAYS {
                    let of = (index, scene);
                    let work = Work::HitsOverTime;
                    let spec = RowSpec::new("hits", of, camera, &layout, wanted.size, work)?
                        .with("probes.states", "off")?
                        .with("probes.hits", "kept")?
                        .with("probes.lattice", lattice)?
                        .with("probes.rays", rays)?
                        .varying("depth", &depth.to_string());
                    let name = format!("depth {depth}/{lattice} {rays}");
                    rows.push(spec.called(&scene.world.name, &name));
                }
            }
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeSet, path::Path};

    use super::*;
    use crate::{
        parameters::{Parameters, ProbeHits},
        probes::Volume,
        world::voxels::Voxels,
    };

    fn scenes() -> Vec<BenchScene> {
        let load = |name: &str| {
            let path = Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("worlds")
                .join(name);
            BenchScene::load(&path, &Parameters::default()).expect("a world of the repository")
        };
        vec![load("cornell.ron"), load("cave.ron"), load("cavern.ron")]
    }

    #[test]
    fn every_world_gets_every_kind_and_every_layout_is_possible() {
        let scenes = scenes();
        let wanted = Wanted {
            scenes: &scenes,
            only: vec![0, 1, 2],
            cameras: &[],
            layouts: &[],
            size: [64, 36],
            quick: false,
        };
        let rows = probes(&wanted).expect("sound");
        let over_time = hits(&wanted).expect("sound");
        let ids: BTreeSet<&str> = (rows.iter().chain(&over_time))
            .map(|row| row.id.as_str())
            .collect();
        assert_eq!(ids.len(), rows.len() + over_time.len());
        assert_eq!(over_time.len(), 3 * 8);
        for scene in &scenes {
            let own = |kind: &str| {
                let prefix = format!("probes/{}/{kind}", scene.world.name);
                ids.iter().filter(|id| id.starts_with(&prefix)).count()
            };
            let empty = Voxels::empty(UVec3::splat(8));
            assert!(own("uniform") > 0 || scene.world.layouts.iter().all(|l| !is_uniform(l)));
            assert!(
                own("cascades") > 0 && own("octree") >= 4,
                "{}",
                scene.world.name
            );
            assert_eq!((own("source"), own("traced"), own("kept")), (2, 4, 8));
            for (_, layout) in layouts(&scene.world) {
                match layout.octree {
                    Some(_) => Volume::octree_of(&layout, &empty, scene.world.origin),
                    None => Volume::new(&layout),
                }
                .unwrap_or_else(|error| panic!("{}: {error}", layout.name));
            }
        }
        let kept = rows
            .iter()
            .find(|row| row.id.ends_with("kept latlong 64 sets 8"));
        let probes = &kept.expect("a row").parameters.probes;
        assert_eq!(
            (probes.hits, probes.rays, probes.hit_sets),
            (ProbeHits::Kept, 64, 8)
        );
    }

    #[test]
    fn an_octree_is_around_its_region_and_never_finer_than_a_voxel() {
        let region = Region {
            centre: Vec3::ZERO,
            span: Vec3::new(30.0, 12.0, 30.0),
            finest: 3.0,
        };
        let spacing = |depth| {
            let layout = region.octree(String::new(), depth, OctreeSpec::default());
            layout.map(|layout| layout.spacing.x)
        };
        assert_eq!(
            [2, 3, 4, 5, 6].map(spacing),
            [Some(32.0), Some(32.0), Some(32.0), Some(32.0), None]
        );
        let cascades = region.cascades();
        let widest = (cascades.counts - 1).as_vec3() * cascades.spacing * 4.0;
        assert!(widest.cmpge(region.span).all());
    }
}
