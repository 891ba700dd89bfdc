//! The tables and charts of the four source documents, by their numbers, on our own worlds.

use glam::UVec3;

use super::{
    super::{super::Failure, model::Missing},
    occlusion,
    probe_tables::{is_uniform, octree_of},
    spec::{BenchScene, Condition, RowSpec, Work},
    suites::Wanted,
};
use crate::world::{LampPreset, LayoutSpec};

const SUITE: &str = "tables";
/// The worlds that the tables use.
pub const CAVE: &str = "cave";
pub const CORNELL: &str = "cornell";
/// Small boxes in a thin roof: the world where the error tables of probes are the most informative.
pub const BEAM: &str = "beam";
/// Rooms behind thin walls: worlds where light leaks unless probes are placed well.
pub const QUALITY: [&str; 4] = ["door", "split", "bleed", "house"];

/// Tables of the sources whose systems grotto does not have.
pub fn missing() -> Vec<Missing> {
    [("octree", "suites `probes` and `hits` have its tables")]
        .map(|(table, reason)| Missing {
            id: format!("{SUITE}/{table}"),
            reason: reason.to_owned(),
        })
        .into()
}

/// Rows of every table whose world is among the wanted ones.
pub fn tables(wanted: &Wanted<'_>) -> Result<Vec<RowSpec>, Failure> {
    let mut all = Tables {
        wanted,
        rows: Vec::new(),
    };
    all.fibix()?;
    all.g3d()?;
    all.minecraft()?;
    all.octree()?;
    Ok(all.rows)
}

struct Tables<'a> {
    wanted: &'a Wanted<'a>,
    rows: Vec<RowSpec>,
}

