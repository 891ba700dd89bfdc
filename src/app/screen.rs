//! The window's surface: configured, and configured again whenever that is needed.

use std::sync::Arc;

use winit::window::Window;

use crate::gpu::{Gpu, GpuError};

/// The surface of the window and its configuration.
pub struct Screen {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
    /// The present mode without vsync.
    unpaced: wgpu::PresentMode,
    /// The surface no longer fits the window.
    stale: bool,
}

/// Whether a frame can be drawn.
pub enum Acquired {
    Texture(wgpu::SurfaceTexture),
    /// Not now; perhaps at the next frame.
    Later,
    /// Nobody would see the frame.
    Hidden,
}

/// The surface of a window. It exists before an adapter is chosen that can draw to it.
///
/// # Errors
/// [`GpuError::NoAdapter`] when the system offers none.
pub fn surface(
    instance: &wgpu::Instance,
    window: &Arc<Window>,
) -> Result<wgpu::Surface<'static>, GpuError> {
    instance.create_surface(window.clone()).map_err(|error| {
        tracing::warn!("creating a surface: {error}");
        GpuError::NoAdapter {
            reason: "no Vulkan, Metal or Direct3D 12 driver can draw to a window here".to_owned(),
        }
    })
}

impl Screen {
    /// # Errors
    /// [`GpuError::NoAdapter`] when the adapter cannot draw to this surface after all.
    pub fn new(
        gpu: &Gpu,
        window: Arc<Window>,
        surface: wgpu::Surface<'static>,
    ) -> Result<Self, GpuError> {
        let capabilities = surface.get_capabilities(&gpu.adapter);
        let format =
            egui_wgpu::preferred_framebuffer_format(&capabilities.formats).map_err(|error| {
                GpuError::NoAdapter {
                    reason: format!("`{}`: {error}", gpu.summary.name),
                }
            })?;
        let size = window.inner_size();
        let configuration = wgpu::SurfaceConfiguration {
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            format,
            color_space: wgpu::SurfaceColorSpace::Auto,
            width: size.width,
            height: size.height,
            present_mode: wgpu::PresentMode::AutoVsync,
            // With more frames in flight, slow frames only respond later.
            desired_maximum_frame_latency: if gpu.summary.is_software() { 1 } else { 2 },
            alpha_mode: wgpu::CompositeAlphaMode::Auto,
            view_formats: Vec::new(),
        };
        Ok(Self {
            window,
            surface,
            configuration,
            unpaced: unpaced(&capabilities.present_modes),
            stale: true,
        })
    }

    pub fn format(&self) -> wgpu::TextureFormat {
        self.configuration.format
    }

    /// Width and height in pixels, both 0 while the window is minimised.
    pub fn size(&self) -> [u32; 2] {
        [self.configuration.width, self.configuration.height]
    }

    /// Sets the size of the window.
    pub fn resize(&mut self, [width, height]: [u32; 2]) {
        if self.size() != [width, height] {
            (self.configuration.width, self.configuration.height) = (width, height);
            self.stale = true;
        }
    }

    pub fn set_vsync(&mut self, vsync: bool) {
        let mode = if vsync {
            wgpu::PresentMode::AutoVsync
        } else {
            self.unpaced
        };
        if self.configuration.present_mode != mode {
            self.configuration.present_mode = mode;
            self.stale = true;
        }
    }

    /// The present mode without vsync. It is [`wgpu::PresentMode::Fifo`], which still waits for the display,
    /// where the surface offers nothing else.
    pub fn unpaced_mode(&self) -> wgpu::PresentMode {
        self.unpaced
    }

    /// The texture of the next frame. With vsync this waits for the display.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] when a lost surface cannot be made again.
    pub fn acquire(&mut self, gpu: &Gpu) -> Result<Acquired, GpuError> {
        use wgpu::CurrentSurfaceTexture as Current;
        if self.size().contains(&0) {
            return Ok(Acquired::Hidden);
        }
        if self.stale {
            self.surface.configure(&gpu.device, &self.configuration);
            self.stale = false;
        }
        Ok(match self.surface.get_current_texture() {
            Current::Success(texture) => Acquired::Texture(texture),
            Current::Suboptimal(texture) => {
                // This texture can still be shown; the next one will fit.
                self.stale = true;
                Acquired::Texture(texture)
            }
            Current::Occluded => Acquired::Hidden,
            Current::Timeout => Acquired::Later,
            Current::Outdated => {
                self.stale = true;
                Acquired::Later
            }
            Current::Lost => {
                self.surface = surface(&gpu.instance, &self.window)?;
                self.stale = true;
                Acquired::Later
            }
            // The device's error handler has received the reason.
            Current::Validation => Acquired::Later,
        })
    }
}

/// The best offered present mode that does not wait for the display.
fn unpaced(offered: &[wgpu::PresentMode]) -> wgpu::PresentMode {
    use wgpu::PresentMode::{Fifo, Immediate, Mailbox};
    let mut known = [Immediate, Mailbox].into_iter();
    known.find(|mode| offered.contains(mode)).unwrap_or(Fifo)
}

#[cfg(test)]
mod tests {
    use wgpu::PresentMode::{Fifo, FifoRelaxed, Immediate, Mailbox};

    use super::*;

    #[test]
    fn without_vsync_nothing_waits_where_the_surface_can() {
        assert_eq!(unpaced(&[Fifo, Mailbox, Immediate]), Immediate);
        assert_eq!(unpaced(&[Fifo, FifoRelaxed, Mailbox]), Mailbox);
        assert_eq!(unpaced(&[Fifo, FifoRelaxed]), Fifo);
    }
}
