//! The studio's meshes, written as tables of vertices and indices, and the room's ambient light.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use glam::Vec3;
use paros_core::internals::{BOX_SIDE, STOOL_TOP};
use paros_core::session::{Tool, ToolBit};

use crate::mesh::hands::HandShape;
use crate::mesh::{MeshBuilder, bits, extent, furniture, hands, light, room, tools, translation};

/// Method by which a mesh's openness is computed.
enum MeshLight {
    /// From the room's light, where the mesh was modelled.
    Room,
    /// From self-occlusion alone: it is carried about.
    Alone,
    /// Not computed: the mesh is emissive, or too small.
    None,
}

/// Writes the meshes into the folder `out`: `vertices.bin` and `indices.bin`, the table `meshes.rs` of
/// their ranges, and the room's light `ambient.rs`.
pub(crate) fn write_meshes(out: &Path) {
    let mut meshes = all_meshes();
    let mut standing = MeshBuilder::default();
    for (_, light, mesh) in &meshes {
        if matches!(light, MeshLight::Room) {
            standing.append(mesh, translation(0.0, 0.0, 0.0));
        }
    }
    // The stool's top takes part in the room's light in its initial position.
    let mut lit_things = standing;
    lit_things.append(&furniture::stool_top(), translation(STOOL_TOP.x, STOOL_TOP.y, STOOL_TOP.z));
    let inside = light::BoxBounds { low: extent::LOW, high: extent::HIGH };
    let lit = light::RoomLight::new(&lit_things, &inside);
    let sculpture_sh = lit.radiance_sh_at(STOOL_TOP + Vec3::Y * (0.5 * BOX_SIDE));
    for (_, light, mesh) in &mut meshes {
        match light {
            MeshLight::Room => light::set_openness_in_room(mesh, &lit, &sculpture_sh),
            MeshLight::Alone => light::set_openness_by_itself(mesh),
            MeshLight::None => {}
        }
    }
    write_ambient(out, &sculpture_sh);
    write_tables(out, &meshes);
}

/// Returns all meshes by name, in the order of the generated `MeshId`.
fn all_meshes() -> Vec<(String, MeshLight, MeshBuilder)> {
    let mut all = vec![
        ("Room".to_owned(), MeshLight::Room, room::room_mesh()),
        ("Outside".to_owned(), MeshLight::None, room::outside_mesh()),
        ("Workbench".to_owned(), MeshLight::Room, furniture::workbench()),
        ("StoolBase".to_owned(), MeshLight::Room, furniture::stool_base()),
        ("StoolTop".to_owned(), MeshLight::Alone, furniture::stool_top()),
    ];
    all.extend(
        Tool::ALL.map(|tool| (format!("{tool:?}"), MeshLight::Alone, tools::tool_body(tool))),
    );
    all.extend(ToolBit::ALL.map(|bit| (format!("{bit:?}"), MeshLight::Alone, bits::bit_mesh(bit))));
    for (name, shape) in [("Open", HandShape::Open), ("Closed", HandShape::Closed)] {
        all.push((format!("{name}LeftHand"), MeshLight::Alone, hands::left_hand(shape)));
        all.push((format!("{name}RightHand"), MeshLight::Alone, hands::right_hand(shape)));
    }
    all.push(("Shard".to_owned(), MeshLight::None, furniture::shard_mesh()));
    all.push(("Chip".to_owned(), MeshLight::None, furniture::chip_mesh()));
    all.push(("Speck".to_owned(), MeshLight::None, furniture::speck_mesh()));
    all
}

fn write_tables(out: &Path, meshes: &[(String, MeshLight, MeshBuilder)]) {
    let (mut vertices, mut indices) = (Vec::new(), Vec::new());
    let (mut ids, mut rows) = (String::new(), String::new());
    let (mut first, mut base) = (0, 0);
    for (name, _, mesh) in meshes {
        for corner in &mesh.corners {
            corner.position.to_array().iter().for_each(|f| vertices.extend(f.to_le_bytes()));
            vertices.extend(corner.normal.to_array().map(|f| (f * 127.0).round() as i8 as u8));
            vertices.push(0);
            vertices.extend(corner.colour.to_array().map(fraction_to_byte));
            vertices.push(fraction_to_byte(corner.openness));
        }
        for i in mesh.triangles.iter().flatten() {
            let index = u16::try_from(*i).expect("at most 65,536 vertices in a mesh");
            indices.extend(index.to_le_bytes());
        }
        let radius = mesh.corners.iter().fold(0.0, |r: f32, c| r.max(c.position.length()));
        let count = 3 * mesh.triangles.len();
        let spaced = space_out_words(name);
        let _ = writeln!(ids, "    /// {spaced}.\n    {name},");
        let _ = writeln!(
            rows,
            "    MeshRange {{ first_index: {first}, index_count: {count}, base_vertex: {base}, \
             vertex_count: {}, radius: {radius:?} }},",
            mesh.corners.len(),
        );
        (first, base) = (first + count, base + mesh.corners.len());
    }
    let count = meshes.len();
    let table = format!(
        "/// A mesh by name.\n#[derive(Clone, Copy, PartialEq, Eq, Debug)]\n#[repr(u8)]\n\
         pub enum MeshId {{\n{ids}}}\n\n/// How many meshes there are.\n\
         pub const MESHES: usize = {count};\n\nstatic TABLE: [MeshRange; MESHES] = [\n{rows}];\n"
    );
    write_file(out, "vertices.bin", &vertices);
    write_file(out, "indices.bin", &indices);
    write_file(out, "meshes.rs", table.as_bytes());
}

fn write_ambient(out: &Path, sculpture_sh: &[[f32; 3]; 9]) {
    let rows: String = sculpture_sh.iter().map(|c| format!("    {c:?},\n")).collect();
    let text = format!(
        "/// Radiance about the sculpture but for the sun's own, in the order and the units of\n\
         /// [`AMBIENT_HARMONICS`](crate::constants::AMBIENT_HARMONICS): the window's sky, and what the room gives back.\n\
         pub const ROOM_AMBIENT: [[f32; 3]; 9] = [\n{rows}];\n"
    );
    write_file(out, "ambient.rs", text.as_bytes());
}

/// Splits a camel-case name into words, lower-case after the first.
fn space_out_words(camel_case: &str) -> String {
    let mut words = String::new();
    for c in camel_case.chars() {
        match c.is_uppercase() && !words.is_empty() {
            true => words.extend([' ', c.to_ascii_lowercase()]),
            false => words.push(c),
        }
    }
    words
}

/// Converts a number in 0..1 to a normalised byte.
fn fraction_to_byte(fraction: f32) -> u8 {
    (fraction.clamp(0.0, 1.0) * 255.0).round() as u8
}

fn write_file(out: &Path, name: &str, bytes: &[u8]) {
    let path = out.join(name);
    fs::write(&path, bytes).unwrap_or_else(|why| panic!("{}: {why}", path.display()));
}
