//! A copy of a box of voxels: two corners mark the box, and the copy is pasted at the face aimed at, as often as
//! wanted.
//!
//! Materials go by name, so a copy can be pasted in another world, as far as that has them. Lamps are not copied.

use std::collections::BTreeMap;

use glam::IVec3;
use serde::{Deserialize, Serialize};

use super::{aim::Target, brush::Stroked, history::Changes};
use crate::{
    app::texts::hands as texts,
    reference::march::FACE_NORMALS,
    world::{Material, bodies::BodyModel, voxels::Voxels},
};

/// Longest edge of a copy (voxels).
pub const MOST_EDGE: i32 = 64;

/// What a user does with the clipboard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Clip {
    /// Marks the voxel aimed at as a corner; the second corner copies the box.
    Mark,
    /// Takes the copy out, or pastes it where the player aims.
    Paste,
    /// Turns the copy by 90° about the vertical.
    Turn,
    /// Air of the copy is pasted too, or not.
    Air,
    /// Forgets the corner, or puts the copy away.
    Cancel,
    /// Lifts the marked box, or what the brush covers, out of the world as a body; or places the copy as one.
    Lift,
    /// Sets the body aimed at into the world.
    Settle,
}

/// Voxels that were copied.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Copied {
    size: IVec3,
    /// Index x + size.x · (y + size.y · z): 0 is air, n the n-th of `materials`.
    voxels: Vec<u8>,
    materials: Vec<String>,
}

/// What the hands hold of a copy.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Clipboard {
    /// The first corner of the box that is being marked (world space).
    pub corner: Option<IVec3>,
    pub copied: Option<Copied>,
    /// Whether the copy is out: its place is outlined, and it can be pasted.
    pub is_out: bool,
    /// Whether air is pasted too. If not, what lies there stays.
    pub with_air: bool,
}

/// What a paste did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pasted {
    pub stroked: Stroked,
    /// Voxels that have another material now.
    pub changed: u64,
    /// Materials that this world lacks, and how many voxels of the copy have them: they were left out.
    pub missing: BTreeMap<String, u64>,
    /// Solid voxels of the copy that lie outside of the world.
    pub outside: u64,
}

impl Clipboard {
    /// Whether a corner is marked or the copy is out.
    pub fn is_active(&self) -> bool {
        self.corner.is_some() || self.is_out
    }

    /// The box that would be copied or pasted at a target: its lowest and highest voxel (grid space) in a world with
    /// this origin.
    pub fn extent(&self, origin: IVec3, target: &Target) -> Option<(IVec3, IVec3)> {
        if let Some(corner) = self.corner {
            let corner = corner - origin;
            return Some((corner.min(target.voxel), corner.max(target.voxel)));
        }
        let copied = self.copied.as_ref().filter(|_| self.is_out)?;
        let low = copied.place(target);
        Some((low, low + copied.size - 1))
    }

    /// What is in progress, in words.
    pub fn text(&self, origin: IVec3, target: Option<&Target>) -> Option<String> {
        if self.corner.is_some() {
            let extent = target.and_then(|target| self.extent(origin, target));
            let size = extent.map(|(low, high)| size_text(high - low + 1));
            return Some(size.unwrap_or_else(|| texts::CORNER.to_owned()));
        }
        let copied = self.copied.as_ref().filter(|_| self.is_out)?;
        Some(texts::copy(&size_text(copied.size), self.with_air))
    }
}

impl Copied {
    /// The voxels of a box (grid space, both ends inclusive).
    pub fn of(voxels: &Voxels, materials: &[Material], low: IVec3, high: IVec3) -> Self {
        let size = high - low + 1;
        let mut names: Vec<String> = Vec::new();
        // The copy's number of each of the world's materials.
        let mut numbers = [0u8; 256];
        let copied = offsets(size).map(|offset| {
            let material = usize::from(voxels.material(low + offset));
            let name = material.checked_sub(1).and_then(|at| materials.get(at));
            let Some(Material { name, .. }) = name else {
                return 0;
            };
            if numbers[material] == 0 {
                names.push(name.clone());
                numbers[material] = names.len() as u8;
            }
            numbers[material]
        });
        Self {
            size,
            voxels: copied.collect(),
            materials: names,
        }
    }

    pub fn size(&self) -> IVec3 {
        self.size
    }

