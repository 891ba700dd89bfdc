//! The bytes of a save. Everything in them is checked before anything is used.
//!
//! Little endian: [`MAGIC`], version (u32), length of the head (u32), length of the compressed content (u64), length
//! of the content (u64), CRC-32 of all this and the head (u32), CRC-32 of the compressed content (u32). Then the head
//! (JSON), then the content (zlib), and nothing else. These first 40 bytes mean the same in every version.
//!
//! The content is a row of sections: name (four letters), length (u64), bytes. As in PNG, a section whose name begins
//! with a capital letter must be understood; one with a small letter may be skipped by a grotto that does not know it.

use std::io::{Read as _, Write as _};

use flate2::{Compression, read::ZlibDecoder, write::ZlibEncoder};
use glam::UVec3;
use serde::de::DeserializeOwned;

use super::{Head, Save, State, bodies};
use crate::world::{
    Overlay, PlacedLamp,
    bodies::ChangedBodies,
    placed,
    voxels::{BRICK_VOXELS, CELL, MASK_WORDS},
};

/// As in PNG: a byte that is no text, and ends of lines that a transfer as text would change.
pub const MAGIC: [u8; 8] = *b"\x89GRT\r\n\x1a\n";
/// Version of the format that is written and read.
pub const VERSION: u32 = 1;
/// Bytes before the head.
pub const FIXED: usize = 40;
/// Longest head (bytes).
const LONGEST_HEAD: u32 = 1 << 20;
/// Longest content (bytes).
const LONGEST_CONTENT: u64 = 1 << 30;

/// State of the player and the choices, as JSON.
const STATE: [u8; 4] = *b"Stat";
/// Changed voxels: number of cells (u32). Each has its place (three u16, in cells), a mask of 512 bits, and a material
/// for each bit that is set. Sorted by z, y, x.
const EDITS: [u8; 4] = *b"Edit";

/// Placed lamps, as JSON. A save without lamps lacks the section, so that a grotto which knows none can open it.
const LAMPS: [u8; 4] = *b"Lamp";

/// Bodies that were placed or pushed: see [`bodies`]. A save without any lacks the section.
const BODIES: [u8; 4] = *b"Body";
/// JSON: names of bodies of the world file that are gone.
const GONE: [u8; 4] = *b"Gone";

/// Longest edge of a grid in cells: a world has at most 4096 voxels on an axis.
const MOST_CELLS: u32 = 4096 / CELL;
/// World time lies within ± this many seconds.
const LATEST_S: f64 = 1e9;
/// The player's eye lies within ± this many voxels.
const FARTHEST: f32 = 1e6;
/// Most slots of a hotbar.
const MOST_SLOTS: usize = 64;
/// Fastest world time.
const FASTEST: f32 = 1e3;

/// Why bytes are no save.
#[derive(Debug, PartialEq)]
pub enum Fault {
    Damaged(String),
    Newer { version: u32, grotto: String },
}

pub(super) fn damaged(reason: impl Into<String>) -> Fault {
    Fault::Damaged(reason.into())
}

/// What the first bytes of a file say about the rest.
pub struct Start {
    version: u32,
    head: usize,
    packed: u64,
    content: u64,
    head_crc32: u32,
    packed_crc32: u32,
}

impl Start {
    /// Bytes of the head.
    pub fn head_length(&self) -> usize {
        self.head
    }

