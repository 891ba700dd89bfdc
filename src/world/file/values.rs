//! From text to numbers, names and vectors: each either fits its key or is refused with its position.

use std::ops::RangeInclusive;

use glam::{DVec3, IVec3, Vec3};

use super::diagnostics::{Problem, Source};
use super::explain::suggest;
use super::leaf::{Leaf, OneOrThree};
use super::printable::is_obeyed;
use super::schema::Vector;
use crate::world::scenery;

/// A value of the file, or what is wrong with it.
pub type Read<T> = Result<T, Box<Problem>>;

/// Coordinates lie within ± this many voxels.
const FARTHEST: f64 = scenery::FARTHEST as f64;

/// Shapes are scaled by at most this factor up or down. With 63 nested scales, the most that brackets
/// allow, the numbers still fit an f64.
pub(in crate::world) const GREATEST_SCALE: f64 = 1e4;

/// Lattice cells of a noise along the edge of a voxel. From 1 up, neighbours are uncorrelated; far
/// above, an f32 no longer distinguishes the places within a cell.
const HIGHEST_FREQUENCY: f64 = 1e3;

/// Most noises, kinds of features, presets, cameras or layouts of a world.
const MAX_NAMES: usize = 1024;

/// Longer texts are cut in messages.
const LONGEST_QUOTE: usize = 40;

/// The value of a key that may be left out.
pub fn or<L, T>(value: &Option<L>, default: T, read: impl FnOnce(&L) -> Read<T>) -> Read<T> {
    value.as_ref().map_or(Ok(default), read)
}

/// The text of a value as messages quote it.
fn quote(leaf: &Leaf) -> String {
    let text = leaf.text();
    match text.char_indices().nth(LONGEST_QUOTE) {
        Some((end, _)) => format!("`{}…`", &text[..end]),
        None => format!("`{text}`"),
    }
}

impl Source {
    /// A finite number that an f32 can hold too.
    pub fn number(&self, leaf: &Leaf, key: &str) -> Read<f64> {
        match ron::from_str::<f64>(leaf.ron()) {
            Ok(value) if (value as f32).is_finite() => Ok(value),
            Ok(_) => Err(self.at(
                leaf,
                format!("`{key}` is {}, which is not a finite number", quote(leaf)),
                "write a finite number, as in 1.5",
            )),
            Err(_) => Err(self.at(
                leaf,
                format!("`{key}` must be a number, not {}", quote(leaf)),
                "write a number without quotes or brackets, as in 1.5",
            )),
        }
    }

    pub fn number_in(&self, leaf: &Leaf, key: &str, range: RangeInclusive<f64>) -> Read<f64> {
        let value = self.number(leaf, key)?;
        if range.contains(&value) {
            return Ok(value);
        }
        let (low, high) = (range.start(), range.end());
        Err(self.at(
            leaf,
            format!("`{key}` is {value}; it must be between {low} and {high}"),
            format!("write a number between {low} and {high}"),
        ))
    }

    /// A number above 0.
    pub fn positive(&self, leaf: &Leaf, key: &str) -> Read<f32> {
        let value = self.number(leaf, key)? as f32;
        if value > 0.0 {
            return Ok(value);
        }
        let help = format!("write a `{key}` above 0");
        Err(self.at(
            leaf,
            format!("`{key}` is {value}; it must be above 0"),
            help,
        ))
    }

    /// The scale factor of a shape.
    pub fn scale(&self, leaf: &Leaf, key: &str) -> Read<f32> {
        self.positive(leaf, key)?;
        Ok(self.number_in(leaf, key, 1.0 / GREATEST_SCALE..=GREATEST_SCALE)? as f32)
    }

    /// Noise cells per voxel, for all axes or for each axis.
    pub fn frequency(&self, value: &OneOrThree, key: &str) -> Read<DVec3> {
        let one = |leaf| self.number_in(leaf, key, -HIGHEST_FREQUENCY..=HIGHEST_FREQUENCY);
        Ok(match value {
            OneOrThree::One(leaf) => DVec3::splat(one(leaf)?),
            OneOrThree::Three(vector) => {
                let [x, y, z] = vector.leaves();
                DVec3::new(one(x)?, one(y)?, one(z)?)
            }
        })
    }

    /// A number of at least 0.
    pub fn not_negative(&self, leaf: &Leaf, key: &str) -> Read<f32> {
        let value = self.number(leaf, key)? as f32;
        if value >= 0.0 {
            return Ok(value);
        }
        let help = format!("write a `{key}` of at least 0");
        Err(self.at(
            leaf,
            format!("`{key}` is {value}; it must not be negative"),
            help,
        ))
    }

    /// A coordinate or a length, in voxels.
    pub fn length(&self, leaf: &Leaf, key: &str) -> Read<f32> {
        Ok(self.number_in(leaf, key, -FARTHEST..=FARTHEST)? as f32)
    }

