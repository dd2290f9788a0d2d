//! Makes what the renderer needs at build time: shader programs and the studio's meshes.

mod meshes;
mod programs;
mod words;

fn main() {
    let out = std::path::PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    println!("cargo::rerun-if-changed=build");
    programs::write(&out);
    meshes::write(&out);
}
