//! Files before they are text: refuses invalid sizes, kinds and encodings.

use std::fs;
use std::io::{ErrorKind, Read as _};
use std::path::Path;

use super::diagnostics::{Problem, Source};
use super::values::Read;
use super::vox_alone;

/// Larger world files are refused unread.
pub const MAX_BYTES: u64 = 16 << 20;

/// The text of a world file. A MagicaVoxel model stands for a world around it: see [`vox_alone::world_around`].
pub fn read(path: &Path) -> Read<Source> {
    let name = path.display().to_string();
    if path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("vox"))
    {
        return Ok(Source {
            text: vox_alone::world_around(path)?.into(),
            name,
        });
    }
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    if path.is_dir() {
        return Err(Problem::of_file(
            format!("{name} is a folder, not a world file"),
            siblings(path, "ron"),
        ));
    }
    let bytes = read_bytes(path, MAX_BYTES).map_err(|message| {
        let is_too_long = fs::symlink_metadata(path)
            .is_err_and(|error| error.kind() == ErrorKind::InvalidFilename);
        let help = if is_too_long {
            "give the file a shorter name".into()
        } else if path.exists() {
            "a world file is a short text; worlds/minimal.ron is the smallest to copy".into()
        } else {
            siblings(folder, "ron")
        };
        Problem::of_file(format!("{name} {message}"), help)
    })?;
    text(&name, bytes)
}

/// The bytes of a file, or why they cannot be read, as a phrase that follows the file's name.
pub fn read_bytes(path: &Path, most: u64) -> Result<Vec<u8>, String> {
    let cannot = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => "does not exist".to_owned(),
        ErrorKind::InvalidFilename => {
            "cannot be read: this name is too long for the file system".to_owned()
        }
        ErrorKind::PermissionDenied => "cannot be read: permission denied".to_owned(),
        _ => format!("cannot be read: {error}"),
    };
    let metadata = fs::metadata(path).map_err(cannot)?;
    // Devices and pipes may never end.
    if !metadata.is_file() {
        return Err("is not a file".to_owned());
    }
    let too_large = |length: u64| {
        format!(
            "has {:.1} MB, more than the {} MB that are read",
            length as f64 / 1e6,
            most / 1_000_000
        )
    };
    if metadata.len() > most {
        return Err(too_large(metadata.len()));
    }
    let mut bytes = Vec::new();
    let file = fs::File::open(path).map_err(cannot)?;
    // One byte more, to detect that the file has grown.
    file.take(most + 1)
        .read_to_end(&mut bytes)
        .map_err(cannot)?;
    if bytes.len() as u64 > most {
        return Err(too_large(bytes.len() as u64));
    }
    Ok(bytes)
}

/// Text from arbitrary bytes.
fn text(name: &str, bytes: Vec<u8>) -> Read<Source> {
    let copy = "worlds/minimal.ron is the smallest world to copy";
    if let Some(order) = utf16(&bytes) {
        return Err(Problem::of_file(
            format!("{name} is UTF-16 text ({order})"),
            "save it as UTF-8 in the text editor",
        ));
    }
    let kind = match &bytes[..] {
        [0x89, b'P', b'N', b'G', ..] => Some("a PNG picture"),
        [0xff, 0xd8, 0xff, ..] => Some("a JPEG picture"),
        [b'V', b'O', b'X', b' ', ..] => Some("a MagicaVoxel model"),
        [0x76, 0x2f, 0x31, 0x01, ..] => Some("an OpenEXR picture"),
        bytes if bytes.contains(&0) => Some("a binary file"),
        _ => None,
    };
    if let Some(kind) = kind {
        let help = format!("a world file is a text in the RON format; {copy}");
        return Err(Problem::of_file(
            format!("{name} is {kind}, not a world file"),
            help,
        ));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..valid]
            .iter()
            .filter(|&&b| b == b'\n')
            .count();
        Problem::of_file(
            format!("{name} is not UTF-8 text: line {line} has a byte that is no character"),
            "save the file as UTF-8 in the text editor",
        )
    })?;
    // Editors on Windows begin UTF-8 with a byte order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    if text.trim().is_empty() {
        return Err(Problem::of_file(format!("{name} is empty"), copy));
    }
    Ok(Source {
        name: name.to_owned(),
        text: text.into(),
    })
}

/// Whether these are the bytes of a UTF-16 text, and which byte of a character comes first. Without a
/// byte order mark, zeros next to the ASCII characters at the beginning show it.
fn utf16(bytes: &[u8]) -> Option<&'static str> {
    const LITTLE: &str = "little-endian";
    const BIG: &str = "big-endian";
    match bytes {
        // UTF-32 begins with the mark of UTF-16.
        [0xff, 0xfe, 0, 0, ..] => return None,
        [0xff, 0xfe, ..] => return Some(LITTLE),
        [0xfe, 0xff, ..] => return Some(BIG),
        _ => {}
    }
    let (pairs, _) = bytes[..bytes.len().min(64)].as_chunks::<2>();
    let is_text = |byte: u8| byte.is_ascii_graphic() || byte.is_ascii_whitespace();
    let mostly = |is_ascii: &dyn Fn(&[u8; 2]) -> bool| {
        let count = pairs.iter().filter(|pair| is_ascii(pair)).count();
        pairs.len() >= 2 && 4 * count >= 3 * pairs.len()
    };
    if mostly(&|[low, high]| is_text(*low) && *high == 0) {
        Some(LITTLE)
    } else if mostly(&|[high, low]| is_text(*low) && *high == 0) {
        Some(BIG)
    } else {
        None
    }
}

/// The files of a folder with this extension, as a remedy.
pub fn siblings(folder: &Path, extension: &str) -> String {
    let shown = folder.display();
    let Ok(entries) = fs::read_dir(folder) else {
        return format!("there is no folder {shown} either");
    };
    let paths = entries.flatten().map(|entry| entry.path());
    let wanted = paths.filter(|path| path.extension().is_some_and(|found| found == extension));
    let mut names: Vec<String> = wanted
        .filter_map(|path| Some(path.file_name()?.to_string_lossy().into_owned()))
        .collect();
    names.sort();
    match names.len() {
        0 => format!("{shown} has no .{extension} files"),
        count if count > 24 => format!("{shown} has {count} .{extension} files"),
        _ => format!("{shown} has {}", names.join(", ")),
    }
}
