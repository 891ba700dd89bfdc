//! A save for tests.

use super::{Head, Save, SavedHotbar, SavedItem, State};
use crate::world::{Overlay, placed::LampBlock};

/// A save with these changes, of a world that need not exist.
pub fn save_of(overlay: Overlay) -> Save {
    Save {
        head: Head {
            world: "cave".into(),
            world_file: "/worlds/cave.ron".into(),
            world_beside: Some("../worlds/cave.ron".into()),
            world_crc32: 0xdead_beef,
            saved_s: 1_790_000_000,
            voxels: overlay.count(),
            lamps: 0,
            bodies: 0,
            grotto: "0.1.0".into(),
        },
        state: State {
            time_s: 1.0 / 3.0,
            paused: false,
            rate: 0.3,
            eye: [0.1, -2.3, 1e-7],
            yaw_deg: 33.3,
            pitch_deg: -12.7,
            fov_deg: 70.0,
            layout: "octree".into(),
            set: vec!["probes.rays=16".into()],
            materials: vec!["stone".into(), "glow".into()],
            origin: [-3, 0, 7],
            hotbar: SavedHotbar {
                slots: vec![
                    Some(SavedItem::Material("glow".into())),
                    None,
                    Some(SavedItem::Lamp(LampBlock::default())),
                ],
                selected: 2,
            },
        },
        overlay,
        lamps: Vec::new(),
        bodies: Default::default(),
    }
}
