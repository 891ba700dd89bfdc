//! Which faces have an entry in the surface cache when there are more faces than entries.

use std::iter;

use grotto::{
    gpu::{Gpu, Kernel, KernelSpec, Recorder},
    passes::surface_cache::{GpuSurfaceCacheInfo, SurfaceCache},
    world::materials::hash::hash,
};

use crate::support;

/// A face has one of `FACINGS` directions. Its entry is searched in `REACH` buckets, beginning with its own, which is one of
/// the first `BUCKETS`.
const FACINGS: usize = 6;
const REACH: usize = 8;
const BUCKETS: u32 = 24;
/// Frames without a pixel on a face after which its entry may be taken.
const FORGOTTEN: u32 = 64;
const WORDS: usize = SurfaceCache::ENTRY_BYTES as usize / 4;
const NO_ENTRY: u32 = u32::MAX;

/// A table, and faces that are seen one after the other.
struct Table {
    gpu: Gpu,
    kernel: Kernel,
    table: wgpu::Buffer,
}

impl Table {
    fn new() -> Self {
        let gpu = support::gpu();
        let kernel = Kernel::new(
            &gpu,
            &KernelSpec {
                shader: "generated/places",
                generated: &[("places", PLACES)],
                ..Default::default()
            },
        )
        .expect("compiles");
        let words = vec![0u32; FACINGS * (BUCKETS as usize + REACH - 1) * WORDS];
        let table = gpu
            .storage_buffer_of("face_table_atomic", &words)
            .expect("fits");
        Self { gpu, kernel, table }
    }

    /// Lets pixels see these faces (key, facing) in a frame; returns the entries that they get. Each is lit then.
    fn see(&self, frame: u32, faces: &[(u32, u32)]) -> Vec<u32> {
        let info = GpuSurfaceCacheInfo {
            frame,
            buckets: BUCKETS,
            ..Default::default()
        };
        let info = self.gpu.uniform_buffer("face_info", &info);
        let faces: Vec<[u32; 2]> = faces.iter().map(|(key, face)| [*key, *face]).collect();
        let seen = self.gpu.storage_buffer_of("seen", &faces).expect("fits");
        let size = faces.len() as u64 * 4;
        let out = self.gpu.storage_buffer("entries", size).expect("fits");
        let bindings = self.kernel.bind(
            &self.gpu,
            &[
                ("face_info", info.as_entire_binding()),
                ("face_table_atomic", self.table.as_entire_binding()),
                ("seen", seen.as_entire_binding()),
                ("entries", out.as_entire_binding()),
            ],
        );
        let mut recorder = Recorder::new(&self.gpu, None);
        recorder.compute("places", |pass| {
            self.kernel.dispatch(pass, &bindings, [1, 1, 1]);
        });
        recorder.submit(&self.gpu).expect("submits");
        let mut entries: Vec<u32> = self.gpu.read_buffer(&out).expect("reads back");
        entries.truncate(faces.len());
        entries
    }
}

const PLACES: &str = "
import package::generated::surface_cache::ENTRY_WORDS;
import package::surface_cache::table::{face_info, NO_ENTRY};
import package::surface_cache::places::{face_table_atomic, place_for, LISTED_WORD, LIT_WORD, SEEN_WORD};
@group(3) @binding(8) var<storage, read> seen: array<vec2u>;
@group(3) @binding(9) var<storage, read_write> entries: array<u32>;
@compute @workgroup_size(1)
fn main() {
    for (var number = 0u; number < arrayLength(&seen); number += 1u) {
        let entry = place_for(seen[number].x, seen[number].y);
        entries[number] = entry;
        if entry != NO_ENTRY {
            // A face that is new in its entry has no light yet.
            if atomicLoad(&face_table_atomic[entry * ENTRY_WORDS + LIT_WORD]) != 0u {
                entries[number] |= 0x80000000u;
            }
            atomicStore(&face_table_atomic[entry * ENTRY_WORDS + LISTED_WORD], face_info.frame);
            atomicStore(&face_table_atomic[entry * ENTRY_WORDS + SEEN_WORD], face_info.frame);
            atomicStore(&face_table_atomic[entry * ENTRY_WORDS + LIT_WORD], face_info.frame);
        }
    }
}
";

/// Set for an entry that had light already.
const LIT: u32 = 1 << 31;

/// Keys whose faces are first looked for in this bucket.
fn keys_of(bucket: u32) -> impl Iterator<Item = u32> {
    (1..).filter(move |key| ((hash(*key) >> 16) * BUCKETS) >> 16 == bucket)
}

#[test]
fn the_last_bucket_has_as_many_places_as_any() {
    let table = Table::new();
    let faces: Vec<(u32, u32)> = keys_of(BUCKETS - 1)
        .map(|key| (key, 4))
        .take(REACH + 1)
        .collect();
    let mut expected: Vec<u32> = (BUCKETS - 1..BUCKETS - 1 + REACH as u32)
        .map(|bucket| bucket * 6 + 4)
        .collect();
    expected.push(NO_ENTRY);
    assert_eq!(table.see(1, &faces), expected);
}

#[test]
fn a_full_table_gives_the_entry_seen_longest_ago_and_only_once_it_is_forgotten() {
    let table = Table::new();
    let mut same_bucket = keys_of(3);
    let mut next = || same_bucket.next().expect("there are many");
    let mut faces: Vec<(u32, u32)> = iter::repeat_with(|| (next(), 2)).take(REACH).collect();
    let places = table.see(1, &faces);
    let expected: Vec<u32> = (3..3 + REACH as u32).map(|bucket| bucket * 6 + 2).collect();
    assert_eq!(places, expected, "one bucket after the other");
    let late = (next(), 2);
    assert_eq!(table.see(2, &[late]), [NO_ENTRY], "all are taken");
    // Faces of another facing have entries of their own.
    assert_eq!(table.see(2, &[(late.0, 5)]), [3 * 6 + 5]);
    // All but the third are seen again; the third keeps its entry until it is forgotten.
    let third = faces.remove(2);
    let again: Vec<u32> = table.see(10, &faces);
    assert!(again.iter().all(|place| place & LIT != 0), "{again:x?}");
    assert_eq!(table.see(FORGOTTEN, &[late]), [NO_ENTRY], "not yet");
    assert_eq!(
        table.see(FORGOTTEN + 1, &[late]),
        [places[2]],
        "dark at first"
    );
    assert_eq!(table.see(FORGOTTEN + 2, &[late]), [places[2] | LIT]);
    assert_eq!(
        table.see(FORGOTTEN + 2, &[third]),
        [NO_ENTRY],
        "it has lost its entry"
    );
    // The others are not forgotten.
    let kept: Vec<u32> = faces
        .iter()
        .map(|face| table.see(70, &[*face])[0])
        .collect();
    assert_eq!(kept, again);
}
