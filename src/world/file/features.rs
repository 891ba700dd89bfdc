//! Features: boxes of voxels, and how many of them are placed where.

use glam::{IVec3, Vec3};

use super::diagnostics::Problem;
use super::leaf::Leaf;
use super::place::Ask;
use super::resolve::{MAX_EDGE, Reader};
use super::schema;
use super::values::{Read, or};
use crate::world::FeaturePart;
use crate::world::sdf::Shape;

/// Most boxes of all features and models together.
pub const MAX_PARTS: usize = 2_000_000;
/// Most copies of one scatter.
const MAX_SCATTERED: u32 = 100_000;

impl Reader<'_> {
    /// Lowest voxel of the world, and the voxel after its highest.
    pub(super) fn world_voxels(&self) -> (IVec3, IVec3) {
        (self.origin, self.origin + self.size.as_ivec3())
    }

    /// `count`, or `density` per 1000 columns of the box; messages point at `place` for either.
    pub(super) fn how_many(
        &self,
        count: &Option<Leaf>,
        density: &Option<Leaf>,
        (low, high): (Vec3, Vec3),
        place: &Leaf,
    ) -> Read<u32> {
        let source = self.source;
        match (count, density) {
            (Some(count), None) => source.count(count, "count", 0..=MAX_SCATTERED),
            (None, Some(leaf)) => {
                let density = f64::from(source.not_negative(leaf, "density")?);
                let columns = f64::from(high.x - low.x) * f64::from(high.z - low.z);
                let count = (density * columns / 1000.0).round();
                if count > f64::from(MAX_SCATTERED) {
                    return Err(source.at(
                        leaf,
                        format!("{density} for each 1000 columns are {count} in this box"),
                        format!("a scatter may have {MAX_SCATTERED}: lower the density"),
                    ));
                }
                Ok(count as u32)
            }
            (Some(count), Some(_)) => Err(source.at(
                count,
                "this scatter has both a `count` and a `density`",
                "keep one of the two",
            )),
            (None, None) => Err(source.at(
                place,
                "this scatter does not say how many",
                "add `count: n`, or `density: n` for n in each 1000 columns",
            )),
        }
    }

    pub(super) fn clearance(&self, clearance: &Option<Leaf>, default: u32) -> Read<u32> {
        or(clearance, default, |leaf| {
            self.source.count(leaf, "clearance", 0..=MAX_EDGE)
        })
    }

    /// The boxes of all features, in the order of the file.
    pub(super) fn features(
        &mut self,
        features: &schema::Features,
        shape: &Shape,
    ) -> Read<Vec<FeaturePart>> {
        let source = self.source;
        let mut names = Vec::new();
        let mut kinds = Vec::new();
        for (name, parts) in &features.kinds.0 {
            names.push(source.name(name, "kind of feature", &names)?);
            let parts = parts.iter().map(|part| self.part(part));
            kinds.push(parts.collect::<Read<Vec<_>>>()?);
        }
        let known = || names.iter().map(String::as_str);
        let mut placed = Vec::new();
        for place in &features.place {
            match place {
                schema::Place::At { kind, places } => {
                    let parts = &kinds[source.find(kind, "kind", known())?];
                    for place in places {
                        let at = source.voxel(place, "places")?;
                        placed.extend(parts.iter().map(|part| moved(part, at)));
                    }
                    self.check_parts(placed.len(), kind)?;
                }
                schema::Place::Scatter {
                    kinds: wanted,
                    count,
                    density,
                    on,
                    min,
                    max,
                    clearance,
                    spacing,
                    seed,
                } => {
                    let own_seed = self.next_seed();
                    let wanted: Vec<(&Leaf, usize)> = wanted
                        .iter()
                        .map(|leaf| Ok((leaf, source.find(leaf, "kind", known())?)))
                        .collect::<Read<_>>()?;
                    let Some(&(first, _)) = wanted.first() else {
                        let stand_in = count.as_ref().or(density.as_ref());
                        let message = "this scatter has no kinds";
                        let help = "name at least one kind of feature in `kinds`";
                        return Err(match stand_in {
                            Some(leaf) => source.at(leaf, message, help),
                            None => Problem::of_file(message, help),
                        });
                    };
                    let bounds = self.bounds(min, max)?;
                    let ask = Ask {
                        count: self.how_many(count, density, bounds, first)?,
                        bounds,
                        ground: *on,
                        clearance: self.clearance(clearance, 1)?,
                        spacing: or(spacing, 0.0, |leaf| source.not_negative(leaf, "spacing"))?,
                        seed: or(seed, own_seed, |leaf| source.seed(leaf))?,
                    };
                    for found in ask.places(shape, self.world_voxels(), &mut self.tried) {
                        let (_, kind) = wanted[found.chance as usize % wanted.len()];
                        placed.extend(kinds[kind].iter().map(|part| moved(part, found.voxel)));
                    }
                    self.check_parts(placed.len(), first)?;
                }
            }
        }
        Ok(placed)
    }

    pub(super) fn check_parts(&self, parts: usize, place: &Leaf) -> Read<()> {
        if parts <= MAX_PARTS {
            return Ok(());
        }
        Err(self.source.at(
            place,
            format!("with these the features have {parts} boxes"),
            format!("a world may have {MAX_PARTS}: place fewer, or kinds of fewer parts"),
        ))
    }

    fn part(&self, part: &schema::Part) -> Read<FeaturePart> {
        let source = self.source;
        let (min, max) = (
            source.voxel(&part.min, "min")?,
            source.voxel(&part.max, "max")?,
        );
        if min.cmpgt(max).any() {
            return Err(source.at_vector(
                &part.max,
                format!("this part is empty: `min` is {min} and `max` is {max}"),
                "both ends belong to the part, and `min` must be at most `max` on every axis",
            ));
        }
        Ok(FeaturePart {
            min,
            max,
            material: self.material(&part.material)?,
            without_corners: part.without_corners,
        })
    }
}

fn moved(part: &FeaturePart, by: IVec3) -> FeaturePart {
    FeaturePart {
        min: part.min + by,
        max: part.max + by,
        ..*part
    }
}
