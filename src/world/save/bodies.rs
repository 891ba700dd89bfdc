//! The section of bodies in a save.
//!
//! Number of placed bodies (u32). Each has its name, its corner, its size (three u8) and a material for each voxel, x
//! first. Then the number of bodies of the world file that were pushed (u32), each with its name and its place. A name is
//! a length (u32) and UTF-8, a place three f32.

use std::sync::Arc;

use glam::{UVec3, Vec3};

use super::format::{Cursor, Fault, damaged};
use crate::world::bodies::{BodyModel, ChangedBodies, MovedBody, PlacedBody};

pub fn encode(bodies: &ChangedBodies) -> Vec<u8> {
    let mut bytes = (bodies.placed.len() as u32).to_le_bytes().to_vec();
    for body in &bodies.placed {
        put(&mut bytes, &body.name, body.corner);
        bytes.extend(body.model.size.to_array().map(|edge| edge as u8));
        bytes.extend(&body.model.materials);
    }
    bytes.extend((bodies.moved.len() as u32).to_le_bytes());
    for body in &bodies.moved {
        put(&mut bytes, &body.name, body.position);
    }
    bytes
}

/// Whoever decodes the rest of a save asks whether they are possible.
pub fn decode(bytes: &[u8]) -> Result<ChangedBodies, Fault> {
    let mut rest = Cursor(bytes);
    let mut bodies = ChangedBodies::default();
    for _ in 0..rest.u32()? {
        let (name, corner) = named_place(&mut rest)?;
        let size = UVec3::from(rest.array::<3>()?.map(u32::from));
        let materials = rest.take(size.element_product() as usize)?.to_vec();
        bodies.placed.push(PlacedBody {
            name,
            model: Arc::new(BodyModel { size, materials }),
            corner,
        });
    }
    for _ in 0..rest.u32()? {
        let (name, position) = named_place(&mut rest)?;
        bodies.moved.push(MovedBody { name, position });
    }
    if !rest.0.is_empty() {
        return Err(damaged("its bodies go on after their end"));
    }
    Ok(bodies)
}

fn put(bytes: &mut Vec<u8>, name: &str, place: Vec3) {
    bytes.extend((name.len() as u32).to_le_bytes());
    bytes.extend(name.as_bytes());
    for axis in place.to_array() {
        bytes.extend(axis.to_le_bytes());
    }
}

fn named_place(rest: &mut Cursor<'_>) -> Result<(String, Vec3), Fault> {
    let length = rest.u32()? as usize;
    let name = String::from_utf8(rest.take(length)?.to_vec());
    let name = name.map_err(|_| damaged("the name of a body is no text"))?;
    let axes = [rest.array()?, rest.array()?, rest.array()?];
    Ok((name, axes.map(f32::from_le_bytes).into()))
}
