//! What a hand can hold.

use serde::{Deserialize, Serialize};

use crate::world::{World, placed::LampBlock};

/// What a right click places.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Item {
    /// 1-based index into the world's materials.
    Material(u8),
    Lamp(LampBlock),
}

impl Item {
    /// All materials of a world.
    pub fn materials(world: &World) -> impl Iterator<Item = Self> {
        (1..=world.materials.len())
            .filter_map(|number| Some(Self::Material(number.try_into().ok()?)))
    }

    /// For a person; `None` for a material that the world does not have.
    pub fn name(&self, world: &World) -> Option<String> {
        match self {
            Self::Material(number) => {
                let index = usize::from(*number).checked_sub(1)?;
                Some(world.materials.get(index)?.name.clone())
            }
            Self::Lamp(block) => Some(block.name()),
        }
    }
}
