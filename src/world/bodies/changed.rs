//! What a player changed about the bodies of a world: those that were placed, and those of the world file that were
//! pushed.

use std::collections::HashSet;
use std::sync::Arc;

use glam::Vec3;

use super::{
    Bodies, Body, BodyModel, MAX_BODIES, MAX_BODY_EDGE, MAX_MODEL_VOXELS, PutBy, WholeBody,
};

/// Coordinates of bodies lie within ± this many voxels.
const FARTHEST: f32 = 16_777_216.0;

/// A body that a player has placed. It stands along the axes of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedBody {
    /// No other body of the world has this name.
    pub name: String,
    pub model: Arc<BodyModel>,
    /// The lowest corner of the model (world space).
    pub corner: Vec3,
}

/// A body of the world file that a player has pushed.
#[derive(Clone, Debug, PartialEq)]
pub struct MovedBody {
    pub name: String,
    /// Where its pivot is now (world space).
    pub position: Vec3,
}

/// All that a player changed about the bodies of a world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChangedBodies {
    /// In the order of placing.
    pub placed: Vec<PlacedBody>,
    pub moved: Vec<MovedBody>,
    /// Names of bodies of the world file that were set into the world as voxels.
    pub gone: Vec<String>,
}

impl ChangedBodies {
    pub fn is_empty(&self) -> bool {
        self.placed.is_empty() && self.moved.is_empty() && self.gone.is_empty()
    }

    /// Why these, read from a file, cannot be the changes of a world; `None` if they can.
    pub fn fault(&self) -> Option<String> {
        let places = self.placed.iter().map(|body| (&body.name, body.corner));
        let moved = self.moved.iter().map(|body| (&body.name, body.position));
        let mut names = HashSet::new();
        for (name, place) in places.chain(moved) {
            if name.is_empty() || !names.insert(name) {
                return Some(format!("no body can have the name `{name}`"));
            }
            if !place.to_array().iter().all(|axis| axis.abs() <= FARTHEST) {
                return Some(format!("no body can be at {place}"));
            }
        }
        if let Some(name) = self.gone.iter().find(|name| !names.insert(*name)) {
            return Some(format!("no body can be the body `{name}`, which is gone"));
        }
        if self.placed.len() > MAX_BODIES {
            return Some(format!("there are more than {MAX_BODIES} bodies"));
        }
        let is_bad = |model: &BodyModel| {
            let size = model.size;
            size.min_element() == 0
                || size.max_element() > MAX_BODY_EDGE
                || size.element_product() as usize != model.materials.len()
                || model.materials.iter().all(|material| *material == 0)
        };
        let mut models = self.placed.iter().map(|body| &body.model);
        models
            .any(|model| is_bad(model))
            .then(|| "the voxels of a body are impossible".to_owned())
    }
}

impl Bodies {
    pub fn index_of(&self, name: &str) -> Option<usize> {
        self.bodies.iter().position(|body| body.name == name)
    }

    /// A name for the next body that a player places.
    pub fn free_name(&self) -> String {
        let mut names = (1..).map(|number| format!("placed {number}"));
        let is_free = |name: &String| self.index_of(name).is_none() && !self.gone.contains(name);
        names.find(is_free).expect("bodies are finite")
    }

    /// Whether there is room for another body, with this model.
    pub fn has_room_for(&self, model: &BodyModel) -> bool {
        let voxels = self.models.iter().map(|model| model.materials.len());
        self.bodies.len() < MAX_BODIES
            && voxels.sum::<usize>() + model.materials.len() <= MAX_MODEL_VOXELS as usize
    }

    /// A body as a player has placed it; `None` for one of the world file.
    pub fn placed(&self, index: usize) -> Option<PlacedBody> {
        let body = &self.bodies[index];
        (body.put_by == PutBy::Placed).then(|| PlacedBody {
            name: body.name.clone(),
            model: Arc::new(self.models[body.model].clone()),
            corner: body.rest.position,
        })
    }

