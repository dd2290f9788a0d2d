//! Mesh files: the result is an error with a message, or a mesh that keeps its invariants and can be baked.

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use paros_core::convert::{ColumnWindings, UpAxis};
use paros_core::volume::BitGrid;
use paros_core::{Baker, RangeMaps, Volume};
use paros_shell::mesh::{COORDINATE_BOUND, MAX_TRIANGLES, Mesh, MeshFormat};
use paros_tests_files::mesh_samples::all_samples;

use crate::engine::FuzzTarget;

pub(super) const OBJ: FuzzTarget = FuzzTarget {
    name: "obj",
    seeds: || seeds(MeshFormat::Obj),
    words: &[
        b"\nv ",
        b"\nf ",
        b"\nvt ",
        b"\nvn ",
        b"\no a",
        b"\nl ",
        b"\nusemtl a",
        b"/",
        b"-1",
        b" 0 ",
        b"1e9",
        b"nan",
        b"1/1/1 2/1/1 3/1/1",
        b"1//1 2//1 3//1",
    ],
    longest: 2000,
    runs: 8000,
    run: |bytes| check(MeshFormat::Obj, bytes),
};

pub(super) const STL: FuzzTarget = FuzzTarget {
    name: "stl",
    seeds: || seeds(MeshFormat::Stl),
    words: &[
        b"solid \n",
        b"endsolid \n",
        b"facet normal 0 0 0\n",
        b"outer loop\n",
        b"vertex 1 2 3\n",
        b"endloop\n",
        b"endfacet\n",
        b"nan",
    ],
    longest: 4000,
    runs: 5000,
    run: |bytes| check(MeshFormat::Stl, bytes),
};

pub(super) const PLY: FuzzTarget = FuzzTarget {
    name: "ply",
    seeds: || seeds(MeshFormat::Ply),
    words: &[
        b"format ascii 1.0\n",
        b"format binary_little_endian 1.0\n",
        b"format binary_big_endian 1.0\n",
        b"element vertex 3\n",
        b"element face 1\n",
        b"element edge 2\n",
        b"property float x\n",
        b"property double y\n",
        b"property uchar z\n",
        b"property list uchar int vertex_indices\n",
        b"property list uint uint vertex_index\n",
        b"property list float int vertex_index\n",
        b"end_header\n",
        b"comment a\n",
    ],
    longest: 2000,
    runs: 8000,
    run: |bytes| check(MeshFormat::Ply, bytes),
};

pub(super) const GLTF: FuzzTarget = FuzzTarget {
    name: "gltf",
    seeds: || seeds(MeshFormat::Gltf),
    words: &[
        b"\"mode\":5,",
        b"\"mode\":6,",
        b"\"byteStride\":4,",
        b"\"byteOffset\":1,",
        b"\"count\":3",
        b"\"componentType\":5121",
        b"\"componentType\":5125",
        b"\"type\":\"SCALAR\"",
        b"{\"mesh\":0}",
        b"\"children\":[1],",
        b"\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],",
        b"\"scale\":[1,-1,1],",
        b"\"sparse\":{\"count\":1},",
        b"{\"attributes\":{\"POSITION\":0}}",
        b"\"uri\":\"data:;base64,AAAA\",",
        b",",
        b"[]",
        b"null",
    ],
    longest: 3000,
    runs: 8000,
    run: |bytes| check(MeshFormat::Gltf, bytes),
};

/// Returns the sample files of a format.
fn seeds(format: MeshFormat) -> Vec<Vec<u8>> {
    let samples = all_samples().into_iter().filter(|(_, kind, _)| *kind == format);
    samples.map(|(_, _, bytes)| bytes).collect()
}

fn check(format: MeshFormat, bytes: &[u8]) -> String {
    let mesh = match Mesh::from_bytes(format, bytes, Path::new("nowhere")) {
        Ok(mesh) => mesh,
        Err(fault) => {
            let said = fault.to_string();
            assert!(!said.is_empty());
            return said;
        }
    };
    let vertices = mesh.positions.len() as u32;
    assert!((1..=MAX_TRIANGLES).contains(&mesh.triangles.len()));
    assert!(mesh.triangles.as_flattened().iter().all(|&i| i < vertices));
    assert!(mesh.positions.as_flattened().iter().all(|c| f64::from(c.abs()) <= COORDINATE_BOUND));
    if mesh.triangles.len() > 5000 {
        return "a mesh too large to bake here".into();
    }
    bake(&mesh)
}

const SIDE: usize = 16;

struct BakeBuffers {
    baker: Baker<SIDE, ColumnWindings<SIDE>>,
    maps: RangeMaps<SIDE, 2>,
    grid: BitGrid<SIDE>,
    volume: Volume<SIDE, 2>,
}

fn bake(mesh: &Mesh) -> String {
    static BUFFERS: Mutex<BakeBuffers> = Mutex::new(BakeBuffers {
        baker: Baker::new(),
        maps: RangeMaps::new(),
        grid: BitGrid::new(),
        volume: Volume::new(),
    });
    let mut buffers = BUFFERS.lock().unwrap_or_else(PoisonError::into_inner);
    let BakeBuffers { baker, maps, grid, volume } = &mut *buffers;
    let Some(_) = mesh.bake_into_maps(UpAxis::Y, baker, maps, grid) else {
        return "a mesh without extent".into();
    };
    volume.set_maps(maps);
    assert!(volume.are_ranges_tight() && volume.is_saturated());
    let kind = if volume.count_voxels() == 0 { "no voxels" } else { "some voxels" };
    format!("baked to {kind}")
}
