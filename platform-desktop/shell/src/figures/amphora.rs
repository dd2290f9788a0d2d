//! A two-handled jar, petals cut around its foot and a wave around its shoulder.

use glam::Vec3;

use super::field::{blend, cut, disc, ellipsoid, groove, limb, max, min, paired, ring, v, wedge};

pub(super) fn field(p: Vec3) -> f32 {
    let jar = blend(ornament(belly(p), p), neck(p), 5.0);
    let jar = blend(jar, handle(paired(p)), 2.5);
    let hollow = ellipsoid(p, v(0.0, 116.0, 0.0), v(12.5, 22.0, 12.5));
    min(cut(jar, hollow, 2.0), foot(p))
}

fn foot(p: Vec3) -> f32 {
    let tread = disc(p, (-4.0, 6.0), 23.0, 2.5);
    let stem = limb(p, (v(0.0, 4.0, 0.0), 15.0), (v(0.0, 18.0, 0.0), 11.0));
    blend(tread, max(stem, -p.y - 4.0), 6.0)
}

fn belly(p: Vec3) -> f32 {
    let round = ellipsoid(p, v(0.0, 56.0, 0.0), v(37.0, 30.0, 37.0));
    let lower = limb(p, (v(0.0, 16.0, 0.0), 9.0), (v(0.0, 48.0, 0.0), 31.0));
    blend(round, lower, 8.0)
}

fn neck(p: Vec3) -> f32 {
    let tube = limb(p, (v(0.0, 76.0, 0.0), 16.0), (v(0.0, 102.0, 0.0), 14.5));
    let lip = disc(p, (103.0, 112.0), 20.5, 4.0);
    min(blend(tube, lip, 5.0), ring(p, 88.0, 15.0, 2.0))
}

/// A link that hangs between lip and shoulder; the rest of its loop is inside the jar.
fn handle(q: Vec3) -> f32 {
    let p = q - v(23.0, 87.0, 0.0);
    let p = v(p.x, p.y - max(-5.0, min(5.0, p.y)), p.z);
    ring(v(p.x, p.z, p.y), 0.0, 15.0, 5.0)
}

fn ornament(d: f32, p: Vec3) -> f32 {
    if d.abs() > 6.0 {
        return d;
    }
    let band = |height: f32| (p.y - height).abs();
    let d = groove(d, min(band(45.0), min(band(64.5), band(68.5))), 1.1);
    let q = wedge(p);
    if p.y < 43.0 {
        // Petals: a furrow along the middle of every wedge.
        return groove(d, q.y, 1.7);
    }
    if p.y > 47.5 && p.y < 62.0 {
        // A zigzag: half a tooth of it in each half of a wedge.
        let rise = 60.0 - q.y * (10.0 / 7.2);
        return groove(d, (p.y - rise) * 0.58, 1.3);
    }
    d
}
