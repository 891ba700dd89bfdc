//! The hotbar at the bottom of the window, and the inventory: everything that can be placed, with pictures.
//!
//! `block` draws a picture on the CPU, `pictures` keeps them as textures, and `bar` draws the hotbar.

mod bar;
mod block;
mod pictures;

use egui::{
    Align2, Button, ComboBox, Grid, Id, Image, RichText, ScrollArea, Slider, TextWrapMode, Ui,
    Window,
};

use bar::Bar;
use pictures::Pictures;

use super::{
    controls::Bindings,
    hands::{Hotbar, Item},
    input::Input,
    texts::inventory as texts,
    widgets,
};
use crate::world::{
    World,
    placed::{LampBlock, LampColour, LampForm, LampMotion, POWERS, RADII, SOFT_RADII},
};

/// Edge length of a picture in the grid (points), and width of its cell.
const PICTURE: f32 = 52.0;
const CELL: f32 = 92.0;
/// Cells in a row.
const COLUMNS: usize = 6;
const GAP: f32 = 8.0;

/// What a window shows of the items.
#[derive(Default)]
pub struct Items {
    bar: Bar,
    /// While it is open.
    inventory: Option<Inventory>,
    pictures: Pictures,
    /// Part of a notch that the mouse wheel was turned by.
    wheel: f32,
}

impl Items {
    pub fn is_open(&self) -> bool {
        self.inventory.is_some()
    }

    pub fn open(&mut self, hotbar: &Hotbar) {
        self.inventory = Some(Inventory::of(hotbar));
    }

    pub fn close(&mut self) {
        self.inventory = None;
    }

    /// The wheel was turned by so many notches away from the user. Whole notches go through the slots: towards the user
    /// to the right.
    pub fn scroll(&mut self, notches: f32) -> Option<Input> {
        self.wheel += notches;
        let whole = self.wheel.trunc();
        self.wheel -= whole;
        (whole != 0.0).then_some(Input::Scroll(-whole as i32))
    }

    /// Draws the hotbar, and the inventory if it is open. Returns what was chosen in them.
    ///
    /// Hints name the keys of `keys`.
    pub fn show(&mut self, ui: &Ui, world: &World, hotbar: &Hotbar, keys: &Bindings) -> Vec<Input> {
        let clicked = self.bar.show(ui, world, hotbar, &mut self.pictures);
        let inventory = self.inventory.as_mut();
        let taken = inventory.and_then(|one| one.show(ui, world, hotbar, keys, &mut self.pictures));
        let item = taken.map(|item| Input::Item {
            slot: hotbar.selected(),
            item,
        });
        clicked.map(Input::Slot).into_iter().chain(item).collect()
    }

    /// Forgets textures that belonged to a lost device.
    pub fn forget_textures(&mut self) {
        self.pictures.forget_textures();
    }
}

/// A row of the panel for what is in the hand. Returns the material that was chosen for it.
pub fn row(ui: &mut Ui, world: &World, hotbar: &Hotbar) -> Option<Item> {
    ui.label("in the hand").on_hover_text(
        "What a right click places; a middle click takes what is under the crosshair, E shows all there is",
    );
    let name = hotbar.item().and_then(|item| item.name(world));
    let names: Vec<&str> = world.materials.iter().map(|m| &*m.name).collect();
    let mut chosen = name.as_deref().unwrap_or("nothing");
    let is_changed = widgets::choose(ui, "in the hand", &mut chosen, &names);
    ui.end_row();
    let index = names.iter().position(|name| *name == chosen)?;
    is_changed.then(|| Item::materials(world).nth(index))?
}

/// All materials and lamps, and the editor of lamps.
#[derive(Default)]
struct Inventory {
    /// What the editor makes.
    block: LampBlock,
}

impl Inventory {
    /// The editor begins with the lamp in the hand, if there is one.
    fn of(hotbar: &Hotbar) -> Self {
        match hotbar.item() {
            Some(Item::Lamp(block)) => Self { block },
            _ => Self::default(),
        }
    }

    /// Draws the inventory. Returns what goes into the selected slot.
    fn show(
        &mut self,
        ui: &Ui,
        world: &World,
        hotbar: &Hotbar,
        keys: &Bindings,
        pictures: &mut Pictures,
    ) -> Option<Item> {
        let mut taken = None;
        let room = ui.ctx().content_rect().size();
        Window::new(texts::HEADING)
            .id(Id::unique("inventory"))
            .anchor(Align2::CENTER_CENTER, [0.0, -0.5 * bar::HEIGHT])
            .collapsible(false)
            .resizable(false)
            .show(ui.ctx(), |ui| {
                let height = (room.y - bar::HEIGHT - 180.0).max(80.0);
                ScrollArea::vertical().max_height(height).show(ui, |ui| {
                    ui.weak(keys.fill(texts::ABOUT));
                    ui.add_space(GAP);
                    ui.strong(texts::MATERIALS);
                    let materials: Vec<Item> = Item::materials(world).collect();
                    taken = cells(ui, "materials", world, hotbar, pictures, &materials);
                    ui.add_space(GAP);
                    ui.strong(texts::LAMPS);
                    let lamps: Vec<Item> = self.kinds().map(Item::Lamp).collect();
                    if let Some(item) = cells(ui, "lamps", world, hotbar, pictures, &lamps) {
                        if let Item::Lamp(block) = item {
                            self.block = block;
                        }
                        taken = Some(item);
                    }
                });
                ui.separator();
                taken = self.editor(ui, world, hotbar, pictures).or(taken);
            });
        taken
    }

