//! F4: the benchmark takes over the camera and the clock, and restores both at its end.

use std::time::{Duration, Instant};

use winit::{
    event::{ElementState, KeyEvent, WindowEvent},
    keyboard::KeyCode,
};

use super::{
    super::{
        AppError,
        benchmark::{Before, Benchmark, Course, Phase, Summary, Surroundings},
        controls::{Action, Press, Trigger},
        input::Input,
        texts::toasts,
    },
    Session,
    input::ESCAPE,
};

/// The running benchmark, and the summary of the last one until it is closed.
#[derive(Default)]
pub(super) struct Benchmarks {
    pub running: Option<Benchmark>,
    pub summary: Option<Summary>,
}

impl Session {
    /// Starts a benchmark.
    pub(super) fn begin_benchmark(&mut self) {
        if self.viewport.choice().traced {
            self.messages.hint(toasts::NO_BENCHMARK);
            return;
        }
        let world = self.viewport.world().clone();
        let course = match self.viewport.voxels() {
            Ok(voxels) => Course::new(&world, voxels, &self.camera),
            Err(error) => return self.messages.toast_error(error.to_string()),
        };
        let before = Before {
            camera: self.camera.clone(),
            clock: self.settings.clock,
        };
        let software = self.viewport.gpu.summary.is_software();
        let benchmark = Benchmark::new(course, before, world.voxel_m, software, Instant::now());
        self.messages.status = Some(benchmark.status());
        self.benchmarks.summary = None;
        self.benchmarks.running = Some(benchmark);
        self.release_mouse();
        self.remade();
    }

    /// Ends the running benchmark, if any, and shows its summary.
    pub(super) fn end_benchmark(&mut self) {
        let Some(benchmark) = self.benchmarks.running.take() else {
            return;
        };
        let mode = self.screen.unpaced_mode();
        let summary = &self.viewport.gpu.summary;
        let surroundings = Surroundings {
            world: self.viewport.world().name.clone(),
            layout: self.viewport.choice().layout.clone(),
            size: self.viewport.frame().size(),
            rendered: self.viewport.frame().rendered_size(),
            adapter: summary.name.clone(),
            software: summary.is_software(),
            presented: format!("{mode:?}"),
            paced: mode == wgpu::PresentMode::Fifo,
        };
        let (before, summary) = benchmark.end(surroundings);
        match &summary {
            Some(summary) => tracing::info!("benchmark: {}", summary.text()),
            None => self.messages.toast(toasts::EMPTY_BENCHMARK),
        }
        self.benchmarks.summary = summary;
        self.give_back(before);
    }

    /// Ends a benchmark whose frames can no longer be compared with each other. In the warm-up no frame is
    /// measured yet: a window often settles on its size in its first frames.
    pub(super) fn abandon_benchmark(&mut self, reason: &str) {
        let counting = |run: &mut Benchmark| run.is_counting();
        if let Some(benchmark) = self.benchmarks.running.take_if(counting) {
            let (before, _) = benchmark.end(Surroundings::default());
            self.messages.toast_error(reason);
            self.give_back(before);
        }
    }

    fn give_back(&mut self, before: Before) {
        self.messages.status = None;
        self.camera = before.camera;
        self.settings.clock = before.clock;
        self.give(Input::Focus(false));
        self.remade();
    }

    /// Moves the camera and the clock: as the user steers, or along the course of a benchmark.
    ///
    /// # Errors
    /// [`AppError::Gpu`] when the device is lost.
    pub(super) fn steer(&mut self, now: Instant, elapsed: Duration) -> Result<(), AppError> {
        let phase = self
            .benchmarks
            .running
            .as_mut()
            .map(|run| run.begin_frame(now));
        match phase {
            Some(Phase::WarmedUp) => {
                // Times that arrive from now on belong to measured frames.
                self.viewport.gpu.wait()?;
                self.hear_times(0.0);
                if let Some(run) = &mut self.benchmarks.running {
                    run.start_counting(Instant::now());
                }
            }
            Some(Phase::Over) => {
                self.viewport.gpu.wait()?;
                self.hear_times(0.0);
                self.end_benchmark();
            }
            Some(Phase::WarmUp | Phase::Counting) | None => {}
        }
        let stands_still = self.benchmarks.running.is_some() || self.menu.is_some();
        self.play.sound.set_paused(stands_still);
        match &self.benchmarks.running {
            Some(run) => {
                self.camera = run.camera();
                self.settings.clock.time_s = run.time_s();
            }
            None => match self.menu.as_ref().map(|menu| menu.occasion) {
                Some(occasion) => self.linger(occasion, elapsed),
                None => self.play_on(elapsed)?,
            },
        }
        Ok(())
    }

    /// Handles input while a benchmark runs or its summary is shown: Esc and the benchmark's own key stop it, any key or
    /// click closes the summary, and nothing else happens. Releases of keys and buttons are passed on.
    pub(super) fn benchmark_takes(&mut self, event: &WindowEvent) -> bool {
        let begins = match event {
            WindowEvent::MouseInput { state, .. }
            | WindowEvent::KeyboardInput {
                event: KeyEvent { state, .. },
                ..
            } => *state == ElementState::Pressed,
            WindowEvent::MouseWheel { .. } => true,
            _ => false,
        };
        let is_busy = self.benchmarks.running.is_some() || self.benchmarks.summary.is_some();
        if !(begins && is_busy) {
            return false;
        }
        let press = match event {
            WindowEvent::KeyboardInput { event, .. } if !event.repeat => self.press(event),
            _ => None,
        };
        if self.benchmarks.running.is_some() {
            let stops = |press: Press| {
                let action = self.preferences.keys.pressed(press);
                press.trigger == ESCAPE || action == Some(Action::Benchmark)
            };
            if press.is_some_and(stops) {
                self.end_benchmark();
            }
        } else if press.is_some_and(closes) || matches!(event, WindowEvent::MouseInput { .. }) {
            self.benchmarks.summary = None;
        }
        true
    }
}

/// Whether a key closes the summary: all do except modifiers and the key for a screenshot of the screen.
fn closes(press: Press) -> bool {
    use KeyCode::{PrintScreen, SuperLeft, SuperRight};
    let is_other = [PrintScreen, SuperLeft, SuperRight]
        .map(Trigger::Key)
        .contains(&press.trigger);
    !is_other && !press.trigger.is_modifier()
}
