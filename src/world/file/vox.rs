//! MagicaVoxel models: voxels become boxes, and palette colours become materials.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use dot_vox::{Dict, DotVoxData, SceneNode};
use glam::{IVec3, Mat3, Vec3};

use super::leaf::Leaf;
use super::matter::MAX_MATERIALS;
use super::resolve::Reader;
use super::schema;
use super::source_file::{self, siblings};
use super::values::Read;
use crate::world::{Colour, FeaturePart, Material, Pattern, materials::MaterialSound};

/// Larger model files are refused unread.
pub const MAX_BYTES: u64 = 64 << 20;
/// Most voxels and nodes of a scene, counting repeated instances.
pub const MAX_WORK: usize = 1 << 24;
/// Groups of a scene may nest this deep.
const MAX_SCENE_DEPTH: usize = 64;

/// A model that has been read.
pub(super) struct VoxModel {
    /// As the world names it.
    pub name: String,
    data: DotVoxData,
    /// The palette index of each voxel, in grotto's axes.
    pub voxels: BTreeMap<[i32; 3], u8>,
}

impl VoxModel {
    /// The lowest and the highest coordinates of its voxels, if it has any.
    pub fn corners(&self) -> Option<(IVec3, IVec3)> {
        let voxels = || self.voxels.keys().map(|&voxel| IVec3::from(voxel));
        Some((voxels().reduce(IVec3::min)?, voxels().reduce(IVec3::max)?))
    }
}

impl Reader<'_> {
    /// Adds the models' voxels to the features and their colours to the materials.
    pub(super) fn models(
        &mut self,
        models: &[schema::Model],
        features: &mut Vec<FeaturePart>,
    ) -> Read<()> {
        for model in models {
            let at = self.source.voxel(&model.at, "at")?;
            let read = self.read_vox(&model.file)?;
            self.add_model(&model.file, &read, at, features)?;
        }
        Ok(())
    }

    /// Reads the model that a world names.
    pub(super) fn read_vox(&self, leaf: &Leaf) -> Read<VoxModel> {
        let name = self.source.text(leaf, "file")?;
        let path = self.model_path(leaf, &name)?;
        let refuse = |message: String| {
            let help = "export the model from MagicaVoxel as .vox again";
            self.source.at(leaf, message, help)
        };
        let bytes = source_file::read_bytes(&path, MAX_BYTES)
            .map_err(|message| refuse(format!("`{name}` {message}")))?;
        let data = parse(&bytes)
            .map_err(|message| refuse(format!("`{name}` is not a MagicaVoxel model: {message}")))?;
        let voxels = scene_voxels(&data).map_err(|m| refuse(format!("`{name}` {m}")))?;
        Ok(VoxModel { name, data, voxels })
    }

    /// The model's file, which must lie in the folder of the world file.
    fn model_path(&self, leaf: &Leaf, name: &str) -> Read<PathBuf> {
        let source = self.source;
        let Some(folder) = self.folder else {
            let help = "save the world as a file beside the model";
            return Err(source.at(leaf, "a world without a folder has no models", help));
        };
        let inside = "keep models in the folder of the world file, or in folders within it";
        // Refused before any access to the disk, so that a world cannot even find out which files exist
        // elsewhere.
        if !is_inside(Path::new(name)) {
            let message = format!("`{name}` lies outside of the world's folder");
            return Err(source.at(leaf, message, inside));
        }
        let path = folder.join(name);
        let missing = || {
            source.at(
                leaf,
                format!("the model `{name}` does not exist"),
                siblings(path.parent().unwrap_or(folder), "vox"),
            )
        };
        let real_path = fs::canonicalize(&path).map_err(|_| missing())?;
        let real_folder = fs::canonicalize(folder).map_err(|_| missing())?;
        // A link may point outside.
        if !real_path.starts_with(&real_folder) {
            let message = format!("`{name}` is a link out of the world's folder");
            return Err(source.at(leaf, message, inside));
        }
        Ok(real_path)
    }

    fn add_model(
        &mut self,
        leaf: &Leaf,
        model: &VoxModel,
        at: IVec3,
        features: &mut Vec<FeaturePart>,
    ) -> Read<()> {
        let mut materials = BTreeMap::new();
        let lowest = model.corners().map_or(IVec3::ZERO, |(lowest, _)| lowest);
        let mut last: Option<FeaturePart> = None;
        // Sorted by axis, so that runs along z are consecutive.
        for (&voxel, &colour) in &model.voxels {
            let material = self.vox_material(leaf, model, colour, &mut materials)?;
            let voxel = IVec3::from(voxel) - lowest + at;
            match &mut last {
                Some(run) if run.material == material && run.max + IVec3::Z == voxel => {
                    run.max = voxel;
                }
                _ => features.extend(last.replace(FeaturePart {
                    min: voxel,
                    max: voxel,
                    material,
                    without_corners: false,
                })),
            }
        }
        features.extend(last);
        self.check_parts(features.len(), leaf)
    }

    /// The material of a palette colour, which `known` remembers.
    pub(super) fn vox_material(
        &mut self,
        leaf: &Leaf,
        model: &VoxModel,
        colour: u8,
        known: &mut BTreeMap<u8, u8>,
    ) -> Read<u8> {
        if let Some(&material) = known.get(&colour) {
            return Ok(material);
        }
        let material = self.model_material(leaf, &model.name, &model.data, colour)?;
        known.insert(colour, material);
        Ok(material)
    }

    /// The material of a palette colour: an existing one that looks the same, or a new one. An emissive
    /// one radiates colour · `_emit` · 10^`_flux`.
    fn model_material(
        &mut self,
        leaf: &Leaf,
        name: &str,
        data: &DotVoxData,
        index: u8,
    ) -> Read<u8> {
        let colour = data.palette.get(usize::from(index));
        let colour = colour.map_or(Vec3::ONE, |c| Vec3::from([c.r, c.g, c.b].map(linear)));
        let number = u32::from(index) + 1;
        let emits = data
            .materials
            .iter()
            .find(|material| material.id == number && material.material_type() == Some("_emit"));
        let strength = emits.map_or(0.0, |material| {
            let flux = material.radiant_flux().unwrap_or(0.0);
            material.emission().unwrap_or(0.0) * 10_f32.powf(flux)
        });
        let strength = if strength.is_finite() {
            strength.clamp(0.0, 65504.0)
        } else {
            0.0
        };
        let material_name = format!("{name} {number}");
        let flat = Colour::Flat(colour);
        let emission = colour * strength;
        let material = Material {
            sound: MaterialSound::of_look(&material_name, &flat, emission),
            name: material_name,
            a: flat.clone(),
            b: flat,
            pattern: Pattern::Plain,
            emission,
        };
        let looks_the_same = |known: &Material| {
            let Material {
                name: _,
                sound: _,
                a,
                b,
                pattern,
                emission,
            } = known;
            (a, b, pattern, emission)
                == (
                    &material.a,
                    &material.b,
                    &material.pattern,
                    &material.emission,
                )
        };
        if let Some(index) = self.materials.iter().position(looks_the_same) {
            return Ok(u8::try_from(index + 1).expect("there are at most 255 materials"));
        }
        if self.materials.len() >= MAX_MATERIALS {
            return Err(self.source.at(
                leaf,
                format!(
                    "with the colours of `{name}` there are more than {MAX_MATERIALS} materials"
                ),
                "use fewer colours in the model, or fewer materials in the world; equal colours \
                 share one",
            ));
        }
        self.materials.push(material);
        Ok(u8::try_from(self.materials.len()).expect("there are at most 255 materials"))
    }
}

