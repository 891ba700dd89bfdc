//! Which probe should be at each pixel. Found on the CPU in f64, by walking along each camera ray in steps of the
//! distance to the nearest sphere or line.

use glam::{DVec2, DVec3, Vec3};
use grotto::{
    frame::Frame, gpu::Gpu, measure::picture::Picture, probes::Layout as _, world::Camera,
};

/// A line, or a sphere when both ends are equal.
#[derive(Clone, Copy)]
struct Shape {
    from: DVec3,
    to: DVec3,
    radius: f64,
    slot: u32,
    is_dead: bool,
}

/// The probe at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    pub slot: u32,
    pub is_line: bool,
    pub is_back_side: bool,
    pub is_moved: bool,
    pub level: u32,
    /// 1 where the shape faces the camera, 0 at its rim.
    pub facing: f64,
}

pub struct Oracle {
    eye: DVec3,
    rays: Vec<DVec3>,
    /// Where each ray meets the voxels.
    surfaces: Vec<f64>,
    shapes: Vec<Shape>,
    lattice_slots: u32,
    level_slots: u32,
    moved: Vec<bool>,
}

// As in docs/notes/probe_views.md and the shader: radii of spheres in probe spacings, radii of lines in radii of spheres,
// and the least radius of each in pixels.
const SPHERE: f64 = 0.08;
const LINE: f64 = 0.2;
const LEAST_PIXELS: [f64; 2] = [1.0, 0.6];
/// Radius of the hole in a dead probe's sphere, as a share of the sphere's radius.
const HOLE: f64 = 0.75;

impl Oracle {
    /// `depth` is the picture's view of depth.
    pub fn new(gpu: &Gpu, frame: &Frame, camera: &Camera, depth: &Picture, lines: bool) -> Self {
        let size = DVec2::new(depth.width.into(), depth.height.into());
        let basis = camera.basis(size.x / size.y);
        let pixels = (0..depth.height).flat_map(|y| (0..depth.width).map(move |x| (x, y)));
        let centre = |(x, y): (u32, u32)| DVec2::new(x.into(), y.into()) + 0.5;
        let rays = pixels.map(|pixel| basis.direction_ws(centre(pixel), size).normalize());
        // White near, half as bright with every 32 voxels, black beyond the world.
        let distance = |rgb: &[f32; 3]| match rgb[0] {
            0.0 => f64::INFINITY,
            shown => -32.0 * f64::from(shown).log2(),
        };
        let field = frame.field();
        let volume = field.volume();
        let places: Vec<[f32; 4]> = gpu.read_buffer(field.places()).expect("reads back");
        let pixel_angle = 2.0 * basis.up.length() / size.y;
        let mut shapes = Vec::new();
        let mut moved = Vec::new();
        for (slot, [x, y, z, w]) in (0..field.atlas().slots).zip(places) {
            let place = Vec3::new(x, y, z).as_dvec3();
            let home = volume.position(slot % volume.slots()).as_dvec3();
            moved.push(place != home);
            if w == 0.0 && slot >= volume.slots() {
                continue;
            }
            let spacing = volume.level_of(slot % volume.slots()).spacing();
            let radius = SPHERE * f64::from(spacing.min_element());
            let least = LEAST_PIXELS.map(|pixels| pixels * pixel_angle);
            let mut add = |from: DVec3, radius| {
                shapes.push(Shape {
                    from,
                    to: place,
                    radius,
                    slot,
                    is_dead: w == 0.0,
                });
            };
            add(place, radius.max(least[0] * place.distance(basis.origin)));
            if lines && place != home {
                let middle = (place + home) / 2.0;
                add(
                    home,
                    (LINE * radius).max(least[1] * middle.distance(basis.origin)),
                );
            }
        }
        Self {
            eye: basis.origin,
            rays: rays.collect(),
            surfaces: depth.rgb.iter().map(distance).collect(),
            shapes,
            lattice_slots: volume.slots(),
            level_slots: volume.level_slots(),
            moved,
        }
    }

    /// Removes all voxels; returns where they were.
    pub fn clear_surfaces(&mut self) -> Vec<f64> {
        let none = vec![f64::INFINITY; self.surfaces.len()];
        std::mem::replace(&mut self.surfaces, none)
    }

    pub fn set_surfaces(&mut self, surfaces: Vec<f64>) {
        self.surfaces = surfaces;
    }

    /// Moves probes and the ends of their lines elsewhere.
    pub fn move_ends(&mut self, by: DVec3) {
        for shape in &mut self.shapes {
            if shape.from == shape.to {
                shape.from += by;
            }
            shape.to += by;
        }
    }

    /// The probe at a pixel, if any; `None` where a hair's breadth decides.
    pub fn at(&self, pixel: u32) -> Option<Option<Expected>> {
        let exact = self.nearest(pixel, 1.0, 0.0);
        let who = |found: Option<Expected>| found.map(|found| (found.slot, found.is_line));
        [(0.97, 0.1), (1.03, -0.1), (0.97, -0.1), (1.03, 0.1)]
            .iter()
            .all(|&(grown, deeper)| who(self.nearest(pixel, grown, deeper)) == who(exact))
            .then_some(exact)
    }

    /// The nearest probe with all radii times `grown` and voxels farther away by `deeper`.
    fn nearest(&self, pixel: u32, grown: f64, deeper: f64) -> Option<Expected> {
        let ray = self.rays[pixel as usize];
        let mut nearest = self.surfaces[pixel as usize] + deeper;
        let mut found = None;
        for shape in &self.shapes {
            let shape = Shape {
                radius: shape.radius * grown,
                ..*shape
            };
            if let Some(distance) = shape.met(self.eye, ray).filter(|met| *met < nearest) {
                nearest = distance;
                let point = self.eye + distance * ray;
                let normal = (point - shape.axis_point(point)).normalize();
                found = Some(Expected {
                    slot: shape.slot,
                    is_line: shape.from != shape.to,
                    is_back_side: shape.slot >= self.lattice_slots,
                    is_moved: self.moved[shape.slot as usize],
                    level: shape.slot % self.lattice_slots / self.level_slots,
                    facing: -normal.dot(ray),
                });
            }
        }
        found
    }
}

impl Shape {
    /// The point of the axis that is nearest to `point`.
    fn axis_point(&self, point: DVec3) -> DVec3 {
        let axis = self.to - self.from;
        let along = (point - self.from).dot(axis) / axis.length_squared().max(1e-12);
        self.from + along.clamp(0.0, 1.0) * axis
    }

    /// Where a ray enters the shape, unless it begins inside.
    fn met(&self, eye: DVec3, ray: DVec3) -> Option<f64> {
        let middle = (self.from + self.to) / 2.0 - eye;
        let bound = self.from.distance(self.to) / 2.0 + self.radius;
        let aside = middle - ray * middle.dot(ray);
        if middle.dot(ray) < -bound || aside.length() > bound {
            return None;
        }
        if self.is_dead && self.from == self.to && aside.length() < HOLE * self.radius {
            return None;
        }
        let gap = |distance: f64| {
            let point = eye + distance * ray;
            point.distance(self.axis_point(point)) - self.radius
        };
        if gap(0.0) <= 0.0 {
            return None;
        }
        let end = middle.length() + bound;
        let mut distance = (middle.length() - bound).max(0.0);
        while distance < end {
            let step = gap(distance);
            if step < 1e-7 {
                return Some(distance);
            }
            distance += step.max(1e-6);
        }
        None
    }
}