    /// Adds a body that a player places. It comes last.
    pub fn add(&mut self, placed: &PlacedBody) {
        self.put(&WholeBody::placed(placed));
    }

    /// What a player changed.
    pub fn changes(&self) -> ChangedBodies {
        let pushed = self.bodies.iter().filter(|b| b.put_by == PutBy::Pushed);
        ChangedBodies {
            placed: (0..self.bodies.len())
                .filter_map(|index| self.placed(index))
                .collect(),
            moved: pushed
                .map(|body| MovedBody {
                    name: body.name.clone(),
                    position: body.rest.position,
                })
                .collect(),
            gone: self.gone.clone(),
        }
    }

    /// Changes the bodies of a world file. `renumbered` gives the number of a material other than air in this world, if
    /// it has one; voxels without are left out. Returns the number of bodies that do not fit, and the number of voxels
    /// left out of the others.
    pub fn take_changes(
        &mut self,
        changed: &ChangedBodies,
        renumbered: impl Fn(u8) -> Option<u8>,
    ) -> [u64; 2] {
        let [mut lost, mut voxels] = [0; 2];
        for name in &changed.gone {
            // One that the file no longer has is gone indeed.
            match self.index_of(name) {
                Some(index) if self.bodies[index].is_still() => self.remove(index),
                Some(_) => lost += 1,
                None => {}
            }
        }
        for moved in &changed.moved {
            let still = |body: &&mut Body| body.name == moved.name && body.is_still();
            match self.bodies.iter_mut().find(still) {
                Some(body) => {
                    body.rest.position = moved.position;
                    body.put_by = PutBy::Pushed;
                }
                None => lost += 1,
            }
        }
        for placed in &changed.placed {
            let mut model = (*placed.model).clone();
            let mut without = 0;
            for material in &mut model.materials {
                let known = if *material == 0 {
                    Some(0)
                } else {
                    renumbered(*material)
                };
                without += u64::from(known.is_none());
                *material = known.unwrap_or(0);
            }
            let is_empty = model.materials.iter().all(|material| *material == 0);
            if is_empty || !self.has_room_for(&model) {
                lost += 1;
                continue;
            }
            voxels += without;
            let name = match self.index_of(&placed.name) {
                Some(_) => self.free_name(),
                None => placed.name.clone(),
            };
            self.add(&PlacedBody {
                name,
                model: Arc::new(model),
                corner: placed.corner,
            });
        }
        [lost, voxels]
    }
}

#[cfg(test)]
pub mod tests {
    use glam::{Quat, UVec3};
    use proptest::prelude::*;

    use super::*;
    use crate::world::{
        Travel,
        bodies::{BodyMotion, Pose},
    };

    fn body_of_file(name: &str, motion: Vec<BodyMotion>) -> Body {
        Body {
            name: name.into(),
            model: 0,
            pivot: Vec3::splat(0.5),
            rest: Pose {
                position: Vec3::new(1.5, 2.0, 3.0),
                rotation: Quat::IDENTITY,
            },
            motion,
            put_by: PutBy::WorldFile,
        }
    }

    /// A still body and one that moves.
    fn of_file() -> Bodies {
        let bob = BodyMotion::Travel(Travel::Bob {
            amplitude: Vec3::Y,
            rate: 1.0,
            phase: 0.0,
        });
        Bodies {
            models: vec![BodyModel {
                size: UVec3::ONE,
                materials: vec![1],
            }],
            bodies: vec![
                body_of_file("still", vec![]),
                body_of_file("bobs", vec![bob]),
            ],
            gone: Vec::new(),
        }
    }

    fn model() -> impl Strategy<Value = BodyModel> {
        let size = (1..5u32, 1..5u32, 1..5u32).prop_map(UVec3::from);
        let materials = size.prop_flat_map(|size| {
            let count = size.element_product() as usize;
            (Just(size), prop::collection::vec(0..3u8, count))
        });
        materials.prop_map(|(size, mut materials)| {
            materials[0] = 1;
            BodyModel { size, materials }
        })
    }

