//! A part of a judge's rows, and the table made of all parts.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use super::{
    super::{
        EXIT_FAULT, Failure,
        options::load_world,
        part::{Head, Part, PartFile},
        settings::Setting,
        shard::Shard,
    },
    Arguments, COMMAND,
    cache::fnv1a,
    page::{Fragment, PICTURES, Page},
    report::{Files, Missing, Report},
    row::Row,
    runner::{Judge, Missed},
    summary, verdict,
};
use crate::{
    gpu::{AdapterSummary, Gpu},
    measure::whole_file,
    parameters::Key,
};

/// The content of a part. RON restores every bit of a number.
#[derive(Serialize, Deserialize)]
struct Stored {
    adapter: AdapterSummary,
    /// Width and height in pixels of the judged pictures.
    size: [u32; 2],
    spp: u32,
    /// Whether pictures and references are anti-aliased.
    displayed: bool,
    /// Width in pixels of the pictures in the page.
    page_pictures: u32,
    varied: Vec<String>,
    /// Number of worlds that were named.
    worlds: usize,
    rows: Vec<StoredRow>,
    fragments: Vec<Fragment>,
    /// CRC-32 of the files that the fragments name.
    checksums: BTreeMap<String, u32>,
    failures: Vec<StoredFailure>,
}

#[derive(Serialize, Deserialize)]
struct StoredRow {
    /// Position among all worlds, cameras and rows.
    place: u32,
    settings: Vec<(String, String)>,
    row: Row,
}

/// A world that is missing: a stored [`Missed`].
#[derive(Serialize, Deserialize)]
struct StoredFailure {
    path: String,
    reason: String,
    fault: bool,
    first_place: u32,
    end_place: u32,
    at: u32,
}

/// The file of a part. Its head lists everything that the table depends on.
///
/// # Errors
/// See [`PartFile::new`].
pub fn file(
    arguments: &Arguments,
    paths: &[PathBuf],
    gpu: &Gpu,
    shard: Shard,
) -> Result<PartFile, Failure> {
    let subjects = &arguments.subjects;
    let parameters = arguments.run.parameters()?;
    let hashed = |text: &str| format!("{:032x}", fnv1a(text.as_bytes()));
    let AdapterSummary {
        name: adapter,
        driver,
        backend,
        ..
    } = &gpu.summary;
    let worlds = paths
        .iter()
        .map(|path| match load_world(path, &parameters) {
            Ok(world) => format!("{} {}", world.name, hashed(&format!("{world:?}"))),
            Err(failure) => format!("{} {}", path.display(), hashed(failure.reason())),
        });
    let worlds: Vec<String> = worlds.collect();
    let settings = subjects.settings(&arguments.run)?;
    let settings: Vec<String> = settings.iter().map(Setting::to_string).collect();
    let masks = arguments.masks.iter().map(|(camera, path)| {
        let bytes = fs::read(path).unwrap_or_default();
        format!("{camera} {:032x}", fnv1a(&bytes))
    });
    let masks: Vec<String> = masks.collect();
    let [width, height] = subjects.size;
    let facts = [
        (
            "grotto",
            format!("{} {}", env!("CARGO_PKG_VERSION"), env!("GROTTO_COMMIT")),
        ),
        ("the adapter", format!("{adapter} ({driver}, {backend})")),
        ("the worlds", worlds.join(", ")),
        ("the cameras", subjects.cameras.join(", ")),
        ("the layouts", subjects.layouts.join(", ")),
        ("the settings", settings.join("; ")),
        ("the parameters", hashed(&format!("{parameters:?}"))),
        ("the size", format!("{width}x{height}")),
        ("the frames", subjects.frames.to_string()),
        ("the time", subjects.time.to_string()),
        ("the seed", subjects.seed.to_string()),
        ("the samples a pixel", arguments.spp.to_string()),
        ("the tracer", format!("{:?}", arguments.against)),
        ("the masks", masks.join(", ")),
        ("--direct", arguments.direct.to_string()),
        ("--page-pictures", arguments.page_pictures.to_string()),
        ("--pictures", arguments.pictures.to_string()),
        ("--skip-stability", arguments.skip_stability.to_string()),
        ("--skip-response", arguments.skip_response.to_string()),
        ("--response-frames", arguments.response_frames.to_string()),
        ("--motion", arguments.motion.fact()),
        ("--displayed", arguments.displayed.to_string()),
    ];
    let head = Head {
        command: COMMAND.to_owned(),
        whole: COMMAND.to_owned(),
        shard,
        facts: facts.map(|(name, value)| (name.to_owned(), value)).into(),
    };
    PartFile::new(&arguments.out, head)
}

