//! Reading a record: everything in it is checked before anything is played.

use std::{
    fs::File,
    io::{self, Read as _},
    path::Path,
};

use serde::Deserialize;

use super::{Header, Moment, Record, RecordError, VERSION, write::part_of};
use crate::{
    app::{
        hands::{Item, hotbar::SLOTS},
        input::Input,
    },
    measure::whole_file::FileError,
    parameters::Parameters,
};

/// Longer records are refused (bytes): some days of play.
const LARGEST: u64 = 1 << 30;
/// Simulated time that may pass between two lines (nanoseconds): recorders write twice as often at least.
const LONGEST_GAP_NS: u64 = 2_000_000_000;
/// Largest edge of a picture (pixels).
const LARGEST_EDGE: u32 = 16_384;
/// Most slots that a wheel is turned by in one input.
const MOST_SCROLLED: u32 = 1 << 20;
/// World time lies within ± this many seconds.
const LATEST_S: f64 = 1e9;
/// Largest change of an angle or a speed in one input, far beyond what a hand does.
const FARTHEST_PX: f32 = 1e7;
/// Fastest world time (seconds per second).
const FASTEST: f32 = 1e3;

const NO_RECORD: &str = "This is no record of grotto: `grotto play --record FILE` writes one.";
const DAMAGED: &str = "The record was changed or damaged: records are written by `grotto play --record FILE`, \
                       and are not to be edited.";
const NEWER: &str = "Play it with the version of grotto that recorded it.";

/// What every version of the format has in its first line.
#[derive(Deserialize)]
struct AnyHeader {
    grotto_record: u32,
}

impl Record {
    /// Reads a record. One that was cut off by a crash ends with its last whole line.
    ///
    /// # Errors
    /// [`RecordError`] with the line, when it is no record, of another version, or damaged.
    pub fn read(path: &Path) -> Result<Self, RecordError> {
        let bytes = bytes_of(path)?;
        let bad = |line: usize, reason: String, remedy| RecordError::Bad {
            place: format!("{}:{line}", path.display()),
            reason,
            remedy,
        };
        // A line that was being written when the program ended has no newline.
        let whole = bytes
            .iter()
            .rposition(|byte| *byte == b'\n')
            .map_or(0, |at| at + 1);
        let text = std::str::from_utf8(&bytes[..whole]).map_err(|error| {
            let line = 1 + bytes[..error.valid_up_to()]
                .iter()
                .filter(|b| **b == b'\n')
                .count();
            bad(
                line,
                "this is not text".to_owned(),
                if line == 1 { NO_RECORD } else { DAMAGED },
            )
        })?;
        let mut lines = text.lines().enumerate();
        let first = lines.next().map_or("", |(_, line)| line);
        let any: AnyHeader = serde_json::from_str(first).map_err(|_| {
            bad(
                1,
                "the line that begins a record is missing".to_owned(),
                NO_RECORD,
            )
        })?;
        if any.grotto_record != VERSION {
            let version = any.grotto_record;
            let reason =
                format!("the record is of version {version}; this grotto plays version {VERSION}");
            return Err(bad(1, reason, NEWER));
        }
        let header: Header =
            serde_json::from_str(first).map_err(|error| bad(1, without_line(&error), DAMAGED))?;
        check_header(&header).map_err(|reason| bad(1, reason, DAMAGED))?;

        let mut moments: Vec<Moment> = Vec::new();
        let mut before_ns = 0;
        for (index, line) in lines {
            let line_number = index + 1;
            let damaged = |reason| bad(line_number, reason, DAMAGED);
            if moments.last().is_some_and(|last| last.end) {
                return Err(damaged("the record goes on after its end".to_owned()));
            }
            let moment: Moment =
                serde_json::from_str(line).map_err(|error| damaged(without_line(&error)))?;
            if moment.at_ns < before_ns || moment.at_ns - before_ns > LONGEST_GAP_NS {
                let reason = format!("time goes from {before_ns} to {} ns", moment.at_ns);
                return Err(damaged(reason));
            }
            moment.inputs.iter().try_for_each(check).map_err(damaged)?;
            before_ns = moment.at_ns;
            moments.push(moment);
        }
        let lines = moments.len() + 1;
        let Some(last) = moments.last() else {
            return Err(bad(
                2,
                "the record ends before anything happens".to_owned(),
                DAMAGED,
            ));
        };
        let cut = (!last.end).then(|| {
            format!(
                "{}:{lines}: the record ends here without its last line, as after a crash: its {:.1} s are played",
                path.display(),
                last.at_ns as f64 * 1e-9
            )
        });
        Ok(Self {
            header,
            moments,
            cut,
        })
    }
}

