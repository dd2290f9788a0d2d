//! Binary STL: 80 bytes of text, the number of triangles as u32, then 50 bytes a triangle (normal, three
//! corners, two unused bytes), all little-endian.

/// Bytes before the triangles.
pub(super) const HEADER_BYTES: usize = 84;

/// Bytes of a triangle.
pub(super) const TRIANGLE_BYTES: usize = 50;

/// The header text. It must not begin with "solid", which marks the text format.
const TEXT: &[u8] = b"Paros sculpture: binary STL, millimetres, z up";

/// A point or vector, padded to four components; the fourth is unused.
pub(super) type StlPoint = [f32; 4];

/// Returns the bytes before the triangles.
pub(super) fn header_bytes(triangles: u32) -> [u8; HEADER_BYTES] {
    let mut bytes = [b' '; HEADER_BYTES];
    bytes[..TEXT.len()].copy_from_slice(TEXT);
    bytes[80..].copy_from_slice(&triangles.to_le_bytes());
    bytes
}

/// Writes a triangle whose corners are small integers, scaled to millimetres by `mm_per_unit`. The cross
/// product of its sides is exact in f32.
#[inline(always)]
pub(super) fn write_triangle(
    [a, b, c]: [StlPoint; 3],
    mm_per_unit: f32,
    bytes: &mut [u8; TRIANGLE_BYTES],
) {
    let normal = unit_normal(a, b, c);
    for (corner, point) in
        [normal, scaled(a, mm_per_unit), scaled(b, mm_per_unit), scaled(c, mm_per_unit)]
            .iter()
            .enumerate()
    {
        for (axis, value) in point[..3].iter().enumerate() {
            let at = corner * 12 + axis * 4;
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        }
    }
    bytes[48..].fill(0);
}

#[inline(always)]
fn scaled(point: StlPoint, scale: f32) -> StlPoint {
    point.map(|c| c * scale)
}

/// Returns the unit normal of a triangle that is counter-clockwise seen from outside.
#[inline(always)]
fn unit_normal(a: StlPoint, b: StlPoint, c: StlPoint) -> StlPoint {
    let (u, v) = (subtract(b, a), subtract(c, a));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0], 0.0];
    let length = libm::sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    scaled(n, 1.0 / length)
}

#[inline(always)]
fn subtract(a: StlPoint, b: StlPoint) -> StlPoint {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], 0.0]
}
