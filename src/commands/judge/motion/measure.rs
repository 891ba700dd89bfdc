//! Draws the frames of each motion, and compares those of the judged moments with their references.

use indicatif::ProgressBar;

use super::{
    super::{
        super::{
            Failure,
            dynamics::{Ball, Digging, RATE},
            frame_loop::FrameLoop,
            options::RunOptions,
            output,
        },
        row::{Names, Target},
        truth::{Film, Tracer},
    },
    options::{Motion, Moves, Plan},
    row::{Moment, MotionRow},
    sweep::Sweep,
};
use crate::{
    frame::Stage,
    lights::Lights,
    measure::{
        comparison::{Shown, compare},
        selection::Selection,
    },
    world::View,
};

/// The references of one camera, which its rows share.
#[derive(Default)]
pub struct Targets {
    all: Vec<(Lights, Vec<Ball>, Target)>,
}

impl Targets {
    /// The reference of a moment: these lights over this stage, which has these edits.
    fn of(
        &mut self,
        film: &Film<'_>,
        stage: &Stage,
        exposure_ev: f32,
        tracer: &mut Tracer<'_>,
    ) -> Result<&Target, Failure> {
        let is_same = |(lights, edits, _): &(Lights, Vec<Ball>, Target)| {
            lights == film.lights && edits[..] == *film.edits
        };
        let index = match self.all.iter().position(is_same) {
            Some(index) => index,
            None => {
                let target = Target::new(tracer.truth(film, stage)?, exposure_ev);
                let key = (film.lights.clone(), film.edits.to_vec());
                self.all.push((key.0, key.1, target));
                self.all.len() - 1
            }
        };
        Ok(&self.all[index].2)
    }
}

/// Everything that the motions of one row of the judge share.
pub struct Judging<'a, 't> {
    pub names: &'a Names<'a>,
    pub plan: &'a Plan,
    /// Frames before anything moves.
    pub settling: u32,
    /// The camera's picture, before anything has moved.
    pub film: Film<'a>,
    pub tracer: &'a mut Tracer<'t>,
    pub targets: &'a mut Targets,
    pub run: &'a RunOptions,
}

/// What the world looks like in a frame.
struct Now<'l> {
    frame: u32,
    time_s: f64,
    lights: &'l Lights,
    edits: &'l [Ball],
}

impl Judging<'_, '_> {
    /// The row at rest, then a row for each motion. The frame loop must have the probes of the row; its time is
    /// as before, and its probes are not.
    ///
    /// # Errors
    /// When the adapter fails, and when the user stops the run.
    pub fn rows(&mut self, frame_loop: &mut FrameLoop<'_>) -> Result<Vec<MotionRow>, Failure> {
        let settling = u64::from(self.settling + 1);
        let at_rest = settling * (1 + self.plan.moments.len() as u64);
        let moving = settling + u64::from(self.plan.frames());
        let bar = output::progress(
            self.run,
            "frames",
            at_rest + moving * self.plan.rows.len() as u64,
        );
        let rest = self.rest(frame_loop, &bar)?;
        let mut rows = Vec::new();
        for (motion, moves) in &self.plan.rows {
            let moments = match moves.edits {
                false => self.moving(frame_loop, *moves, &bar)?,
                true => {
                    let mut own = frame_loop.in_own_world(&self.names.case.world)?;
                    self.moving(&mut own, *moves, &bar)?
                }
            };
            rows.push(MotionRow::new(*motion, *moves, moments, &rest));
        }
        bar.finish_and_clear();
        frame_loop.set_time(self.names.case.time_s());
        let still = Moves {
            lamps: false,
            camera: false,
            edits: false,
        };
        rows.insert(0, MotionRow::new(Motion::Rest, still, rest, &[]));
        Ok(rows)
    }

    /// World time after this many frames of motion.
    fn time_s(&self, frame: u32) -> f64 {
        self.names.case.time_s() + f64::from(frame) / RATE
    }