    /// A lamp of each form and colour; otherwise like the one in the editor.
    fn kinds(&self) -> impl Iterator<Item = LampBlock> {
        let block = self.block;
        LampForm::ALL.into_iter().flat_map(move |form| {
            LampColour::ALL.into_iter().map(move |colour| LampBlock {
                form,
                colour,
                ..block
            })
        })
    }

    /// Changes the lamp in the hand, or makes one to be taken.
    fn editor(
        &mut self,
        ui: &mut Ui,
        world: &World,
        hotbar: &Hotbar,
        pictures: &mut Pictures,
    ) -> Option<Item> {
        let before = self.block;
        let in_hand = hotbar.item() == Some(Item::Lamp(before));
        let mut taken = None;
        ui.horizontal(|ui| {
            if let Some(texture) = pictures.of(ui.ctx(), world, Item::Lamp(before)) {
                ui.add(Image::new((texture, egui::vec2(PICTURE, PICTURE))));
            }
            Grid::new("lamp editor")
                .num_columns(4)
                .spacing([10.0, 4.0])
                .show(ui, |ui| {
                    let block = &mut self.block;
                    ui.label(texts::KIND);
                    choose(ui, "form", &mut block.form, &LampForm::ALL, LampForm::name);
                    ui.label(texts::POWER);
                    ui.add(
                        Slider::new(&mut block.power, POWERS)
                            .logarithmic(true)
                            .fixed_decimals(0)
                            .suffix(" W"),
                    );
                    ui.end_row();
                    ui.label(texts::COLOUR);
                    choose(
                        ui,
                        "colour",
                        &mut block.colour,
                        &LampColour::ALL,
                        LampColour::name,
                    );
                    ui.label(texts::RADIUS).on_hover_text(texts::RADIUS_HINT);
                    ui.add(Slider::new(&mut block.radius, RADII).fixed_decimals(2));
                    ui.end_row();
                    ui.label(texts::MOTION);
                    choose(
                        ui,
                        "motion",
                        &mut block.motion,
                        &LampMotion::ALL,
                        LampMotion::name,
                    );
                    ui.label(texts::SOFT).on_hover_text(texts::SOFT_HINT);
                    ui.add(Slider::new(&mut block.soft_radius, SOFT_RADII).fixed_decimals(2));
                    ui.end_row();
                });
            if !in_hand && ui.button(texts::TAKE).clicked() {
                taken = Some(Item::Lamp(self.block));
            }
        });
        if in_hand && self.block != before {
            taken = Some(Item::Lamp(self.block));
        }
        taken
    }
}

fn choose<T: Copy + PartialEq>(
    ui: &mut Ui,
    id: &str,
    chosen: &mut T,
    all: &[T],
    name: impl Fn(T) -> &'static str,
) {
    ComboBox::from_id_salt(id)
        .selected_text(name(*chosen))
        .show_ui(ui, |ui| {
            for one in all {
                ui.selectable_value(chosen, *one, name(*one));
            }
        });
}

/// A grid of items. Returns the one that was clicked.
fn cells(
    ui: &mut Ui,
    id: &str,
    world: &World,
    hotbar: &Hotbar,
    pictures: &mut Pictures,
    items: &[Item],
) -> Option<Item> {
    let mut clicked = None;
    Grid::new(id).spacing([4.0, 4.0]).show(ui, |ui| {
        for (index, item) in items.iter().enumerate() {
            ui.vertical_centered(|ui| {
                ui.set_width(CELL);
                let size = egui::vec2(PICTURE, PICTURE);
                let button = match pictures.of(ui.ctx(), world, *item) {
                    Some(texture) => Button::image(Image::new((texture, size))),
                    None => Button::new("").min_size(size),
                };
                let button = button.selected(hotbar.item() == Some(*item));
                let name = item.name(world).unwrap_or_default();
                if ui.add(button).on_hover_text(&name).clicked() {
                    clicked = Some(*item);
                }
                let short = match item {
                    Item::Material(_) => name,
                    Item::Lamp(block) => format!("{} {}", block.colour.name(), block.form.name()),
                };
                let label = egui::Label::new(RichText::new(short).small());
                ui.add(label.wrap_mode(TextWrapMode::Truncate));
            });
            if (index + 1) % COLUMNS == 0 {
                ui.end_row();
            }
        }
    });
    clicked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_notches_of_the_wheel_go_through_the_slots() {
        let mut items = Items::default();
        assert_eq!(items.scroll(1.0), Some(Input::Scroll(-1)));
        assert_eq!(items.scroll(-2.0), Some(Input::Scroll(2)));
        let parts: Vec<_> = (0..8).filter_map(|_| items.scroll(0.25)).collect();
        assert_eq!(parts, [Input::Scroll(-1), Input::Scroll(-1)]);
    }
}
