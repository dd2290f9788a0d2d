//! Writer of GLB (glTF 2.0, binary) for viewers: vertices are shared and have normals; units are metres, with
//! y up.

use std::fmt::Write as _;

use crate::models::threemf::read_stl;

/// "glTF", "JSON" and "BIN\0", as little-endian words.
const MAGIC: u32 = 0x4654_6C67;
const JSON: u32 = 0x4E4F_534A;
const BINARY: u32 = 0x004E_4942;

/// Metres in a millimetre.
const METRES: f32 = 1e-3;

/// Converts a binary STL in millimetres with z up to GLB.
///
/// # Errors
/// A description of what is wrong with the STL; for example, it has no triangles.
pub(crate) fn write_glb(stl: &[u8]) -> Result<Vec<u8>, String> {
    let (corners, triangles) = read_stl(stl)?;
    if triangles.is_empty() {
        return Err("a mesh without triangles".into());
    }
    // The STL's x, y and z become x, -z and y.
    let corners: Vec<[f32; 3]> =
        corners.iter().map(|[x, y, z]| [x * METRES, z * METRES, -y * METRES]).collect();
    let normals = find_smooth_normals(&corners, &triangles);
    let mut head = write_head(&corners, triangles.len());
    while !head.len().is_multiple_of(4) {
        head.push(' ');
    }
    let binary = 24 * corners.len() + 12 * triangles.len();
    let length = 12 + 8 + head.len() + 8 + binary;
    let mut glb = Vec::with_capacity(length);
    let word = |number: usize| u32::try_from(number).map_err(|_| "a mesh of over 4 GB");
    for number in [MAGIC, 2, word(length)?, word(head.len())?, JSON] {
        glb.extend(number.to_le_bytes());
    }
    glb.extend(head.into_bytes());
    for number in [word(binary)?, BINARY] {
        glb.extend(number.to_le_bytes());
    }
    for place in corners.iter().chain(&normals).flatten() {
        glb.extend(place.to_le_bytes());
    }
    for number in triangles.iter().flatten() {
        glb.extend(number.to_le_bytes());
    }
    Ok(glb)
}

/// The number of smoothing passes over the normals. The mesh has a vertex for each voxel face, so that slopes
/// are steps one voxel high. This many passes smooth steps up to six voxels wide.
const SMOOTHINGS: usize = 12;

/// Computes smooth normals: repeatedly averages the normals of neighbouring vertices, so that voxel steps
/// don't show. Neighbours with another direction have less weight, which keeps edges sharp.
fn find_smooth_normals(corners: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let mut normals = find_normals(corners, triangles);
    for _ in 0..SMOOTHINGS {
        let mut sums = normals.clone();
        for [a, b, c] in triangles {
            // Each edge belongs to two triangles, once in each direction.
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let (from, to) = (*from as usize, *to as usize);
                let (one, other) = (normals[from], normals[to]);
                let alike: f32 = (0..3).map(|k| one[k] * other[k]).sum();
                let weight = alike.max(0.0).powi(2);
                sums[from] = [0, 1, 2].map(|k| sums[from][k] + weight * other[k]);
            }
        }
        normals = sums;
        normals.iter_mut().for_each(normalise);
    }
    normals
}

/// Scales a normal to length 1.
fn normalise(normal: &mut [f32; 3]) {
    let length = normal.iter().map(|place| place * place).sum::<f32>().sqrt();
    // A vertex without triangles, or whose triangles cancel out, gets a normal that points up, as glTF
    // requires length 1.
    *normal = match length > 0.0 && length.is_finite() {
        true => normal.map(|place| place / length),
        false => [0.0, 1.0, 0.0],
    };
}

/// Computes the normal of each vertex: the area-weighted mean of its triangles' normals.
fn find_normals(corners: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let mut sums = vec![[0.0f32; 3]; corners.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|number| corners[number as usize]);
        let (u, v) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
        let normal =
            [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        for number in triangle {
            let sum = &mut sums[*number as usize];
            *sum = [0, 1, 2].map(|k| sum[k] + normal[k]);
        }
    }
    sums.iter_mut().for_each(normalise);
    sums
}

fn write_head(corners: &[[f32; 3]], triangles: usize) -> String {
    let bound = |k: usize, pick: fn(f32, f32) -> f32, from: f32| {
        corners.iter().fold(from, |bound, corner| pick(bound, corner[k]))
    };
    let least = [0, 1, 2].map(|k| bound(k, f32::min, f32::INFINITY));
    let most = [0, 1, 2].map(|k| bound(k, f32::max, f32::NEG_INFINITY));
    let (count, numbers) = (corners.len(), 3 * triangles);
    let (of_corners, of_numbers) = (12 * count, 4 * numbers);
    let mut head = String::from(
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"Paros\"},\"scene\":0,\
         \"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"name\":\"sculpture\"}],\
         \"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.69,0.62,0.51,1],\
         \"metallicFactor\":0,\"roughnessFactor\":0.85}}],\"meshes\":[{\"primitives\":[{\
         \"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"indices\":2,\"material\":0}]}],",
    );
    // Writing to a String doesn't fail.
    let _ = write!(
        head,
        "\"buffers\":[{{\"byteLength\":{}}}],\"bufferViews\":[\
         {{\"buffer\":0,\"byteOffset\":0,\"byteLength\":{of_corners},\"target\":34962}},\
         {{\"buffer\":0,\"byteOffset\":{of_corners},\"byteLength\":{of_corners},\"target\":34962}},\
         {{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{of_numbers},\"target\":34963}}],\
         \"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":{count},\"type\":\"VEC3\",\
         \"min\":{least:?},\"max\":{most:?}}},\
         {{\"bufferView\":1,\"componentType\":5126,\"count\":{count},\"type\":\"VEC3\"}},\
         {{\"bufferView\":2,\"componentType\":5125,\"count\":{numbers},\"type\":\"SCALAR\"}}]}}",
        2 * of_corners + of_numbers,
        2 * of_corners,
    );
    head
}

