//! Files that are no world files at all.

use std::fs;
use std::path::Path;

use grotto::world::World;
use grotto::world::file::{self, Overrides};

use super::{FULL, refused};
use crate::support::{folder, root};

fn load(path: &Path) -> Result<World, miette::Report> {
    file::load(path, &Overrides::default())
}

fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    text.encode_utf16().flat_map(bytes).collect()
}

#[test]
fn files_that_are_no_worlds_are_refused() {
    let folder = folder();
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).expect("written");
        path
    };
    file("good.ron", FULL.as_bytes());
    let large = file("large.ron", b"");
    let grown = fs::File::options().write(true).open(&large);
    grown
        .and_then(|file| file.set_len(100_000_000))
        .expect("grown");
    for (path, message, remedy) in [
        (file("empty.ron", b""), "is empty", "minimal.ron"),
        (file("blank.ron", b" \n\t\n"), "is empty", "minimal.ron"),
        (
            file("png.ron", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"),
            "a PNG picture",
            "RON",
        ),
        (file("binary.ron", b"(title\0\x01"), "a binary file", "RON"),
        (
            file("latin.ron", b"(\ntitle: \"caf\xe9\")"),
            "line 2",
            "UTF-8",
        ),
        (
            file(
                "marked.ron",
                &utf16(&format!("\u{feff}{FULL}"), u16::to_le_bytes),
            ),
            "is UTF-16 text (little-endian)",
            "save it as UTF-8",
        ),
        (
            file(
                "big.ron",
                &utf16(&format!("\u{feff}{FULL}"), u16::to_be_bytes),
            ),
            "is UTF-16 text (big-endian)",
            "save it as UTF-8",
        ),
        (
            file(
                "unmarked.ron",
                &utf16("// 洞窟, a cave\n(title: \"\")", u16::to_le_bytes),
            ),
            "is UTF-16 text (little-endian)",
            "save it as UTF-8",
        ),
        (
            folder.path().join("a".repeat(300)),
            "name is too long",
            "shorter name",
        ),
        (large, "has 100.0 MB", "minimal.ron"),
        (folder.path().to_owned(), "is a folder", "good.ron"),
        (
            folder.path().join("missing.ron"),
            "does not exist",
            "good.ron",
        ),
        (
            folder.path().join("nowhere/a.ron"),
            "does not exist",
            "no folder",
        ),
    ] {
        let problem = refused(load(&path));
        assert!(
            problem.to_string().contains(message),
            "{problem} lacks {message}"
        );
        let help = problem.remedy();
        assert!(help.contains(remedy), "{help} lacks {remedy}");
    }
    if cfg!(unix) {
        let problem = refused(load(Path::new("/dev/zero")));
        assert!(problem.to_string().contains("is not a file"), "{problem}");
    }
}

#[test]
fn line_ends_and_marks_of_other_editors_do_not_matter() {
    let folder = folder();
    let path = folder.path().join("world.ron");
    for text in [format!("\u{feff}{FULL}"), FULL.replace('\n', "\r\n")] {
        fs::write(&path, text).expect("written");
        let world = load(&path).unwrap_or_else(|report| panic!("{report:?}"));
        assert_eq!(world.name, "world");
        assert_eq!(world.layouts.len(), 3);
    }
}

#[test]
fn what_a_world_holds_is_summed_up() {
    let folder = folder();
    let path = folder.path().join("full.ron");
    fs::write(&path, FULL).expect("written");
    let summary = file::check(&path).expect("sound").to_string();
    for part in [
        "64 × 48 × 64 voxels of 0.5 m, seed 7",
        "rock, moss, cap",
        "4 of 2 models",
        "one (3), many (7), and a sun",
        "entrance, back",
        "coarse (100), fine (567)",
    ] {
        assert!(summary.contains(part), "{summary}");
    }
}

#[test]
fn all_worlds_that_come_with_grotto_are_sound() {
    let folder = root().join("worlds");
    for entry in fs::read_dir(folder).expect("the folder of worlds") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "ron") {
            let world = load(&path).unwrap_or_else(|report| panic!("{report:?}"));
            assert!(!world.title.is_empty(), "{} has a title", path.display());
        }
    }
}
