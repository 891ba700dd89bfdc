//! What a world is: shape, materials, features, lights, cameras and probe layouts, as read from a RON
//! file, and the voxels generated from it. Knows no GPU.
//!
//! Spaces: `_ws` is world space (+Y up, right-handed, in voxels; the lamp powers of a file with
//! `voxel_m` other than 1 are converted while it is read, so that one unit is one voxel everywhere
//! after [`file::load`]). `_gs` is grid space: world space minus [`World::origin`], so that the grid
//! begins at 0. Voxel (x, y, z) covers [x, x+1) on each axis, and its shape is sampled at its centre.

pub mod bodies;
pub mod camera;
pub mod features;
pub mod file;
pub mod generate;
pub mod materials;
pub mod new_cave;
pub mod noise;
pub mod placed;
pub mod rules;
pub mod save;
pub mod scenery;
pub mod sdf;
pub mod travel;
pub mod view;
pub mod voxels;

use std::fmt;

use glam::{IVec3, UVec3};

pub use bodies::Bodies;
pub use camera::CameraBasis;
pub use features::FeaturePart;
pub use materials::{Colour, Material, MaterialSound, Pattern, Rule};
pub use noise::NoiseField;
pub use placed::PlacedLamp;
pub use scenery::{
    Camera, Lamp, LampKind, LampPreset, LayoutSpec, Motion, PLAYER_HEIGHT_M, ResponseSpec, Sky,
    Sun, Wall,
};
pub use sdf::Sdf;
pub use travel::Travel;
pub use view::View;
pub use voxels::Overlay;

/// A world as its file describes it, checked: every name resolved, every number finite.
#[derive(Clone, Debug)]
pub struct World {
    /// The file's stem: `cave` for `worlds/cave.ron`.
    pub name: String,
    /// The first sentence of the file.
    pub title: String,
    /// Extent in voxels.
    pub size: UVec3,
    /// World-space coordinates of voxel (0, 0, 0) of the grid.
    pub origin: IVec3,
    /// Metres per voxel, for display only: everything else here is already in voxels.
    pub voxel_m: f32,
    /// Seeds the noise fields, scatters and flickers that name no seed of their own.
    pub seed: u32,
    /// Negative inside the solid.
    pub shape: Sdf,
    /// Referred to by index from [`Sdf`] and [`materials::Condition`].
    pub noises: Vec<NoiseField>,
    /// Material `m` of the voxels is `materials[m - 1]`; 0 is air. At most 255.
    pub materials: Vec<Material>,
    /// The first rule that holds names the material of a solid voxel; the last rule always holds.
    pub rules: Vec<Rule>,
    /// Boxes of voxels that fill air, in order (later ones override earlier ones; rock overrides all).
    pub features: Vec<FeaturePart>,
    /// Voxels that move by themselves; they are not part of the grid.
    pub bodies: Bodies,
    /// Height of the player in voxels: 1.77 m unless the file says otherwise.
    pub player_height: f64,
    pub sky: Sky,
    pub sun: Option<Sun>,
    /// Never empty; the first one is lit by default.
    pub lamp_presets: Vec<LampPreset>,
    /// Never empty.
    pub cameras: Vec<Camera>,
    /// Never empty.
    pub layouts: Vec<LayoutSpec>,
    pub response: ResponseSpec,
    /// What was changed about it; nothing for a world file.
    pub restored: Restored,
}

impl World {
    /// The sound of a voxel's material (1-based); that of stone, if the world has no such material.
    pub fn sound_of(&self, material: u8) -> MaterialSound {
        let index = usize::from(material).checked_sub(1);
        let known = index.and_then(|index| self.materials.get(index));
        known.map_or(MaterialSound::Stone, |known| known.sound)
    }
}

/// What a save, or the player of a window, adds to its world.
#[derive(Clone, Default)]
pub struct Restored {
    pub overlay: Overlay,
    /// In the order in which they were placed; no two share a voxel.
    pub lamps: Vec<PlacedLamp>,
    /// What was at hand.
    pub hotbar: save::SavedHotbar,
    /// What a person should know about it, such as changes that no longer fit.
    pub notes: Vec<String>,
}

impl Restored {
    /// Takes the lamps that lie in a world of this origin and size, and notes how many do not.
    pub fn take_lamps(&mut self, lamps: &[PlacedLamp], origin: IVec3, size: UVec3) {
        let within = |lamp: &&PlacedLamp| lamp.is_within(origin, size);
        self.lamps = lamps.iter().filter(within).copied().collect();
        let lost = lamps.len() - self.lamps.len();
        if lost > 0 {
            let note =
                format!("{lost} placed lamps are left out, for they lie outside of the world");
            self.notes.push(note);
        }
    }
}

/// Without the notes and the hotbar: worlds are told apart by their debug texts, and neither changes a picture.
impl fmt::Debug for Restored {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (&self.overlay, &self.lamps).fmt(f)
    }
}