    /// Bodies that a player placed, and perhaps the still one, pushed or gone.
    pub fn changes() -> impl Strategy<Value = ChangedBodies> {
        let place = || (-900..900i32, -90..90i32, -900..900i32).prop_map(glam::IVec3::from);
        let place = move || place().prop_map(|at| at.as_vec3() / 8.0);
        let placed = prop::collection::vec((model(), place()), 0..5);
        let still = (prop::option::of(place()), any::<bool>());
        (placed, still).prop_map(|(placed, (moved, is_gone))| ChangedBodies {
            placed: (placed.into_iter().enumerate())
                .map(|(number, (model, corner))| PlacedBody {
                    name: format!("placed {}", number + 1),
                    model: Arc::new(model),
                    corner,
                })
                .collect(),
            moved: moved
                .map(|position| MovedBody {
                    name: "still".into(),
                    position,
                })
                .into_iter()
                .collect(),
            gone: (is_gone && moved.is_none())
                .then(|| "still".to_owned())
                .into_iter()
                .collect(),
        })
    }

    proptest! {
        #[test]
        fn changes_that_are_taken_are_the_changes(changes in changes()) {
            prop_assert_eq!(changes.fault(), None);
            let mut bodies = of_file();
            prop_assert_eq!(bodies.take_changes(&changes, Some), [0, 0]);
            prop_assert_eq!(bodies.changes(), changes.clone());
            prop_assert_eq!(bodies.free_name(), format!("placed {}", changes.placed.len() + 1));
            while let Some(index) = bodies.bodies.iter().position(|b| b.put_by == PutBy::Placed) {
                bodies.remove(index);
            }
            prop_assert_eq!(&bodies.models, &of_file().models);
        }
    }

    #[test]
    fn what_does_not_fit_is_counted() {
        let one = |name: &str, materials: Vec<u8>| PlacedBody {
            name: name.into(),
            model: Arc::new(BodyModel {
                size: UVec3::new(materials.len() as u32, 1, 1),
                materials,
            }),
            corner: Vec3::ZERO,
        };
        let moved = |name: &str| MovedBody {
            name: name.into(),
            position: Vec3::ZERO,
        };
        let changes = ChangedBodies {
            placed: vec![
                one("a", vec![1, 2]),
                one("b", vec![2]),
                one("still", vec![1]),
            ],
            moved: vec![moved("bobs"), moved("lost")],
            gone: vec!["unknown".into()],
        };
        let mut bodies = of_file();
        let lost = bodies.take_changes(&changes, |m| (m == 1).then_some(3));
        assert_eq!(lost, [3, 1], "two were moved, one has no material left");
        assert_eq!(bodies.bodies[2].name, "a");
        assert_eq!(bodies.models[bodies.bodies[2].model].materials, [3, 0]);
        assert_eq!(bodies.bodies[3].name, "placed 1", "its name was taken");
        let twice = ChangedBodies {
            placed: vec![one("a", vec![1]); 2],
            ..Default::default()
        };
        assert!(twice.fault().is_some());
        let empty = ChangedBodies {
            placed: vec![one("a", vec![0])],
            ..Default::default()
        };
        assert!(empty.fault().is_some());
        let far = MovedBody {
            name: "still".into(),
            position: Vec3::X * f32::NAN,
        };
        let far = ChangedBodies {
            moved: vec![far],
            ..Default::default()
        };
        assert!(far.fault().is_some());
        let both = ChangedBodies {
            moved: vec![moved("still")],
            gone: vec!["still".into()],
            ..Default::default()
        };
        assert!(both.fault().is_some());
        let moves = ChangedBodies {
            gone: vec!["bobs".into()],
            ..Default::default()
        };
        assert_eq!(of_file().take_changes(&moves, Some), [1, 0], "it moves now");
    }
}
