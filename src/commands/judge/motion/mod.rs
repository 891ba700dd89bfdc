//! `grotto judge --motion`: DDGI while lamps move, the camera sweeps and voxels change, each moment against a
//! reference of that very moment.

mod measure;
mod options;
mod plot;
mod row;
mod sweep;
mod table;

pub use self::{
    measure::{Judging, Targets},
    options::MotionOptions,
    plot::{STYLE, of_row as plot},
    row::MotionRow,
    table::{LEGEND, line, of_rows},
};