    pub fn whole(&self, leaf: &Leaf, key: &str, range: RangeInclusive<i64>) -> Read<i64> {
        let value = self.number(leaf, key)?;
        let (low, high) = (range.start(), range.end());
        if value.fract() != 0.0 {
            return Err(self.at(
                leaf,
                format!("`{key}` must be a whole number, not {value}"),
                format!("write a whole number between {low} and {high}"),
            ));
        }
        // The range lies within ±2⁵³, where every whole number is exact.
        if value < *low as f64 || value > *high as f64 {
            return Err(self.at(
                leaf,
                format!("`{key}` is {value}; it must be between {low} and {high}"),
                format!("write a whole number between {low} and {high}"),
            ));
        }
        Ok(value as i64)
    }

    pub fn count(&self, leaf: &Leaf, key: &str, range: RangeInclusive<u32>) -> Read<u32> {
        let range = i64::from(*range.start())..=i64::from(*range.end());
        Ok(self.whole(leaf, key, range)? as u32)
    }

    pub fn seed(&self, leaf: &Leaf) -> Read<u32> {
        self.count(leaf, "seed", 0..=u32::MAX)
    }

    pub fn text(&self, leaf: &Leaf, key: &str) -> Read<String> {
        let text: String = ron::from_str(leaf.ron()).map_err(|_| {
            self.at(
                leaf,
                format!("`{key}` must be a text, not {}", quote(leaf)),
                "write it between double quotes, as in \"moss\"",
            )
        })?;
        // Tables need one line.
        let text = text.replace(['\n', '\r', '\t'], " ");
        match text.chars().find(|c| is_obeyed(*c)) {
            None => Ok(text),
            Some(c) => Err(self.at(
                leaf,
                format!(
                    "this text has a character that terminals obey, {}",
                    c.escape_unicode()
                ),
                "remove it: the text is printed to terminals",
            )),
        }
    }

    /// A name that later keys and the command line refer to.
    pub fn name(&self, leaf: &Leaf, what: &str, taken: &[String]) -> Read<String> {
        let name = self.text(leaf, &format!("name of a {what}"))?;
        if name.trim().is_empty() {
            let help = format!("write what the {what} is called");
            return Err(self.at(leaf, format!("the name of this {what} is empty"), help));
        }
        if taken.len() >= MAX_NAMES {
            let help = "names are compared one by one: use fewer";
            return Err(self.at(
                leaf,
                format!("there are more than {MAX_NAMES} {what}s"),
                help,
            ));
        }
        if taken.contains(&name) {
            return Err(self.at(
                leaf,
                format!("there are two {what}s called `{name}`"),
                "rename one of the two",
            ));
        }
        Ok(name)
    }

    /// The index of an existing name.
    pub fn find<'n>(
        &self,
        leaf: &Leaf,
        what: &str,
        names: impl Iterator<Item = &'n str> + Clone,
    ) -> Read<usize> {
        let wanted = self.text(leaf, what)?;
        names
            .clone()
            .position(|name| name == wanted)
            .ok_or_else(|| {
                self.at(
                    leaf,
                    format!("there is no {what} called `{wanted}`"),
                    suggest(&wanted, names),
                )
            })
    }

    /// A point or an offset in world space, voxels.
    pub fn point(&self, vector: &Vector, key: &str) -> Read<Vec3> {
        Ok(Vec3::new(
            self.length(&vector.0, key)?,
            self.length(&vector.1, key)?,
            self.length(&vector.2, key)?,
        ))
    }

    /// A voxel in world space.
    pub fn voxel(&self, vector: &Vector, key: &str) -> Read<IVec3> {
        let farthest = FARTHEST as i64;
        let axis = |leaf| -> Read<i32> { Ok(self.whole(leaf, key, -farthest..=farthest)? as i32) };
        Ok(IVec3::new(
            axis(&vector.0)?,
            axis(&vector.1)?,
            axis(&vector.2)?,
        ))
    }

    /// Three numbers of at least 0.
    pub fn not_negative3(&self, vector: &Vector, key: &str) -> Read<Vec3> {
        Ok(Vec3::new(
            self.not_negative(&vector.0, key)?,
            self.not_negative(&vector.1, key)?,
            self.not_negative(&vector.2, key)?,
        ))
    }

    /// Three shares of reflected light, linear Rec. 709.
    pub fn albedo(&self, [r, g, b]: [&Leaf; 3], key: &str) -> Read<Vec3> {
        let share = |leaf| -> Read<f32> { Ok(self.number_in(leaf, key, 0.0..=1.0)? as f32) };
        Ok(Vec3::new(share(r)?, share(g)?, share(b)?))
    }

    /// A vector long enough to have a direction; not normalised.
    pub fn direction(&self, vector: &Vector, key: &str) -> Read<Vec3> {
        let direction = self.point(vector, key)?;
        if direction.length() > 1e-6 {
            return Ok(direction);
        }
        Err(self.at_vector(
            vector,
            format!("`{key}` is (0, 0, 0), which has no direction"),
            "write a vector that is longer than 0; it need not have length 1",
        ))
    }
}

impl Vector {
    pub fn leaves(&self) -> [&Leaf; 3] {
        [&self.0, &self.1, &self.2]
    }
}
