//! Sun, sky, cameras and layouts.

use glam::{UVec3, Vec3};

use super::leaf::OneOrThree;
use super::resolve::Reader;
use super::schema;
use super::values::{Read, or};
use crate::world::scenery::{
    FARTHEST, LEAST_COUNT, LEAST_SPACING, MAX_CASCADES, MAX_DEPTH, MAX_OCTREE_CELLS, MAX_PROBES,
    OctreeSpec, Split,
};
use crate::world::sdf::Shape;
use crate::world::{Camera, LayoutSpec, Sky, Sun};

impl Reader<'_> {
    pub(super) fn sun(&self, sun: &schema::Sun) -> Read<Sun> {
        Ok(Sun {
            towards: self.source.direction(&sun.towards, "towards")?.normalize(),
            irradiance: self.source.not_negative3(&sun.irradiance, "irradiance")?,
        })
    }

    pub(super) fn sky(&self, sky: &schema::Sky) -> Read<Sky> {
        let source = self.source;
        let zenith = source.not_negative3(&sky.zenith, "zenith")?;
        Ok(Sky {
            zenith,
            horizon: or(&sky.horizon, zenith, |v| source.not_negative3(v, "horizon"))?,
            ground: or(&sky.ground, zenith, |v| source.not_negative3(v, "ground"))?,
        })
    }

    pub(super) fn cameras(&self, cameras: &[schema::Camera], shape: &Shape) -> Read<Vec<Camera>> {
        let source = self.source;
        let mut names = Vec::new();
        let mut resolved = Vec::new();
        for camera in cameras {
            let name = source.name(&camera.name, "camera", &names)?;
            names.push(name.clone());
            let position = source.point(&camera.position, "position")?;
            let yaw = or(&camera.yaw_deg, 0.0, |leaf| source.length(leaf, "yaw_deg"))?;
            let pitch = or(&camera.pitch_deg, 0.0, |leaf| {
                Ok(source.number_in(leaf, "pitch_deg", -90.0..=90.0)? as f32)
            })?;
            let (yaw_deg, pitch_deg) = match &camera.look_at {
                None => (yaw, pitch),
                Some(target) => {
                    if let Some(angle) = camera.yaw_deg.as_ref().or(camera.pitch_deg.as_ref()) {
                        return Err(source.at(
                            angle,
                            format!("camera `{name}` has both `look_at` and an angle"),
                            "keep `look_at`, or the angles `yaw_deg` and `pitch_deg`",
                        ));
                    }
                    let along = source.point(target, "look_at")? - position;
                    if along.length() < 1e-6 {
                        return Err(source.at_vector(
                            target,
                            format!("camera `{name}` looks at the place where it stands"),
                            "`look_at` is the point that comes to the middle of the picture",
                        ));
                    }
                    towards(along)
                }
            };
            resolved.push(Camera {
                name,
                position,
                yaw_deg,
                pitch_deg,
                fov_deg: or(&camera.fov_deg, DEFAULT_FOV_DEG, |leaf| {
                    Ok(source.number_in(leaf, "fov_deg", 1.0..=170.0)? as f32)
                })?,
            });
        }
        if resolved.is_empty() {
            resolved.push(self.overview(shape));
        }
        Ok(resolved)
    }

    /// A camera in the air that looks at the middle of the box: the first of a few places, from the
    /// upper corners inwards, that is well clear of solid voxels.
    fn overview(&self, shape: &Shape) -> Camera {
        let (low, high) = self.world_box();
        let (centre, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let mut places = Vec::new();
        for share in [0.9, 0.6, 0.3] {
            for (x, y, z) in [
                (0.8, 0.6, 1.0),
                (-0.8, 0.6, 1.0),
                (0.8, 0.2, -1.0),
                (-0.8, -0.2, -1.0),
            ] {
                places.push(centre + half * Vec3::new(x, y, z) * share);
            }
        }
        let clear = |place: &&Vec3| shape.eval(place.as_dvec3()) > 2.0;
        // If the world has no such place: from outside.
        let outside = centre + half.length() * Vec3::new(0.8, 0.9, 1.2);
        let position = places.iter().find(clear).copied().unwrap_or(outside);
        let (yaw_deg, pitch_deg) = towards(centre - position);
        Camera {
            name: "overview".into(),
            position,
            yaw_deg,
            pitch_deg,
            fov_deg: DEFAULT_FOV_DEG,
        }
    }

    pub(super) fn layouts(&self, layouts: &[schema::Layout]) -> Read<Vec<LayoutSpec>> {
        let (low, high) = self.world_box();
        let mut names = Vec::new();
        let mut resolved = Vec::new();
        for layout in layouts {
            let layout = self.layout(layout, &names)?;
            names.push(layout.name.clone());
            resolved.push(layout);
        }
        if resolved.is_empty() {
            let size = high - low;
            let spacing = (size.max_element() / 8.0).max(1.0);
            resolved.push(LayoutSpec {
                name: "auto".into(),
                counts: (size / spacing).ceil().as_uvec3().max(UVec3::splat(2)),
                spacing: Vec3::splat(spacing),
                centre: (low + high) / 2.0,
                follow: false,
                cascades: 1,
                octree: None,
            });
        }
        Ok(resolved)
    }

    fn layout(&self, layout: &schema::Layout, names: &[String]) -> Read<LayoutSpec> {
        let source = self.source;
        let name = source.name(&layout.name, "layout", names)?;
        if let Some(octree) = &layout.octree {
            return self.octree_layout(layout, octree, name);
        }
        let missing = |key: &str| {
            source.at(
                &layout.name,
                format!("layout `{name}` lacks `{key}`"),
                format!("write `{key}`, or `octree: (depth: 4)`"),
            )
        };
        let counts_at = layout.counts.as_ref().ok_or_else(|| missing("counts"))?;
        let spacing_at = layout.spacing.as_ref().ok_or_else(|| missing("spacing"))?;
        let [x, y, z] = counts_at.leaves();
        let count = |leaf| source.count(leaf, "counts", 1..=MAX_PROBES);
        let counts = UVec3::new(count(x)?, count(y)?, count(z)?);
        let cascades = or(&layout.cascades, 1, |leaf| {
            source.count(leaf, "cascades", 1..=MAX_CASCADES)
        })?;
        let each = counts.to_array().map(u64::from);
        let probes = each.iter().fold(u64::from(cascades), |a, b| a * b);
        if probes > u64::from(MAX_PROBES) {
            return Err(source.at_vector(
                counts_at,
                format!("layout `{name}` has {probes} probes"),
                format!("a layout may have {MAX_PROBES}; widen the spacing"),
            ));
        }
        if (layout.follow || cascades > 1) && counts.min_element() < LEAST_COUNT {
            return Err(source.at_vector(
                counts_at,
                format!("layout `{name}` is too thin for light to fade at its edges"),
                format!("with `follow` or `cascades`, write counts of at least {LEAST_COUNT}"),
            ));
        }
        let spacing = self.spacing(spacing_at)?;
        let (low, high) = self.world_box();
        let middle = if layout.follow {
            Vec3::ZERO
        } else {
            (low + high) / 2.0
        };
        let centre = or(&layout.centre, middle, |v| source.point(v, "centre"))?;
        let coarsest = spacing.as_dvec3() * f64::from(1u32 << (cascades - 1));
        let reach = centre.as_dvec3().abs() + (counts - 1).as_dvec3() * 0.5 * coarsest;
        let reach = reach.max_element();
        if reach > f64::from(FARTHEST) {
            return Err(source.at_vector(
                counts_at,
                format!("layout `{name}` reaches {reach:.0} voxels from the origin"),
                format!("{FARTHEST} are possible; narrow the spacing, or use fewer cascades"),
            ));
        }
        Ok(LayoutSpec {
            name,
            counts,
            spacing,
            centre,
            follow: layout.follow,
            cascades,
            octree: None,
        })
    }

    fn spacing(&self, spacing: &OneOrThree) -> Read<Vec3> {
        let apart = |leaf| -> Read<f32> {
            let range = f64::from(LEAST_SPACING)..=f64::from(FARTHEST);
            Ok(self.source.number_in(leaf, "spacing", range)? as f32)
        };
        Ok(match spacing {
            OneOrThree::One(leaf) => Vec3::splat(apart(leaf)?),
            OneOrThree::Three(v) => Vec3::new(apart(&v.0)?, apart(&v.1)?, apart(&v.2)?),
        })
    }

    /// A layout with an octree. Whether the tree has too many probes depends on the voxels.
    fn octree_layout(
        &self,
        layout: &schema::Layout,
        octree: &schema::Octree,
        name: String,
    ) -> Read<LayoutSpec> {
        let source = self.source;
        let depth = source.count(&octree.depth, "depth", 1..=MAX_DEPTH)?;
        if layout.follow || layout.cascades.is_some() {
            return Err(source.at(
                &layout.name,
                format!("layout `{name}` has an octree and `follow` or `cascades`"),
                "leave one of them out: an octree has levels of its own, and its place is fixed",
            ));
        }
        let counts = or(&layout.counts, UVec3::splat(2), |counts| {
            let [x, y, z] = counts.leaves();
            let count = |leaf| source.count(leaf, "counts", 2..=MAX_PROBES);
            Ok(UVec3::new(count(x)?, count(y)?, count(z)?))
        })?;
        let (low, high) = self.world_box();
        let halvings = (1u32 << depth) as f32;
        let longest = ((high - low).max_element() / halvings).ceil().max(1.0) * halvings;
        let spacing = or(&layout.spacing, Vec3::splat(longest), |v| self.spacing(v))?;
        let finest = spacing / halvings;
        if finest.min_element() < 1.0 || finest != finest.round() {
            return Err(source.at(
                &octree.depth,
                format!("layout `{name}` cannot halve a spacing of {spacing} voxels {depth} times"),
                format!("write a `spacing` that is a multiple of {halvings}, or a lower `depth`"),
            ));
        }
        let cells = (counts - 1).to_array().map(|n| u64::from(n) << depth);
        let cells = cells.iter().fold(1u64, |a, b| a.saturating_mul(*b));
        if cells > MAX_OCTREE_CELLS {
            return Err(source.at(
                &octree.depth,
                format!("layout `{name}` divides its lattice into {cells} cells"),
                format!("{MAX_OCTREE_CELLS} are possible; lower `depth` or `counts`"),
            ));
        }
        let centre = or(&layout.centre, (low + high) / 2.0, |v| {
            source.point(v, "centre")
        })?;
        let reach = centre.as_dvec3().abs() + (counts - 1).as_dvec3() * 0.5 * spacing.as_dvec3();
        if reach.max_element() > f64::from(FARTHEST) {
            return Err(source.at(
                &octree.depth,
                format!(
                    "layout `{name}` reaches {:.0} voxels from the origin",
                    reach.max_element()
                ),
                format!("{FARTHEST} are possible; narrow the spacing, or use lower counts"),
            ));
        }
        let (split, divide_at) = match octree.split {
            schema::Split::Surface => (Split::Surface, 0.0),
            schema::Split::Hits => (Split::Hits, 0.5),
        };
        Ok(LayoutSpec {
            name,
            counts,
            spacing,
            centre,
            follow: false,
            cascades: 1,
            octree: Some(OctreeSpec {
                depth,
                split,
                divide_at: or(&octree.divide_at, divide_at, |leaf| {
                    Ok(source.number_in(leaf, "divide_at", 0.0..=1000.0)? as f32)
                })?,
                free_below: or(&octree.free_below, 0.25, |leaf| {
                    Ok(source.number_in(leaf, "free_below", 0.0..=1.0)? as f32)
                })?,
                source: octree.source,
            }),
        })
    }
}

const DEFAULT_FOV_DEG: f32 = 60.0;

/// Yaw and pitch in degrees of a camera that looks along a vector.
fn towards(along: Vec3) -> (f32, f32) {
    let yaw = (-along.x).atan2(-along.z);
    let pitch = along.y.atan2(along.x.hypot(along.z));
    (yaw.to_degrees(), pitch.to_degrees())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_looks_at_its_target() {
        for along in [Vec3::new(1.0, 2.0, -3.0), Vec3::X, Vec3::NEG_Y, Vec3::Z] {
            let (yaw_deg, pitch_deg) = towards(along);
            let camera = Camera {
                name: "test".into(),
                position: Vec3::ZERO,
                yaw_deg,
                pitch_deg,
                fov_deg: DEFAULT_FOV_DEG,
            };
            let forward = camera.basis(1.0).forward.as_vec3();
            assert!(
                forward.distance(along.normalize()) < 1e-5,
                "{along}: {forward}"
            );
        }
    }
}
