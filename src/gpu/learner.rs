//! Times passes for their [`ChunkTime`] alone, in frames whose passes are not timed one by one.

use std::sync::Arc;

use super::{Gpu, dispatch_chunks::ChunkTime};

/// Most passes of one submission that are timed this way.
const MOST_PASSES: u32 = 64;

/// Timestamps of the passes of one submission.
pub(super) struct Learner {
    stamps: wgpu::QuerySet,
    /// For each pair of timestamps: the chunk time that learns from it, and the workgroups between
    /// them.
    learning: Vec<(Arc<ChunkTime>, u32)>,
}

impl Learner {
    /// `None` if the adapter has no timestamps.
    pub(super) fn new(device: &wgpu::Device) -> Option<Self> {
        if !device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        let stamps = device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("chunk_time"),
            ty: wgpu::QueryType::Timestamp,
            count: 2 * MOST_PASSES,
        });
        Some(Self {
            stamps,
            learning: Vec::new(),
        })
    }

    /// The timestamp writes with which a compute pass of `groups` workgroups begins; `None` if no room
    /// is left.
    pub(super) fn stamps(
        &mut self,
        chunk_time: &Arc<ChunkTime>,
        groups: u32,
    ) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let first = 2 * self.learning.len() as u32;
        if first >= 2 * MOST_PASSES {
            return None;
        }
        self.learning.push((chunk_time.clone(), groups));
        Some(wgpu::ComputePassTimestampWrites {
            query_set: &self.stamps,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        })
    }

    /// Submits `encoder`; the chunk times learn when the work is done and the device is polled.
    pub(super) fn submit(
        self,
        gpu: &Gpu,
        mut encoder: wgpu::CommandEncoder,
    ) -> wgpu::SubmissionIndex {
        if self.learning.is_empty() {
            return gpu.queue.submit([encoder.finish()]);
        }
        let count = 2 * self.learning.len() as u32;
        let bytes = u64::from(count) * u64::from(wgpu::QUERY_SIZE);
        let buffer = |label, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes,
                usage,
                mapped_at_creation: false,
            })
        };
        let resolved = buffer(
            "chunk_time_resolved",
            wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
        );
        let read = buffer(
            "chunk_time_read",
            wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        );
        encoder.resolve_query_set(&self.stamps, 0..count, &resolved, 0);
        encoder.copy_buffer_to_buffer(&resolved, 0, &read, 0, bytes);
        let index = gpu.queue.submit([encoder.finish()]);
        let period_ms = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
        let (mapped, learning) = (read.clone(), self.learning);
        read.map_async(wgpu::MapMode::Read, .., move |result| {
            if result.is_err() {
                return;
            }
            let Ok(view) = mapped.get_mapped_range(..) else {
                return;
            };
            let pairs = view.chunks_exact(2 * wgpu::QUERY_SIZE as usize);
            for ((chunk_time, groups), pair) in learning.iter().zip(pairs) {
                let [begun, ended]: [u64; 2] = bytemuck::pod_read_unaligned(pair);
                let ticks = ended.saturating_sub(begun);
                chunk_time.learn(*groups, ticks as f64 * period_ms);
            }
        });
        index
    }
}