#[cfg(test)]
mod tests {
    use super::{find_normals, find_smooth_normals, write_glb};

    fn stl_of(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut stl = vec![0; 84];
        for triangle in triangles {
            stl.extend([0; 12]);
            stl.extend(triangle.iter().flatten().flat_map(|place| place.to_le_bytes()));
            stl.extend([0; 2]);
        }
        stl
    }

    /// A tetrahedron, 100 mm along each axis.
    fn tetrahedron() -> Vec<[[f32; 3]; 3]> {
        let corners = [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0], [0.0, 0.0, 100.0]];
        [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|of| of.map(|k: usize| corners[k])).into()
    }

    #[test]
    fn each_triangle_is_read_back_with_normals_that_look_outwards() {
        let triangles = tetrahedron();
        let glb = write_glb(&stl_of(&triangles)).expect("a mesh");
        let read = gltf::Gltf::from_slice(&glb).expect("valid by the specification");
        let blob = read.blob.clone().expect("its bytes");
        let primitive = read.meshes().next().and_then(|mesh| mesh.primitives().next());
        let primitive = primitive.expect("a mesh");
        let accessor = |semantic| primitive.get(&semantic).expect("it is there");
        let floats = |accessor: gltf::Accessor<'_>| -> Vec<[f32; 3]> {
            let start = accessor.view().expect("a view").offset();
            let bytes = &blob[start..][..12 * accessor.count()];
            let places: Vec<f32> = bytes
                .chunks_exact(4)
                .map(|four| f32::from_le_bytes(four.try_into().unwrap()))
                .collect();
            places.chunks_exact(3).map(|three| three.try_into().unwrap()).collect()
        };
        let corners = floats(accessor(gltf::Semantic::Positions));
        let normals = floats(accessor(gltf::Semantic::Normals));
        assert_eq!((corners.len(), normals.len()), (4, 4), "each once");
        let indices = primitive.indices().expect("numbers");
        let start = indices.view().expect("a view").offset();
        assert_eq!(blob.len(), start + 4 * indices.count());
        let numbers: Vec<usize> = blob[start..]
            .chunks_exact(4)
            .map(|four| u32::from_le_bytes(four.try_into().unwrap()) as usize)
            .collect();
        let turned = |[x, y, z]: [f32; 3]| [x * 1e-3, z * 1e-3, -y * 1e-3];
        for (three, triangle) in numbers.chunks_exact(3).zip(&triangles) {
            let read = [0, 1, 2].map(|k| corners[three[k]]);
            assert_eq!(read, triangle.map(turned));
        }
        assert_eq!(numbers.len(), 12);
        let middle = [0.025, 0.025, -0.025];
        for (corner, normal) in corners.iter().zip(&normals) {
            let out: f32 = (0..3).map(|k| (corner[k] - middle[k]) * normal[k]).sum();
            let length: f32 = normal.iter().map(|place| place * place).sum();
            assert!(out > 0.0 && (length - 1.0).abs() < 1e-5, "{corner:?} {normal:?}");
        }
        let bounds = primitive.bounding_box();
        assert_eq!((bounds.min, bounds.max), ([0.0, 0.0, -0.1], [0.1, 0.1, 0.0]));
    }

    /// A slope of a quarter is made of steps a voxel high and four wide.
    #[test]
    fn steps_of_voxels_look_like_the_slope_that_they_are() {
        const SIDE: usize = 48;
        let at = |x: usize, y: usize| (x + SIDE * y) as u32;
        let places = (0..SIDE * SIDE).map(|k| (k % SIDE, k / SIDE));
        let corners: Vec<[f32; 3]> =
            places.clone().map(|(x, y)| [x as f32, y as f32, (x / 4) as f32]).collect();
        let squares = places.filter(|(x, y)| x + 1 < SIDE && y + 1 < SIDE);
        let triangles: Vec<[u32; 3]> = squares
            .flat_map(|(x, y)| {
                let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let slope = [-1.0 / 17f32.sqrt(), 0.0, 4.0 / 17f32.sqrt()];
        let furthest = |normals: &[[f32; 3]]| {
            let inner = (SIDE / 3..SIDE / 2).map(|x| normals[at(x, SIDE / 2) as usize]);
            let cosines = inner.map(|normal| (0..3).map(|k| normal[k] * slope[k]).sum::<f32>());
            cosines.fold(1.0, f32::min).acos().to_degrees()
        };
        let (rough, smooth) =
            (find_normals(&corners, &triangles), find_smooth_normals(&corners, &triangles));
        assert!(furthest(&rough) > 10.0, "{}", furthest(&rough));
        assert!(furthest(&smooth) < 3.0, "{}", furthest(&smooth));
    }

    #[test]
    fn what_is_no_mesh_is_refused() {
        assert!(write_glb(&stl_of(&[])).is_err());
        assert!(write_glb(&stl_of(&[[[1.0; 3], [1.0; 3], [2.0; 3]]])).is_err(), "without an area");
        assert!(write_glb(&stl_of(&[[[f32::INFINITY; 3], [1.0; 3], [2.0; 3]]])).is_err());
        assert!(write_glb(&[0; 83]).is_err());
    }
}
