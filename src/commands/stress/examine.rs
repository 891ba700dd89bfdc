//! Examines one scene with every check.

use std::{
    cell::RefCell,
    panic::{self, AssertUnwindSafe},
    time::{Duration, Instant},
};

use super::{
    super::Failure,
    checks::{
        Check, Findings,
        darkness::{Darkness, Reached},
        energy, finite, marching, memory, reference, voxels,
    },
    fault::Fault,
    play::{Part, Play},
    scene::Scene,
    test_case::TestCase,
    watched::Watched,
};
use crate::{frame::Stage, measure::picture::Picture, world::file::Summary};

/// Longest time of a dispatch on a GPU, milliseconds.
const MOST_MS: f64 = 50.0;
/// Longest time of a scene: far more than any scene needs.
const MOST_TIME: Duration = Duration::from_secs(120);
const MOST_TIME_IN_SOFTWARE: Duration = Duration::from_secs(900);

/// The options of an examination.
#[derive(Clone, Copy)]
pub struct Examination {
    pub fault: Option<Fault>,
    /// Only the work that this check needs.
    pub only: Option<Check>,
}

thread_local! {
    /// The message of the last panic of this thread.
    static PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Stores the messages of panics for the report, in place of printing them.
pub fn listen_for_panics() {
    panic::set_hook(Box::new(|info| {
        let place = info
            .location()
            .map(|place| format!(" at {}:{}", place.file(), place.line()));
        let said = info.payload_as_str().unwrap_or("no message");
        PANIC.with_borrow_mut(|kept| *kept = format!("{said}{}", place.unwrap_or_default()));
    }));
}

/// Plays a scene and judges it. A scene that cannot be played is a finding, too.
pub fn examine(watched: &mut Watched, scene: &Scene, examination: Examination) -> Findings {
    let start = Instant::now();
    let mut findings = Findings::default();
    let world = match scene.load() {
        Ok(world) => world,
        Err(failure) => {
            findings.note(Check::Loads, Err(failure.reason().to_owned()));
            return findings;
        }
    };
    findings.note(Check::Loads, Ok(()));
    let most = if watched.gpu.summary.is_software() {
        MOST_TIME_IN_SOFTWARE
    } else {
        MOST_TIME
    };
    let before = memory::allocated(&watched.gpu);
    let played = panic::catch_unwind(AssertUnwindSafe(|| {
        let case = TestCase::of(world, &scene.set, scene.seed)?;
        Judge {
            examination,
            case: &case,
            findings: &mut findings,
        }
        .judge(watched)
    }));
    let verdict = match played {
        Ok(played) => played.map_err(|failure| failure.reason().to_owned()),
        Err(_) => Err(format!("a panic: {}", PANIC.with_borrow(Clone::clone))),
    };
    findings.note(Check::Runs, verdict);
    if let Err(error) = watched.gpu.wait() {
        findings.note(Check::Runs, Err(error.to_string()));
    }
    let errors = watched.errors();
    findings.note(
        Check::Validation,
        errors.first().map_or(Ok(()), |error| Err(error.clone())),
    );
    if let Some(verdict) = memory::returned(before, memory::allocated(&watched.gpu)) {
        findings.note(Check::Memory, verdict);
    }
    let took = start.elapsed();
    findings.note(
        Check::Time,
        if took <= most {
            Ok(())
        } else {
            Err(format!("the scene took longer than {} s", most.as_secs()))
        },
    );
    findings
}

struct Judge<'a> {
    examination: Examination,
    case: &'a TestCase,
    findings: &'a mut Findings,
}

/// The pictures of a play and the stored light of the probes at its end, for a comparison bit for bit.
type Take = Vec<(String, Vec<f32>)>;

