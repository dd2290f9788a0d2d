//! glTF 2.0: the triangles of the default scene, each under the transform of its node.
//!
//! The reader uses positions, indices, skins and node transforms. It ignores everything else, including
//! extensions that don't change geometry, even if the file requires them.

mod accessor;
mod container;
mod matrix;
mod skin;

use super::builder::{MeshBuilder, VertexIndex};
use super::{Mesh, MeshFault, malformed};
use accessor::{Accessor, describe_compression, find_compression, number};
use container::{Buffers, Parts};
use matrix::{IDENTITY, Matrix};
use serde_json::Value;
use skin::Skins;
use std::path::Path;

pub(super) fn parse(bytes: &[u8], folder: &Path) -> Result<Mesh, MeshFault> {
    let Parts { json, binary } = container::split(bytes)?;
    check_version(&json["asset"])?;
    let mut scene = Scene {
        json: &json,
        buffers: Buffers::new(&json, binary, folder),
        skins: Skins::new(&json),
        builder: MeshBuilder::default(),
    };
    scene.add_scene()?;
    scene.builder.finish()
}

/// Checks the version. Minor versions add only optional features, unless a file requires a minimum version.
fn check_version(asset: &Value) -> Result<(), String> {
    let version = asset["version"].as_str().unwrap_or("");
    if version.split('.').next() != Some("2") {
        return Err(format!("`asset.version` is {version:?}; expected \"2.0\""));
    }
    match asset["minVersion"].as_str() {
        None | Some("2.0") => Ok(()),
        Some(least) => Err(format!("`asset.minVersion` is {least:?}; expected at most \"2.0\"")),
    }
}

/// Returns the elements of an array; an empty slice for any other value.
fn items(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

struct Scene<'a> {
    json: &'a Value,
    buffers: Buffers<'a>,
    skins: Skins<'a>,
    builder: MeshBuilder,
}

/// The transform of a primitive: one for all vertices, or a skin.
#[derive(Clone, Copy)]
enum Placement<'a> {
    Rigid(&'a Matrix),
    /// The transforms of a skin's joints.
    Skinned(&'a [Matrix]),
}

impl Scene<'_> {
    /// Adds the default scene, or else the first one. For a file without scenes adds all trees of nodes or,
    /// without nodes, all meshes.
    fn add_scene(&mut self) -> Result<(), MeshFault> {
        let json = self.json;
        let scenes = items(&json["scenes"]);
        let default = number(&json["scene"]).and_then(|index| scenes.get(index));
        let roots: Vec<usize> = match default.or_else(|| scenes.first()) {
            Some(scene) => items(&scene["nodes"]).iter().filter_map(number).collect(),
            None => self.skins.nodes.roots(),
        };
        if scenes.is_empty() && roots.is_empty() {
            let mut meshes = items(&json["meshes"]).iter().enumerate();
            return meshes.try_for_each(|(index, mesh)| {
                let added = self.add_mesh(mesh, &Value::Null, None, &[IDENTITY]);
                added.map_err(|fault| fault.at(|| format!("mesh {index}")))
            });
        }
        for index in self.skins.nodes.list_subtrees(roots)? {
            let added = self.add_node(index);
            added.map_err(|fault| fault.at(|| format!("node {index}")))?;
        }
        Ok(())
    }

    fn add_node(&mut self, index: usize) -> Result<(), MeshFault> {
        let json = self.json;
        let node = &json["nodes"][index];
        if node["mesh"].is_null() {
            return Ok(());
        }
        let mesh = accessor::find(json, "meshes", &node["mesh"])?;
        let skin = match number(&node["skin"]) {
            Some(skin) => Some(self.skins.joint_matrices(skin, &mut self.buffers)?),
            None => None,
        };
        let world_from_node = self.skins.nodes.world_from_node(index);
        let instances = skin::instances(json, node, &mut self.buffers, &world_from_node)?;
        self.add_mesh(mesh, &node["weights"], skin.as_deref().map(Vec::as_slice), &instances)
    }

    /// Adds a mesh once for each instance.
    fn add_mesh(
        &mut self,
        mesh: &Value,
        node_weights: &Value,
        joints: Option<&[Matrix]>,
        instances: &[Matrix],
    ) -> Result<(), MeshFault> {
        let weights = if node_weights.is_null() { &mesh["weights"] } else { node_weights };
        let weights: Vec<f64> =
            items(weights).iter().map(|weight| weight.as_f64().unwrap_or(0.0)).collect();
        for (index, primitive) in items(&mesh["primitives"]).iter().enumerate() {
            let added = self.add_primitive(primitive, &weights, joints, instances);
            added.map_err(|fault| fault.at(|| format!("primitive {index}")))?;
        }
        Ok(())
    }

    fn add_primitive(
        &mut self,
        primitive: &Value,
        weights: &[f64],
        joints: Option<&[Matrix]>,
        instances: &[Matrix],
    ) -> Result<(), MeshFault> {
        let Some(mode) = Mode::of(primitive) else { return Ok(()) };
        let attributes = &primitive["attributes"];
        if attributes["POSITION"].is_null() {
            return Ok(());
        }
        let json = self.json;
        let positions = &json["accessors"][number(&attributes["POSITION"]).unwrap_or(usize::MAX)];
        if let Some(name) = find_compression(primitive)
            && positions["bufferView"].is_null()
        {
            return malformed(describe_compression(name));
        }
        skin::load_primitive(json, &mut self.buffers, primitive)?;
        let geometry = Geometry::find(json, &self.buffers, primitive, weights, joints.is_some())?;
        let triangles = mode.count_triangles(geometry.corner_count());
        if triangles == 0 {
            return Ok(());
        }
        // Primitives and nodes may share an accessor, so the file's length doesn't bound the number of
        // triangles.
        self.builder.check_room(triangles.saturating_mul(instances.len()))?;
        for instance in instances {
            let placement = match joints {
                Some(joints) if geometry.skin.is_some() => Placement::Skinned(joints),
                _ => Placement::Rigid(instance),
            };
            for triangle in 0..triangles {
                let [a, b, c] = mode.corners_of(triangle).map(|corner| geometry.index_of(corner));
                let (first, is_mirrored) = geometry.place(a?, placement, &mut self.builder);
                let (second, _) = geometry.place(b?, placement, &mut self.builder);
                let (third, _) = geometry.place(c?, placement, &mut self.builder);
                let triangle =
                    if is_mirrored { [first, third, second] } else { [first, second, third] };
                self.builder.add_triangle(triangle)?;
            }
        }
        Ok(())
    }
}

