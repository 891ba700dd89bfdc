//! Passes and whole frames on the GPU, through the library: against closed forms, against the CPU and
//! against themselves. A software device is enough.

#[path = "../support/mod.rs"]
mod support;

mod antialias;
mod bits;
mod bodies;
mod buried;
mod cascades;
mod cell_shadows;
mod dispatch_chunks;
mod display;
mod distances;
mod edits;
mod energy;
mod face_places;
mod final_gather;
mod golden;
mod indirect;
mod kept_hits;
mod lamps;
mod light;
mod light_at_edges;
mod many_lamps;
mod marching;
mod occlusion;
mod octree;
mod placed_lamps;
mod pops;
mod probe_views;
mod probes;
mod rhythms;
mod seen_lamps;
mod soft_shadows;
mod tonemap;
mod trend;
mod upscale;
mod voxelise;
