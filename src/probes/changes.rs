//! What probes are told about changes: lamps and voxels change on the CPU, so these changes are known
//! at once and without noise. Each probe finds out itself where and when their light arrives.

use glam::{IVec3, Vec3};

use super::repeats::{GreatChange, Repeats};

crate::shared! {
    in probes;

    /// Edits that are tracked separately; further ones are merged.
    pub const EDITS: usize = 8;

    /// A body that moves at least so far in a frame (voxels) jumps. Nobody knows which probes saw it where it was, so all of
    /// them measure their distances anew.
    pub(crate) const BODY_JUMP: f32 = 4.0;
}

/// From this alert on, light changes greatly, as when a lamp is switched; lamps that glide or flicker stay below.
pub(crate) const GREAT_ALERT: f32 = 0.25;
/// Frames for which a great change counts as one: until its light has gone through a few bounces. Light that is followed
/// as after a switch for longer comes late where a lamp was switched and glides on.
const GREAT_FRAMES: u32 = 18;
/// Share of an alert that remains after one frame: bounces take several frames, and sleeping probes
/// update only every tenth frame.
const ALERT_KEPT: f32 = 0.95;
/// Smaller alerts count as none.
const LEAST_ALERT: f32 = 0.002;
/// After this many frames without a change the light starts to count as still; it counts fully as still
/// another STILLER_FRAMES later. Until then probes settle.
const STILL_FRAMES: u32 = 64;
const STILLER_FRAMES: u32 = 64;
/// A body that moves this far in a frame (voxels) counts as a full change.
const FAR_VOXELS: f32 = 16.0;
/// Length of an edit (voxels) from which it may change the light of all of a large world.
const WIDE_EDIT: f32 = 12.0;
/// Frames after which an edit is forgotten: longer than any history.
const REMEMBERED_FRAMES: u32 = 2048;

/// A sphere (world space, voxels) within which voxels have changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EditSphere {
    pub centre_ws: Vec3,
    pub radius: f32,
    /// The first frame that shows the edit.
    pub frame: u32,
    /// The first frame that measures distances after it: rays that are repeated measure none.
    pub measured_from: u32,
}

/// A box (grid space) within which voxels have changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EditBox {
    pub low_gs: Vec3,
    pub high_gs: Vec3,
}

/// How much light changes when the point of a body that moves farthest goes this way (voxels) in a frame: as
/// [`crate::lights::Lights::change_since`] says it of lamps. A body hides or reflects a part of the light only.
pub fn change_of_bodies(way: f32) -> f32 {
    (way / FAR_VOXELS).min(1.0)
}

/// The recent changes of lamps and voxels. Edits are noted here once; probes and surface cache read them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    alert: f32,
    /// The same, of changes that may concern every probe: of lamps, bodies, and large edits.
    wide_alert: f32,
    /// Frames since there was a change or an alert.
    still_frames: u32,
    /// Frames since lamps or bodies have changed.
    steady_frames: u32,
    edits: Vec<EditSphere>,
    /// Whether voxels were edited since the last frame.
    pending: Option<EditBox>,
    shown_first: Option<EditBox>,
    /// The newest edits, and the first frame that shows them.
    latest: Option<(EditBox, u32)>,
    /// The first frame that showed the edits before those.
    before_latest: Option<u32>,
    /// The last frame that was the first to show a great change of light.
    great: Option<u32>,
    bodies_jumped: u32,
    repeats: Repeats,
}

impl Changes {
    /// Voxels may have changed: `first` and `last` in grid space, both inclusive. `origin_ws` is the world position
    /// of the grid; `frame` is the next one.
    pub fn edit(&mut self, first: IVec3, last: IVec3, origin_ws: IVec3, frame: u32) {
        let (low, high) = (first.as_vec3(), last.as_vec3() + 1.0);
        let added = EditBox {
            low_gs: low,
            high_gs: high,
        };
        self.pending = Some(self.pending.map_or(added, |before| before.joined(&added)));
        self.edits.push(EditSphere {
            centre_ws: (low + high) / 2.0 + origin_ws.as_vec3(),
            radius: low.distance(high) / 2.0,
            frame,
            measured_from: frame,
        });
        while self.edits.len() > EDITS {
            self.join_nearest();
        }
    }