impl Tables<'_> {
    fn scene(&self, name: &str) -> Option<(usize, &BenchScene)> {
        let mut scenes = self.wanted.scenes();
        let found = scenes.find(|(_, scene, ..)| scene.world.name == name);
        found.map(|(index, scene, ..)| (index, scene))
    }

    /// Adds a row to a table: the world's layout (or another), with these parameters.
    fn add(
        &mut self,
        table: &str,
        world: &str,
        name: &str,
        (layout, work): (Option<LayoutSpec>, Work),
        set: &[(&str, &str)],
    ) -> Result<(), Failure> {
        let Some((index, scene)) = self.scene(world) else {
            return Ok(());
        };
        let Some(camera) = self.wanted.camera(scene) else {
            return Ok(());
        };
        let layout = layout.unwrap_or_else(|| scene.world.layouts[0].clone());
        let size = self.wanted.size;
        let mut spec = RowSpec::new(SUITE, (index, scene), camera, &layout, size, work)?;
        for (key, value) in set {
            spec = spec.with(key, value)?;
        }
        let spec = spec.varying("table", table);
        self.rows.push(spec.called(table, name));
        Ok(())
    }

    /// Tables 4.1–4.7 and Fig. 4.8: maps, errors, stability, times. The algorithm is the source's.
    fn fibix(&mut self) -> Result<(), Failure> {
        const PROBES_ALONE: [(&str, &str); 1] = [("probes.method", "source")];
        let with = |more: &[(&'static str, &'static str)]| [&PROBES_ALONE[..], more].concat();
        let maps = [
            ("8", "8"),
            ("8", "16"),
            ("8", "32"),
            ("16", "16"),
            ("32", "16"),
        ];
        for (irradiance, distance) in maps {
            let set = with(&[
                ("probes.irradiance_texels", irradiance),
                ("probes.distance_texels", distance),
            ]);
            let name = format!("irradiance {irradiance}, distance {distance}");
            let work = (None, Work::Bytes);
            self.add("fibix-4.1", CORNELL, &name, work, &set)?;
        }
        let work = || (None, Work::Error);
        self.add(
            "fibix-4.2",
            BEAM,
            "direct light alone",
            (None, Work::DirectError),
            &PROBES_ALONE,
        )?;
        for (name, relocation, weights) in [
            ("simple", "off", "perception"),
            ("offset to surface", "surface", "perception"),
            ("offset and clear", "clear", "perception"),
            ("adjusted filter", "clear", "adjusted"),
        ] {
            let set = with(&[
                ("source.relocation", relocation),
                ("source.weights", weights),
            ]);
            self.add("fibix-4.2", BEAM, name, work(), &set)?;
        }
        for texels in ["8", "16", "32", "64"] {
            let set = with(&[("probes.distance_texels", texels)]);
            let name = format!("distance {texels}");
            self.add("fibix-4.3", BEAM, &name, work(), &set)?;
        }
        let set = with(&[("source.depth", "reject")]);
        self.add(
            "fibix-4.3",
            BEAM,
            "distance 16, long rays rejected",
            work(),
            &set,
        )?;
        for rays in ["8", "16", "32", "64", "128", "256"] {
            let set = with(&[("probes.rays", rays)]);
            let name = format!("rays {rays}");
            let stability = (None, Work::Stability);
            self.add("fibix-4.4", CORNELL, &name, stability, &set)?;
        }
        for distance in ["8", "16", "32"] {
            for irradiance in ["4", "8", "16"] {
                let set = with(&[
                    ("probes.distance_texels", distance),
                    ("probes.irradiance_texels", irradiance),
                ]);
                let name = format!("distance {distance}, irradiance {irradiance}");
                self.add("fibix-4.5", BEAM, &name, work(), &set)?;
            }
        }
        let lattice = self.lattice("11×10×15", UVec3::new(11, 10, 15));
        let frames = || (lattice.clone(), Work::Frames(Condition::Moving));
        for rays in ["8", "16", "32", "64", "128", "256"] {
            let set = with(&[("probes.rays", rays), ("probes.states", "off")]);
            let name = format!("rays {rays}");
            self.add("fibix-4.6", CAVE, &name, frames(), &set)?;
        }
        for texels in ["4", "8", "16", "32", "64"] {
            let set = with(&[
                ("probes.rays", "64"),
                ("probes.distance_texels", texels),
                ("probes.states", "off"),
            ]);
            let name = format!("distance {texels}");
            self.add("fibix-4.7", CAVE, &name, frames(), &set)?;
        }
        Ok(())
    }

    /// Tables 7.3–7.9: the field's rays, times and states by grid, rays and culling; the occlusion field; and the field's weights,
    /// added one by one.
    fn g3d(&mut self) -> Result<(), Failure> {
        const ALONE: (&str, &str) = ("probes.method", "source");
        let grids = [
            ("16×16×16", UVec3::splat(16)),
            ("32×16×32", UVec3::new(32, 16, 32)),
            ("32×32×32", UVec3::splat(32)),
        ];
        for (grid, counts) in grids {
            for rays in ["64", "512"] {
                for states in ["off", "on"] {
                    let set = [ALONE, ("probes.rays", rays), ("probes.states", states)];
                    let name = format!("{grid}/rays {rays}/states {states}");
                    let work = (self.lattice(grid, counts), Work::Frames(Condition::Moving));
                    self.add("g3d-7.3-7.6-7.9", CAVE, &name, work, &set)?;
                }
            }
        }
        for counts in [
            [16, 8, 16],
            [16, 16, 16],
            [32, 8, 32],
            [32, 16, 32],
            [32, 32, 32],
        ] {
            let probes: u32 = counts.iter().product();
            for states in ["off", "on"] {
                let name = format!("probes {probes}/states {states}");
                let layout = self.lattice(&format!("{probes} probes"), UVec3::from_array(counts));
                let set = [ALONE, ("probes.rays", "64"), ("probes.states", states)];
                let work = (layout, Work::Frames(Condition::Moving));
                self.add("g3d-7.7", CAVE, &name, work, &set)?;
            }
        }
        // One lamp, as in the source.
        for rays in ["64", "512"] {
            let set = [
                ALONE,
                ("probes.rays", rays),
                ("probes.states", "off"),
                ("lights.max_lamps", "1"),
                ("occlusion.lamps", "1"),
                ("lights.shadows", "field"),
            ];
            let lattice = self.lattice("32×16×32", UVec3::new(32, 16, 32));
            let work = (lattice, Work::Frames(Condition::Moving));
            self.add("g3d-7.8", CAVE, &format!("rays {rays}"), work, &set)?;
            self.light_by(1);
        }
        for weights in ["trilinear", "direction", "visibility", "perception"] {
            let set = [ALONE, ("source.weights", weights)];
            self.add("g3d-weights", BEAM, weights, (None, Work::Error), &set)?;
        }
        Ok(())
    }

    /// The charts: layouts, rays, textures, lamps, moving against still lamps.
    fn minecraft(&mut self) -> Result<(), Failure> {
        const RAYS: (&str, &str) = ("probes.rays", "400");
        for world in [CAVE, CORNELL] {
            let Some((_, scene)) = self.scene(world) else {
                continue;
            };
            let mut layouts = scene.world.layouts.clone();
            layouts.sort_by(|a, b| a.name.cmp(&b.name));
            for layout in layouts {
                let name = format!("{world}/{}", layout.name);
                let work = (Some(layout), Work::Frames(Condition::Moving));
                self.add("minecraft-layouts", world, &name, work, &[RAYS])?;
            }
        }
        let moving = || (None, Work::Frames(Condition::Moving));
        for rays in ["16", "144", "400", "900", "1600", "2025"] {
            let name = format!("rays {rays}");
            let set = [("probes.rays", rays)];
            self.add("minecraft-rays", CAVE, &name, moving(), &set)?;
        }
        for textures in ["on", "off"] {
            let name = format!("textures {textures}");
            let set = [RAYS, ("textures.enabled", textures)];
            self.add("minecraft-textures", CAVE, &name, moving(), &set)?;
        }
        for condition in [Condition::Moving, Condition::Still] {
            for lamps in 1..=8 {
                let name = format!("lamps {lamps}/{}", condition.name());
                let work = (None, Work::Frames(condition));
                self.add("minecraft-lamps", CAVE, &name, work, &[RAYS])?;
                self.light_by(lamps);
            }
        }
        Ok(())
    }

    /// Error by layout, and in an octree as fine as the finest: with the final gather, and by the probes alone.
    fn octree(&mut self) -> Result<(), Failure> {
        for world in QUALITY {
            let Some((_, scene)) = self.scene(world) else {
                continue;
            };
            let uniform = scene.world.layouts.iter().filter(|one| is_uniform(one));
            let layouts: Vec<_> = uniform.cloned().chain(octree_of(&scene.world)).collect();
            for layout in layouts {
                for gather in ["on", "off"] {
                    let name = format!("{world}/{}/gather {gather}", layout.name);
                    let set = [("probes.final_gather", gather)];
                    let work = (Some(layout.clone()), Work::Error);
                    self.add("octree-quality", world, &name, work, &set)?;
                }
            }
        }
        Ok(())
    }

    /// Limits the last row's lamps to the first `count` of its world's largest preset.
    fn light_by(&mut self, count: usize) {
        let lamps = self.scene(CAVE).map(|(_, scene)| scene.most_lamps());
        if let (Some(row), Some(mut lamps)) = (self.rows.last_mut(), lamps) {
            lamps.truncate(count);
            row.lamps = LampPreset {
                name: format!("first {count}"),
                lamps,
            };
            row.varied.insert(
                "lamps".to_owned(),
                super::super::model::Varied::Number(count as f64),
            );
        }
    }

    /// Probes that fill the space of the cave's coarsest layout. `None` without the cave.
    fn lattice(&self, name: &str, counts: UVec3) -> Option<LayoutSpec> {
        let (_, scene) = self.scene(CAVE)?;
        Some(LayoutSpec {
            name: name.to_owned(),
            ..occlusion::lattice(&scene.world, counts)?
        })
    }
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeSet, path::Path};

    use super::*;
    use crate::{parameters::Parameters, probes::Volume, world::voxels::Voxels};

    #[test]
    fn every_table_has_its_rows() {
        let load = |name: &str| {
            let path = Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("worlds")
                .join(name);
            BenchScene::load(&path, &Parameters::default()).expect("a world of the repository")
        };
        let own = [CAVE, CORNELL, BEAM].into_iter();
        let scenes: Vec<_> = own
            .chain(QUALITY)
            .map(|name| load(&format!("{name}.ron")))
            .collect();
        let wanted = Wanted {
            scenes: &scenes,
            only: (0..scenes.len()).collect(),
            cameras: &[],
            layouts: &[],
            size: [64, 36],
            quick: false,
        };
        let rows = tables(&wanted).expect("sound");
        let ids: BTreeSet<&str> = rows.iter().map(|row| row.id.as_str()).collect();
        assert_eq!(ids.len(), rows.len(), "every row has a name of its own");
        let of = |table: &str| {
            let prefix = format!("tables/{table}/");
            ids.iter().filter(|id| id.starts_with(&prefix)).count()
        };
        for (table, count) in [
            ("fibix-4.1", 5),
            ("fibix-4.2", 5),
            ("fibix-4.3", 5),
            ("fibix-4.4", 6),
            ("fibix-4.5", 9),
            ("fibix-4.6", 6),
            ("fibix-4.7", 5),
            ("g3d-7.3-7.6-7.9", 12),
            ("g3d-7.7", 10),
            ("g3d-7.8", 2),
            ("g3d-weights", 4),
            ("minecraft-layouts", 10),
            ("minecraft-rays", 6),
            ("minecraft-textures", 2),
            ("minecraft-lamps", 16),
            // Three, three, three and two uniform layouts, and an octree each.
            ("octree-quality", 2 * (4 + 4 + 4 + 3)),
        ] {
            assert_eq!(of(table), count, "{table}");
        }
        let is_octree =
            |row: &&RowSpec| row.id.contains("octree-quality") && row.layout.octree.is_some();
        let octrees: Vec<_> = rows.iter().filter(is_octree).collect();
        assert_eq!(octrees.len(), 2 * QUALITY.len());
        for row in octrees {
            let scene = &scenes[row.scene];
            let depth = row.layout.octree.as_ref().map_or(0, |octree| octree.depth);
            let finest = row.layout.spacing.x / (1u32 << depth) as f32;
            let uniform = scene.world.layouts.iter().filter(|one| is_uniform(one));
            let spacing = uniform.map(|one| one.spacing.max_element());
            assert!(
                finest <= spacing.fold(f32::INFINITY, f32::min),
                "{}",
                row.id
            );
            let voxels = Voxels::empty(UVec3::splat(8));
            let volume = Volume::octree_of(&row.layout, &voxels, scene.world.origin);
            volume.unwrap_or_else(|error| panic!("{}: {error}", row.id));
        }
        let lamps = |id: &str| {
            let row = rows.iter().find(|row| row.id == id);
            row.map(|row| row.lamps.lamps.len())
        };
        assert_eq!(lamps("tables/minecraft-lamps/lamps 3/still"), Some(3));
    }
}
