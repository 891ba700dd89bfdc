//! F2: the picture, without what is drawn over it, as a file in the current folder.

use std::{
    path::Path,
    time::{Instant, SystemTime},
};

use super::Session;
use crate::{
    app::{screenshot, texts::toasts},
    measure::picture_file,
};

impl Session {
    pub(super) fn save_screenshot(&mut self) {
        let path = screenshot::free_name(Path::new(""), SystemTime::now());
        let picture = self.viewport.read_display();
        let saved = picture
            .map_err(|error| error.to_string())
            .and_then(|picture| {
                picture_file::write_png(&path, &picture).map_err(|error| error.to_string())
            });
        match saved {
            Ok(()) => self.messages.toast(toasts::saved(&path)),
            Err(error) => self.messages.toast_error(error),
        }
        self.rate.interrupt();
        self.last_frame = Instant::now();
    }
}
