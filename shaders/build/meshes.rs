//! The studio's meshes, written as tables of vertices and indices, and the room's ambient light.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use glam::Vec3;
use paros_core::frame::{BOX, STOOL};
use paros_core::tools::{Bit, Tool};

use crate::mesh::{Mesh, bits, furniture, hands, light, room, to, tools};

/// What a mesh's light is.
enum Light {
    /// It stands in the room, where it was made.
    Room,
    /// It is carried about, and shades only itself.
    Alone,
    /// None: it shines by itself, or is too small.
    None,
}

/// Writes the meshes into the folder `out`: `vertices.bin`, `indices.bin`, and `meshes.rs` and
/// `ambient.rs` that tell what is in them.
pub(crate) fn write(out: &Path) {
    let mut meshes = all();
    let mut standing = Mesh::default();
    for (_, light, mesh) in &meshes {
        if matches!(light, Light::Room) {
            standing.add(mesh, to(0.0, 0.0, 0.0));
        }
    }
    // The stool's top takes part in the room's light where it is at first.
    let mut lit_things = standing;
    lit_things.add(&furniture::stool_top(), to(STOOL.x, STOOL.y, STOOL.z));
    let lit = light::Lit::new(&lit_things, (room::LOW, room::HIGH));
    let about = lit.harmonics(STOOL + Vec3::Y * (0.5 * BOX));
    for (_, light, mesh) in &mut meshes {
        match light {
            Light::Room => light::open_in_room(mesh, &lit, &about),
            Light::Alone => light::open_alone(mesh),
            Light::None => {}
        }
    }
    write_ambient(out, &about);
    write_tables(out, &meshes);
}

/// All meshes by name, in the order of `MeshId`.
fn all() -> Vec<(String, Light, Mesh)> {
    let mut all = vec![
        ("Room".to_owned(), Light::Room, room::room()),
        ("Outside".to_owned(), Light::None, room::outside()),
        ("Workbench".to_owned(), Light::Room, furniture::bench()),
        ("StoolBase".to_owned(), Light::Room, furniture::stool_base()),
        ("StoolTop".to_owned(), Light::Alone, furniture::stool_top()),
    ];
    all.extend(Tool::ALL.map(|tool| (format!("{tool:?}"), Light::Alone, tools::tool(tool))));
    all.extend(Bit::ALL.map(|bit| (format!("{bit:?}"), Light::Alone, bits::bit(bit))));
    for (name, closed) in [("Open", false), ("Closed", true)] {
        all.push((format!("{name}LeftHand"), Light::Alone, hands::left(closed)));
        all.push((format!("{name}RightHand"), Light::Alone, hands::right(closed)));
    }
    all.push(("Chip".to_owned(), Light::None, furniture::chip()));
    all.push(("Speck".to_owned(), Light::None, furniture::speck()));
    all
}

fn write_tables(out: &Path, meshes: &[(String, Light, Mesh)]) {
    let (mut vertices, mut indices) = (Vec::new(), Vec::new());
    let (mut ids, mut rows) = (String::new(), String::new());
    let (mut first, mut base) = (0, 0);
    for (name, _, mesh) in meshes {
        for corner in &mesh.corners {
            corner.position.to_array().iter().for_each(|f| vertices.extend(f.to_le_bytes()));
            vertices.extend(corner.normal.to_array().map(|f| (f * 127.0).round() as i8 as u8));
            vertices.push(0);
            vertices.extend(corner.colour.to_array().map(unit));
            vertices.push(unit(corner.open));
        }
        for i in mesh.triangles.iter().flatten() {
            let index = u16::try_from(*i).expect("at most 65,536 vertices in a mesh");
            indices.extend(index.to_le_bytes());
        }
        let radius = mesh.corners.iter().fold(0.0, |r: f32, c| r.max(c.position.length()));
        let count = 3 * mesh.triangles.len();
        let spoken = spoken(name);
        let _ = writeln!(ids, "    /// {spoken}.\n    {name},");
        let _ = writeln!(
            rows,
            "    Mesh {{ first_index: {first}, index_count: {count}, base_vertex: {base}, \
             vertex_count: {}, radius: {radius:?} }},",
            mesh.corners.len(),
        );
        (first, base) = (first + count, base + mesh.corners.len());
    }
    let count = meshes.len();
    let table = format!(
        "/// A mesh by name.\n#[derive(Clone, Copy, PartialEq, Eq, Debug)]\n#[repr(u8)]\n\
         pub enum MeshId {{\n{ids}}}\n\n/// How many meshes there are.\n\
         pub const MESHES: usize = {count};\n\nstatic TABLE: [Mesh; MESHES] = [\n{rows}];\n"
    );
    write_file(out, "vertices.bin", &vertices);
    write_file(out, "indices.bin", &indices);
    write_file(out, "meshes.rs", table.as_bytes());
}

fn write_ambient(out: &Path, about: &[[f32; 3]; 9]) {
    let rows: String = about.iter().map(|c| format!("    {c:?},\n")).collect();
    let text = format!(
        "/// Radiance about the sculpture but for the sun's own, in the order and the units of\n\
         /// [`AMBIENT`](crate::constants::AMBIENT): the window's sky, and what the room gives back.\n\
         pub const ROOM_AMBIENT: [[f32; 3]; 9] = [\n{rows}];\n"
    );
    write_file(out, "ambient.rs", text.as_bytes());
}

/// A name as words.
fn spoken(name: &str) -> String {
    let mut words = String::new();
    for c in name.chars() {
        match c.is_uppercase() && !words.is_empty() {
            true => words.extend([' ', c.to_ascii_lowercase()]),
            false => words.push(c),
        }
    }
    words
}

/// A part of one as a byte.
fn unit(part: f32) -> u8 {
    (part.clamp(0.0, 1.0) * 255.0).round() as u8
}

fn write_file(out: &Path, name: &str, bytes: &[u8]) {
    let path = out.join(name);
    fs::write(&path, bytes).unwrap_or_else(|why| panic!("{}: {why}", path.display()));
}
