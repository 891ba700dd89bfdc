//! The worlds that come with grotto, judged by their voxels on the CPU.

mod cave;
mod proving;
