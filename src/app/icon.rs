//! How the desktop tells the window from others: its icon, and the name of its desktop entry.

use image::ImageFormat;
use winit::window::{Icon, WindowAttributes};

/// `packaging/icon.ron`, drawn by `scripts/icon`.
const PNG: &[u8] = include_bytes!("../../packaging/icon.png");

/// The attributes with icon and name.
pub fn identified(attributes: WindowAttributes) -> WindowAttributes {
    named(attributes.with_window_icon(icon()))
}

/// Wayland has no icons of windows: a compositor looks for the desktop entry of this name.
#[cfg(all(unix, not(target_vendor = "apple")))]
fn named(attributes: WindowAttributes) -> WindowAttributes {
    use winit::platform::wayland::WindowAttributesExtWayland as _;
    attributes.with_name("grotto", "grotto")
}

#[cfg(not(all(unix, not(target_vendor = "apple"))))]
fn named(attributes: WindowAttributes) -> WindowAttributes {
    attributes
}

fn icon() -> Option<Icon> {
    let picture = image::load_from_memory_with_format(PNG, ImageFormat::Png).ok()?;
    let pixels = picture.into_rgba8();
    let (width, height) = pixels.dimensions();
    Icon::from_rgba(pixels.into_raw(), width, height).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_icon_is_a_small_square_picture() {
        assert!(PNG.len() < 100_000, "{} bytes", PNG.len());
        let picture = image::load_from_memory(PNG).expect("a picture");
        assert_eq!((picture.width(), picture.height()), (256, 256));
        assert!(icon().is_some());
    }
}
