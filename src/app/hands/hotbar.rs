//! The ten items at hand, one of which is in the hand.

use super::item::Item;
use crate::world::{
    World,
    placed::{LampBlock, LampColour, LampForm, LampMotion},
    save::{SavedHotbar, SavedItem},
};

pub const SLOTS: usize = 10;

/// Ten slots, of which one is selected.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hotbar {
    slots: [Option<Item>; SLOTS],
    selected: usize,
}

/// What the last slots hold at first.
const LAMPS: [LampBlock; 3] = [
    LampBlock {
        form: LampForm::Point,
        colour: LampColour::Warm,
        power: 1500.0,
        radius: 0.25,
        soft_radius: 0.0,
        motion: LampMotion::Still,
    },
    LampBlock {
        form: LampForm::Point,
        colour: LampColour::Amber,
        power: 800.0,
        radius: 0.25,
        soft_radius: 0.0,
        motion: LampMotion::Flicker,
    },
    LampBlock {
        form: LampForm::Spot,
        colour: LampColour::White,
        power: 4000.0,
        radius: 0.25,
        soft_radius: 0.0,
        motion: LampMotion::Still,
    },
];

impl Hotbar {
    /// That of the save that the world was restored from, else the first materials of the world, and three lamps.
    pub fn of(world: &World) -> Self {
        let saved = &world.restored.hotbar;
        if !saved.slots.is_empty() {
            return Self::restored(saved, world);
        }
        let mut hotbar = Self::default();
        let (materials, lamps) = hotbar.slots.split_at_mut(SLOTS - LAMPS.len());
        for (slot, item) in materials.iter_mut().zip(Item::materials(world)) {
            *slot = Some(item);
        }
        for (slot, block) in lamps.iter_mut().zip(LAMPS) {
            *slot = Some(Item::Lamp(block));
        }
        hotbar
    }

    /// Leaves out materials that the world does not have, and lamps that cannot be.
    fn restored(saved: &SavedHotbar, world: &World) -> Self {
        let mut hotbar = Self::default();
        for (slot, item) in hotbar.slots.iter_mut().zip(&saved.slots) {
            *slot = item.as_ref().and_then(|item| match item {
                SavedItem::Material(name) => Item::materials(world)
                    .find(|item| item.name(world).is_some_and(|known| known == *name)),
                SavedItem::Lamp(block) => block.fault().is_none().then_some(Item::Lamp(*block)),
            });
        }
        hotbar.select(saved.selected);
        hotbar
    }

    /// For a save of a run in this world.
    pub fn saved(&self, world: &World) -> SavedHotbar {
        let saved = |item: &Item| match item {
            Item::Material(_) => item.name(world).map(SavedItem::Material),
            Item::Lamp(block) => Some(SavedItem::Lamp(*block)),
        };
        SavedHotbar {
            slots: self
                .slots
                .iter()
                .map(|slot| slot.as_ref().and_then(saved))
                .collect(),
            selected: self.selected,
        }
    }

    /// What is in the hand.
    pub fn item(&self) -> Option<Item> {
        self.slots[self.selected]
    }

    pub fn slots(&self) -> &[Option<Item>; SLOTS] {
        &self.slots
    }

    pub fn selected(&self) -> usize {
        self.selected
    }

    /// Slots that do not exist stay unselected.
    pub fn select(&mut self, slot: usize) {
        if slot < SLOTS {
            self.selected = slot;
        }
    }

    /// Goes this many slots to the right; after the last comes the first.
    pub fn scroll(&mut self, slots: i32) {
        let right = slots.rem_euclid(SLOTS as i32) as usize;
        self.selected = (self.selected + right) % SLOTS;
    }

    /// Puts an item into a slot.
    pub fn put(&mut self, slot: usize, item: Item) {
        if let Some(slot) = self.slots.get_mut(slot) {
            *slot = Some(item);
        }
    }

