//! Affine transforms of glTF's nodes, in double precision.

use serde_json::Value;

/// A 4 x 4 matrix, column-major as in the format.
pub(super) type Matrix = [[f64; 4]; 4];

pub(super) const IDENTITY: Matrix =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

/// Returns the transform from a node's space to its parent's.
pub(super) fn parent_from_node(node: &Value) -> Matrix {
    if let Some(elements) = numbers::<16>(&node["matrix"]) {
        let column = |k: usize| [0, 1, 2, 3].map(|row| elements[4 * k + row]);
        return [0, 1, 2, 3].map(column);
    }
    from_parts(
        numbers(&node["translation"]).unwrap_or([0.0; 3]),
        numbers(&node["rotation"]).unwrap_or([0.0, 0.0, 0.0, 1.0]),
        numbers(&node["scale"]).unwrap_or([1.0; 3]),
    )
}

/// Reads an array of exactly M numbers.
fn numbers<const M: usize>(value: &Value) -> Option<[f64; M]> {
    let values = value.as_array().filter(|values| values.len() == M)?;
    let mut numbers = [0.0; M];
    for (number, value) in numbers.iter_mut().zip(values) {
        *number = value.as_f64()?;
    }
    Some(numbers)
}

/// Returns the transform that scales, rotates by a quaternion (x, y, z, w), which is normalised here, and
/// translates, in that order.
pub(super) fn from_parts(translation: [f64; 3], rotation: [f64; 4], scale: [f64; 3]) -> Matrix {
    let length = rotation.iter().map(|c| c * c).sum::<f64>().sqrt();
    let [x, y, z, w] =
        if length > 0.0 { rotation.map(|c| c / length) } else { [0.0, 0.0, 0.0, 1.0] };
    let turned = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
        [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
        [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
    ];
    let column = |k: usize| {
        let [a, b, c] = turned[k].map(|element| element * scale[k]);
        [a, b, c, 0.0]
    };
    let [a, b, c] = translation;
    [column(0), column(1), column(2), [a, b, c, 1.0]]
}

/// Returns the transform that applies `b`, then `a`.
pub(super) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    b.map(|column| [0, 1, 2, 3].map(|row| (0..4).map(|k| a[k][row] * column[k]).sum()))
}

/// Returns the sum of `a` and `weight` times `b`.
pub(super) fn add_weighted(a: &Matrix, weight: f64, b: &Matrix) -> Matrix {
    [0, 1, 2, 3].map(|column| [0, 1, 2, 3].map(|row| a[column][row] + weight * b[column][row]))
}

pub(super) fn transform_point(matrix: &Matrix, p: [f64; 3]) -> [f64; 3] {
    [0, 1, 2]
        .map(|k| matrix[0][k] * p[0] + matrix[1][k] * p[1] + matrix[2][k] * p[2] + matrix[3][k])
}

/// Returns `true` if a transform mirrors.
pub(super) fn is_mirror(m: &Matrix) -> bool {
    let determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
        - m[1][0] * (m[0][1] * m[2][2] - m[0][2] * m[2][1])
        + m[2][0] * (m[0][1] * m[1][2] - m[0][2] * m[1][1]);
    determinant < 0.0
}
