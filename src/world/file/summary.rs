//! The content of a world, in a few lines.

use std::fmt;

use crate::world::World;
use crate::world::voxels::grid_cells;

/// What `grotto check` prints for a valid world.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    pub title: String,
    /// Voxels along each axis.
    pub size: [u32; 3],
    pub voxel_m: f32,
    pub seed: u32,
    pub materials: Vec<String>,
    /// Boxes of features and models.
    pub parts: usize,
    /// Bodies, and the models that they share.
    pub bodies: [usize; 2],
    /// Names, with the number of lamps of each.
    pub lamp_presets: Vec<(String, usize)>,
    pub sun: bool,
    pub cameras: Vec<String>,
    /// Names, with the number of probes of each; of octrees, which depend on the voxels, those that are not divided.
    pub layouts: Vec<(String, u64)>,
    /// Size in bytes of the grid of cells, without bricks, whose number depends on the surface.
    pub grid_bytes: u64,
}

impl Summary {
    pub fn of(world: &World) -> Self {
        let cells = grid_cells(world.size).to_array().map(u64::from);
        let presets = world.lamp_presets.iter();
        let layouts = world.layouts.iter();
        Self {
            title: world.title.clone(),
            size: world.size.to_array(),
            voxel_m: world.voxel_m,
            seed: world.seed,
            materials: world.materials.iter().map(|m| m.name.clone()).collect(),
            parts: world.features.len(),
            bodies: [world.bodies.bodies.len(), world.bodies.models.len()],
            lamp_presets: presets.map(|p| (p.name.clone(), p.lamps.len())).collect(),
            sun: world.sun.is_some(),
            cameras: world.cameras.iter().map(|c| c.name.clone()).collect(),
            layouts: layouts
                .map(|l| {
                    let each = l.counts.to_array().map(u64::from);
                    let probes = each.iter().fold(u64::from(l.cascades), |a, b| a * b);
                    (l.name.clone(), probes)
                })
                .collect(),
            grid_bytes: cells.iter().product::<u64>() * size_of::<u32>() as u64,
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fn counted<T: fmt::Display>(all: &[(String, T)]) -> String {
            let all = all.iter().map(|(name, count)| format!("{name} ({count})"));
            all.collect::<Vec<_>>().join(", ")
        }
        let [x, y, z] = self.size;
        writeln!(f, "{}", self.title)?;
        writeln!(
            f,
            "  size       {x} × {y} × {z} voxels of {} m, seed {}",
            self.voxel_m, self.seed
        )?;
        writeln!(
            f,
            "  grid       {}, and the bricks of its surface",
            bytes(self.grid_bytes)
        )?;
        writeln!(f, "  materials  {}", self.materials.join(", "))?;
        writeln!(f, "  features   {} boxes", self.parts)?;
        let [bodies, models] = self.bodies;
        if bodies > 0 {
            let models = match models {
                1 => "one model".to_owned(),
                models => format!("{models} models"),
            };
            writeln!(f, "  bodies     {bodies} of {models}")?;
        }
        let sun = if self.sun { ", and a sun" } else { "" };
        writeln!(f, "  lamps      {}{sun}", counted(&self.lamp_presets))?;
        writeln!(f, "  cameras    {}", self.cameras.join(", "))?;
        write!(f, "  layouts    {} (probes)", counted(&self.layouts))
    }
}

/// A size with a unit that leaves one to four digits before the point.
fn bytes(count: u64) -> String {
    match count {
        0..10_000 => format!("{count} bytes"),
        10_000..10_000_000 => format!("{} kB", count / 1000),
        _ => format!("{} MB", count / 1_000_000),
    }
}