/// Whether a path stays in the folder where it begins, ignoring links.
pub(super) fn is_inside(path: &Path) -> bool {
    use std::path::Component;
    path.components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}

/// From sRGB (IEC 61966-2-1) to linear.
fn linear(encoded: u8) -> f32 {
    let encoded = f32::from(encoded) / 255.0;
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

/// Parses a model whose chunks nest no deeper than the format defines, because the parser recurses.
pub(super) fn parse(bytes: &[u8]) -> Result<DotVoxData, String> {
    let word = |at: usize| {
        let bytes = bytes.get(at..at + 4)?;
        Some(u32::from_le_bytes(bytes.try_into().expect("four bytes")) as usize)
    };
    if !bytes.starts_with(b"VOX ") || bytes.get(8..12) != Some(b"MAIN") {
        return Err("it does not begin as one".into());
    }
    let cut = "it ends in the middle";
    let content = word(12).ok_or(cut)?;
    let mut at = 20_usize.checked_add(content).ok_or(cut)?;
    while at < bytes.len() {
        let (content, children) = (word(at + 4).ok_or(cut)?, word(at + 8).ok_or(cut)?);
        if children != 0 {
            return Err("its chunks nest deeper than those of any known version".into());
        }
        at += 12 + content;
    }
    if at > bytes.len() {
        return Err(cut.into());
    }
    dot_vox::load_bytes(bytes).map_err(str::to_owned)
}

/// A rotation, mirroring and translation in MagicaVoxel's space (z up).
#[derive(Clone, Copy)]
struct Pose {
    turn: Mat3,
    position: Vec3,
}

impl Pose {
    const HOME: Self = Self {
        turn: Mat3::IDENTITY,
        position: Vec3::ZERO,
    };
}

/// All voxels of the scene with their palette index, in grotto's axes (+Y up); later models override
/// earlier ones.
pub(super) fn scene_voxels(data: &DotVoxData) -> Result<BTreeMap<[i32; 3], u8>, String> {
    let mut scene = VoxScene {
        data,
        voxels: BTreeMap::new(),
        work: 0,
    };
    if data.scenes.is_empty() {
        for model in 0..data.models.len() {
            scene.add_model(model, Pose::HOME)?;
        }
    } else {
        scene.walk(0, Pose::HOME, 0)?;
    }
    Ok(scene.voxels)
}

struct VoxScene<'a> {
    data: &'a DotVoxData,
    voxels: BTreeMap<[i32; 3], u8>,
    /// Nodes and voxels visited: groups that share children could take for ever.
    work: usize,
}

