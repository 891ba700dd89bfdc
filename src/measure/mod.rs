//! Pictures and statistics. Knows no world.