    /// The first moment and the judged ones: each time the world stands still, and fresh probes settle.
    fn rest(
        &mut self,
        frame_loop: &mut FrameLoop<'_>,
        bar: &ProgressBar,
    ) -> Result<Vec<Moment>, Failure> {
        let mut moments: Vec<Moment> = Vec::new();
        let mut before: Option<Lights> = None;
        let frames: Vec<u32> = std::iter::once(0)
            .chain(self.plan.moments.iter().copied())
            .collect();
        for frame in frames {
            let time_s = self.time_s(frame);
            let lights = self.names.case.lights_at(time_s);
            // Equal lights give equal frames.
            if let Some(last) = moments.last().filter(|_| before.as_ref() == Some(&lights)) {
                let same = Moment {
                    frame,
                    time_s,
                    ..last.clone()
                };
                moments.push(same);
                bar.inc(u64::from(self.settling + 1));
                continue;
            }
            self.settle(frame_loop, &lights, time_s, bar)?;
            let now = Now {
                frame,
                time_s,
                lights: &lights,
                edits: &[],
            };
            moments.push(self.judged(frame_loop, &now)?);
            before = Some(lights);
        }
        Ok(moments)
    }

    /// The judged moments of a motion, which begins with settled probes.
    fn moving(
        &mut self,
        frame_loop: &mut FrameLoop<'_>,
        moves: Moves,
        bar: &ProgressBar,
    ) -> Result<Vec<Moment>, Failure> {
        let (case, camera) = (self.names.case, self.names.camera);
        let voxels = frame_loop.voxels()?;
        let sweep = Sweep::new(&case.world, &voxels, camera, &self.plan.moments);
        let mut digging = Digging::new(&case.world, &voxels, camera);
        self.settle(frame_loop, &case.lights, case.time_s(), bar)?;
        let mut moments = Vec::new();
        for frame in 1..=self.plan.frames() {
            let time_s = match moves.lamps {
                true => self.time_s(frame),
                false => case.time_s(),
            };
            let lights = case.lights_at(time_s);
            if moves.camera {
                frame_loop.look(&sweep.at(frame), View::Full);
            }
            if moves.edits
                && let Some(edit) = digging.step(frame - 1)
            {
                frame_loop.apply(digging.voxels(), &edit)?;
            }
            frame_loop.set_time(time_s);
            frame_loop.advance(&lights, 1, &|| bar.inc(1))?;
            if self.plan.moments.contains(&frame) {
                let now = Now {
                    frame,
                    time_s,
                    lights: &lights,
                    edits: digging.balls(),
                };
                moments.push(self.judged(frame_loop, &now)?);
            }
        }
        Ok(moments)
    }

    /// Settles fresh probes in the world at rest, as the camera sees it from its place.
    fn settle(
        &self,
        frame_loop: &mut FrameLoop<'_>,
        lights: &Lights,
        time_s: f64,
        bar: &ProgressBar,
    ) -> Result<(), Failure> {
        frame_loop.forget()?;
        frame_loop.look(self.names.camera, View::Full);
        frame_loop.set_time(time_s);
        frame_loop.advance(lights, self.settling + 1, &|| bar.inc(1))
    }

    /// Compares the last frame, which must show all light from the camera's place.
    fn judged(&mut self, frame_loop: &FrameLoop<'_>, now: &Now<'_>) -> Result<Moment, Failure> {
        let exposure_ev = frame_loop.shot().exposure_ev;
        let full = Shown::from_linear(frame_loop.radiance()?, exposure_ev);
        let indirect = frame_loop.radiance_of(View::Indirect)?;
        let indirect = Shown::from_linear(indirect, exposure_ev);
        let film = Film {
            lights: now.lights,
            edits: now.edits,
            ..self.film
        };
        let stage = frame_loop.stage();
        let target = self.targets.of(&film, stage, exposure_ev, self.tracer)?;
        let figures = |ours: &Shown, truth: &Shown| {
            let compared = compare(ours, truth, &Selection::ALL);
            compared.map(|(figures, _)| figures).map_err(Failure::fault)
        };
        Ok(Moment {
            frame: now.frame,
            time_s: now.time_s,
            full: figures(&full, &target.full)?,
            indirect: figures(&indirect, &target.indirect)?,
        })
    }
}
