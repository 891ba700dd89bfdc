//! The work: world by world, camera by camera, row by row.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{Arc, atomic::AtomicBool},
};

use super::{
    super::{
        Failure,
        driver::Driver,
        output,
        settings::Setting,
        subject::{Subject, Unnamed},
    },
    Arguments,
    cache::Cache,
    page::Page,
    report::{Files, Missing, Report},
    row::{self, Dark, Names, Pictures, Plan, Row, Target},
    summary, table,
    truth::{Film, Tracer},
};
use crate::{
    frame::Stage,
    gpu::Gpu,
    measure::{picture::Picture, selection::Selection},
    passes::ViewMode,
    world::Camera,
};

/// The work, and what has come of it.
pub struct Judge<'a> {
    pub arguments: &'a Arguments,
    pub gpu: &'a Gpu,
    pub cache: &'a Cache,
    pub masks: &'a BTreeMap<String, Selection>,
    pub stop: &'a Arc<AtomicBool>,
    pub files: &'a Files,
    /// Keys with a column of their own.
    pub varied: &'a [&'static str],
    pub rows: Vec<Row>,
    pub page: Page,
    /// Worlds that are missing from the table, and why.
    pub failures: Vec<(PathBuf, Failure)>,
}

impl Judge<'_> {
    fn report(&self, complete: bool) -> Report<'_> {
        let missing = |(path, failure): &(PathBuf, Failure)| Missing {
            world: path.display().to_string(),
            message: failure.reason().to_owned(),
        };
        Report {
            version: env!("CARGO_PKG_VERSION"),
            adapter: &self.gpu.summary,
            size: self.arguments.subjects.size,
            spp: self.arguments.spp,
            complete,
            rows: &self.rows,
            by_setting: summary::by_setting(&self.rows),
            failures: self.failures.iter().map(missing).collect(),
            varied: self.varied,
        }
    }

    pub fn write(&self, complete: bool) -> Result<(), Failure> {
        self.files.write(&self.report(complete), &self.page)
    }

    pub fn print(&self, complete: bool) -> Result<(), Failure> {
        let report = self.report(complete);
        match self.arguments.run.json {
            true => output::print_json(&report),
            false => output::print(&report.text()),
        }
    }

    /// What is there stays, and is said to be incomplete: the last row has written it.
    pub fn stopped(&self) -> Result<(), Failure> {
        let out = self.arguments.out.display();
        if self.rows.is_empty() {
            return Err(Failure::interrupted(format!(
                "stopped before the first row: nothing is written to {out}"
            )));
        }
        self.print(false)?;
        Err(Failure::interrupted(format!(
            "stopped: {out} holds the first {} rows, and says that there were to be more",
            self.rows.len()
        )))
    }

    /// Adds the rows of a world; those that are done stay when it fails.
    pub fn world(&mut self, path: &Path) -> Result<(), Failure> {
        let (arguments, run) = (self.arguments, &self.arguments.run);
        let loaded = Subject::load(path, run, &arguments.subjects, Unnamed::All)?;
        let Some(subject) = loaded else {
            let text = format!("{}: no such camera or layout; left out", path.display());
            output::note(run, &text);
            return Ok(());
        };
        let stage = Stage::build(self.gpu, &subject.world)?;
        let mut driver = Driver::new(
            self.gpu,
            stage,
            &subject.layouts[0],
            &subject.parameters,
            subject.view(&subject.cameras[0]),
        )?;
        driver.stop_at(self.stop);
        let mut tracer = Tracer {
            world: &subject.world,
            lights: &subject.lights,
            run,
            cache: self.cache,
            gpu: self.gpu,
            against: arguments.against,
            stop: self.stop,
            voxels: None,
        };
        self.page.world(&subject.world);
        for camera in &subject.cameras {
            let target = self.target(&subject, camera, &mut tracer, &mut driver)?;
            self.page.camera(camera, &target)?;
            if arguments.direct {
                let names = Names {
                    world: &subject.world,
                    camera,
                    layout: "",
                    settings: &Setting::default(),
                };
                let judged = row::direct_alone(&mut driver, &names, &subject.lights, &target)?;
                self.add(judged)?;
            }
            for layout in &subject.layouts {
                for settings in &subject.settings {
                    let probes = settings.of(&subject.parameters).probes;
                    driver.replace_probes(layout, &probes)?;
                    let names = Names {
                        world: &subject.world,
                        camera,
                        layout: &layout.name,
                        settings,
                    };
                    let judged = self.row(&subject, &names, &target, &mut driver)?;
                    self.add(judged)?;
                }
            }
        }
        Ok(())
    }

    fn film<'c>(&self, subject: &Subject, camera: &'c Camera) -> Film<'c> {
        Film {
            camera,
            size: self.arguments.subjects.size,
            spp: self.arguments.spp,
            seed: self.arguments.subjects.seed,
            textures: subject.parameters.textures.enabled,
        }
    }

    fn target(
        &self,
        subject: &Subject,
        camera: &Camera,
        tracer: &mut Tracer<'_>,
        driver: &mut Driver<'_>,
    ) -> Result<Target, Failure> {
        let truth = tracer.truth(&self.film(subject, camera), driver.stage())?;
        let mut target = Target::new(truth, subject.parameters.picture.exposure_ev);
        let dark = match self.masks.get(&camera.name) {
            Some(mask) => Some(mask.clone()),
            None => {
                driver.look(camera, ViewMode::Normal);
                driver.advance(&subject.lights, 1, &|| {})?;
                let mask = target.unlit(&driver.radiance()?);
                let selected = |mask: Picture| Selection::mask([mask.width, mask.height], &mask);
                mask.map(selected).transpose().map_err(Failure::fault)?
            }
        };
        if let Some(pixels) = dark {
            let bright = self.brightest(subject, tracer, driver.stage())?;
            target.dark = (bright > 0.0).then_some(Dark { pixels, bright });
        }
        Ok(target)
    }

    /// The mean luminance that the brightest of a world's cameras sees.
    fn brightest(
        &self,
        subject: &Subject,
        tracer: &mut Tracer<'_>,
        stage: &Stage,
    ) -> Result<f64, Failure> {
        let mut brightest: f64 = 0.0;
        for camera in &subject.world.cameras {
            let truth = tracer.truth(&self.film(subject, camera), stage)?;
            let light = row::luminance(&row::full(&truth), &Selection::ALL);
            brightest = brightest.max(light);
        }
        Ok(brightest)
    }

    fn row(
        &self,
        subject: &Subject,
        names: &Names<'_>,
        target: &Target,
        driver: &mut Driver<'_>,
    ) -> Result<(Row, Pictures), Failure> {
        let arguments = self.arguments;
        let plan = Plan {
            frames: arguments.subjects.frames,
            stability: !arguments.skip_stability,
            watched: (!arguments.skip_response).then_some(arguments.response_frames),
        };
        let bar = output::progress(&arguments.run, "frames", plan.length());
        let after = || bar.inc(1);
        let judged = row::judge(driver, names, &subject.lights, target, &plan, &after);
        bar.finish_and_clear();
        judged
    }

    /// Adds a row, and writes all that there are.
    fn add(&mut self, (row, pictures): (Row, Pictures)) -> Result<(), Failure> {
        output::note(&self.arguments.run, &table::line(&row));
        self.page.row(&row, &pictures)?;
        self.rows.push(row);
        self.write(false)
    }
}