impl VoxScene<'_> {
    fn spend(&mut self, work: usize) -> Result<(), String> {
        self.work += work;
        if self.work > MAX_WORK {
            return Err(format!("shows more than {MAX_WORK} voxels and nodes"));
        }
        Ok(())
    }

    fn walk(&mut self, node: u32, pose: Pose, depth: usize) -> Result<(), String> {
        self.spend(1)?;
        if depth > MAX_SCENE_DEPTH {
            return Err(format!("nests groups more than {MAX_SCENE_DEPTH} deep"));
        }
        let data = self.data;
        let hidden = |attributes: &Dict| attributes.get("_hidden").is_some_and(|v| v == "1");
        match data.scenes.get(node as usize) {
            None => Err(format!("refers to node {node}, which it does not have")),
            Some(
                SceneNode::Transform { attributes, .. }
                | SceneNode::Group { attributes, .. }
                | SceneNode::Shape { attributes, .. },
            ) if hidden(attributes) => Ok(()),
            Some(SceneNode::Transform {
                frames,
                child,
                layer_id,
                ..
            }) => {
                let layer = data.layers.get(*layer_id as usize);
                if layer.is_some_and(dot_vox::Layer::hidden) {
                    return Ok(());
                }
                let local = frames.first().map(|frame| pose_of(&frame.attributes));
                let local = local.transpose()?.unwrap_or(Pose::HOME);
                let pose = Pose {
                    turn: pose.turn * local.turn,
                    position: pose.turn * local.position + pose.position,
                };
                self.walk(*child, pose, depth + 1)
            }
            Some(SceneNode::Group { children, .. }) => children
                .iter()
                .try_for_each(|child| self.walk(*child, pose, depth + 1)),
            // Several models are frames of an animation: the first one is shown.
            Some(SceneNode::Shape { models, .. }) => match models.first() {
                Some(model) => self.add_model(model.model_id as usize, pose),
                None => Ok(()),
            },
        }
    }

    fn add_model(&mut self, model: usize, pose: Pose) -> Result<(), String> {
        let model = self.data.models.get(model);
        let model = model.ok_or("refers to a model that it does not have")?;
        self.spend(model.voxels.len())?;
        // A model rotates about the corner in its middle.
        let size = [model.size.x, model.size.y, model.size.z];
        let pivot = Vec3::from(size.map(|edge| (edge / 2) as f32));
        for voxel in &model.voxels {
            let centre = Vec3::from([voxel.x, voxel.y, voxel.z].map(f32::from)) + 0.5;
            let turned = pose.turn * (centre - pivot) + pose.position;
            let ours = Vec3::new(turned.x, turned.z, -turned.y).floor().as_ivec3();
            self.voxels.insert(ours.to_array(), voxel.i);
        }
        Ok(())
    }
}

/// Reads `_r` (a signed permutation of the axes in one byte) and `_t` of a frame.
fn pose_of(attributes: &Dict) -> Result<Pose, String> {
    let mut turn = Mat3::IDENTITY;
    if let Some(text) = attributes.get("_r") {
        let byte: u8 = text.parse().map_err(|_| format!("has a turn `{text}`"))?;
        let (first, second) = (usize::from(byte & 3), usize::from(byte >> 2 & 3));
        if first > 2 || second > 2 || first == second {
            return Err(format!("has a turn `{text}` that is none"));
        }
        let sign = |bit: u8| if byte >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let mut rows = [Vec3::ZERO; 3];
        rows[0][first] = sign(4);
        rows[1][second] = sign(5);
        rows[2][3 - first - second] = sign(6);
        turn = Mat3::from_cols(rows[0], rows[1], rows[2]).transpose();
    }
    let mut position = Vec3::ZERO;
    if let Some(text) = attributes.get("_t") {
        let numbers: Vec<i32> = text.split_whitespace().flat_map(str::parse).collect();
        let [x, y, z] = numbers[..] else {
            return Err(format!("has a place `{text}` that is none"));
        };
        // Model files reach ±1000; this keeps sums of them exact in f32.
        position = IVec3::new(x, y, z)
            .clamp(IVec3::splat(-65536), IVec3::splat(65536))
            .as_vec3();
    }
    Ok(Pose { turn, position })
}
