//! Makes the renderer's inputs at build time: shader programs, the studio's meshes, the panels' texts and
//! atlas.

mod atlas;
#[path = "../src/twin/bvh.rs"]
mod bvh;
#[allow(dead_code, unreachable_pub)] // the programs and the twin use the rest
#[path = "../src/constants.rs"]
mod constants;
mod counting;
#[allow(dead_code, unreachable_pub)] // the twin uses the rest
#[path = "../src/twin/harmonics.rs"]
mod harmonics;
mod layout;
mod mesh;
mod meshes;
mod programs;
mod shared;
mod text;
mod words;

fn main() {
    let out = std::path::PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    println!("cargo::rerun-if-changed=build");
    println!("cargo::rerun-if-changed=src/constants.rs");
    println!("cargo::rerun-if-changed=src/twin/bvh.rs");
    println!("cargo::rerun-if-changed=src/twin/harmonics.rs");
    programs::write_programs(&out);
    meshes::write_meshes(&out);
    text::write_texts(&out);
}
