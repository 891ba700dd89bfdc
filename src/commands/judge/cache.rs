//! References on disk, found by their content. A file that is damaged or from another version is replaced by a
//! new trace.
//!
//! Format of a file: a line that identifies it. Then, in little endian: the length of the version, the version,
//! and the CRC-32 of the rest. The rest is width, height, direct light and indirect light, with three f32 per
//! pixel; then both once more by the first half of the paths, where there is one.

use std::{
    fs,
    io::{self, Write as _},
    path::{Path, PathBuf},
};

use atomic_write_file::AtomicWriteFile;
use directories::ProjectDirs;

use crate::measure::{picture::Picture, whole_file::FileError};

const FIRST_LINE: &[u8] = b"grotto reference\n";

/// A path-traced picture in two parts, whose sum is the full picture. Linear light.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    pub direct: Picture,
    pub indirect: Picture,
}

/// A reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    pub whole: Traced,
    /// The same by the first half of the paths alone: it differs from the whole as much as a picture without any error
    /// does, for the two halves are independent. `None` with one path per pixel, and in files before 2026-11-27.
    pub half: Option<Traced>,
}

impl Traced {
    /// The mean of two pictures of the same size, each with its share of the paths.
    pub fn mean(a: &Self, b: &Self, share_of_a: f32) -> Self {
        let mean = |a: &Picture, b: &Picture| {
            let pairs = a.rgb.iter().zip(&b.rgb);
            let mixed = pairs.map(|(a, b)| {
                std::array::from_fn(|channel| b[channel] + share_of_a * (a[channel] - b[channel]))
            });
            Picture {
                rgb: mixed.collect(),
                ..*a
            }
        };
        Self {
            direct: mean(&a.direct, &b.direct),
            indirect: mean(&a.indirect, &b.indirect),
        }
    }
}

/// The key under which a reference is stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Key {
    /// Everything that the picture depends on, except the tracer.
    pub content: String,
    /// Version of the tracer.
    pub version: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

/// The result of a look-up in the cache.
#[derive(Debug, PartialEq)]
pub enum Found {
    Truth(Box<Truth>),
    Nothing,
    /// The file cannot be used, and why.
    Unusable(String),
}

/// A folder of references, or no folder.
pub struct Cache {
    folder: Option<PathBuf>,
}

impl Cache {
    /// Uses this folder, or without one the user's cache folder, where the system has one.
    pub fn new(folder: Option<&Path>) -> Self {
        let own = || {
            Some(
                ProjectDirs::from("", "", "grotto")?
                    .cache_dir()
                    .join("references"),
            )
        };
        Self {
            folder: folder.map(Path::to_owned).or_else(own),
        }
    }

    /// A cache that finds and stores nothing.
    pub fn none() -> Self {
        Self { folder: None }
    }

    fn path(&self, key: &Key) -> Option<PathBuf> {
        let name = format!("{:032x}.reference", fnv1a(key.content.as_bytes()));
        Some(self.folder.as_ref()?.join(name))
    }

    pub fn load(&self, key: &Key) -> Found {
        let Some(path) = self.path(key) else {
            return Found::Nothing;
        };
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Found::Nothing,
            Err(reason) => {
                return Found::Unusable(FileError::reading(&path, reason).to_string());
            }
        };
        match decode(&bytes, key) {
            Ok(truth) => Found::Truth(Box::new(truth)),
            Err(reason) => Found::Unusable(format!("{}: {reason}", path.display())),
        }
    }

    /// Stores a reference.
    ///
    /// # Errors
    /// When the file cannot be written, with the path.
    pub fn store(&self, key: &Key, truth: &Truth) -> Result<(), String> {
        let (Some(path), Some(folder)) = (self.path(key), &self.folder) else {
            return Ok(());
        };
        let write = || {
            fs::create_dir_all(folder)?;
            let mut file = AtomicWriteFile::open(&path)?;
            file.write_all(&encode(truth, &key.version))?;
            file.commit()
        };
        write().map_err(|reason| FileError::writing(&path, reason).to_string())
    }
}

fn encode(truth: &Truth, version: &str) -> Vec<u8> {
    let mut body = Vec::new();
    let Truth { whole, half } = truth;
    for edge in [whole.direct.width, whole.direct.height] {
        body.extend(edge.to_le_bytes());
    }
    for traced in [Some(whole), half.as_ref()].into_iter().flatten() {
        for picture in [&traced.direct, &traced.indirect] {
            let values = picture.rgb.as_flattened().iter();
            body.extend(values.flat_map(|value| value.to_le_bytes()));
        }
    }
    let mut bytes = FIRST_LINE.to_vec();
    bytes.extend((version.len() as u32).to_le_bytes());
    bytes.extend(version.as_bytes());
    bytes.extend(crc32fast::hash(&body).to_le_bytes());
    bytes.extend(body);
    bytes
}