impl Judge<'_> {
    fn wants(&self, checks: &[Check]) -> bool {
        self.examination
            .only
            .is_none_or(|only| checks.contains(&only))
    }

    fn plants(&self, fault: Fault) -> bool {
        self.examination.fault == Some(fault)
    }

    fn judge(&mut self, watched: &mut Watched) -> Result<(), Failure> {
        let gpu = watched.gpu.clone();
        let before = memory::allocated(&gpu);
        if self.plants(Fault::Buffer) {
            watched.kept.push(gpu.storage_buffer("planted", 1 << 16)?);
        }
        let stage = Stage::build(&gpu, &self.case.world)?;
        let built = stage.read_back(&gpu)?;
        if self.plants(Fault::Distance) {
            voxels::overstate(&gpu, &stage.voxels, &built);
        }
        let found = stage.read_back(&gpu)?;
        self.findings.note(Check::Distances, found.validate());
        if self.wants(&[Check::Voxels]) {
            self.findings
                .note(Check::Voxels, voxels::against_the_cpu(self.case, &found));
        }
        let early = [Check::Voxels, Check::Distances];
        if self
            .examination
            .only
            .is_some_and(|only| early.contains(&only))
        {
            return Ok(());
        }
        let mut play = Play::new(&gpu, self.case, stage, self.examination.fault)?;
        play.reached = self.wants(&[Check::Dark]).then(Reached::default);
        if self.wants(&[Check::Marching]) {
            let on_gpu = &play.frame.stage.voxels;
            let hits = marching::against_plain(&gpu, self.case, on_gpu, &play.voxels, &play.shot)?;
            self.findings.note(Check::Marching, hits);
        }
        gpu.wait()?;
        let taken = memory::allocated(&gpu)
            .zip(before)
            .map(|(now, before)| now.saturating_sub(before));
        let summary = Summary::of(&self.case.world);
        self.findings.note(
            Check::Predicted,
            memory::predicted(&play.frame, &self.case.world, &summary, taken),
        );
        let first = self.play(&mut play)?;
        self.at_the_end(&mut play, &first)?;
        let mut longest_ms = std::mem::take(&mut play.longest_ms);
        drop(play);
        if self.wants(&[Check::Repeat, Check::Dispatch]) {
            let stage = Stage::build(&gpu, &self.case.world)?;
            let mut again = Play::new(&gpu, self.case, stage, self.examination.fault)?;
            let mut second = self.take(&mut again, |_, _, _, _| {})?;
            if self.plants(Fault::Order)
                && let Some((_, values)) = second.last_mut()
            {
                values[0] += 1.0;
            }
            self.findings.note(Check::Repeat, same(&first, &second));
            // Other work on the same GPU may delay a pass once. A pass that is slow by itself is slow again.
            for (pass, ms) in &mut longest_ms {
                *ms = ms.min(again.longest_ms.get(pass).copied().unwrap_or_default());
            }
        }
        if self.plants(Fault::Slow) {
            longest_ms.insert("planted".to_owned(), 80.0);
        }
        let mut slow = longest_ms.iter().filter(|(_, ms)| **ms > MOST_MS);
        self.findings.note(
            Check::Dispatch,
            slow.next().map_or(Ok(()), |(pass, _)| {
                Err(format!("pass `{pass}` takes more than {MOST_MS} ms"))
            }),
        );
        Ok(())
    }

    /// Plays every part; `after` receives each picture.
    fn take(
        &mut self,
        play: &mut Play<'_>,
        mut after: impl FnMut(&mut Self, &Play<'_>, Part, &Picture),
    ) -> Result<Take, Failure> {
        let mut take = Take::new();
        for part in Part::ALL {
            play.part(part)?;
            let picture = play.frame.read_radiance(play.gpu)?;
            after(self, play, part, &picture);
            take.push((part.name().to_owned(), picture.rgb.into_flattened()));
        }
        take.push((
            "the irradiance of probes".to_owned(),
            finite::irradiance(play)?,
        ));
        Ok(take)
    }

    fn play(&mut self, play: &mut Play<'_>) -> Result<Take, Failure> {
        let case = self.case;
        self.take(play, |judge, play, part, picture| {
            judge
                .findings
                .note(Check::Finite, finite::picture(part.name(), picture));
            judge
                .findings
                .note(Check::Energy, energy::picture(part.name(), picture, case));
            if part.is_dark_where_no_light_was()
                && judge.knows_what_is_dark(play)
                && let Some(darkness) = Darkness::of(play)
            {
                let verdict = darkness.light_in(picture);
                let verdict = verdict.map_err(|message| format!("{}: {message}", part.name()));
                judge.findings.note(Check::Dark, verdict);
            }
        })
    }

    /// Probes with estimated visibility are known to leak, so they are not judged. A planted leak is, because it pretends to be exact.
    fn knows_what_is_dark(&self, play: &Play<'_>) -> bool {
        play.frame.field().exact() || self.plants(Fault::Leak)
    }

    /// Judges the last picture and the contents of the buffers.
    fn at_the_end(&mut self, play: &mut Play<'_>, take: &Take) -> Result<(), Failure> {
        let gpu = play.gpu;
        let found = play.frame.stage.read_back(gpu)?;
        self.findings
            .note(Check::Edits, voxels::against_the_copy(&found, &play.voxels));
        if !self.plants(Fault::Distance) {
            self.findings.note(Check::Distances, found.validate());
        }
        if self.plants(Fault::Nan) {
            let means = play.frame.field().variability();
            gpu.queue.write_buffer(means, 0, &f32::NAN.to_le_bytes());
        }
        self.findings.note(Check::Finite, finite::buffers(play)?);
        if let Some((_, irradiance)) = take.last() {
            self.findings
                .note(Check::Energy, energy::irradiance(irradiance, self.case));
        }
        if self.wants(&[Check::Dark, Check::Band]) {
            let shown = play.frame.read_radiance(gpu)?;
            let truth = reference::traced(play, reference::SAMPLES)?;
            self.findings
                .note(Check::Finite, finite::picture("the reference", &truth));
            if let Some(darkness) = Darkness::of(play) {
                self.findings
                    .note(Check::Dark, reference::is_dark(&darkness, &truth));
            }
            let mut verdict = reference::band(play, &shown, &truth);
            if matches!(verdict, Some(Err(_))) && self.wants(&[Check::Band]) {
                let truth = reference::traced(play, reference::MANY_SAMPLES)?;
                verdict = reference::band(play, &shown, &truth);
            }
            if let Some(verdict) = verdict {
                self.findings.note(Check::Band, verdict);
            }
        }
        Ok(())
    }
}

fn same(first: &Take, second: &Take) -> Result<(), String> {
    for ((name, a), (_, b)) in first.iter().zip(second) {
        let differing = a
            .iter()
            .zip(b)
            .filter(|(a, b)| a.to_bits() != b.to_bits())
            .count();
        if differing > 0 {
            return Err(format!(
                "{name}: {differing} of {} numbers differ when it is rendered again",
                a.len()
            ));
        }
    }
    Ok(())
}