    pub fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let Some(fixed) = bytes.first_chunk::<FIXED>() else {
            return Err(damaged("it ends in its first bytes"));
        };
        if fixed[..8] != MAGIC {
            return Err(damaged("it does not begin as a save of grotto"));
        }
        let mut rest = Cursor(&fixed[8..]);
        let start = Self {
            version: rest.u32()?,
            head: rest.u32()? as usize,
            packed: rest.u64()?,
            content: rest.u64()?,
            head_crc32: rest.u32()?,
            packed_crc32: rest.u32()?,
        };
        let fits = start.head <= LONGEST_HEAD as usize
            && start.packed <= super::LARGEST
            && start.content <= LONGEST_CONTENT;
        match fits {
            true => Ok(start),
            false => Err(damaged("its lengths are impossible")),
        }
    }

    /// The head, from the first bytes of a file up to its end.
    pub fn head(&self, bytes: &[u8]) -> Result<Head, Fault> {
        let end = FIXED + self.head;
        let head = bytes.get(FIXED..end);
        let head = head.ok_or_else(|| damaged("it ends in its head"))?;
        let mut crc32 = crc32fast::Hasher::new();
        crc32.update(&bytes[..32]);
        crc32.update(head);
        if crc32.finalize() != self.head_crc32 {
            return Err(damaged("the checksum of its head is wrong"));
        }
        if self.version > VERSION {
            let head: Option<serde_json::Value> = serde_json::from_slice(head).ok();
            let grotto = head.and_then(|head| Some(head.get("grotto")?.as_str()?.to_owned()));
            return Err(Fault::Newer {
                version: self.version,
                grotto: grotto.unwrap_or_else(|| "a newer version".to_owned()),
            });
        }
        json("head", head)
    }
}

/// The bytes of a save.
pub fn encode(save: &Save) -> Vec<u8> {
    let mut content = Vec::new();
    let mut section = |name: [u8; 4], bytes: &[u8]| {
        content.extend(name);
        content.extend((bytes.len() as u64).to_le_bytes());
        content.extend(bytes);
    };
    // Maps of strings and numbers: JSON can hold them all.
    section(STATE, &serde_json::to_vec(&save.state).unwrap_or_default());
    section(EDITS, &edits(&save.overlay));
    if !save.lamps.is_empty() {
        section(LAMPS, &serde_json::to_vec(&save.lamps).unwrap_or_default());
    }
    if !save.bodies.placed.is_empty() || !save.bodies.moved.is_empty() {
        section(BODIES, &bodies::encode(&save.bodies));
    }
    if !save.bodies.gone.is_empty() {
        let gone = &save.bodies.gone;
        section(GONE, &serde_json::to_vec(gone).unwrap_or_default());
    }
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(4));
    // Writing to a Vec cannot fail.
    let _ = encoder.write_all(&content);
    let packed = encoder.finish().unwrap_or_default();

    let head = serde_json::to_vec(&save.head).unwrap_or_default();
    let mut bytes = MAGIC.to_vec();
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((head.len() as u32).to_le_bytes());
    bytes.extend((packed.len() as u64).to_le_bytes());
    bytes.extend((content.len() as u64).to_le_bytes());
    let mut crc32 = crc32fast::Hasher::new();
    crc32.update(&bytes);
    crc32.update(&head);
    bytes.extend(crc32.finalize().to_le_bytes());
    bytes.extend(crc32fast::hash(&packed).to_le_bytes());
    bytes.extend(head);
    bytes.extend(packed);
    bytes
}

/// The save that these bytes are.
pub fn decode(bytes: &[u8]) -> Result<Save, Fault> {
    let start = Start::read(bytes)?;
    let head = start.head(bytes)?;
    let packed = &bytes[FIXED + start.head..];
    if packed.len() as u64 != start.packed {
        let side = if (packed.len() as u64) < start.packed {
            "it is cut off"
        } else {
            "it goes on after its end"
        };
        return Err(damaged(side));
    }
    if crc32fast::hash(packed) != start.packed_crc32 {
        return Err(damaged("the checksum of its content is wrong"));
    }
    let mut content = Vec::new();
    ZlibDecoder::new(packed)
        .take(start.content + 1)
        .read_to_end(&mut content)
        .map_err(|error| damaged(format!("its content cannot be unpacked: {error}")))?;
    if content.len() as u64 != start.content {
        return Err(damaged("its content has another length than it says"));
    }
    let (mut state, mut overlay, mut lamps) = (None, None, Vec::new());
    let (mut changed_bodies, mut gone) = (ChangedBodies::default(), Vec::new());
    let mut rest = Cursor(&content);
    while !rest.0.is_empty() {
        let name = rest.array::<4>()?;
        let length = rest.u64()?;
        let bytes = rest.take(usize::try_from(length).unwrap_or(usize::MAX))?;
        match name {
            STATE => state = Some(json::<State>("state", bytes)?),
            EDITS => overlay = Some(overlay_of(bytes)?),
            LAMPS => lamps = lamps_of(bytes)?,
            BODIES => changed_bodies = bodies::decode(bytes)?,
            GONE => gone = json("bodies that are gone", bytes)?,
            [b'a'..=b'z', ..] => {}
            _ => {
                return Err(Fault::Newer {
                    version: VERSION,
                    grotto: head.grotto,
                });
            }
        }
    }
    let state = state.ok_or_else(|| damaged("it has no state"))?;
    check(&state)?;
    changed_bodies.gone = gone;
    if let Some(fault) = changed_bodies.fault() {
        return Err(damaged(fault));
    }
    Ok(Save {
        head,
        state,
        overlay: overlay.ok_or_else(|| damaged("it has no changes, not even none"))?,
        lamps,
        bodies: changed_bodies,
    })
}