fn decode(bytes: &[u8], key: &Key) -> Result<Truth, &'static str> {
    const SHORT: &str = "it ends too early";
    let rest = bytes
        .strip_prefix(FIRST_LINE)
        .ok_or("it is not a reference of grotto's")?;
    let (length, rest) = number(rest).ok_or(SHORT)?;
    let (version, rest) = rest.split_at_checked(length as usize).ok_or(SHORT)?;
    if version != key.version.as_bytes() {
        return Err("it was traced by another version");
    }
    let (crc, body) = number(rest).ok_or(SHORT)?;
    if crc32fast::hash(body) != crc {
        return Err("it is damaged");
    }
    let (width, rest) = number(body).ok_or(SHORT)?;
    let (height, light) = number(rest).ok_or(SHORT)?;
    let pixels = width as usize * height as usize;
    let of_whole = pixels * 24;
    if [width, height] != key.size || ![of_whole, 2 * of_whole].contains(&light.len()) {
        return Err("it is a picture of another size");
    }
    let values: Vec<f32> = light
        .as_chunks::<4>()
        .0
        .iter()
        .map(|v| f32::from_le_bytes(*v))
        .collect();
    let picture = |rgb: &[[f32; 3]]| Picture {
        width,
        height,
        rgb: rgb.to_vec(),
    };
    let traced = |rgb: &[[f32; 3]]| {
        let (direct, indirect) = rgb.split_at(pixels);
        Traced {
            direct: picture(direct),
            indirect: picture(indirect),
        }
    };
    let (whole, half) = values.as_chunks::<3>().0.split_at(2 * pixels);
    Ok(Truth {
        whole: traced(whole),
        half: (!half.is_empty()).then(|| traced(half)),
    })
}

/// The first four bytes as a number, and the remaining bytes.
fn number(bytes: &[u8]) -> Option<(u32, &[u8])> {
    let (first, rest) = bytes.split_first_chunk()?;
    Some((u32::from_le_bytes(*first), rest))
}

/// FNV-1a with 128 bits (Fowler, Noll, Vo): a name for a text that is the same on every machine.
pub fn fnv1a(bytes: &[u8]) -> u128 {
    const BASIS: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    let step = |hash: u128, byte: &u8| (hash ^ u128::from(*byte)).wrapping_mul(PRIME);
    bytes.iter().fold(BASIS, step)
}

#[cfg(test)]
mod tests {
    use tempfile::tempdir;

    use super::*;

    fn truth() -> Truth {
        let picture = |base: f32| Picture {
            width: 3,
            height: 2,
            rgb: (0..6).map(|i| [base + i as f32, 0.5, -base]).collect(),
        };
        let traced = |base| Traced {
            direct: picture(base),
            indirect: picture(100.0 * base),
        };
        Truth {
            whole: traced(1.0),
            half: Some(traced(1.5)),
        }
    }

    fn key() -> Key {
        Key {
            content: "a room".to_owned(),
            version: "1".to_owned(),
            size: [3, 2],
        }
    }

    #[test]
    fn known_hashes() {
        assert_eq!(fnv1a(b""), 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d);
        assert_eq!(fnv1a(b"a"), 0xd228_cb69_6f1a_8caf_7891_2b70_4e4a_8964);
    }

    #[test]
    fn what_is_stored_is_found_and_nothing_else_is() {
        let folder = tempdir().expect("a temporary folder");
        let cache = Cache::new(Some(folder.path()));
        assert_eq!(cache.load(&key()), Found::Nothing);
        cache.store(&key(), &truth()).expect("writable");
        assert_eq!(cache.load(&key()), Found::Truth(Box::new(truth())));
        let other = Key {
            content: "another room".to_owned(),
            ..key()
        };
        assert_eq!(cache.load(&other), Found::Nothing);
        assert_eq!(Cache::none().load(&key()), Found::Nothing);
        let without_half = Truth {
            half: None,
            ..truth()
        };
        cache.store(&key(), &without_half).expect("writable");
        assert_eq!(cache.load(&key()), Found::Truth(Box::new(without_half)));
    }

    #[test]
    fn a_mean_counts_paths() {
        let [a, b] = [8.0, 2.0].map(|value| {
            let picture = Picture {
                width: 1,
                height: 1,
                rgb: vec![[value, 0.0, 1.0]],
            };
            Traced {
                direct: picture.clone(),
                indirect: picture,
            }
        });
        let mean = Traced::mean(&a, &b, 0.25);
        assert_eq!(mean.direct.rgb, [[3.5, 0.0, 1.0]]);
        assert_eq!(mean.indirect, mean.direct);
    }

    #[test]
    fn another_version_and_every_kind_of_damage_are_unusable() {
        let folder = tempdir().expect("a temporary folder");
        let cache = Cache::new(Some(folder.path()));
        cache.store(&key(), &truth()).expect("writable");
        let newer = Key {
            version: "2".to_owned(),
            ..key()
        };
        let reason = |found| match found {
            Found::Unusable(reason) => reason,
            found => panic!("{found:?}"),
        };
        assert!(reason(cache.load(&newer)).contains("another version"));
        let path = cache.path(&key()).expect("a folder");
        let whole = fs::read(&path).expect("stored");
        for end in 0..whole.len() {
            fs::write(&path, &whole[..end]).expect("writable");
            reason(cache.load(&key()));
        }
        for at in 0..whole.len() {
            let mut flipped = whole.clone();
            flipped[at] ^= 0x10;
            fs::write(&path, &flipped).expect("writable");
            reason(cache.load(&key()));
        }
        fs::write(&path, &whole).expect("writable");
        assert!(matches!(cache.load(&key()), Found::Truth(_)));
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let folder = tempdir().expect("a temporary folder");
        let file = folder.path().join("a file");
        fs::write(&file, "").expect("writable");
        let refused = Cache::new(Some(&file)).store(&key(), &truth());
        assert!(refused.expect_err("a file").contains("a file"));
    }
}