    /// Voxels that are not air.
    pub fn solid(&self) -> usize {
        self.voxels.iter().filter(|voxel| **voxel != 0).count()
    }

    fn at(&self, offset: IVec3) -> u8 {
        let [x, y, z] = offset.to_array();
        self.voxels[(x + self.size.x * (y + self.size.y * z)) as usize]
    }

    /// The copy turned by 90°, counterclockwise as seen from above.
    pub fn turned(&self) -> Self {
        let size = IVec3::new(self.size.z, self.size.y, self.size.x);
        let before = |offset: IVec3| IVec3::new(self.size.x - 1 - offset.z, offset.y, offset.x);
        Self {
            size,
            voxels: offsets(size)
                .map(|offset| self.at(before(offset)))
                .collect(),
            materials: self.materials.clone(),
        }
    }

    /// The copy as the model of a body, and where its lowest voxel goes at a target (grid space). With the materials that
    /// this world lacks, and the number of voxels that are left out for that; `None` if none is left.
    pub fn as_body(
        &self,
        materials: &[Material],
        target: &Target,
    ) -> (Option<(BodyModel, IVec3)>, BTreeMap<String, u64>) {
        let known = self.numbers_in(materials);
        let mut missing = BTreeMap::new();
        let voxels = self.voxels.iter().map(|number| {
            let Some(number) = usize::from(*number).checked_sub(1) else {
                return 0;
            };
            known[number].unwrap_or_else(|| {
                *missing.entry(self.materials[number].clone()).or_default() += 1;
                0
            })
        });
        let model = BodyModel {
            size: self.size.as_uvec3(),
            materials: voxels.collect(),
        };
        let is_empty = model.materials.iter().all(|material| *material == 0);
        let body = (!is_empty).then(|| (model, self.place(target)));
        (body, missing)
    }

    /// The number of each material of the copy in a world, if that has it.
    fn numbers_in(&self, materials: &[Material]) -> Vec<Option<u8>> {
        let number = |name: &String| {
            let at = materials.iter().position(|material| material.name == *name);
            at.and_then(|at| u8::try_from(at + 1).ok())
        };
        self.materials.iter().map(number).collect()
    }

    /// Where the lowest voxel of the copy goes (grid space): it touches the face aimed at, its middle before that, and
    /// stands on the height aimed at.
    fn place(&self, target: &Target) -> IVec3 {
        let at = target.before().unwrap_or(target.voxel);
        let mut low = at - (self.size - 1) / 2;
        low.y = at.y;
        if let Some(face) = target.face {
            let normal = FACE_NORMALS[usize::from(face)];
            let axis = usize::from(face / 2);
            low[axis] = match normal[axis] {
                1 => at[axis],
                _ => at[axis] - (self.size[axis] - 1),
            };
        }
        low
    }

    /// Gives the voxels at the target the materials of the copy. Those for which `is_kept` (grid space) stay as they
    /// are; `with_air`: the copy's air is pasted too.
    pub fn paste(
        &self,
        voxels: &mut Voxels,
        materials: &[Material],
        target: &Target,
        with_air: bool,
        is_kept: impl Fn(IVec3) -> bool,
    ) -> Pasted {
        let low = self.place(target);
        let size = voxels.size().as_ivec3();
        let known = self.numbers_in(materials);
        let mut pasted = Pasted::default();
        for offset in offsets(self.size) {
            let Some(number) = usize::from(self.at(offset)).checked_sub(1) else {
                continue;
            };
            let at = low + offset;
            let is_inside = at.cmpge(IVec3::ZERO).all() && at.cmplt(size).all();
            if known[number].is_none() {
                let name = self.materials[number].clone();
                *pasted.missing.entry(name).or_default() += 1;
            } else if !is_inside {
                pasted.outside += 1;
            }
        }
        let changed = &mut pasted.changed;
        let (edit, changes) = Changes::make(voxels, low, low + self.size - 1, |voxel, old| {
            let new = match self.at(voxel - low) {
                0 if with_air => 0,
                0 => old,
                number => known[usize::from(number) - 1].unwrap_or(old),
            };
            let new = if is_kept(voxel) { old } else { new };
            *changed += u64::from(new != old);
            new
        });
        pasted.stroked = Stroked { edit, changes };
        pasted
    }
}

