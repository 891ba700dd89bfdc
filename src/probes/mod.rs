//! Probe layouts, octahedral maps, states. Knows no GPU.
