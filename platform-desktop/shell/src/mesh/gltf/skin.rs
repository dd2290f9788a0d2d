//! Nodes and the transforms of meshes: those of the node tree, instances, and skins in their bind pose.

use super::super::MAX_TRIANGLES;
use super::accessor::{self, Accessor, number};
use super::container::Buffers;
use super::items;
use super::matrix::{self, IDENTITY, Matrix};
use serde_json::Value;
use std::rc::Rc;

/// The nodes of a file, which form trees.
pub(super) struct Nodes<'a> {
    nodes: &'a [Value],
    /// The nodes without a parent.
    roots: Vec<usize>,
    /// For each node, the transform from its space to the world's.
    world_from_nodes: Vec<Matrix>,
}

impl<'a> Nodes<'a> {
    fn new(json: &'a Value) -> Self {
        let nodes = items(&json["nodes"]);
        let children = |node: &'a Value| {
            items(&node["children"]).iter().filter_map(number).filter(|i| *i < nodes.len())
        };
        let mut is_child = vec![false; nodes.len()];
        nodes.iter().flat_map(children).for_each(|child| is_child[child] = true);
        let roots: Vec<usize> = (0..nodes.len()).filter(|&index| !is_child[index]).collect();
        let mut world_from_nodes = vec![IDENTITY; nodes.len()];
        let mut pending: Vec<_> = roots.iter().map(|&root| (root, IDENTITY)).collect();
        let mut is_placed = vec![false; nodes.len()];
        while let Some((index, world_from_parent)) = pending.pop() {
            if std::mem::replace(&mut is_placed[index], true) {
                continue;
            }
            let node = &nodes[index];
            let world_from_node =
                matrix::product(&world_from_parent, &matrix::parent_from_node(node));
            world_from_nodes[index] = world_from_node;
            pending.extend(children(node).map(|child| (child, world_from_node)));
        }
        Nodes { nodes, roots, world_from_nodes }
    }

    /// Returns the nodes without a parent.
    pub(super) fn roots(&self) -> Vec<usize> {
        self.roots.clone()
    }

    /// Returns the transform from a node's space to the world's.
    pub(super) fn world_from_node(&self, index: usize) -> Matrix {
        self.world_from_nodes[index]
    }

    /// Lists the nodes of trees in depth-first order, without those that `KHR_node_visibility` hides.
    pub(super) fn list_subtrees(&self, mut pending: Vec<usize>) -> Result<Vec<usize>, String> {
        let mut seen = vec![false; self.nodes.len()];
        let mut listed = Vec::new();
        while let Some(index) = pending.pop() {
            let Some(node) = self.nodes.get(index) else {
                let count = self.nodes.len();
                return Err(format!("found node {index}; expected less than {count}"));
            };
            if std::mem::replace(&mut seen[index], true) {
                return Err(format!("node {index} is reached twice; expected trees"));
            }
            if node["extensions"]["KHR_node_visibility"]["visible"].as_bool() == Some(false) {
                continue;
            }
            listed.push(index);
            pending.extend(items(&node["children"]).iter().filter_map(number));
        }
        Ok(listed)
    }
}

/// The skins of a file.
pub(super) struct Skins<'a> {
    json: &'a Value,
    pub(super) nodes: Nodes<'a>,
    /// For each skin, the transforms of its joints, once they are computed.
    matrices: Vec<Option<Rc<Vec<Matrix>>>>,
}

impl<'a> Skins<'a> {
    pub(super) fn new(json: &'a Value) -> Self {
        let matrices = vec![None; items(&json["skins"]).len()];
        Skins { json, nodes: Nodes::new(json), matrices }
    }

    /// Returns, for each joint, the transform from the mesh's space to the world's. By the specification, the
    /// transform of the mesh's own node is ignored.
    pub(super) fn joint_matrices(
        &mut self,
        skin: usize,
        buffers: &mut Buffers<'_>,
    ) -> Result<Rc<Vec<Matrix>>, String> {
        let definition = accessor::find(self.json, "skins", &skin.into())?;
        if let Some(matrices) = &self.matrices[skin] {
            return Ok(Rc::clone(matrices));
        }
        let inverses = &definition["inverseBindMatrices"];
        let inverses: Option<Accessor<'_, 16>> = match inverses {
            Value::Null => None,
            index => {
                accessor::load(self.json, buffers, index)?;
                Some(Accessor::find(self.json, buffers, index)?)
            }
        };
        let mut matrices = Vec::new();
        for (i, joint) in items(&definition["joints"]).iter().enumerate() {
            let node = number(joint).filter(|node| *node < self.nodes.nodes.len());
            let node =
                node.ok_or_else(|| format!("skin {skin}: found joint {joint}; expected a node"))?;
            let inverse = inverses.as_ref().filter(|inverses| i < inverses.count).map_or(
                IDENTITY,
                |inverses| {
                    let elements = inverses.get(i);
                    [0, 1, 2, 3].map(|column| [0, 1, 2, 3].map(|row| elements[4 * column + row]))
                },
            );
            matrices.push(matrix::product(&self.nodes.world_from_node(node), &inverse));
        }
        let matrices = Rc::new(matrices);
        self.matrices[skin] = Some(Rc::clone(&matrices));
        Ok(matrices)
    }
}

