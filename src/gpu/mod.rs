//! Device, shader composition, kernels, timing. Knows no world.