/// # Errors
/// When the part cannot be written, or when one of its pictures cannot be read back.
pub fn write(judge: &Judge<'_>, file: PartFile, worlds: usize) -> Result<(), Failure> {
    let fragments = judge.page.fragments().to_vec();
    let folder = judge.arguments.out.join(PICTURES);
    let checksum = |name: &String| {
        let path = folder.join(name);
        let bytes = fs::read(&path).map_err(|reason| Failure::unread(&path, reason))?;
        Ok((name.clone(), crc32fast::hash(&bytes)))
    };
    let names = fragments.iter().flat_map(|fragment| &fragment.files);
    let checksums = names.map(checksum).collect::<Result<_, Failure>>()?;
    let rows = judge.rows.iter().zip(&judge.places);
    let stored = Stored {
        adapter: judge.gpu.summary.clone(),
        size: judge.arguments.subjects.size,
        spp: judge.arguments.spp,
        displayed: judge.arguments.displayed,
        page_pictures: judge.arguments.page_pictures,
        varied: judge.varied.iter().map(|&key| key.to_owned()).collect(),
        worlds,
        rows: rows
            .map(|(row, place)| StoredRow {
                place: *place,
                settings: row.settings.texts(),
                row: row.clone(),
            })
            .collect(),
        fragments,
        checksums,
        failures: judge.failures.iter().map(StoredFailure::of).collect(),
    };
    let text = ron::to_string(&stored).map_err(Failure::fault)?;
    file.write(text.as_bytes())?;
    Ok(())
}

impl StoredFailure {
    fn of(missed: &Missed) -> Self {
        Self {
            path: missed.path.display().to_string(),
            reason: missed.failure.reason().to_owned(),
            fault: missed.failure.exit_code() == EXIT_FAULT,
            first_place: missed.world.start,
            end_place: missed.world.end,
            at: missed.at,
        }
    }

    fn missed(self) -> Missed {
        let failure = match self.fault {
            true => Failure::fault(self.reason),
            false => Failure::bad_input(self.reason),
        };
        Missed {
            path: self.path.into(),
            failure,
            world: self.first_place..self.end_place,
            at: self.at,
        }
    }

    /// Whether a whole run would have skipped this place: a world ends at its first failure.
    fn hides(&self, place: u32) -> bool {
        (self.at..self.end_place).contains(&place)
    }
}

/// Writes the tables of all parts, which must be in order, into a folder. The inner result is that of the whole
/// run.
///
/// # Errors
/// When a part is damaged, does not fit the others, or lacks a picture, and when a file cannot be written.
pub fn merge(parts: &[Part], out: &Path) -> Result<Result<(), Failure>, Failure> {
    let mut all: Option<Stored> = None;
    for part in parts {
        let stored = read(part)?;
        copy_pictures(part, &stored, out)?;
        match &mut all {
            None => all = Some(stored),
            Some(all) => join(all, stored).map_err(|reason| part.refused(&reason))?,
        }
    }
    let Some(mut all) = all else {
        return Err(Failure::bad_input("there are no parts"));
    };
    all.rows.sort_by_key(|row| row.place);
    all.fragments.sort_by_key(|fragment| fragment.place);
    all.failures
        .sort_by_key(|failure| (failure.first_place, failure.end_place));
    let hidden = |place| all.failures.iter().any(|failure| failure.hides(place));
    all.rows.retain(|row| !hidden(row.place));
    all.fragments.retain(|fragment| !hidden(fragment.place));
    let shown: BTreeSet<&String> = all.fragments.iter().flat_map(|f| &f.files).collect();
    for name in all.checksums.keys().filter(|name| !shown.contains(name)) {
        let path = out.join(PICTURES).join(name);
        fs::remove_file(&path).map_err(|reason| Failure::unwritten(&path, reason))?;
    }
    let rows: Vec<Row> = all.rows.into_iter().map(|stored| stored.row).collect();
    let failures: Vec<Missed> = all
        .failures
        .into_iter()
        .map(StoredFailure::missed)
        .collect();
    if !rows.is_empty() {
        let known = |name: &String| Key::find(name).map(|key| key.name).ok();
        let varied: Vec<&'static str> = all.varied.iter().filter_map(known).collect();
        let missing = failures.iter().map(|missed| Missing {
            world: missed.path.display().to_string(),
            message: missed.failure.reason().to_owned(),
        });
        let report = Report {
            version: env!("CARGO_PKG_VERSION"),
            adapter: &all.adapter,
            size: all.size,
            spp: all.spp,
            displayed: all.displayed,
            complete: true,
            rows: &rows,
            by_setting: summary::by_setting(&rows),
            failures: missing.collect(),
            varied: &varied,
        };
        let page = Page::of_fragments(all.fragments, all.page_pictures);
        Files::new(out)?.write(&report, &page)?;
    }
    Ok(verdict(failures, all.worlds))
}

