//! Changes with which measurements time the light's response: one lamp, and one wall.

use std::collections::BTreeSet;

use super::leaf::Leaf;
use super::resolve::Reader;
use super::schema;
use super::values::Read;
use crate::world::{LampKind, LampPreset, ResponseSpec, Wall};

/// Most voxels of a wall.
const MOST_VOXELS: i64 = 1 << 20;

impl Reader<'_> {
    pub(super) fn response(
        &self,
        response: &schema::Response,
        presets: &[LampPreset],
        resized: bool,
    ) -> Read<ResponseSpec> {
        let source = self.source;
        let lamps = || presets.iter().flat_map(|preset| &preset.lamps);
        // Presets may share lamp names: remedies list each name once.
        let names: BTreeSet<&str> = lamps().map(|lamp| lamp.name.as_str()).collect();
        let named = |leaf: &Leaf| -> Read<String> {
            let index = source.find(leaf, "lamp", names.iter().copied())?;
            let name = names.iter().nth(index).expect("it was found there");
            Ok((*name).to_owned())
        };
        let lamp = response.lamp.as_ref().map(named).transpose()?;
        let lamp_to = match &response.lamp_to {
            None => None,
            Some(vector) => {
                // Without a name, the first lamp that has a position moves.
                let mut meant = lamps().filter(|one| lamp.as_ref().is_none_or(|n| one.name == *n));
                let placed = |kind: &LampKind| !matches!(kind, LampKind::Directional { .. });
                if !meant.any(|lamp| placed(&lamp.kind)) {
                    return Err(source.at_vector(
                        vector,
                        "`lamp_to` has no lamp to move",
                        "name a point or spot lamp in `lamp`, or leave `lamp_to` out",
                    ));
                }
                Some(source.point(vector, "lamp_to")?)
            }
        };
        let wall = response.wall.as_ref().map(|wall| self.wall(wall, resized));
        Ok(ResponseSpec {
            lamp,
            lamp_to,
            wall: wall.transpose()?,
        })
    }

    /// In a world with an overridden size the wall may lie outside: then nothing changes.
    fn wall(&self, wall: &schema::Wall, resized: bool) -> Read<Wall> {
        let source = self.source;
        let (min, max) = (
            source.voxel(&wall.min, "min")?,
            source.voxel(&wall.max, "max")?,
        );
        if min.cmpgt(max).any() {
            return Err(source.at_vector(
                &wall.max,
                format!("this wall is empty: `min` is {min} and `max` is {max}"),
                "both ends belong to the wall, and `min` must be at most `max` on every axis",
            ));
        }
        let edges = (max - min).to_array().map(|edge| i64::from(edge) + 1);
        let voxels: i64 = edges.iter().fold(1, |a, b| a.saturating_mul(*b));
        if voxels > MOST_VOXELS {
            return Err(source.at_vector(
                &wall.max,
                format!("this wall has {voxels} voxels"),
                format!("{MOST_VOXELS} are allowed: a small opening is change enough"),
            ));
        }
        let (low, high) = self.world_voxels();
        if !resized && (max.cmplt(low).any() || min.cmpge(high).any()) {
            return Err(source.at_vector(
                &wall.min,
                format!(
                    "this wall lies outside of the world, which is {low} … {}",
                    high - 1
                ),
                "write voxels in world space: the origin is where `origin` says",
            ));
        }
        Ok(Wall {
            min,
            max,
            material: self.material(&wall.material)?,
        })
    }
}