/// The topology of a primitive's triangles.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Mode {
    Triangles,
    Strip,
    Fan,
}

impl Mode {
    /// Returns the mode of a primitive; `None` for points and lines.
    fn of(primitive: &Value) -> Option<Self> {
        match &primitive["mode"] {
            Value::Null => Some(Mode::Triangles),
            mode => match number(mode) {
                Some(4) => Some(Mode::Triangles),
                Some(5) => Some(Mode::Strip),
                Some(6) => Some(Mode::Fan),
                _ => None,
            },
        }
    }

    fn count_triangles(self, corners: usize) -> usize {
        if self == Mode::Triangles { corners / 3 } else { corners.saturating_sub(2) }
    }

    /// Returns the corners of a triangle, by its number.
    fn corners_of(self, triangle: usize) -> [usize; 3] {
        let i = triangle;
        match self {
            Mode::Strip if i.is_multiple_of(2) => [i, i + 1, i + 2],
            Mode::Strip => [i + 1, i, i + 2],
            Mode::Fan => [0, i + 1, i + 2],
            Mode::Triangles => [3 * i, 3 * i + 1, 3 * i + 2],
        }
    }
}

/// The accessors of a primitive.
struct Geometry<'a> {
    positions: Accessor<'a, 3>,
    indices: Option<Accessor<'a, 1>>,
    /// The morph targets: weights and displacements of the vertices.
    targets: Vec<(f64, Accessor<'a, 3>)>,
    skin: Option<skin::Influences<'a>>,
}

impl<'a> Geometry<'a> {
    fn find(
        json: &Value,
        buffers: &'a Buffers<'_>,
        primitive: &Value,
        weights: &[f64],
        has_skin: bool,
    ) -> Result<Self, String> {
        let attributes = &primitive["attributes"];
        let positions = Accessor::find(json, buffers, &attributes["POSITION"])?;
        let indices = match &primitive["indices"] {
            Value::Null => None,
            indices => Some(Accessor::find(json, buffers, indices)?),
        };
        let mut targets = Vec::new();
        for (target, weight) in items(&primitive["targets"]).iter().zip(weights) {
            if *weight != 0.0 && !target["POSITION"].is_null() {
                let displacements = Accessor::find(json, buffers, &target["POSITION"])?;
                targets.push((*weight, displacements));
            }
        }
        let skin = match has_skin {
            true => skin::Influences::find(json, buffers, attributes)?,
            false => None,
        };
        Ok(Geometry { positions, indices, targets, skin })
    }

    fn corner_count(&self) -> usize {
        self.indices.as_ref().map_or(self.positions.count, |indices| indices.count)
    }

    fn index_of(&self, corner: usize) -> Result<usize, String> {
        let Some(indices) = &self.indices else { return Ok(corner) };
        let [index] = indices.get(corner);
        if index >= 0.0 && index < self.positions.count as f64 {
            return Ok(index as usize);
        }
        let count = self.positions.count;
        Err(format!("found index {index}; expected less than {count}"))
    }

    /// Adds vertex `i`, transformed. Returns the vertex, and `true` if its transform mirrors.
    fn place(
        &self,
        i: usize,
        placement: Placement<'_>,
        builder: &mut MeshBuilder,
    ) -> (VertexIndex, bool) {
        let mut point = self.positions.get(i);
        for (weight, displacements) in &self.targets {
            if i < displacements.count {
                let by = displacements.get(i);
                point = [0, 1, 2].map(|k| point[k] + weight * by[k]);
            }
        }
        let blended;
        let matrix = match (placement, &self.skin) {
            (Placement::Skinned(joints), Some(skin)) => {
                blended = skin.blend(i, joints);
                &blended
            }
            (Placement::Rigid(matrix), _) => matrix,
            (Placement::Skinned(_), None) => &IDENTITY,
        };
        let placed = matrix::transform_point(matrix, point);
        (builder.add_vertex(placed), matrix::is_mirror(matrix))
    }
}
