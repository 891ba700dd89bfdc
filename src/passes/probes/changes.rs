//! What pass `probes/blend` is told of changes.

use bytemuck::{Pod, Zeroable};

use crate::{
    parameters::ProbeParameters,
    probes::changes::{Changes, EDITS},
};

/// Share of its unrest that a probe keeps per update after a change: late bounces come in while it fades.
const UNREST_KEPT: f32 = 0.9;

/// `Changes` of `shaders/probes/changes.wesl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GpuChanges {
    pub alert: f32,
    pub deviations: f32,
    pub unrest_kept: f32,
    pub frame: u32,
    pub edit_count: u32,
    pub _pad: [u32; 3],
    pub edits: [GpuEditSphere; EDITS],
}

/// `EditSphere` of `shaders/probes/changes.wesl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GpuEditSphere {
    pub centre_ws: [f32; 3],
    pub radius: f32,
    pub frame: u32,
    pub _pad: [u32; 3],
}

impl GpuChanges {
    pub fn new(changes: &Changes, parameters: &ProbeParameters, frame: u32) -> Self {
        let mut edits = [GpuEditSphere::default(); EDITS];
        for (out, edit) in edits.iter_mut().zip(changes.edits()) {
            *out = GpuEditSphere {
                centre_ws: edit.centre_ws.to_array(),
                radius: edit.radius,
                frame: edit.frame,
                ..GpuEditSphere::default()
            };
        }
        Self {
            alert: changes.alert(),
            deviations: parameters.change_deviations,
            unrest_kept: UNREST_KEPT,
            frame,
            edit_count: changes.edits().len() as u32,
            edits,
            ..Self::default()
        }
    }
}
