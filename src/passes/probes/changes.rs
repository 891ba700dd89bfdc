//! What passes `probes/blend` and `probes/blend_distances` know of changes.

use crate::{
    parameters::ProbeParameters,
    probes::changes::{Changes, EDITS},
};

/// Share of its variability that a probe keeps per update after a change. Late bounces arrive while the variability
/// fades.
const VARIABILITY_KEPT: f32 = 0.9;

crate::shared! {
    in probes;

    /// What changes in the world, and how probes respond.
    pub struct GpuChanges as Changes {
        /// Certainty that light changes now: 0 to 1.
        pub alert: f32,
        /// Standard deviations of a probe's own noise beyond which its light counts as changed.
        pub deviations: f32,
        /// Share of its variability that a probe keeps per update.
        pub variability_kept: f32,
        pub frame: u32,
        pub edit_count: u32,
        /// Certainty that light has not changed for long, 0 to 1.
        pub stillness: f32,
        /// The last frame in which a body came, went or jumped.
        pub bodies_jumped: u32,
        pub _pad: u32,
        pub edits: [GpuEditSphere; EDITS],
    }

    /// Where voxels have changed.
    pub struct GpuEditSphere as EditSphere {
        pub centre_ws: [f32; 3],
        pub radius: f32,
        /// Number of the first frame that measures distances after the edit.
        pub frame: u32,
        pub _pad: [u32; 3],
    }
}

impl GpuChanges {
    /// `repeats`: probes repeat their rays ([`crate::probes::repeats`]), so they need not be told of changes.
    pub fn new(changes: &Changes, parameters: &ProbeParameters, repeats: bool, frame: u32) -> Self {
        let mut edits = [GpuEditSphere::default(); EDITS];
        for (out, edit) in edits.iter_mut().zip(changes.edits()) {
            *out = GpuEditSphere {
                centre_ws: edit.centre_ws.to_array(),
                radius: edit.radius,
                frame: if repeats {
                    edit.measured_from
                } else {
                    edit.frame
                },
                ..GpuEditSphere::default()
            };
        }
        Self {
            alert: if repeats { 0.0 } else { changes.alert() },
            stillness: changes.stillness(),
            deviations: parameters.change_deviations,
            variability_kept: VARIABILITY_KEPT,
            frame,
            bodies_jumped: changes.bodies_jumped(),
            edit_count: changes.edits().len() as u32,
            edits,
            ..Self::default()
        }
    }
}
