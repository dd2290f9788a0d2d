#![no_std]
#![forbid(unsafe_code)]
pub mod maps;
pub mod plane;
pub mod row;
pub mod size;
