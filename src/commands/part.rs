//! Part files, which `--shard I/N` writes for `grotto merge`.
//!
//! Format of a file: a line that identifies it. Then, in little endian: the CRC-32 of the rest, the length of
//! the head, the head (RON, which restores every number exactly), and the data of the command.

use std::{
    fs,
    io::Write as _,
    path::{Path, PathBuf},
};

use atomic_write_file::AtomicWriteFile;
use serde::{Deserialize, Serialize};

use super::{Failure, shard::Shard};
use crate::measure::whole_file;

/// The first line of a file. It ends with the version of the format.
const FIRST_LINE: &[u8] = b"grotto part 1\n";
/// How the first line starts in every version.
const ANY_VERSION: &[u8] = b"grotto part ";
/// Separator between the name of the whole and that of the part.
const MARK: &str = ".part-";

/// The whole that a part belongs to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Head {
    /// `reference` or `judge`.
    pub command: String,
    /// Name of the whole's file, or the stem of its files.
    pub whole: String,
    pub shard: Shard,
    /// Everything that the whole depends on, each under a readable name. All parts of one whole have the same
    /// facts.
    pub facts: Vec<(String, String)>,
}

/// A part that has been read.
#[derive(Debug)]
pub struct Part {
    pub path: PathBuf,
    pub head: Head,
    pub body: Vec<u8>,
}

impl Head {
    pub fn file_name(&self) -> String {
        let Shard { index, count } = self.shard;
        format!("{}{MARK}{index}-of-{count}", self.whole)
    }

    /// The first fact that differs, with both values.
    fn difference<'a>(&'a self, other: &'a Self) -> Option<(&'a str, &'a str, &'a str)> {
        if self.command != other.command {
            return Some(("the command", &self.command, &other.command));
        }
        let missing = "none";
        let all = self.facts.iter().chain(&other.facts);
        for (name, _) in all {
            let [a, b] = [self, other].map(|head| {
                let found = head.facts.iter().find(|(known, _)| known == name);
                found.map_or(missing, |(_, value)| value)
            });
            if a != b {
                return Some((name, a, b));
            }
        }
        None
    }
}

/// A part that is written when it is complete. A dropped one leaves no trace.
pub struct PartFile {
    path: PathBuf,
    file: AtomicWriteFile,
    head: Head,
}

impl PartFile {
    /// A part in a folder, which is created if need be.
    ///
    /// # Errors
    /// When the folder cannot be created or the file cannot be written, and when the file exists as a part of
    /// another whole.
    pub fn new(folder: &Path, head: Head) -> Result<Self, Failure> {
        let path = folder.join(head.file_name());
        whole_file::create_folder(folder)?;
        if path.exists() {
            let other = |difference: &str| {
                Failure::bad_input(format!(
                    "{}: exists already, and {difference}; delete it or choose another folder",
                    path.display()
                ))
            };
            let there = Part::read(&path).map_err(|_| other("is not a readable part"))?;
            if let Some((name, old, new)) = there.head.difference(&head) {
                return Err(other(&format!(
                    "is a part of something else: {name} was {old} and would be {new}"
                )));
            }
        }
        let file = whole_file::open(&path)?;
        Ok(Self { path, file, head })
    }

    pub fn shard(&self) -> Shard {
        self.head.shard
    }

    /// Writes the part and returns its path.
    ///
    /// # Errors
    /// When the file cannot be written, as on a full disk.
    pub fn write(mut self, body: &[u8]) -> Result<PathBuf, Failure> {
        let bytes = encode(&self.head, body);
        self.file
            .write_all(&bytes)
            .and_then(|()| self.file.commit())
            .map_err(|reason| Failure::unwritten(&self.path, reason))?;
        Ok(self.path)
    }
}

