//! Replaces a device that is lost while the window is open.

use std::time::{Duration, Instant};

use winit::{event_loop::ActiveEventLoop, window::Window};

use super::Session;
use crate::{
    app::{
        AppError,
        screen::{self, Screen},
        texts::toasts,
    },
    gpu::{DeviceErrors, Gpu, Timing},
    passes::view::overlay::Overlay,
};

/// A device that is lost again within this time is not replaced: the next one would be lost too.
const LEAST_BETWEEN: Duration = Duration::from_secs(10);

impl Session {
    /// Opens the adapter again and moves everything that is shown to it. Edits are kept; light is computed
    /// again.
    ///
    /// # Errors
    /// [`AppError`] when the adapter is gone, and when devices are lost one after another.
    pub(super) fn replace_device(&mut self, event_loop: &ActiveEventLoop) -> Result<(), AppError> {
        let now = Instant::now();
        let last = self.replaced.replace(now);
        if last.is_some_and(|last| now.saturating_duration_since(last) < LEAST_BETWEEN) {
            return self.check();
        }
        tracing::error!("the device was lost; another one takes its place");
        let surface = screen::surface(&self.viewport.gpu.instance, &self.window)?;
        let gpu = self.viewport.gpu.reopened(Some(&surface))?;
        self.device_errors = DeviceErrors::watch(&gpu);
        self.screen = Screen::new(&gpu, self.window.clone(), surface)?;
        self.overlay = Overlay::new(&gpu, self.screen.format())?;
        self.timing = Timing::new(&gpu)?;
        // The panel's textures were on the old device: a new context uploads all of them again.
        self.egui = panel_state(event_loop, &self.window, &gpu);
        if let Some(menu) = &mut self.menu {
            menu.forget_textures();
        }
        self.items.forget_textures();
        self.viewport.move_to(gpu)?;
        self.messages.toast(toasts::GPU_LOST);
        self.remade();
        Ok(())
    }
}

/// The panel's state for a device.
pub(super) fn panel_state(
    event_loop: &ActiveEventLoop,
    window: &Window,
    gpu: &Gpu,
) -> egui_winit::State {
    let context = egui::Context::default();
    context.set_theme(egui::Theme::Dark);
    // A click that spans slow frames is still a click.
    context.options_mut(|options| options.input_options.max_click_duration = f64::INFINITY);
    egui_winit::State::new(
        context,
        egui::ViewportId::ROOT,
        event_loop,
        Some(window.scale_factor() as f32),
        None,
        Some(gpu.limits.max_texture_dimension_2d as usize),
    )
}