/// The joints of each vertex and their weights, four in each set.
pub(super) struct Influences<'a> {
    sets: Vec<(Accessor<'a, 4>, Accessor<'a, 4>)>,
}

impl<'a> Influences<'a> {
    /// Finds the influences of a primitive; `None` if it has none.
    pub(super) fn find(
        json: &Value,
        buffers: &'a Buffers<'_>,
        attributes: &Value,
    ) -> Result<Option<Self>, String> {
        let mut sets = Vec::new();
        for [joints, weights] in influence_sets(attributes) {
            sets.push((
                Accessor::find(json, buffers, joints)?,
                Accessor::find(json, buffers, weights)?,
            ));
        }
        Ok(Some(Influences { sets }).filter(|influences| !influences.sets.is_empty()))
    }

    /// Returns the weighted mean of the joints' transforms for a vertex. If all weights are 0, the first
    /// joint counts fully.
    pub(super) fn blend(&self, i: usize, joints: &[Matrix]) -> Matrix {
        let mut sum = [[0.0; 4]; 4];
        let mut total = 0.0;
        let joint_at = |index: f64| joints.get(index as usize).unwrap_or(&IDENTITY);
        for (of_joints, weights) in &self.sets {
            if i < of_joints.count && i < weights.count {
                let (indices, weights) = (of_joints.get(i), weights.get(i));
                for (index, weight) in indices.into_iter().zip(weights) {
                    if weight > 0.0 {
                        sum = matrix::add_weighted(&sum, weight, joint_at(index));
                        total += weight;
                    }
                }
            }
        }
        if total > 0.0 {
            return sum.map(|column| column.map(|element| element / total));
        }
        let first = self.sets.first().filter(|(of_joints, _)| i < of_joints.count);
        *joint_at(first.map_or(0.0, |(of_joints, _)| of_joints.get(i)[0]))
    }
}

/// Returns the attributes `JOINTS_n` and `WEIGHTS_n` of all sets.
fn influence_sets(attributes: &Value) -> impl Iterator<Item = [&Value; 2]> {
    (0..).map_while(|set| {
        let names = [format!("JOINTS_{set}"), format!("WEIGHTS_{set}")];
        let [joints, weights] = names.map(|name| attributes.get(name).unwrap_or(&Value::Null));
        (!joints.is_null() && !weights.is_null()).then_some([joints, weights])
    })
}

/// Loads all buffers that a primitive's geometry needs.
pub(super) fn load_primitive(
    json: &Value,
    buffers: &mut Buffers<'_>,
    primitive: &Value,
) -> Result<(), String> {
    let attributes = &primitive["attributes"];
    let targets = items(&primitive["targets"]).iter().map(|target| &target["POSITION"]);
    let used = [&attributes["POSITION"], &primitive["indices"]].into_iter().chain(targets);
    for index in used.chain(influence_sets(attributes).flatten()).filter(|index| !index.is_null()) {
        accessor::load(json, buffers, index)?;
    }
    Ok(())
}

/// Returns the transforms of a node's instances (`EXT_mesh_gpu_instancing`), or only its own.
pub(super) fn instances(
    json: &Value,
    node: &Value,
    buffers: &mut Buffers<'_>,
    world_from_node: &Matrix,
) -> Result<Vec<Matrix>, String> {
    let attributes = &node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    let names = ["TRANSLATION", "ROTATION", "SCALE"];
    for name in names {
        if !attributes[name].is_null() {
            accessor::load(json, buffers, &attributes[name])?;
        }
    }
    let buffers = &*buffers;
    let vectors = |name: &str| -> Result<Option<Accessor<'_, 3>>, String> {
        let index = &attributes[name];
        if index.is_null() { Ok(None) } else { Accessor::find(json, buffers, index).map(Some) }
    };
    let (translations, scales) = (vectors("TRANSLATION")?, vectors("SCALE")?);
    let rotations: Option<Accessor<'_, 4>> = match &attributes["ROTATION"] {
        Value::Null => None,
        index => Some(Accessor::find(json, buffers, index)?),
    };
    let counts = [
        translations.as_ref().map(|accessor| accessor.count),
        rotations.as_ref().map(|accessor| accessor.count),
        scales.as_ref().map(|accessor| accessor.count),
    ];
    let Some(count) = counts.into_iter().flatten().min() else {
        return Ok(vec![*world_from_node]);
    };
    let instance = |i: usize| {
        let translation = translations.as_ref().map_or([0.0; 3], |accessor| accessor.get(i));
        let rotation = rotations.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |accessor| accessor.get(i));
        let scale = scales.as_ref().map_or([1.0; 3], |accessor| accessor.get(i));
        matrix::product(world_from_node, &matrix::from_parts(translation, rotation, scale))
    };
    if count > MAX_TRIANGLES {
        return Err(format!("found {count} instances; expected at most {MAX_TRIANGLES}"));
    }
    Ok((0..count).map(instance).collect())
}