impl Part {
    /// # Errors
    /// When the file cannot be read, is damaged, or is of another version.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let bad = |reason: &str| Failure::bad_input(format!("{}: {reason}", path.display()));
        let bytes = fs::read(path).map_err(|reason| Failure::unread(path, reason))?;
        let (head, body) = decode(&bytes).map_err(bad)?;
        Ok(Self {
            path: path.to_owned(),
            head,
            body,
        })
    }

    /// The error for a part whose content is wrong.
    pub fn refused(&self, reason: &str) -> Failure {
        Failure::bad_input(format!("{}: {reason}", self.path.display()))
    }
}

/// The files of parts in a folder, sorted by name. Empty where the folder has none.
///
/// # Errors
/// When the folder cannot be read.
pub fn files_in(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let unreadable = |reason| Failure::unread(folder, reason);
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let shard = name.rsplit_once(MARK).and_then(|(_, shard)| {
            let (index, count) = shard.split_once("-of-")?;
            Shard::parse(&format!("{index}/{count}")).ok()
        });
        if shard.is_some() && path.is_file() {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// Sorts the parts of one whole by their numbers.
///
/// # Errors
/// Names the part that is missing, given twice, or of another whole.
pub fn in_order(mut parts: Vec<Part>) -> Result<Vec<Part>, Failure> {
    parts.sort_by_key(|part| part.head.shard.index);
    if let [first, others @ ..] = &parts[..] {
        for other in others {
            if let Some((name, a, b)) = first.head.difference(&other.head) {
                return Err(other.refused(&format!(
                    "part {} is not of the same work as part {} ({}): {name} is {b} and {a}",
                    other.head.shard,
                    first.head.shard,
                    first.path.display()
                )));
            }
        }
    }
    let shards: Vec<Shard> = parts.iter().map(|part| part.head.shard).collect();
    Shard::check_complete(&shards).map_err(|reason| {
        let whole = parts.first().map_or("", |part| &part.head.whole);
        Failure::bad_input(format!("{whole}: {reason}"))
    })?;
    Ok(parts)
}

fn encode(head: &Head, body: &[u8]) -> Vec<u8> {
    let head = ron::to_string(head).expect("strings and numbers can be written");
    let mut rest = (head.len() as u32).to_le_bytes().to_vec();
    rest.extend(head.as_bytes());
    rest.extend(body);
    let mut bytes = FIRST_LINE.to_vec();
    bytes.extend(crc32fast::hash(&rest).to_le_bytes());
    bytes.extend(rest);
    bytes
}

fn decode(bytes: &[u8]) -> Result<(Head, Vec<u8>), &'static str> {
    const DAMAGED: &str = "the part is damaged; run it again";
    let Some(rest) = bytes.strip_prefix(FIRST_LINE) else {
        return Err(match bytes.starts_with(ANY_VERSION) {
            true => {
                "the part was written by another version of grotto; run all parts with one version"
            }
            false => "it is not a part that grotto wrote",
        });
    };
    let (crc, rest) = number(rest).ok_or(DAMAGED)?;
    if crc32fast::hash(rest) != crc {
        return Err(DAMAGED);
    }
    let (length, rest) = number(rest).ok_or(DAMAGED)?;
    let (head, body) = rest.split_at_checked(length as usize).ok_or(DAMAGED)?;
    let head: Head = ron::de::from_bytes(head).map_err(|_| DAMAGED)?;
    // `grotto merge` writes a file of this name.
    let is_name = Path::new(&head.whole).file_name() == Some(head.whole.as_ref());
    is_name.then(|| (head, body.to_vec())).ok_or(DAMAGED)
}

/// The first four bytes as a number, and the remaining bytes.
pub fn number(bytes: &[u8]) -> Option<(u32, &[u8])> {
    let (first, rest) = bytes.split_first_chunk()?;
    Some((u32::from_le_bytes(*first), rest))
}

#[cfg(test)]
mod tests {
    use tempfile::tempdir;

    use super::*;

    fn head(index: u32) -> Head {
        Head {
            command: "reference".to_owned(),
            whole: "a.exr".to_owned(),
            shard: Shard { index, count: 3 },
            facts: vec![
                ("samples".to_owned(), "64".to_owned()),
                ("world".to_owned(), "\"a\" \u{1}".to_owned()),
            ],
        }
    }

    fn stored(folder: &Path, head: Head) -> PathBuf {
        let file = PartFile::new(folder, head).expect("writable");
        file.write(b"body").expect("writable")
    }

    #[test]
    fn what_is_written_is_read_and_every_kind_of_damage_is_refused() {
        let folder = tempdir().expect("a temporary folder");
        let path = stored(folder.path(), head(2));
        assert!(path.ends_with("a.exr.part-2-of-3"));
        let part = Part::read(&path).expect("just written");
        assert_eq!((&part.head, &part.body[..]), (&head(2), &b"body"[..]));
        let whole = fs::read(&path).expect("written");
        for end in 0..whole.len() {
            decode(&whole[..end]).expect_err("it is cut short");
        }
        for at in 0..whole.len() {
            let mut flipped = whole.clone();
            flipped[at] ^= 0x10;
            decode(&flipped).expect_err("a bit is flipped");
        }
        let newer = [b"grotto part 2\n", &whole[FIRST_LINE.len()..]].concat();
        assert!(
            decode(&newer)
                .expect_err("newer")
                .contains("another version")
        );
    }

    #[test]
    fn only_files_of_parts_are_found() {
        let folder = tempdir().expect("a temporary folder");
        for index in [2, 1] {
            stored(folder.path(), head(index));
        }
        for other in [
            "a.exr",
            "a.exr.part-4-of-3",
            "a.exr.part-1",
            "a.exr.part-1-of-3~",
        ] {
            fs::write(folder.path().join(other), "").expect("writable");
        }
        let found = files_in(folder.path()).expect("a folder");
        let names: Vec<_> = found
            .iter()
            .filter_map(|path| path.file_name()?.to_str())
            .collect();
        assert_eq!(names, ["a.exr.part-1-of-3", "a.exr.part-2-of-3"]);
        files_in(&folder.path().join("nowhere")).expect_err("no folder");
    }

    #[test]
    fn parts_that_make_no_whole_are_named() {
        let part = |head: Head| Part {
            path: head.file_name().into(),
            head,
            body: Vec::new(),
        };
        let refused = |heads: Vec<Head>| {
            let failure = in_order(heads.into_iter().map(part).collect()).expect_err("no whole");
            assert_eq!(failure.exit_code(), 2);
            failure.to_string()
        };
        let all = in_order([3, 1, 2].map(head).map(part).into()).expect("a whole");
        assert_eq!(
            all.iter()
                .map(|part| part.head.shard.index)
                .collect::<Vec<_>>(),
            [1, 2, 3]
        );
        assert!(refused([3, 1].map(head).into()).contains("part 2/3 is missing"));
        assert!(refused([3, 1, 2, 2].map(head).into()).contains("part 2/3 is there 2 times"));
        let mut foreign = head(2);
        foreign.facts[0].1 = "65".to_owned();
        let message = refused(vec![head(1), foreign.clone(), head(3)]);
        for word in ["a.exr.part-2-of-3", "samples is 65 and 64"] {
            assert!(message.contains(word), "{message}");
        }
        foreign.facts = vec![("samples".to_owned(), "64".to_owned())];
        assert!(refused(vec![head(1), foreign, head(3)]).contains("world is none and"));
    }

    #[test]
    fn a_part_of_something_else_is_not_overwritten() {
        let folder = tempdir().expect("a temporary folder");
        stored(folder.path(), head(1));
        stored(folder.path(), head(1));
        let mut other = head(1);
        other.facts[0].1 = "128".to_owned();
        let refused = PartFile::new(folder.path(), other)
            .map(|_| ())
            .expect_err("another");
        assert!(
            refused
                .to_string()
                .contains("samples was 64 and would be 128"),
            "{refused}"
        );
        fs::write(folder.path().join(head(2).file_name()), "mine").expect("writable");
        PartFile::new(folder.path(), head(2))
            .map(|_| ())
            .expect_err("not ours");
    }
}
