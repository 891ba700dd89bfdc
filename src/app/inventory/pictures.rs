//! The pictures of items as textures. They are made one a frame, and kept while the materials stay the same.

use egui::{Context, TextureHandle, TextureId, TextureOptions};

use super::block;
use crate::{
    app::hands::Item,
    world::{
        Material, World,
        materials::MaterialSet,
        placed::{LampColour, LampForm},
    },
};

/// Items that look alike have one picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Look {
    Material(u8),
    Lamp(LampForm, LampColour),
}

#[derive(Default)]
pub struct Pictures {
    textures: Vec<(Look, TextureHandle)>,
    /// Of the world that the pictures are of.
    materials: Vec<Material>,
    /// The frame in which the last one was made.
    made_in: Option<u64>,
}

impl Pictures {
    /// The picture of an item; `None` if it has none, or none yet.
    pub fn of(&mut self, context: &Context, world: &World, item: Item) -> Option<TextureId> {
        if self.materials != world.materials {
            self.materials.clone_from(&world.materials);
            self.textures
                .retain(|(look, _)| matches!(look, Look::Lamp(..)));
        }
        let look = match item {
            Item::Material(number) => Look::Material(number),
            Item::Lamp(block) => Look::Lamp(block.form, block.colour),
        };
        let known = self.textures.iter().find(|(known, _)| *known == look);
        if let Some((_, texture)) = known {
            return Some(texture.id());
        }
        // Textures of blocks take milliseconds to bake.
        let frame = context.cumulative_frame_nr();
        if self.made_in == Some(frame) {
            context.request_repaint();
            return None;
        }
        let image = match item {
            Item::Material(number) => {
                let index = usize::from(number).checked_sub(1)?;
                let material = world.materials.get(index)?;
                let set = MaterialSet::bake(std::slice::from_ref(material), world.seed);
                block::of_material(&set)
            }
            Item::Lamp(lamp) => block::of_lamp(&lamp),
        };
        self.made_in = Some(frame);
        let texture = context.load_texture("item", image, TextureOptions::LINEAR);
        let id = texture.id();
        self.textures.push((look, texture));
        Some(id)
    }

    /// Forgets textures that belonged to a lost device.
    pub fn forget_textures(&mut self) {
        self.textures.clear();
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::world::{file, placed::LampBlock};

    fn world(name: &str) -> World {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        file::load(&path, &file::Overrides::default()).expect("it loads")
    }

    #[test]
    fn a_frame_makes_one_picture_and_another_world_has_others() {
        let context = Context::default();
        let (cave, small) = (world("worlds/cave.ron"), world("worlds/minimal.ron"));
        let mut pictures = Pictures::default();
        let lamp = Item::Lamp(LampBlock::default());
        let mut made = Vec::new();
        let frame = |draw: &mut dyn FnMut(&Context)| {
            let mut output = context.run_ui(Default::default(), |ui| draw(ui.ctx()));
            // Nobody draws them.
            output.textures_delta.clear();
        };
        for _ in 0..3 {
            frame(&mut |context| {
                let of = |item| pictures.of(context, &cave, item).is_some();
                made.push([Item::Material(1), lamp, Item::Material(2)].map(of));
            });
        }
        assert_eq!(made, [[true, false, false], [true, true, false], [true; 3]]);
        frame(&mut |context| {
            let mut of = |item| pictures.of(context, &small, item).is_some();
            assert!(of(lamp) && of(Item::Material(1)));
            assert!(!of(Item::Material(2)) && !of(Item::Material(0)));
        });
        assert_eq!(pictures.textures.len(), 2);
    }
}