fn read(part: &Part) -> Result<Stored, Failure> {
    let damaged = || part.refused("the part is damaged; run it again");
    let mut stored: Stored = ron::de::from_bytes(&part.body).map_err(|_| damaged())?;
    for StoredRow { settings, row, .. } in &mut stored.rows {
        row.settings = Setting::from_texts(settings).map_err(|_| damaged())?;
    }
    Ok(stored)
}

/// Adds the rows and pictures of another part. Where both show a camera, they must show the same reference.
fn join(all: &mut Stored, other: Stored) -> Result<(), String> {
    for fragment in other.fragments {
        match all
            .fragments
            .iter()
            .find(|known| known.place == fragment.place)
        {
            None => all.fragments.push(fragment),
            Some(known) if *known == fragment => {}
            Some(_) => {
                return Err(
                    "the part shows another reference than the others; run all parts again"
                        .to_owned(),
                );
            }
        }
    }
    for row in other.rows {
        if all.rows.iter().any(|known| known.place == row.place) {
            return Err("the part has a row that another has too; run all parts again".to_owned());
        }
        all.rows.push(row);
    }
    for (name, crc) in other.checksums {
        if *all.checksums.entry(name.clone()).or_insert(crc) != crc {
            return Err(format!(
                "its picture {name} differs from that of the others; run all parts again"
            ));
        }
    }
    for failure in other.failures {
        let same = |known: &&mut StoredFailure| {
            (known.first_place, known.end_place, &known.path)
                == (failure.first_place, failure.end_place, &failure.path)
        };
        match all.failures.iter_mut().find(same) {
            None => all.failures.push(failure),
            // A whole run would have stopped at the earlier failure.
            Some(known) if failure.at < known.at => *known = failure,
            Some(_) => {}
        }
    }
    Ok(())
}

/// Copies the pictures in full size, which are beside the part.
fn copy_pictures(part: &Part, stored: &Stored, out: &Path) -> Result<(), Failure> {
    let from = part.path.with_file_name(PICTURES);
    let to = out.join(PICTURES);
    for (name, crc) in &stored.checksums {
        let bytes = fs::read(from.join(name)).ok();
        let Some(bytes) = bytes.filter(|bytes| crc32fast::hash(bytes) == *crc) else {
            return Err(part.refused(&format!(
                "its picture {PICTURES}/{name} is missing or damaged; run the part again"
            )));
        };
        whole_file::create_folder(&to)?;
        let copy = to.join(name);
        fs::write(&copy, bytes).map_err(|reason| Failure::unwritten(&copy, reason))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{super::row::Noise, *};
    use crate::measure::{
        comparison::{AbsoluteSummary, Comparison, FlipSummary},
        stability::Stability,
    };

    fn row(values: &[f64]) -> Row {
        let comparison = |at: usize| Comparison {
            flip: FlipSummary {
                mean: values[at],
                p99: values[at + 1],
                max: values[at + 2],
            },
            abs_sum: AbsoluteSummary {
                mean: values[at + 3],
                max: values[at + 4],
            },
            rel_mse: values[at + 5],
            energy_ratio: values[at + 6],
            size: [4, 3],
            pixels: u64::MAX,
        };
        Row {
            world: "a \"room\"".to_owned(),
            camera: "ü\n".to_owned(),
            layout: String::new(),
            settings: Setting::default(),
            direct_alone: true,
            rays: 8,
            hysteresis: values[14] as f32,
            frames: 3,
            full: comparison(0),
            indirect: comparison(7),
            noise: Some(Noise {
                full: values[17],
                indirect: values[18],
            }),
            leak_ratio: Some(values[15]),
            stability: Some(Stability {
                mean: values[16],
                p99: 0.1 + 0.2,
                max: 1.0 / 3.0,
                frames: 50,
            }),
            response: None,
            probe_bytes: 1,
            motion: Vec::new(),
        }
    }

    /// Every bit counts: JSON would round some numbers, and has no infinity.
    #[test]
    fn numbers_are_stored_exactly() {
        let mut state = 1u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            f64::from_bits(state ^ state >> 17)
        };
        let special = [
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            -0.0,
            5e-324,
            f64::MAX,
            0.1,
        ];
        for round in 0..400 {
            let values: Vec<f64> = match round {
                0 => special.into_iter().cycle().take(19).collect(),
                _ => (0..19).map(|_| next()).collect(),
            };
            let before = row(&values);
            let text = ron::to_string(&before).expect("it can be written");
            let after: Row = ron::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
            // The shortest text of a number identifies it, except for the kinds of NaN.
            assert_eq!(format!("{after:?}"), format!("{before:?}"));
        }
    }
}