fn bytes_of(path: &Path) -> Result<Vec<u8>, RecordError> {
    let reading = |reason| FileError::reading(path, reason);
    let file = File::open(path).map_err(|reason| {
        let part = part_of(path);
        if reason.kind() == io::ErrorKind::NotFound && part.is_file() {
            return RecordError::Bad {
                place: path.display().to_string(),
                reason: "the run did not end by itself, so its record is incomplete".to_owned(),
                remedy: "Play what there is: `--replay FILE.part`.",
            };
        }
        reading(reason).into()
    })?;
    let mut bytes = Vec::new();
    file.take(LARGEST + 1)
        .read_to_end(&mut bytes)
        .map_err(reading)?;
    if bytes.len() as u64 > LARGEST {
        return Err(RecordError::Bad {
            place: path.display().to_string(),
            reason: format!("the file has more than {LARGEST} bytes"),
            remedy: NO_RECORD,
        });
    }
    Ok(bytes)
}

/// serde_json counts lines itself, but sees only one.
fn without_line(error: &serde_json::Error) -> String {
    let text = error.to_string();
    match text.rsplit_once(" at line ") {
        Some((reason, _)) => format!("{reason} at column {}", error.column()),
        None => text,
    }
}

fn check_header(header: &Header) -> Result<(), String> {
    check_size(header.size)?;
    let mut parameters = Parameters::default();
    for assignment in &header.set {
        parameters
            .set(assignment)
            .map_err(|error| error.to_string())?;
    }
    let camera = header.camera();
    let fits = camera.position.is_finite()
        && camera.yaw_deg.abs() <= 360.0
        && camera.pitch_deg.abs() <= 90.0
        && (1.0..=170.0).contains(&camera.fov_deg);
    match fits {
        true => Ok(()),
        false => Err("the camera cannot be looked through".to_owned()),
    }
}

fn check_size(size: [u32; 2]) -> Result<(), String> {
    match size.iter().all(|edge| (1..=LARGEST_EDGE).contains(edge)) {
        true => Ok(()),
        false => Err(format!(
            "a picture cannot have {} × {} pixels",
            size[0], size[1]
        )),
    }
}

/// A file can hold what no hand and no panel does.
fn check(input: &Input) -> Result<(), String> {
    let fits = match input {
        Input::Look(right, down) => right.abs() <= FARTHEST_PX && down.abs() <= FARTHEST_PX,
        Input::FlySpeed(notches) => notches.abs() <= FARTHEST_PX,
        Input::Slot(slot) => *slot < SLOTS,
        Input::Scroll(slots) => slots.unsigned_abs() <= MOST_SCROLLED,
        Input::Item { slot, item } => {
            let fault = match item {
                Item::Lamp(block) => block.fault(),
                Item::Material(_) => None,
            };
            *slot < SLOTS && fault.is_none()
        }
        Input::Clock { rate, time_s, .. } => {
            (0.0..=FASTEST).contains(rate) && time_s.abs() <= LATEST_S
        }
        Input::Resize(size) => return check_size(*size),
        Input::Set(assignment) => {
            let set = Parameters::default().set(assignment);
            return set.map_err(|error| error.to_string());
        }
        _ => true,
    };
    match fits {
        true => Ok(()),
        false => Err(format!("{input:?} is out of range")),
    }
}

#[cfg(test)]
mod tests {
    use std::{fs, path::PathBuf};

    use super::*;
    use crate::{
        app::{
            hands::{
                brush::{Brush, Shape, Stroke},
                clipboard::Clip,
            },
            input::Key,
            record::Recorder,
            viewport::Choice,
        },
        world::{Camera, placed::LampBlock},
    };

    fn header() -> Header {
        let mut parameters = Parameters::default();
        parameters.set("probes.rays=16").expect("a key");
        parameters.set("probes.hysteresis=0.123").expect("a key");
        let choice = Choice {
            parameters,
            layout: "a layout".into(),
            size: [64, 40],
            traced: false,
        };
        let camera = Camera {
            name: "start".into(),
            position: glam::Vec3::new(0.1, -2.3, 1e-7),
            yaw_deg: 33.3,
            pitch_deg: -12.7,
            fov_deg: 70.0,
        };
        Header::new(
            Path::new("worlds/minimal.ron"),
            0xdead_beef,
            7,
            &choice,
            &camera,
        )
    }

    fn inputs() -> Vec<Input> {
        vec![
            Input::Press(Key::Forward),
            Input::Release(Key::NoClip),
            Input::Look(0.1, -33.7),
            Input::FlySpeed(1.0),
            Input::Stroke(Stroke::Dig),
            Input::Brush(Brush {
                shape: Shape::Ball,
                radius: 1.7,
            }),
            Input::Clip(Clip::Mark),
            Input::Slot(9),
            Input::Scroll(-3),
            Input::Item {
                slot: 4,
                item: Item::Material(3),
            },
            Input::Item {
                slot: 0,
                item: Item::Lamp(LampBlock {
                    power: 1234.5,
                    soft_radius: 0.7,
                    ..LampBlock::default()
                }),
            },
            Input::Camera(2),
            Input::Clock {
                paused: true,
                rate: 0.3,
                time_s: 1.0 / 3.0,
            },
            Input::Set("probes.rays=32".into()),
            Input::Layout("other".into()),
            Input::Resize([8, 9]),
            Input::Focus(false),
            Input::Reload,
        ]
    }