fn json<T: DeserializeOwned>(what: &str, bytes: &[u8]) -> Result<T, Fault> {
    serde_json::from_slice(bytes).map_err(|error| damaged(format!("its {what}: {error}")))
}

fn check(state: &State) -> Result<(), Fault> {
    let fits = state.time_s.abs() <= LATEST_S
        && (0.0..=FASTEST).contains(&state.rate)
        && state.eye.iter().all(|axis| axis.abs() <= FARTHEST)
        && state.yaw_deg.abs() <= 360.0
        && state.pitch_deg.abs() <= 90.0
        && (1.0..=170.0).contains(&state.fov_deg)
        && state
            .origin
            .iter()
            .all(|axis| axis.unsigned_abs() <= 1 << 24)
        && state.materials.len() <= 255
        && state.hotbar.slots.len() <= MOST_SLOTS;
    match fits {
        true => Ok(()),
        false => Err(damaged("its state is impossible")),
    }
}

fn lamps_of(bytes: &[u8]) -> Result<Vec<PlacedLamp>, Fault> {
    let lamps: Vec<PlacedLamp> = json("lamps", bytes)?;
    match placed::fault(&lamps) {
        Some(fault) => Err(damaged(fault)),
        None => Ok(lamps),
    }
}

fn edits(overlay: &Overlay) -> Vec<u8> {
    let bricks = overlay.bricks();
    let mut bytes = (bricks.len() as u32).to_le_bytes().to_vec();
    for (cell, brick) in bricks {
        for axis in cell.to_array() {
            bytes.extend((axis as u16).to_le_bytes());
        }
        for word in brick.mask() {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(brick.changed().map(|(_, material)| material));
    }
    bytes
}

fn overlay_of(bytes: &[u8]) -> Result<Overlay, Fault> {
    let mut rest = Cursor(bytes);
    let mut overlay = Overlay::default();
    let mut last = None;
    for _ in 0..rest.u32()? {
        let [x, y, z] = [rest.u16()?, rest.u16()?, rest.u16()?].map(u32::from);
        if [x, y, z].iter().any(|axis| *axis >= MOST_CELLS) {
            return Err(damaged("a change lies outside of every world"));
        }
        if last
            .replace([z, y, x])
            .is_some_and(|last| last >= [z, y, x])
        {
            return Err(damaged("its changes are out of order"));
        }
        let mut mask = [0; MASK_WORDS];
        for word in &mut mask {
            *word = rest.u64()?;
        }
        if mask == [0; MASK_WORDS] {
            return Err(damaged("a change changes nothing"));
        }
        for index in (0..BRICK_VOXELS).filter(|at| mask[at / 64] >> (at % 64) & 1 == 1) {
            let number = index as u32;
            let local = UVec3::new(number & 7, number >> 3 & 7, number >> 6);
            let [material] = rest.array::<1>()?;
            overlay.set(UVec3::new(x, y, z) * CELL + local, material);
        }
    }
    match rest.0 {
        [] => Ok(overlay),
        _ => Err(damaged("its changes go on after their end")),
    }
}

/// Bytes that are read from front to back.
pub(super) struct Cursor<'a>(pub &'a [u8]);

