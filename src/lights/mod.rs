//! Lamps, sun and sky as the shaders and the reference see them. Knows no GPU.
