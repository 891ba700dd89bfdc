//! However a file's bytes are damaged, reading it gives a world or one problem with a remedy.

use grotto::world::file::Problem;
use proptest::prelude::*;

use super::{FULL, read};

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_never_panic(
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4, any::<u8>()), 1..6),
    ) {
        let mut bytes = FULL.as_bytes().to_vec();
        for (index, edit, byte) in edits {
            if bytes.is_empty() {
                break;
            }
            let at = index.index(bytes.len());
            // Mostly characters that have a meaning in world files.
            let signs = b"()[]{},:\"\\/*-.0123456789eNr#'";
            let byte = if byte < 230 { signs[usize::from(byte) % signs.len()] } else { byte };
            match edit {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                2 => drop(bytes.drain(at..(at + 9).min(bytes.len()))),
                _ => bytes.truncate(at + 1),
            }
        }
        let text = String::from_utf8_lossy(&bytes);
        if let Err(report) = read(&text) {
            let rendered = format!("{report:?}");
            prop_assert!(!rendered.is_empty());
            let problem: Problem = report.downcast().expect("a problem of the file");
            prop_assert!(!problem.remedy().is_empty());
        }
    }
}
