//! Support for the renderer's tests: a device with validation, and an offscreen target.
//! It takes volumes and eyes and gives pixels.
//! It knows no window, and no OpenXR: the shells' own tests have them.
pub mod test_renderer;

/// The sum of a pixel's red, green and blue.
pub fn rgb_sum(pixel: [u8; 4]) -> i32 {
    pixel[..3].iter().map(|c| i32::from(*c)).sum()
}

/// How many pixels differ by more than a shade.
pub fn count_differing(a: &[[u8; 4]], b: &[[u8; 4]]) -> usize {
    let far = |(a, b): &(&[u8; 4], &[u8; 4])| (0..3).any(|i| a[i].abs_diff(b[i]) > 8);
    a.iter().zip(b).filter(far).count()
}
