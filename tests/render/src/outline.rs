//! Checks the profile of a shape's outline in a picture against the exact coverage of its pixels.

/// Number of sample squares along a pixel's side for computing its exact coverage.
const SQUARES: usize = 12;
/// Number of bins of the profile a pixel.
const PARTS: f32 = 4.0;

/// Checks the coverage of each pixel by a shape in a picture of `[width, height]` pixels, row by row. Around
/// the outline there must be at least three levels between none and full, the mean coverage must fall from
/// inside to outside, and it must be within an eighth of the exact coverage on average. `outside` returns the
/// distance of a place outside the shape's outline in pixels, or infinity where the place is to be ignored.
/// `hits` returns `true` if the ray through a place meets the surface.
///
/// # Panics
/// A check fails.
pub fn check_profile(
    covered: &[f32],
    size: [u32; 2],
    outside: impl Fn([f32; 2]) -> f32,
    hits: impl Fn([f32; 2]) -> bool,
) {
    let mut parts = [(0.0, 0u32); 12];
    let (mut off, mut pixels, mut seen) = (0.0, 0u32, Vec::new());
    for (i, covered) in covered.iter().enumerate() {
        let corner = [i as u32 % size[0], i as u32 / size[0]].map(|c| c as f32);
        let beside = outside(corner.map(|c| c + 0.5));
        if beside.abs() >= 1.5 {
            continue;
        }
        let (sum, count) = &mut parts[((beside + 1.5) * PARTS) as usize];
        (*sum, *count) = (*sum + covered, *count + 1);
        if beside.abs() < 0.75 {
            off += (covered - exact_coverage(corner, &hits)).abs();
            pixels += 1;
            seen.push((covered * 16.0).round() as u32);
        }
    }
    let profile = parts.map(|(sum, count)| sum / count.max(1) as f32);
    let off = off / pixels as f32;
    println!("{profile:.2?}, {off:.3} off the exact coverage in the mean");
    seen.sort_unstable();
    seen.dedup();
    let between = seen.iter().filter(|level| (1..16).contains(*level)).count();
    assert!(parts.iter().all(|(_, count)| *count > 20), "{parts:?}");
    assert!(between >= 3, "levels {seen:?} of 16");
    assert!(profile.windows(2).all(|pair| pair[1] <= pair[0] + 0.01), "{profile:?}");
    assert!(off <= 0.125, "{off} of a pixel off in the mean");
}

/// Returns the share of a pixel, given by its corner, that shows the surface.
fn exact_coverage(corner: [f32; 2], hits: &impl Fn([f32; 2]) -> bool) -> f32 {
    let inside = |i: &usize| {
        let part = [i % SQUARES, i / SQUARES].map(|c| (c as f32 + 0.5) / SQUARES as f32);
        hits([corner[0] + part[0], corner[1] + part[1]])
    };
    (0..SQUARES * SQUARES).filter(inside).count() as f32 / (SQUARES * SQUARES) as f32
}
