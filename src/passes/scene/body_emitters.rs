//! The emissive faces of bodies, as lists from which shaders choose at random (`shaders/light/body_emitters.wesl`). They are
//! those of the models, so that nothing changes when a body moves.

use super::body_models::{FACES, GpuModel, packed_face, places};
use crate::world::bodies::{Bodies, BodyModel};

crate::shared! {
    in scene;

    /// A body that has emissive faces.
    pub struct GpuGlowingBody as GlowingBody {
        /// Its number among all bodies.
        pub body: u32,
        /// Index of the vector with the first two emissive faces of its model.
        pub faces_at: u32,
        /// Number of these faces.
        pub faces: u32,
        /// Weight of its faces, and of those of the glowing bodies before it.
        pub weight_until: f32,
    }
}

/// Every face of an emissive voxel of a model that borders on air in the model. The weight of a face is the sum of the channels
/// of the radiance that it emits.
pub struct EmissiveFaces {
    /// Packed.
    faces: Vec<u32>,
    /// Weight of each face and of those before it.
    weights_until: Vec<f32>,
}

impl EmissiveFaces {
    /// `weights`: of a face of each material.
    pub fn of(model: &BodyModel, weights: &[f64]) -> Self {
        let mut all = Self {
            faces: Vec::new(),
            weights_until: Vec::new(),
        };
        if weights.iter().all(|&weight| weight <= 0.0) {
            return all;
        }
        let mut sum = 0.0;
        for at in places(model.size) {
            let voxel = at.as_ivec3();
            let material = usize::from(model.material(voxel));
            let weight = match material {
                0 => 0.0,
                _ => weights.get(material - 1).copied().unwrap_or(0.0),
            };
            if weight <= 0.0 {
                continue;
            }
            for (face, facing) in FACES.iter().enumerate() {
                if model.material(voxel + *facing) == 0 {
                    sum += weight;
                    all.faces.push(packed_face(at, face));
                    all.weights_until.push(sum as f32);
                }
            }
        }
        all
    }

    /// Of all faces.
    fn weight(&self) -> f32 {
        self.weights_until.last().copied().unwrap_or(0.0)
    }

    /// Two faces in a vector: each the packed face, then the weight until it.
    pub fn vectors(&self) -> impl Iterator<Item = [u32; 4]> + '_ {
        let words = |at: usize| match (self.faces.get(at), self.weights_until.get(at)) {
            (Some(face), Some(weight)) => [*face, weight.to_bits()],
            _ => [0; 2],
        };
        (0..self.faces.len().div_ceil(2)).map(move |pair| {
            let ([a, b], [c, d]) = (words(2 * pair), words(2 * pair + 1));
            [a, b, c, d]
        })
    }
}

impl GpuGlowingBody {
    /// All of them, in the order of the bodies. `models_at`: the index of the first vector of each model.
    pub fn of_all(bodies: &Bodies, models: &[GpuModel], models_at: &[u32]) -> Vec<Self> {
        let mut until = 0.0;
        let mut all = Vec::new();
        for (number, body) in bodies.bodies.iter().enumerate() {
            let model = &models[body.model];
            let emissive = &model.emissive;
            if !emissive.faces.is_empty() {
                until += f64::from(emissive.weight());
                all.push(Self {
                    body: number as u32,
                    faces_at: models_at[body.model] + model.first_emissive as u32,
                    faces: emissive.faces.len() as u32,
                    weight_until: until as f32,
                });
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;

    /// A row of stone, lamp, lamp, air, lamp.
    fn row() -> BodyModel {
        BodyModel {
            size: UVec3::new(5, 1, 1),
            materials: vec![1, 2, 2, 0, 3],
        }
    }

    #[test]
    fn faces_beside_air_are_listed_with_their_weights() {
        let found = EmissiveFaces::of(&row(), &[0.0, 2.0, 5.0]);
        // Four sides of the first lamp, five of the second, and all six of the one that stands alone.
        assert_eq!(found.faces.len(), 4 + 5 + 6);
        assert_eq!(found.weight(), 9.0 * 2.0 + 6.0 * 5.0);
        assert_eq!(found.weights_until[0], 2.0);
        assert!(found.weights_until.is_sorted());
        assert_eq!(found.faces[4], 2 | 1 << 18, "the second looks along +x");
        let vectors: Vec<[u32; 4]> = found.vectors().collect();
        assert_eq!(vectors.len(), 8);
        assert_eq!(vectors[0][2], found.faces[1]);
        assert_eq!(f32::from_bits(vectors[7][1]), found.weight());
        assert!(EmissiveFaces::of(&row(), &[0.0; 3]).faces.is_empty());
        assert!(EmissiveFaces::of(&row(), &[]).faces.is_empty());
    }
}