    /// A record of all inputs, a mark, and an end.
    fn written() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("run.record");
        let mut recorder = Recorder::create(&path, &header()).expect("writable");
        recorder.add(5, &inputs()).expect("writable");
        recorder.add(6, &[]).expect("nothing to say yet");
        recorder.add(700_000_000, &[]).expect("writable");
        assert!(!path.exists(), "it has its name at the end only");
        recorder.finish(900_000_000).expect("writable");
        (folder, path)
    }

    #[test]
    fn what_was_written_is_read_to_the_bit() {
        let (_folder, path) = written();
        let record = Record::read(&path).expect("it is whole");
        assert_eq!(record.header, header());
        assert_eq!(record.moments.len(), 3);
        assert_eq!(record.moments[0].inputs, inputs());
        assert_eq!((record.end_ns(), &record.cut), (900_000_000, &None));
        assert!(!part_of(&path).exists());
    }

    #[test]
    fn a_crash_loses_no_more_than_the_line_being_written() {
        let (_folder, path) = written();
        let text = fs::read_to_string(&path).expect("readable");
        let lines: Vec<&str> = text.lines().collect();
        let cut = format!("{}\n{}\n{}", lines[0], lines[1], &lines[2][..3]);
        fs::write(part_of(&path), cut).expect("writable");
        let record = Record::read(&part_of(&path)).expect("what there is");
        assert_eq!(record.moments.len(), 1);
        let note = record.cut.expect("it is said");
        assert!(note.contains(".part:2:"), "{note}");
        fs::remove_file(&path).expect("it is there");
        let hint = Record::read(&path).expect_err("only the part").to_string();
        assert!(hint.contains("FILE.part"), "{hint}");
    }

    #[test]
    fn bad_records_give_one_message_with_the_line() {
        let (folder, path) = written();
        let text = fs::read_to_string(&path).expect("readable");
        let bad = folder.path().join("bad.record");
        let refused = |bytes: &[u8]| {
            fs::write(&bad, bytes).expect("writable");
            Record::read(&bad).expect_err("it is bad").to_string()
        };
        for (from, to, parts) in [
            (
                "\"grotto_record\":2",
                "\"grotto_record\":9",
                [":1: ", "version 9"],
            ),
            (
                "{\"grotto_record\"",
                "{\"recordings\"",
                [":1: ", "no record of grotto"],
            ),
            (
                "\"size\":[64,40]",
                "\"size\":[0,40]",
                [":1: ", "0 × 40 pixels"],
            ),
            (
                "probes.rays=16",
                "probes.rays=1",
                [":1: ", "from 8 to 4096"],
            ),
            ("\"fov_deg\":70.0", "\"fov_deg\":0.0", [":1: ", "camera"]),
            (
                "{\"press\":\"forward\"}",
                "{\"pres\":\"forward\"}",
                [":2: ", "pres"],
            ),
            (
                "{\"resize\":[8,9]}",
                "{\"resize\":[8,0]}",
                [":2: ", "8 × 0 pixels"],
            ),
            (
                "{\"look\":[0.1,",
                "{\"look\":[1e30,",
                [":2: ", "out of range"],
            ),
            ("\"t\":700000000", "\"t\":4", [":3: ", "from 5 to 4 ns"]),
            (
                "\"t\":700000000",
                "\"t\":99000000000",
                [":3: ", "to 99000000000 ns"],
            ),
            (
                "\"t\":700000000",
                "\"t\":7,\"end\":true",
                [":4: ", "after its end"],
            ),
            ("\"t\":700000000}", "\"t\":700", [":3: ", "column"]),
        ] {
            assert!(text.contains(from), "{from}");
            let message = refused(text.replacen(from, to, 1).as_bytes());
            for part in parts {
                assert!(message.contains(part), "{from}: {message}");
            }
        }
        for nonsense in [
            &b""[..],
            b"\n",
            b"\xff\xfe\n",
            b"PNG\n",
            b"{\"grotto_record\":2}\n",
            b"[]",
        ] {
            let message = refused(nonsense);
            assert!(message.contains("bad.record:1: "), "{message}");
        }
        let first = text.split_inclusive('\n').next().expect("a header");
        assert!(refused(first.as_bytes()).contains("bad.record:2: "));
    }
}