impl<'a> Cursor<'a> {
    pub fn take(&mut self, length: usize) -> Result<&'a [u8], Fault> {
        let (taken, rest) = self
            .0
            .split_at_checked(length)
            .ok_or_else(|| damaged("it ends in the middle"))?;
        self.0 = rest;
        Ok(taken)
    }

    pub fn array<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let taken = self.take(N)?;
        taken
            .try_into()
            .map_err(|_| damaged("it ends in the middle"))
    }

    pub fn u16(&mut self) -> Result<u16, Fault> {
        self.array().map(u16::from_le_bytes)
    }

    pub fn u32(&mut self) -> Result<u32, Fault> {
        self.array().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Result<u64, Fault> {
        self.array().map(u64::from_le_bytes)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{super::sample::save_of, *};
    use crate::world::{
        bodies::changed::tests::changes,
        placed::tests::{lamp, lamps},
    };

    fn overlays() -> impl Strategy<Value = Overlay> {
        let voxel = (0..4096u32, 0..300u32, 0..40u32, 0..=255u8);
        proptest::collection::vec(voxel, 0..200).prop_map(|voxels| {
            let mut overlay = Overlay::default();
            for (x, y, z, material) in voxels {
                overlay.set(UVec3::new(x, y, z), material);
            }
            overlay
        })
    }

    fn with_lamps(overlay: Overlay, lamps: Vec<PlacedLamp>) -> Save {
        Save {
            lamps,
            ..save_of(overlay)
        }
    }

    fn with_all(overlay: Overlay, lamps: Vec<PlacedLamp>, bodies: ChangedBodies) -> Save {
        Save {
            bodies,
            ..with_lamps(overlay, lamps)
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn what_is_written_is_read(overlay in overlays(), lamps in lamps(), bodies in changes()) {
            let save = with_all(overlay, lamps, bodies);
            let read = decode(&encode(&save));
            prop_assert!(read == Ok(save));
        }

        /// Any bit may flip, any end may be missing or added: the bytes are refused, and nothing panics.
        #[test]
        fn damage_is_noticed(
            overlay in overlays(),
            lamps in lamps(),
            bodies in changes(),
            at in any::<prop::sample::Index>(),
            bit in 0..8u8,
        ) {
            let bytes = encode(&with_all(overlay, lamps, bodies));
            let mut flipped = bytes.clone();
            flipped[at.index(bytes.len())] ^= 1 << bit;
            prop_assert!(matches!(decode(&flipped), Err(Fault::Damaged(_))));
            prop_assert!(matches!(decode(&bytes[..at.index(bytes.len())]), Err(Fault::Damaged(_))));
            let longer = [&bytes[..], &[bit]].concat();
            prop_assert!(matches!(decode(&longer), Err(Fault::Damaged(_))));
        }

        /// Nonsense within right checksums is refused too.
        #[test]
        fn nonsense_is_refused(bytes in proptest::collection::vec(any::<u8>(), 0..700)) {
            let _ = overlay_of(&bytes);
            let _ = bodies::decode(&bytes);
            prop_assert!(lamps_of(&bytes).is_err());
            prop_assert!(decode(&bytes).is_err());
        }
    }

    /// A save with another version and other sections, with right checksums.
    fn made(version: u32, sections: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let save = save_of(Overlay::default());
        let mut content = Vec::new();
        let state = serde_json::to_vec(&save.state).expect("JSON");
        let empty = 0u32.to_le_bytes();
        let own: [(&[u8; 4], &[u8]); 2] = [(&STATE, &state), (&EDITS, &empty)];
        for (name, bytes) in own.iter().chain(sections) {
            content.extend(*name);
            content.extend((bytes.len() as u64).to_le_bytes());
            content.extend(*bytes);
        }
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(&content).expect("a Vec");
        let packed = encoder.finish().expect("a Vec");
        let head = serde_json::to_vec(&save.head).expect("JSON");
        let mut bytes = MAGIC.to_vec();
        bytes.extend(version.to_le_bytes());
        bytes.extend((head.len() as u32).to_le_bytes());
        bytes.extend((packed.len() as u64).to_le_bytes());
        bytes.extend((content.len() as u64).to_le_bytes());
        let crc32 = crc32fast::hash(&[&bytes[..], &head].concat());
        bytes.extend(crc32.to_le_bytes());
        bytes.extend(crc32fast::hash(&packed).to_le_bytes());
        bytes.extend(head);
        bytes.extend(packed);
        bytes
    }

    #[test]
    fn newer_saves_are_told_from_damaged_ones() {
        let newer = |version| {
            Err(Fault::Newer {
                version,
                grotto: "0.1.0".into(),
            })
        };
        assert!(decode(&made(VERSION, &[])).is_ok());
        assert!(
            decode(&made(VERSION, &[(b"note", b"?")])).is_ok(),
            "it may be skipped"
        );
        assert_eq!(decode(&made(VERSION, &[(b"Else", b"")])), newer(VERSION));
        assert_eq!(decode(&made(9, &[])), newer(9));
    }

    #[test]
    fn lamps_that_cannot_be_are_damage_and_saves_without_lamps_are_as_before() {
        let lamp = lamp(glam::IVec3::ONE);
        let with = |lamps: &[PlacedLamp]| {
            let section = serde_json::to_vec(lamps).expect("JSON");
            decode(&made(VERSION, &[(&LAMPS, &section)]))
        };
        assert_eq!(with(&[lamp]).map(|save| save.lamps), Ok(vec![lamp]));
        assert!(matches!(with(&[lamp, lamp]), Err(Fault::Damaged(_))));
        let mut dark = lamp;
        dark.block.power = -1.0;
        assert!(matches!(with(&[dark]), Err(Fault::Damaged(_))));
        let plain = encode(&save_of(Overlay::default()));
        assert!(decode(&plain).is_ok_and(|save| save.lamps.is_empty()));
        assert!(encode(&with_lamps(Overlay::default(), vec![lamp])).len() > plain.len());
    }

    #[test]
    fn bodies_that_cannot_be_are_damage_and_saves_without_bodies_are_as_before() {
        let save = |bodies: &[u8]| decode(&made(VERSION, &[(&BODIES, bodies)]));
        let body = crate::world::bodies::PlacedBody {
            name: "placed 1".into(),
            model: std::sync::Arc::new(crate::world::bodies::BodyModel {
                size: UVec3::new(2, 1, 1),
                materials: vec![1, 0],
            }),
            corner: glam::Vec3::new(1.0, 2.5, -3.0),
        };
        let bytes = |placed: &[&crate::world::bodies::PlacedBody]| {
            bodies::encode(&ChangedBodies {
                placed: placed.iter().map(|body| (*body).clone()).collect(),
                ..Default::default()
            })
        };
        let whole = bytes(&[&body]);
        let read = save(&whole).map(|save| save.bodies.placed);
        assert_eq!(read, Ok(vec![body.clone()]));
        let is_damage = |bytes: &[u8]| matches!(save(bytes), Err(Fault::Damaged(_)));
        assert!(is_damage(&bytes(&[&body, &body])), "two of one name");
        assert!(is_damage(&whole[..whole.len() - 1]) && is_damage(&[&whole[..], &[0]].concat()));
        let mut empty = body.clone();
        std::sync::Arc::make_mut(&mut empty.model).materials = vec![0, 0];
        assert!(is_damage(&bytes(&[&empty])));
        // Counts of four milliards are no reason to allocate.
        assert!(is_damage(&[0xff; 64]));
        let plain = encode(&save_of(Overlay::default()));
        assert!(decode(&plain).is_ok_and(|save| save.bodies.is_empty()));
    }

    #[test]
    fn lengths_are_checked_before_anything_is_allocated() {
        let mut bytes = encode(&save_of(Overlay::default()));
        for (at, length) in [(12, 4), (16, 8), (24, 8)] {
            let mut changed = bytes.clone();
            changed[at..at + length].fill(0xff);
            let fault = damaged("its lengths are impossible");
            assert_eq!(decode(&changed).err(), Some(fault));
        }
        bytes.truncate(FIXED);
        assert!(decode(&bytes).is_err());
    }
}
