//! Serialisation of vectors and quaternions: their components, which must be finite.

use glam::{Quat, Vec3};

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};

/// Length of a serialised vector in bytes.
pub(crate) const VEC3_BYTES: usize = 3 * size_of::<f32>();

/// Length of a serialised quaternion in bytes.
pub(crate) const QUAT_BYTES: usize = 4 * size_of::<f32>();

/// Writes the three components as f32.
pub(crate) fn write_vec3(to: &mut ByteWriter<'_>, v: Vec3) {
    v.to_array().iter().for_each(|f| to.f32(*f));
}

/// Writes the four components, x, y, z and w, as f32.
pub(crate) fn write_quat(to: &mut ByteWriter<'_>, q: Quat) {
    q.to_array().iter().for_each(|f| to.f32(*f));
}

/// Reads the output of [`write_vec3`].
pub(crate) fn read_vec3(from: &mut ByteReader<'_>) -> Result<Vec3, BadBytes> {
    Ok(Vec3::new(read_finite(from)?, read_finite(from)?, read_finite(from)?))
}

/// Reads the output of [`write_quat`].
pub(crate) fn read_finite_quat(from: &mut ByteReader<'_>) -> Result<Quat, BadBytes> {
    Ok(Quat::from_xyzw(
        read_finite(from)?,
        read_finite(from)?,
        read_finite(from)?,
        read_finite(from)?,
    ))
}

fn read_finite(from: &mut ByteReader<'_>) -> Result<f32, BadBytes> {
    let bad = from.error_here("a finite number");
    let value = from.f32()?;
    if value.is_finite() { Ok(value) } else { Err(bad) }
}
