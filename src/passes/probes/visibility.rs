//! Pass `probes/visibility`: which of the surfaces around it each probe sees, and where its back-side probe is. Runs
//! after pass `probes/classify`.

use super::ProbeField;
use crate::{
    gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle},
    probes::{Layout as _, VisibilityBits},
};

crate::shared! {
    in probes;

    /// A lattice point whose probe looks around in this frame.
    pub struct GpuSight as Sight {
        pub slot: u32,
        /// 1: none of its bits is known, because it is new or has moved.
        pub begins_again: u32,
        /// 1: it has a back-side probe.
        pub has_back_side: u32,
        /// 1: the back-side probe was elsewhere before, or nowhere.
        pub back_side_begins_again: u32,
    }
}

/// A count, and what is listed.
const fn list_bytes(item: usize, slots: u32) -> u64 {
    4 + item as u64 * slots as u64
}

/// Bytes of what the workgroups of a probe have seen together: three counts.
const SEEN_BYTES: usize = 12;
/// Words of bits for each workgroup of a probe: boxes of up to 20³ voxels have one workgroup, the largest eight.
const WORDS_A_SHARE: u32 = 192;
const MOST_SHARES: u32 = 8;

pub struct ProbeVisibility {
    list: (Kernel, Bindings),
    arguments: (Kernel, Bindings),
    look: (Kernel, Bindings),
    choose: (Kernel, Bindings),
    look_back: (Kernel, Bindings),
    has_back_side: bool,
    /// Workgroups of one thread per lattice point.
    slot_groups: [u32; 2],
    /// The most that look around.
    look_groups: [u32; 2],
    dispatch: wgpu::Buffer,
    /// Of GPU memory.
    bytes: u64,
}

impl ProbeVisibility {
    /// `resources` are those of the voxels.
    ///
    /// # Errors
    /// [`GpuError::Shader`]; [`GpuError::TooLarge`].
    pub fn new(
        gpu: &Gpu,
        field: &ProbeField,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, GpuError> {
        let shares = if gpu.summary.is_software() {
            1
        } else {
            field.visibility_bits().map_or(1, shares_of)
        };
        Self::with_shares(gpu, field, resources, shares)
    }

    /// The same with so many workgroups for each probe: what it sees does not depend on them.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_shares(
        gpu: &Gpu,
        field: &ProbeField,
        resources: &[(&str, wgpu::BindingResource<'_>)],
        shares: u32,
    ) -> Result<Self, GpuError> {
        let bits = field.visibility_bits();
        let slots = bits.map_or(1, |_| field.volume().slots());
        let look_groups = rectangle(slots * shares);
        let spec = KernelSpec {
            shader: "probes/visibility",
            offered: &[
                field.layout_constants()[0],
                // On a CPU the first threads of a workgroup take all rows before the others begin.
                ("THREADS", f64::from(gpu.threads(1024, 8))),
                ("SHARES", f64::from(shares)),
            ],
            ..Default::default()
        };
        let entries = ["list", "arguments", "look", "choose", "look_back"];
        let kernels = Kernel::of_entries(gpu, &spec, entries)?;
        let sights = gpu.storage_buffer("sights", list_bytes(size_of::<GpuSight>(), slots))?;
        let seen = gpu.storage_buffer("seen_list", list_bytes(SEEN_BYTES, slots))?;
        let dispatch = gpu.storage_buffer_of("sight_dispatch", &[0, look_groups[1], 1])?;
        let mut all = resources.to_vec();
        all.extend(field.state_resources());
        all.extend([
            // One buffer: written by two steps, read by the others.
            ("sights", sights.as_entire_binding()),
            ("sights_out", sights.as_entire_binding()),
            ("seen_list", seen.as_entire_binding()),
            ("sight_dispatch", dispatch.as_entire_binding()),
        ]);
        let [list, arguments, look, choose, look_back] = kernels.map(|kernel| {
            let bindings = kernel.bind(gpu, &all);
            (kernel, bindings)
        });
        let slot_groups = rectangle(slots.div_ceil(list.0.workgroup_size[0]));
        Ok(Self {
            list,
            arguments,
            look,
            choose,
            look_back,
            has_back_side: bits.is_some_and(VisibilityBits::back_side),
            slot_groups,
            look_groups,
            bytes: sights.size() + seen.size() + dispatch.size(),
            dispatch,
        })
    }

    /// After pass `probes/classify`, before pass `probes/trace`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        self.record_look(recorder);
        self.record_look_back(recorder);
    }

    /// The first part of [`record`](Self::record): what probes see.
    pub fn record_look(&self, recorder: &mut Recorder<'_>) {
        let (list, arguments) = (&self.list, &self.arguments);
        recorder.run(&list.0, &list.1, self.slot_groups);
        recorder.compute(&arguments.0.label, |pass| {
            arguments.0.dispatch(pass, &arguments.1, [1, 1, 1]);
        });
        self.run_listed(recorder, &self.look);
    }

    /// The second part of [`record`](Self::record): where back-side probes are, and what they see.
    pub fn record_look_back(&self, recorder: &mut Recorder<'_>) {
        let (kernel, bindings) = &self.choose;
        recorder.run(kernel, bindings, self.slot_groups);
        if self.has_back_side {
            self.run_listed(recorder, &self.look_back);
        }
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    fn run_listed(&self, recorder: &mut Recorder<'_>, (kernel, bindings): &(Kernel, Bindings)) {
        let groups = (&self.dispatch, 0);
        recorder.run_indirect(kernel, bindings, self.look_groups, groups);
    }
}

/// Workgroups for each probe. An edit touches few probes, and where boxes are large each of them would take long.
fn shares_of(bits: &VisibilityBits) -> u32 {
    let words = bits.boxes().iter().map(|seen| seen.words()).max();
    (words.unwrap_or(0) / WORDS_A_SHARE).clamp(1, MOST_SHARES)
}