    /// Takes an item into the hand: from the slot that has it, else into the selected slot.
    pub fn pick(&mut self, item: Item) {
        match self.slots.iter().position(|slot| *slot == Some(item)) {
            Some(slot) => self.selected = slot,
            None => self.slots[self.selected] = Some(item),
        }
    }

    /// Empties slots whose material the world does not have, as after an edit of its file.
    pub fn fit(&mut self, world: &World) {
        for slot in &mut self.slots {
            slot.take_if(|item| item.name(world).is_none());
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::world::file;

    fn world(name: &str) -> World {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        file::load(&path, &file::Overrides::default()).expect("it loads")
    }

    #[test]
    fn a_new_hotbar_has_the_worlds_materials_and_lamps() {
        let small = Hotbar::of(&world("worlds/minimal.ron"));
        assert_eq!(small.item(), Some(Item::Material(1)));
        assert_eq!(small.slots()[1..7], [None; 6]);
        let large = Hotbar::of(&world("worlds/cave.ron"));
        assert_eq!(large.slots()[6], Some(Item::Material(7)));
        for hotbar in [small, large] {
            let is_lamp = |slot: &Option<Item>| matches!(slot, Some(Item::Lamp(_)));
            assert!(hotbar.slots()[7..].iter().all(is_lamp));
        }
        assert!(LAMPS.iter().all(|block| block.fault().is_none()));
    }

    #[test]
    fn slots_are_chosen_by_number_and_by_the_wheel_round_and_round() {
        let mut hotbar = Hotbar::of(&world("worlds/cave.ron"));
        hotbar.select(9);
        hotbar.scroll(1);
        assert_eq!(hotbar.selected(), 0);
        hotbar.scroll(-3);
        assert_eq!(hotbar.selected(), 7);
        hotbar.scroll(i32::MIN);
        assert!(hotbar.selected() < SLOTS);
        hotbar.select(SLOTS);
        hotbar.put(SLOTS, Item::Material(1));
        assert_eq!(
            hotbar.slots(),
            Hotbar::of(&world("worlds/cave.ron")).slots()
        );
    }

    #[test]
    fn an_item_is_picked_from_its_slot_or_into_the_hand() {
        let mut hotbar = Hotbar::of(&world("worlds/cave.ron"));
        hotbar.pick(Item::Material(3));
        assert_eq!(hotbar.selected(), 2);
        let unknown = Item::Lamp(LampBlock {
            colour: LampColour::Violet,
            ..LampBlock::default()
        });
        hotbar.pick(unknown);
        assert_eq!((hotbar.selected(), hotbar.item()), (2, Some(unknown)));
    }

    #[test]
    fn a_save_brings_back_what_was_at_hand() {
        let mut cave = world("worlds/cave.ron");
        let mut hotbar = Hotbar::of(&cave);
        hotbar.put(1, Item::Material(3));
        hotbar.put(4, Item::Lamp(LampBlock::default()));
        hotbar.select(4);
        let saved = hotbar.saved(&cave);
        cave.restored.hotbar = saved.clone();
        assert_eq!(Hotbar::of(&cave), hotbar);
        // Another world has other materials, and a file may hold anything.
        let mut other = world("worlds/minimal.ron");
        other.restored.hotbar = SavedHotbar {
            selected: 99,
            ..saved
        };
        let impossible = LampBlock {
            power: f32::NAN,
            ..LampBlock::default()
        };
        other.restored.hotbar.slots[5] = Some(SavedItem::Lamp(impossible));
        let restored = Hotbar::of(&other);
        assert_eq!((restored.slots()[1], restored.slots()[5]), (None, None));
        assert_eq!(restored.slots()[4], Some(Item::Lamp(LampBlock::default())));
        assert_eq!(restored.selected(), 0);
    }

    #[test]
    fn materials_that_the_world_lost_leave_their_slots() {
        let mut hotbar = Hotbar::of(&world("worlds/cave.ron"));
        hotbar.fit(&world("worlds/minimal.ron"));
        assert_eq!(hotbar, Hotbar::of(&world("worlds/minimal.ron")));
    }
}
