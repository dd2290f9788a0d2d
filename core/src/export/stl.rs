//! Binary STL: 80 bytes of text, the number of triangles, then 50 bytes a triangle (normal, three
//! corners, two bytes unused), all little-endian.

/// Bytes before the triangles.
pub(super) const HEADER: usize = 84;

/// Bytes of a triangle.
pub(super) const RECORD: usize = 50;

/// Must not begin with "solid", by which readers know the text form.
const TEXT: &[u8] = b"Paros sculpture: binary STL, millimetres, z up";

/// A point or vector; the fourth component is idle.
pub(super) type Point = [f32; 4];

/// The bytes before the triangles.
pub(super) fn header(triangles: u32) -> [u8; HEADER] {
    let mut bytes = [b' '; HEADER];
    bytes[..TEXT.len()].copy_from_slice(TEXT);
    bytes[80..].copy_from_slice(&triangles.to_le_bytes());
    bytes
}

/// A triangle whose corners are given in small integers, of which `scale` makes millimetres. The
/// cross product of its sides is exact in f32.
#[inline(always)]
pub(super) fn record([a, b, c]: [Point; 3], scale: f32, bytes: &mut [u8; RECORD]) {
    let normal = normal(a, b, c);
    for (corner, point) in
        [normal, scaled(a, scale), scaled(b, scale), scaled(c, scale)].iter().enumerate()
    {
        for (axis, value) in point[..3].iter().enumerate() {
            let at = corner * 12 + axis * 4;
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        }
    }
    bytes[48..].fill(0);
}

#[inline(always)]
fn scaled(point: Point, scale: f32) -> Point {
    point.map(|c| c * scale)
}

/// The unit normal of a triangle that is counter-clockwise seen from outside.
#[inline(always)]
fn normal(a: Point, b: Point, c: Point) -> Point {
    let (u, v) = (minus(b, a), minus(c, a));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0], 0.0];
    let length = libm::sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    scaled(n, 1.0 / length)
}

#[inline(always)]
fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], 0.0]
}
