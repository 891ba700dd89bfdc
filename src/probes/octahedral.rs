//! Octahedral maps: the sphere of directions on a square (Cigolle et al. 2014, "A Survey of Efficient
//! Representations for Independent Unit Vectors").
//!
//! The square is [−1, 1]²; +Z is its centre and −Z its four corners. A map of n × n texels has a border
//! one texel wide, so that bilinear filtering may cross the edges: beyond an edge the square continues
//! at the mirrored place of the same edge.
//!
//! `shaders/math/octahedral.wesl` does the same on the GPU.

use glam::{DVec2, DVec3, IVec2, UVec2, Vec2Swizzles as _};

/// Point of the square for a direction (of any length except 0).
pub fn encode(direction: DVec3) -> DVec2 {
    let on_octahedron = direction / (direction.x.abs() + direction.y.abs() + direction.z.abs());
    let flat = DVec2::new(on_octahedron.x, on_octahedron.y);
    if direction.z >= 0.0 { flat } else { fold(flat) }
}

/// Unit direction of a point of the square.
pub fn decode(point: DVec2) -> DVec3 {
    let z = 1.0 - point.x.abs() - point.y.abs();
    let flat = if z >= 0.0 { point } else { fold(point) };
    flat.extend(z).normalize()
}

/// Folds the lower half of the octahedron outwards over the edges of the diamond |x| + |y| = 1, and
/// back.
fn fold(point: DVec2) -> DVec2 {
    // The paper's signNotZero: `signum` gives +1 for +0.
    (DVec2::ONE - point.yx().abs()) * point.signum()
}

/// Unit direction through the centre of a texel of an n × n map.
pub fn texel_direction(texel: UVec2, n: u32) -> DVec3 {
    decode((texel.as_dvec2() + 0.5) * (2.0 / f64::from(n)) - 1.0)
}

/// The texel of an n × n map that a texel of its border repeats. Coordinates count from the map's first
/// inner texel, so that border texels have −1 or n in at least one coordinate. An inner texel is its
/// own source.
pub fn border_source(texel: IVec2, n: u32) -> UVec2 {
    let last = n as i32 - 1;
    let mut source = texel;
    if texel.x < 0 || texel.x > last {
        source.x = texel.x.clamp(0, last);
        source.y = last - texel.y;
    }
    if texel.y < 0 || texel.y > last {
        source.x = last - source.x;
        source.y = source.y.clamp(0, last);
    }
    source.as_uvec2()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_axes_lie_where_the_paper_puts_them() {
        assert_eq!(encode(DVec3::Z), DVec2::ZERO);
        assert_eq!(encode(DVec3::X), DVec2::X);
        assert_eq!(encode(DVec3::NEG_Y), DVec2::NEG_Y);
        assert_eq!(encode(DVec3::NEG_Z).abs(), DVec2::ONE);
    }

    #[test]
    fn texels_cover_the_sphere_evenly_enough() {
        let n = 16;
        let mean: DVec3 = (0..n * n)
            .map(|i| texel_direction(UVec2::new(i % n, i / n), n))
            .sum();
        assert!(mean.length() < 1e-9, "opposite texels cancel: {mean}");
    }

    #[test]
    fn a_border_texel_repeats_the_texel_whose_centre_lies_nearest() {
        // Beyond an edge the square continues mirrored; the border texel's own centre, reflected by
        // that rule, must be the centre of its source.
        let n = 8;
        let size = f64::from(n);
        for x in -1..=n as i32 {
            for y in -1..=n as i32 {
                let mut point = (DVec2::new(f64::from(x), f64::from(y)) + 0.5) * (2.0 / size) - 1.0;
                if point.x.abs() > 1.0 {
                    point = DVec2::new(2.0 * point.x.signum() - point.x, -point.y);
                }
                if point.y.abs() > 1.0 {
                    point = DVec2::new(-point.x, 2.0 * point.y.signum() - point.y);
                }
                let source = border_source(IVec2::new(x, y), n);
                let expected = texel_direction(source, n);
                assert!(decode(point).distance(expected) < 1e-12, "texel {x}, {y}");
            }
        }
    }

    proptest! {
        #[test]
        fn decoding_inverts_encoding(x in -1.0..1.0f64, y in -1.0..1.0f64, z in -1.0..1.0f64) {
            let direction = DVec3::new(x, y, z);
            prop_assume!(direction.length() > 1e-3);
            let point = encode(direction);
            prop_assert!(point.abs().max_element() <= 1.0 + 1e-12);
            prop_assert!(decode(point).distance(direction.normalize()) < 1e-12);
        }

        #[test]
        fn the_map_is_continuous_over_its_edges(along in -1.0..1.0f64, edge in 0..4u32) {
            let near = 1.0 - 1e-9;
            let (a, b) = match edge {
                0 => (DVec2::new(near, along), DVec2::new(near, -along)),
                1 => (DVec2::new(-near, along), DVec2::new(-near, -along)),
                2 => (DVec2::new(along, near), DVec2::new(-along, near)),
                _ => (DVec2::new(along, -near), DVec2::new(-along, -near)),
            };
            prop_assert!(decode(a).distance(decode(b)) < 1e-7);
        }
    }
}
