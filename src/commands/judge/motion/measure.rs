//! Draws the frames of each motion, and compares those of the judged moments with their references.

use indicatif::ProgressBar;

use super::{
    super::{
        super::{
            Failure,
            dynamics::{Digging, Edited, RATE, Stroke},
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
    world::{View, bodies::Pose},
};

/// What moves in a world: everything that the references of one camera differ in.
#[derive(PartialEq)]
struct Scenery {
    lights: Lights,
    poses: Vec<Pose>,
    edits: Vec<Stroke>,
}

/// The references of one camera, which its rows share.
#[derive(Default)]
pub struct Targets {
    all: Vec<(Scenery, Target)>,
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
        let now = Scenery {
            lights: film.lights.clone(),
            poses: tracer.world.bodies.poses(film.time_s),
            edits: film.edits.to_vec(),
        };
        let index = match self.all.iter().position(|(known, _)| *known == now) {
            Some(index) => index,
            None => {
                let target = Target::new(tracer.truth(film, stage)?, exposure_ev)?;
                self.all.push((now, target));
                self.all.len() - 1
            }
        };
        Ok(&self.all[index].1)
    }
}

/// Everything that the motions of one row of the judge share.
pub struct Judging<'a, 't> {
    pub names: &'a Names<'a>,
    pub plan: &'a Plan,
    /// Frames before anything moves.
    pub settling: u32,
    /// Speed of a camera that turns (degrees per second).
    pub turn_deg: f32,
    /// The camera's picture, before anything has moved.
    pub film: Film<'a>,
    pub tracer: &'a mut Tracer<'t>,
    pub targets: &'a mut Targets,
    pub run: &'a RunOptions,
}

/// The world in a judged frame.
struct Now {
    frame: u32,
    time_s: f64,
    lights: Lights,
    edits: Vec<Stroke>,
}

impl Judging<'_, '_> {
    /// The row at rest, then a row for each motion. The frame loop must have the probes of the row; its time is
    /// as before, and its probes are not.
    ///
    /// # Errors
    /// When the adapter fails, and when the user stops the run.
    pub fn rows(&mut self, frame_loop: &mut FrameLoop<'_>) -> Result<Vec<MotionRow>, Failure> {
        let bar = output::progress(self.run, "frames", self.length());
        let mut known = Vec::new();
        let still = Moves {
            lamps: false,
            camera: false,
            edits: false,
        };
        let moments = self.moments(frame_loop, still, &mut known, &bar)?;
        let mut rows = vec![MotionRow::new(Motion::Rest, still, moments)];
        for (motion, moves) in &self.plan.rows {
            let moments = match moves.edits {
                false => self.moments(frame_loop, *moves, &mut known, &bar)?,
                true => {
                    let mut own = frame_loop.in_own_world(&self.names.case.world)?;
                    self.moments(&mut own, *moves, &mut known, &bar)?
                }
            };
            rows.push(MotionRow::new(*motion, *moves, moments));
        }
        bar.finish_and_clear();
        frame_loop.set_time(self.names.case.time_s());
        Ok(rows)
    }

    /// Most frames of all rows, for progress.
    fn length(&self) -> u64 {
        let run = |frames: u32| u64::from(self.settling + 1) + u64::from(frames);
        let rows = &self.plan.rows;
        let each_at_rest: u64 = self.plan.moments.iter().copied().map(run).sum();
        let has = |is: fn(&Moves) -> bool| u64::from(rows.iter().any(|(_, moves)| is(moves)));
        let at_rest = has(|moves| moves.lamps && !moves.edits) + has(|moves| moves.edits);
        (1 + rows.len() as u64) * run(self.plan.frames()) + at_rest * each_at_rest
    }

    /// The judged moments of a motion, which begins with settled probes. `known`: moments at rest, of this row and
    /// the rows before it.
    fn moments(
        &mut self,
        frame_loop: &mut FrameLoop<'_>,
        moves: Moves,
        known: &mut Vec<(Now, Moment)>,
        bar: &ProgressBar,
    ) -> Result<Vec<Moment>, Failure> {
        let judged = self.moving(frame_loop, moves, bar)?;
        if !moves.lamps && !moves.camera && !moves.edits {
            let moments = judged.iter().map(|(_, moment)| moment.clone()).collect();
            known.extend(judged);
            return Ok(moments);
        }
        let mut moments = Vec::new();
        for (now, mut moment) in judged {
            let is_same = |(rest, _): &&(Now, Moment)| {
                rest.frame == now.frame && rest.lights == now.lights && rest.edits == now.edits
            };
            moment.rest_flip = match known.iter().find(is_same) {
                Some((_, rest)) => rest.rest_flip,
                None => {
                    let rest = self.at_rest(frame_loop, &now, bar)?;
                    let flip = rest.rest_flip;
                    known.push((now, rest));
                    flip
                }
            };
            moments.push(moment);
        }
        Ok(moments)
    }

    /// Draws the frames of a motion, and compares the judged ones; with the first one if nothing moves.
    fn moving(
        &mut self,
        frame_loop: &mut FrameLoop<'_>,
        moves: Moves,
        bar: &ProgressBar,
    ) -> Result<Vec<(Now, Moment)>, Failure> {
        let (case, camera) = (self.names.case, self.names.camera);
        let voxels = frame_loop.voxels()?;
        let sweep = Sweep::new(
            &case.world,
            &voxels,
            camera,
            &self.plan.moments,
            self.turn_deg,
        );
        let mut digging = Digging::new(Edited::Ball, &case.world, &voxels, camera);
        self.settle(frame_loop, &case.lights, case.time_s(), bar)?;
        let is_still = !moves.lamps && !moves.camera && !moves.edits;
        let mut judged = Vec::new();
        for frame in 0..=self.plan.frames() {
            let time_s = match moves.lamps {
                true => case.time_s() + f64::from(frame) / RATE,
                false => case.time_s(),
            };
            let lights = case.lights_at(time_s);
            if frame > 0 {
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
            }
            // At the start, every motion shows the same picture.
            if self.plan.moments.contains(&frame) || frame == 0 && is_still {
                let now = Now {
                    frame,
                    time_s,
                    lights,
                    edits: digging.strokes().to_vec(),
                };
                let moment = self.judged(frame_loop, &now)?;
                judged.push((now, moment));
            }
        }
        Ok(judged)
    }

    /// Judges a moment after as many frames of a world that has stood still, as it is at that moment. The frame
    /// loop must have its world.
    fn at_rest(
        &mut self,
        frame_loop: &mut FrameLoop<'_>,
        now: &Now,
        bar: &ProgressBar,
    ) -> Result<Moment, Failure> {
        let mut own;
        let frame_loop = match &now.edits[..] {
            [] => frame_loop,
            edits => {
                own = frame_loop.in_own_world(&self.names.case.world)?;
                let mut voxels = own.voxels()?;
                for stroke in edits {
                    let edit = stroke.apply(&mut voxels);
                    own.apply(&voxels, &edit)?;
                }
                &mut own
            }
        };
        self.settle(frame_loop, &now.lights, now.time_s, bar)?;
        frame_loop.advance(&now.lights, now.frame, &|| bar.inc(1))?;
        self.judged(frame_loop, now)
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

    /// Compares the last frame, which must show all light from the camera's place, as if it were at rest.
    fn judged(&mut self, frame_loop: &mut FrameLoop<'_>, now: &Now) -> Result<Moment, Failure> {
        let exposure_ev = frame_loop.shot().exposure_ev;
        let full = Shown::from_linear(frame_loop.radiance()?, exposure_ev);
        let indirect = frame_loop.radiance_of(View::Indirect)?;
        let indirect = Shown::from_linear(indirect, exposure_ev);
        let film = Film {
            lights: &now.lights,
            time_s: now.time_s,
            edits: &now.edits,
            ..self.film
        };
        let stage = frame_loop.stage();
        let target = self.targets.of(&film, stage, exposure_ev, self.tracer)?;
        let figures = |ours: &Shown, truth: &Shown| {
            let compared = compare(ours, truth, &Selection::ALL);
            compared.map(|(figures, _)| figures).map_err(Failure::fault)
        };
        let full = figures(&full, &target.full)?;
        Ok(Moment {
            frame: now.frame,
            time_s: now.time_s,
            full,
            indirect: figures(&indirect, &target.indirect)?,
            noise: target.noise,
            rest_flip: full.flip.mean,
        })
    }
}