    /// In this frame a body came, went or moved by `BODY_JUMP` or more.
    pub fn bodies_jump(&mut self, frame: u32) {
        self.bodies_jumped = frame;
    }

    /// The last frame in which bodies did so; 0 if they never did.
    pub fn bodies_jumped(&self) -> u32 {
        self.bodies_jumped
    }

    /// Begins a frame in which the lights differ by `light_change` from the frame before
    /// ([`crate::lights::Lights::change_since`]).
    pub fn begin_frame(&mut self, light_change: f32, frame: u32) {
        let faded = self.alert * ALERT_KEPT;
        let wide = self.wide_alert * ALERT_KEPT;
        self.shown_first = self.pending.take();
        if let Some(edit) = self.shown_first {
            self.before_latest = self.latest.map(|(_, frame)| frame);
            self.latest = Some((edit, frame));
        }
        let sure = f32::from(u8::from(self.shown_first.is_some()));
        let of_light = light_change.clamp(0.0, 1.0);
        self.alert = sure.max(of_light).max(faded);
        let is_wide = self.shown_first.is_some_and(EditBox::is_wide);
        let of_edit = if is_wide { 1.0 } else { 0.0 };
        self.wide_alert = of_light.max(of_edit).max(wide);
        if self.alert < LEAST_ALERT {
            self.alert = 0.0;
        }
        self.still_frames = if light_change > 0.0 || self.alert > 0.0 || frame == 0 {
            0
        } else {
            self.still_frames.saturating_add(1)
        };
        self.steady_frames = if light_change > 0.0 {
            0
        } else {
            self.steady_frames.saturating_add(1)
        };
        let great = if light_change >= GREAT_ALERT {
            Some(GreatChange::Light)
        } else {
            self.shown_first.map(|_| GreatChange::Edit)
        };
        if great.is_some() {
            self.great = Some(frame);
        }
        self.repeats.begin_frame(great, frame);
        if let Some(first) = self.repeats.great_since() {
            for edit in self.edits.iter_mut().filter(|edit| edit.frame >= first) {
                edit.measured_from = frame + 1;
            }
        }
        self.edits
            .retain(|edit| frame.saturating_sub(edit.frame) < REMEMBERED_FRAMES);
    }

    /// Which rays of probes are repeated.
    pub fn repeats(&self) -> Repeats {
        self.repeats
    }

    /// Forgets all edits: frame numbers start from 0 again, and no probe has a history.
    pub fn forget_edits(&mut self) {
        self.edits.clear();
        self.latest = None;
        self.before_latest = None;
        self.great = None;
        self.bodies_jumped = 0;
        self.repeats = Repeats::default();
    }

    /// The edits that this frame is the first to show.
    pub fn shown_first(&self) -> Option<EditBox> {
        self.shown_first
    }

    /// The newest edits, and the first frame that shows them.
    pub fn latest_edit(&self) -> Option<(EditBox, u32)> {
        self.latest
    }

    /// Confidence that light is changing now, 0 to 1.
    pub fn alert(&self) -> f32 {
        self.alert
    }

    /// The same, of changes that may concern every probe of a world: small edits concern those around them.
    pub fn wide_alert(&self) -> f32 {
        self.wide_alert
    }

    /// Whether light changes greatly now, as after a switched lamp or an edit.
    pub fn are_great(&self, frame: u32) -> bool {
        self.alert >= GREAT_ALERT
            && (self.frames_since_great(frame)).is_some_and(|since| since < GREAT_FRAMES)
    }

    /// Frames since the last great change: 0 in the frame that shows it, `None` if there was none.
    pub fn frames_since_great(&self, frame: u32) -> Option<u32> {
        self.great.map(|great| frame.saturating_sub(great))
    }

    /// Frames since the last change or alert: 0 during one.
    pub fn still_frames(&self) -> u32 {
        self.still_frames
    }

    /// Frames since lamps or bodies have changed, whatever was edited: 0 while they change.
    pub fn steady_frames(&self) -> u32 {
        self.steady_frames
    }

    /// Confidence that light has not changed for a long time, 0 to 1.
    pub fn stillness(&self) -> f32 {
        let still = self.still_frames.saturating_sub(STILL_FRAMES);
        (still as f32 / STILLER_FRAMES as f32).min(1.0)
    }

