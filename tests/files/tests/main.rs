//! Tests of reading and writing files. All are one binary, so that the core is instantiated only once.

mod bake_meshes;
mod bared_figures;
mod demo;
mod figures;
mod hidden_starts;
mod mesh_dialects;
mod mesh_gltf;
mod mesh_limits;
mod mesh_readers;
mod mesh_shells;
mod naive_hand;
mod placement;
mod print;
mod restless;
mod rmap;
mod rmap_layers;
mod trace;
mod trace_layers;
mod visitors;
