//! The hotbar: ten slots with pictures at the bottom of the window, and the name of what has come into the hand.

use egui::{
    Align2, Area, Color32, FontId, Id, Order, Rect, Sense, Stroke, StrokeKind, Ui, Vec2, pos2, vec2,
};

use super::Pictures;
use crate::{
    app::hands::{Hotbar, Item, hotbar::SLOTS},
    world::World,
};

/// Height of the hotbar with its margin (points).
pub const HEIGHT: f32 = SLOT + 2.0 * MARGIN;
const WIDTH: f32 = SLOT * SLOTS as f32;
const SLOT: f32 = 46.0;
const MARGIN: f32 = 10.0;
/// How long the name is shown, and how long it fades (seconds).
const NAMED_S: f64 = 1.6;
const FADED_S: f64 = 0.4;

/// What the hotbar remembers of the last frames.
#[derive(Default)]
pub struct Bar {
    in_hand: Option<Item>,
    selected: usize,
    /// When that changed (seconds of the window).
    changed_s: Option<f64>,
}

impl Bar {
    /// Draws the hotbar in what panels leave of the window, if they leave enough. Returns the slot that was clicked, where the
    /// mouse is free.
    pub fn show(
        &mut self,
        ui: &Ui,
        world: &World,
        hotbar: &Hotbar,
        pictures: &mut Pictures,
    ) -> Option<usize> {
        let room = ui.available_rect_before_wrap();
        if room.width() < WIDTH {
            return None;
        }
        let area = Area::new(Id::unique("hotbar"))
            .order(Order::Middle)
            .pivot(Align2::CENTER_BOTTOM)
            .fixed_pos(room.center_bottom() - vec2(0.0, MARGIN))
            .show(ui.ctx(), |ui| slots(ui, world, hotbar, pictures));
        self.name(ui, area.response.rect, world, hotbar);
        area.inner
    }

    fn name(&mut self, ui: &Ui, bar: Rect, world: &World, hotbar: &Hotbar) {
        let now_s = ui.input(|input| input.time);
        let (in_hand, selected) = (hotbar.item(), hotbar.selected());
        if (self.in_hand, self.selected) != (in_hand, selected) || self.changed_s.is_none() {
            (self.in_hand, self.selected) = (in_hand, selected);
            self.changed_s = Some(now_s);
        }
        let shown_s = now_s - self.changed_s.unwrap_or(now_s);
        let strength = ((NAMED_S + FADED_S - shown_s) / FADED_S).clamp(0.0, 1.0) as f32;
        let name = in_hand.and_then(|item| item.name(world));
        let Some(name) = name.filter(|_| strength > 0.0) else {
            return;
        };
        let layer = egui::LayerId::new(Order::Middle, Id::unique("name in hand"));
        let painter = ui.ctx().layer_painter(layer);
        let at = bar.center_top() - vec2(0.0, 6.0);
        for (offset, colour) in [
            (vec2(1.0, 1.0), Color32::from_black_alpha(200)),
            (Vec2::ZERO, Color32::WHITE),
        ] {
            painter.text(
                at + offset,
                Align2::CENTER_BOTTOM,
                &name,
                FontId::proportional(16.0),
                colour.gamma_multiply(strength),
            );
        }
    }
}

fn slots(ui: &mut Ui, world: &World, hotbar: &Hotbar, pictures: &mut Pictures) -> Option<usize> {
    let mut clicked = None;
    let size = vec2(WIDTH, SLOT);
    let (bar, response) = ui.allocate_exact_size(size, Sense::click());
    let painter = ui.painter();
    for (index, item) in hotbar.slots().iter().enumerate() {
        let low = bar.min + vec2(SLOT * index as f32, 0.0);
        let slot = Rect::from_min_size(low, Vec2::splat(SLOT));
        painter.rect_filled(slot.shrink(1.0), 3.0, Color32::from_black_alpha(130));
        let texture = item.and_then(|item| pictures.of(ui.ctx(), world, item));
        if let Some(texture) = texture {
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            painter.image(texture, slot.shrink(4.0), whole, Color32::WHITE);
        }
        let line = if index == hotbar.selected() {
            Stroke::new(2.5, Color32::WHITE)
        } else {
            Stroke::new(1.0, Color32::from_white_alpha(70))
        };
        painter.rect_stroke(slot.shrink(1.0), 3.0, line, StrokeKind::Inside);
        painter.text(
            low + vec2(5.0, 3.0),
            Align2::LEFT_TOP,
            (index + 1) % SLOTS,
            FontId::proportional(10.0),
            Color32::from_white_alpha(180),
        );
        let is_here = |at: egui::Pos2| slot.contains(at);
        if response.clicked() && response.interact_pointer_pos().is_some_and(is_here) {
            clicked = Some(index);
        }
    }
    clicked
}
