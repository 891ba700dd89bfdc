//! What is heard of a run: footfalls, and what strokes change.

use super::Run;
use crate::{
    app::{
        AppError,
        hands::{Changes, Side},
        player::{Contact, Footfall},
        sound::{Kind, Noise},
    },
    world::materials::MaterialSound,
};

impl Run<'_> {
    /// # Errors
    /// [`AppError`] when the voxels must be read back and the device is lost.
    pub(super) fn footfall(&mut self, footfall: &Footfall) -> Result<(), AppError> {
        let ground = self.viewport.ground()?;
        let material = ground.voxels.material(footfall.voxel - ground.origin);
        self.noises.make(Noise {
            kind: match footfall.contact {
                Contact::Step => Kind::Step,
                Contact::Land => Kind::Land,
            },
            material: self.viewport.world().sound_of(material),
            strength: footfall.strength,
            at_ns: footfall.at_ns,
        });
        Ok(())
    }

    /// Voxels were dug where most of them are air now; else they were placed.
    pub(super) fn noise_of(&mut self, changes: &Changes) {
        let (kind, side) = match changes.most(Side::After) {
            0 => (Kind::Dig, Side::Before),
            _ => (Kind::Place, Side::After),
        };
        self.noises.make(Noise {
            kind,
            material: self.viewport.world().sound_of(changes.most(side)),
            // One voxel is soft, a ball of radius 5 is as loud as it gets.
            strength: (changes.voxels() as f32).log2() / 9.0,
            at_ns: self.player.now_ns(),
        });
    }

    /// A lamp is hung, taken down or switched.
    pub(super) fn noise_of_lamp(&mut self, kind: Kind) {
        self.noises.make(Noise {
            kind,
            material: MaterialSound::Glow,
            strength: 0.0,
            at_ns: self.player.now_ns(),
        });
    }
}
