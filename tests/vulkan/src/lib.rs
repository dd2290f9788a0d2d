//! Support for the renderer's tests: a device with validation, and an offscreen target. Windows and OpenXR
//! are covered by the shells' own tests.
pub mod test_renderer;

/// Returns the sum of a pixel's red, green and blue.
pub fn rgb_sum(pixel: [u8; 4]) -> i32 {
    pixel[..3].iter().map(|c| i32::from(*c)).sum()
}

/// Returns the number of pixels that differ by more than 8 in a channel.
pub fn count_differing(a: &[[u8; 4]], b: &[[u8; 4]]) -> usize {
    let far = |(a, b): &(&[u8; 4], &[u8; 4])| (0..3).any(|i| a[i].abs_diff(b[i]) > 8);
    a.iter().zip(b).filter(far).count()
}