    /// At most [`EDITS`].
    pub fn edits(&self) -> &[EditSphere] {
        &self.edits
    }

    /// The first frame that showed the edits before the newest ones.
    pub fn edit_before(&self) -> Option<u32> {
        self.before_latest
    }

    /// Merges the two edits whose common sphere is smallest.
    fn join_nearest(&mut self) {
        let count = self.edits.len();
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        let joined = pairs.map(|(a, b)| (a, b, self.edits[a].joined(&self.edits[b])));
        if let Some((a, b, sphere)) = joined.min_by(|x, y| x.2.radius.total_cmp(&y.2.radius)) {
            self.edits.remove(b);
            self.edits[a] = sphere;
        }
    }
}

impl EditBox {
    fn is_wide(self) -> bool {
        (self.high_gs - self.low_gs).max_element() > WIDE_EDIT
    }

    /// The smallest box around both.
    fn joined(&self, other: &Self) -> Self {
        Self {
            low_gs: self.low_gs.min(other.low_gs),
            high_gs: self.high_gs.max(other.high_gs),
        }
    }
}

impl EditSphere {
    /// The smallest sphere around both; its frame is the newer one.
    fn joined(&self, other: &Self) -> Self {
        let frame = self.frame.max(other.frame);
        let measured_from = self.measured_from.max(other.measured_from);
        let (large, small) = if self.radius >= other.radius {
            (self, other)
        } else {
            (other, self)
        };
        let offset = small.centre_ws - large.centre_ws;
        let apart = offset.length();
        if apart + small.radius <= large.radius {
            return Self {
                frame,
                measured_from,
                ..*large
            };
        }
        let radius = (apart + large.radius + small.radius) / 2.0;
        Self {
            centre_ws: large.centre_ws + offset * ((radius - large.radius) / apart),
            radius,
            frame,
            measured_from,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn light_is_still_long_after_the_last_change() {
        let mut changes = Changes::default();
        let after = |changes: &mut Changes, light_change: f32, frames: std::ops::Range<u32>| {
            for frame in frames {
                changes.begin_frame(light_change, frame);
            }
            changes.stillness()
        };
        assert_eq!(after(&mut changes, 0.0, 0..60), 0.0, "probes are new");
        assert_eq!(after(&mut changes, 0.0, 60..200), 1.0);
        // Too little for an alert.
        assert_eq!(after(&mut changes, 1e-4, 200..201), 0.0);
        assert_eq!(after(&mut changes, 0.0, 201..400), 1.0);
        changes.edit(IVec3::ZERO, IVec3::ONE, IVec3::ZERO, 400);
        assert_eq!(
            after(&mut changes, 0.0, 400..560),
            0.0,
            "the alert has to fade"
        );
        assert_eq!(after(&mut changes, 0.0, 560..700), 1.0);
    }

    #[test]
    fn an_alert_is_there_at_once_and_fades() {
        let mut changes = Changes::default();
        changes.begin_frame(0.0, 0);
        assert_eq!(changes.alert(), 0.0);
        changes.begin_frame(0.8, 1);
        assert_eq!(changes.alert(), 0.8);
        changes.begin_frame(0.1, 2);
        assert!((changes.alert() - 0.76).abs() < 1e-6, "{}", changes.alert());
        for frame in 3..200 {
            changes.begin_frame(0.0, frame);
        }
        assert_eq!(changes.alert(), 0.0);
    }

    #[test]
    fn only_large_edits_and_lamps_alert_every_probe() {
        let mut changes = Changes::default();
        changes.edit(IVec3::ZERO, IVec3::splat(4), IVec3::ZERO, 3);
        changes.begin_frame(0.0, 3);
        assert_eq!((changes.alert(), changes.wide_alert()), (1.0, 0.0));
        changes.edit(IVec3::ZERO, IVec3::new(31, 0, 0), IVec3::ZERO, 4);
        changes.begin_frame(0.0, 4);
        assert_eq!(changes.wide_alert(), 1.0);
        let mut changes = Changes::default();
        // Single voxels far apart, in one frame.
        for corner in [IVec3::ZERO, IVec3::splat(20)] {
            changes.edit(corner, corner, IVec3::ZERO, 3);
        }
        changes.begin_frame(0.0, 3);
        assert_eq!(changes.wide_alert(), 1.0);
        let mut changes = Changes::default();
        changes.begin_frame(0.6, 3);
        changes.begin_frame(0.0, 4);
        assert!((changes.wide_alert() - 0.57).abs() < 1e-6);
    }

    #[test]
    fn an_edit_alerts_the_next_frame_and_is_remembered_for_a_while() {
        let mut changes = Changes::default();
        changes.edit(IVec3::splat(1), IVec3::splat(2), IVec3::ONE, 5);
        changes.begin_frame(0.0, 5);
        assert_eq!(changes.alert(), 1.0);
        let seen_first = EditBox {
            low_gs: Vec3::splat(1.0),
            high_gs: Vec3::splat(3.0),
        };
        assert_eq!(changes.shown_first(), Some(seen_first));
        let edit = changes.edits()[0];
        assert_eq!(edit.centre_ws, Vec3::splat(3.0));
        assert!((edit.radius - 3f32.sqrt()).abs() < 1e-6);
        changes.begin_frame(0.0, 6);
        assert!(changes.alert() < 1.0 && changes.edits().len() == 1);
        assert_eq!(changes.shown_first(), None);
        assert_eq!(changes.latest_edit(), Some((seen_first, 5)));
        changes.begin_frame(0.0, 5 + REMEMBERED_FRAMES);
        assert!(changes.edits().is_empty());
    }

    #[test]
    fn a_great_change_ends_before_its_alert() {
        let mut changes = Changes::default();
        let mut great = Vec::new();
        for frame in 0..120 {
            if frame == 70 {
                changes.edit(IVec3::ZERO, IVec3::ONE, IVec3::ZERO, frame);
            }
            let light_change = match frame {
                10 => 1.0,
                // Its alert is below GREAT_ALERT after four frames.
                50 => 0.3,
                _ => 0.0,
            };
            changes.begin_frame(light_change, frame);
            if changes.are_great(frame) {
                great.push(frame);
            }
        }
        let expected: Vec<u32> = (10..28).chain(50..54).chain(70..88).collect();
        assert_eq!(great, expected);
    }

    #[test]
    fn a_wandering_lamp_keeps_the_alert_low() {
        let mut changes = Changes::default();
        for frame in 0..1000 {
            changes.begin_frame(0.02, frame);
        }
        assert_eq!(changes.alert(), 0.02);
    }

    proptest! {
        #[test]
        fn merged_edits_cover_all_edits(
            places in prop::collection::vec((-50..50i32, -50..50i32, 1..6i32), 1..40),
        ) {
            let mut changes = Changes::default();
            for (frame, &(x, y, edge)) in places.iter().enumerate() {
                let min = IVec3::new(x, y, x - y);
                changes.edit(min, min + edge, IVec3::ZERO, frame as u32);
            }
            prop_assert!(changes.edits().len() <= EDITS);
            for (frame, &(x, y, edge)) in places.iter().enumerate() {
                let min = IVec3::new(x, y, x - y).as_vec3();
                let corners = [min, min + edge as f32 + 1.0];
                let covers = |edit: &EditSphere| {
                    corners.iter().all(|c| c.distance(edit.centre_ws) <= edit.radius + 1e-2)
                        && edit.frame >= frame as u32
                };
                prop_assert!(changes.edits().iter().any(covers));
            }
        }
    }

    #[test]
    fn frames_are_counted_since_the_last_great_change() {
        let mut changes = Changes::default();
        changes.begin_frame(0.2, 0);
        assert_eq!(changes.frames_since_great(0), None, "a lamp that glides");
        changes.begin_frame(1.0, 1);
        assert_eq!(changes.frames_since_great(1), Some(0));
        changes.begin_frame(0.2, 2);
        assert_eq!(changes.frames_since_great(2), Some(1));
        changes.edit(IVec3::ZERO, IVec3::ONE, IVec3::ZERO, 5);
        changes.begin_frame(0.0, 5);
        assert_eq!(changes.frames_since_great(7), Some(2), "an edit");
        changes.forget_edits();
        assert_eq!(changes.frames_since_great(8), None);
    }
}
