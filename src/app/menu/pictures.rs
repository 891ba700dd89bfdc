//! Pictures of the worlds in the menu. A thread makes them, one world after the other, while the menu is shown; they
//! are kept in the user's cache.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{self, Receiver},
    },
    thread::{self, JoinHandle},
};

use egui::{ColorImage, TextureHandle, TextureOptions};

use super::worlds::{Entry, Origin};
use crate::{
    app::viewport::{Choice, Viewport},
    gpu::{DeviceErrors, Gpu, Recorder},
    measure::{picture::Picture, picture_file, whole_file},
    parameters::Parameters,
    world::{
        World,
        file::{self, Overrides},
    },
};

/// Width and height (pixels).
pub const SIZE: [u32; 2] = [256, 144];
/// Frames until the light of a picture has settled well enough.
const FRAMES: u32 = 24;

/// Worlds of more voxels than this come last.
const LARGE: u64 = 1 << 23;

/// The pictures that have been made so far.
pub struct Pictures {
    images: BTreeMap<String, ColorImage>,
    textures: BTreeMap<String, TextureHandle>,
    made: Receiver<(String, ColorImage)>,
    stopped: Arc<AtomicBool>,
    maker: Option<JoinHandle<()>>,
}

impl Pictures {
    /// Begins to read the pictures of these worlds from `cache`, and to make those that are not there on the adapter of
    /// `gpu`; without one they stay away.
    pub fn begin(gpu: Option<&Gpu>, entries: Vec<Entry>, cache: PathBuf) -> Self {
        let (sender, made) = mpsc::channel();
        let stopped = Arc::new(AtomicBool::new(false));
        let (gpu, stop) = (gpu.cloned(), stopped.clone());
        let maker = thread::spawn(move || {
            let send = |name: &str, picture: &Picture| {
                // Without a receiver the menu is gone, and `stop` is set.
                let _ = sender.send((name.to_owned(), image_of(picture)));
            };
            let mut missing: Vec<_> = entries
                .into_iter()
                .filter(|entry| match kept(entry, &cache) {
                    Some(picture) => {
                        send(&entry.name, &picture);
                        false
                    }
                    None => true,
                })
                .collect();
            if missing.is_empty() {
                return;
            }
            // A large world takes minutes on a software adapter: the others do not wait for it.
            missing.sort_by_cached_key(|entry| voxels(entry) > LARGE);
            // A device of its own: a window's surface can be configured only while its device has nothing to do.
            let Some(Ok(gpu)) = gpu.map(|gpu| gpu.reopened(None)) else {
                return;
            };
            let _errors = DeviceErrors::watch(&gpu);
            for entry in missing {
                // A world that cannot be built has a card without a picture.
                if let Some(picture) = rendered(&gpu, &entry, &stop) {
                    keep(&entry, &cache, &picture);
                    send(&entry.name, &picture);
                }
            }
        });
        Self {
            images: BTreeMap::new(),
            textures: BTreeMap::new(),
            made,
            stopped,
            maker: Some(maker),
        }
    }

    /// The picture of a world, once it is made.
    pub fn texture(&mut self, context: &egui::Context, name: &str) -> Option<&TextureHandle> {
        self.images.extend(self.made.try_iter());
        if !self.textures.contains_key(name) {
            let image = self.images.get(name)?.clone();
            let texture = context.load_texture(name, image, TextureOptions::LINEAR);
            self.textures.insert(name.to_owned(), texture);
        }
        self.textures.get(name)
    }

    /// Forgets the textures of a context that is gone.
    pub fn forget_textures(&mut self) {
        self.textures.clear();
    }
}

impl Drop for Pictures {
    fn drop(&mut self) {
        self.stopped.store(true, Ordering::Relaxed);
        // Some drivers crash when the process ends while a thread still uses them. After a panic, which was printed,
        // there is nothing to wait for.
        let _ = self.maker.take().map(JoinHandle::join);
    }
}

fn image_of(picture: &Picture) -> ColorImage {
    let size = [picture.width as usize, picture.height as usize];
    let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    let rgb: Vec<u8> = picture
        .rgb
        .as_flattened()
        .iter()
        .map(|value| byte(*value))
        .collect();
    ColorImage::from_rgb(size, &rgb)
}

/// The file of a world's picture: another for each content and each version of grotto.
fn file_of(entry: &Entry, cache: &Path) -> Option<PathBuf> {
    let key = crc32fast::hash(entry.text()?.as_bytes());
    let version = env!("CARGO_PKG_VERSION");
    Some(cache.join(format!("{}-{key:08x}-{version}.png", entry.name)))
}

/// The picture in the cache, if there is one.
fn kept(entry: &Entry, cache: &Path) -> Option<Picture> {
    let (picture, _) = picture_file::read(&file_of(entry, cache)?).ok()?;
    ([picture.width, picture.height] == SIZE).then_some(picture)
}

/// Without a cache the picture is made again at the next start.
fn keep(entry: &Entry, cache: &Path, picture: &Picture) {
    if let Some(path) = file_of(entry, cache)
        && whole_file::create_folder(cache).is_ok()
    {
        let _ = picture_file::write_png(&path, picture);
    }
}

/// How many voxels its world has; none if the file is wrong.
fn voxels(entry: &Entry) -> u64 {
    parsed(entry).map_or(0, |world| world.size.as_u64vec3().element_product())
}

fn parsed(entry: &Entry) -> Option<World> {
    let folder = match &entry.origin {
        Origin::File(path) => path.parent(),
        Origin::BuiltIn(_) => None,
    };
    file::parse(&entry.text()?, &entry.name, folder, &Overrides::default()).ok()
}

/// The world from its first camera; `None` when it cannot be built, and when the menu is gone.
fn rendered(gpu: &Gpu, entry: &Entry, stop: &AtomicBool) -> Option<Picture> {
    if stop.load(Ordering::Relaxed) {
        return None;
    }
    let world = parsed(entry)?;
    let camera = world.cameras.first()?.clone();
    let choice = Choice {
        parameters: Parameters::default(),
        layout: String::new(),
        size: SIZE,
        traced: false,
    };
    let mut viewport = Viewport::new(gpu.clone(), Path::new(""), world, choice).ok()?;
    for frame in 0..FRAMES {
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        let mut recorder = Recorder::new(gpu, None);
        let time_s = f64::from(frame) / 60.0;
        viewport.record(&mut recorder, &camera, time_s, 0).ok()?;
        recorder.submit(gpu).ok()?;
        // One frame at a time: the menu's own frames come in between.
        gpu.wait().ok()?;
    }
    viewport.read_display().ok()
}