/// All offsets within a box of this size, in the order of [`Copied`]'s voxels.
fn offsets(size: IVec3) -> impl Iterator<Item = IVec3> {
    let IVec3 { x, y, z } = size;
    (0..x * y * z).map(move |index| IVec3::new(index % x, index / x % y, index / (x * y)))
}

/// `X × Y × Z`.
pub fn size_text(size: IVec3) -> String {
    format!("{} × {} × {}", size.x, size.y, size.z)
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};
    use proptest::prelude::*;

    use super::*;
    use crate::{
        app::hands::history::Side,
        world::{Colour, MaterialSound, Pattern},
    };

    const SIZE: i32 = 24;

    fn material(name: &str) -> Material {
        Material {
            name: name.into(),
            a: Colour::Flat(Vec3::ONE),
            b: Colour::Flat(Vec3::ONE),
            pattern: Pattern::Plain,
            emission: Vec3::ZERO,
            sound: MaterialSound::Stone,
        }
    }

    fn materials(names: &[&str]) -> Vec<Material> {
        names.iter().map(|name| material(name)).collect()
    }

    /// Every voxel has a material of its place, or is air.
    fn scene(seed: i32) -> Voxels {
        let mut voxels = Voxels::empty(UVec3::splat(SIZE as u32));
        voxels.edit(IVec3::ZERO, IVec3::splat(SIZE - 1), |at, _| {
            ((at.x * 7 + at.y * 5 + at.z * 3 + at.x * at.z + seed) % 5).clamp(0, 3) as u8
        });
        voxels
    }

    /// A target before whose upper face the copy stands with its lowest voxel at `low`.
    fn below(copied: &Copied, low: IVec3) -> Target {
        let at = low + (copied.size - 1) / 2;
        Target {
            voxel: IVec3::new(at.x, low.y - 1, at.z),
            face: Some(3),
            material: 1,
        }
    }

    fn corners() -> impl Strategy<Value = (IVec3, IVec3)> {
        let place = || (0..SIZE, 1..SIZE, 0..SIZE).prop_map(IVec3::from);
        (place(), place()).prop_map(|(a, b): (IVec3, IVec3)| (a.min(b), a.max(b)))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn a_paste_with_air_restores_what_was_copied_and_an_undo_what_was_before(
            (low, high) in corners(), seed in 1..5i32,
        ) {
            let known = materials(&["a", "b", "c"]);
            let original = scene(0);
            let copied = Copied::of(&original, &known, low, high);
            let mut voxels = scene(seed);
            let before = voxels.crc32();
            let target = below(&copied, low);
            let pasted = copied.paste(&mut voxels, &known, &target, true, |_| false);
            prop_assert!(pasted.missing.is_empty() && pasted.outside == 0);
            for offset in offsets(copied.size) {
                prop_assert_eq!(voxels.material(low + offset), original.material(low + offset));
            }
            prop_assert_eq!(voxels.validate(), Ok(()));
            pasted.stroked.changes.put(&mut voxels, Side::Before);
            prop_assert_eq!(voxels.crc32(), before);
        }

        #[test]
        fn a_paste_without_air_leaves_what_lies_there(
            (low, high) in corners(), seed in 1..5i32,
        ) {
            let known = materials(&["a", "b", "c"]);
            let original = scene(0);
            let copied = Copied::of(&original, &known, low, high);
            let (there, mut voxels) = (scene(seed), scene(seed));
            let kept = low;
            let pasted = copied.paste(&mut voxels, &known, &below(&copied, low), false, |at| at == kept);
            let mut changed = 0;
            for offset in offsets(copied.size) {
                let at = low + offset;
                let expected = match original.material(at) {
                    0 => there.material(at),
                    _ if at == kept => there.material(at),
                    solid => solid,
                };
                prop_assert_eq!(voxels.material(at), expected);
                changed += u64::from(expected != there.material(at));
            }
            prop_assert_eq!(pasted.changed, changed);
        }

        #[test]
        fn four_turns_are_none_and_one_turn_keeps_every_voxel((low, high) in corners()) {
            let known = materials(&["a", "b", "c"]);
            let copied = Copied::of(&scene(0), &known, low, high);
            let turned = copied.turned();
            prop_assert_eq!(turned.solid(), copied.solid());
            for offset in offsets(copied.size) {
                // Counterclockwise from above: what lay towards +x now lies towards −z.
                let after = IVec3::new(offset.z, offset.y, copied.size.x - 1 - offset.x);
                prop_assert_eq!(turned.at(after), copied.at(offset));
            }
            prop_assert_eq!(turned.turned().turned().turned(), copied);
        }

        #[test]
        fn a_copy_touches_the_face_aimed_at_and_stands_on_its_height(
            (low, high) in corners(), face in 0..6u8,
        ) {
            let copied = Copied::of(&scene(0), &materials(&["a", "b", "c"]), low, high);
            let target = Target { voxel: IVec3::splat(50), face: Some(face), material: 1 };
            let at = copied.place(&target);
            let end = at + copied.size - 1;
            let axis = usize::from(face / 2);
            let beside = target.before().expect("a face");
            let touching = if face % 2 == 1 { at[axis] } else { end[axis] };
            prop_assert_eq!(touching, beside[axis]);
            prop_assert!(at.cmple(beside).all() && end.cmpge(beside).all());
            prop_assert!(axis == 1 || at.y == beside.y);
        }
    }

    #[test]
    fn another_world_takes_materials_by_name_and_says_which_it_lacks() {
        let copied = Copied::of(
            &scene(0),
            &materials(&["moss", "rock", "glow"]),
            IVec3::ONE,
            IVec3::splat(8),
        );
        let mut voxels = Voxels::empty(UVec3::splat(SIZE as u32));
        let there = materials(&["sand", "rock"]);
        let target = below(&copied, IVec3::ONE);
        let pasted = copied.paste(&mut voxels, &there, &target, false, |_| false);
        let count = |material: u8| {
            let all = offsets(IVec3::splat(SIZE));
            all.filter(|at| scene(0).material(*at) == material)
                .filter(|at| at.cmpge(IVec3::ONE).all() && at.cmple(IVec3::splat(8)).all())
                .count() as u64
        };
        let missing: Vec<_> = pasted.missing.into_iter().collect();
        assert_eq!(
            missing,
            [("glow".to_owned(), count(3)), ("moss".to_owned(), count(1))]
        );
        assert_eq!(pasted.changed, count(2));
        // Rock is the second here.
        let solid = offsets(IVec3::splat(SIZE)).map(|at| voxels.material(at));
        assert!(
            solid
                .into_iter()
                .all(|material| material == 0 || material == 2)
        );
    }

    #[test]
    fn what_lies_outside_of_the_world_is_counted_and_left_out() {
        let known = materials(&["a", "b", "c"]);
        let mut full = Voxels::empty(UVec3::splat(SIZE as u32));
        full.fill_box(IVec3::ZERO, IVec3::splat(3), 2);
        let copied = Copied::of(&full, &known, IVec3::ZERO, IVec3::splat(3));
        let mut voxels = Voxels::empty(UVec3::splat(SIZE as u32));
        let target = below(&copied, IVec3::new(SIZE - 1, 2, 2));
        let pasted = copied.paste(&mut voxels, &known, &target, true, |_| false);
        assert_eq!((pasted.changed, pasted.outside), (16, 48));
    }

    #[test]
    fn the_box_follows_the_aim_and_its_size_is_told() {
        let target = Target {
            voxel: IVec3::new(3, 4, 5),
            face: Some(3),
            material: 1,
        };
        let origin = IVec3::new(-8, 0, 2);
        let mut clipboard = Clipboard::default();
        assert_eq!(clipboard.extent(origin, &target), None);
        assert_eq!(
            (clipboard.is_active(), clipboard.text(origin, None)),
            (false, None)
        );
        clipboard.corner = Some(IVec3::new(-3, 3, 9));
        let (low, high) = (IVec3::new(3, 3, 5), IVec3::new(5, 4, 7));
        assert_eq!(clipboard.extent(origin, &target), Some((low, high)));
        let told = clipboard.text(origin, Some(&target));
        assert_eq!(told.as_deref(), Some("3 × 2 × 3"));
        let known = materials(&["a", "b", "c"]);
        clipboard = Clipboard {
            copied: Some(Copied::of(&scene(0), &known, low, high)),
            is_out: true,
            with_air: true,
            corner: None,
        };
        let place = (IVec3::new(2, 5, 4), IVec3::new(4, 6, 6));
        assert_eq!(clipboard.extent(origin, &target), Some(place));
        let told = clipboard.text(origin, None);
        assert_eq!(told.as_deref(), Some("copy of 3 × 2 × 3 with air"));
    }
}
