//! A round little creature with a smile, made to be changed: big smooth forms and few details.

use glam::Vec3;

use super::field::{blend, cut, ellipsoid, groove, limb, min, paired, sphere, v};

pub(super) fn field(p: Vec3) -> f32 {
    let q = paired(p);
    let body = patch(ellipsoid(q, v(0.0, 40.0, 0.0), v(30.0, 32.0, 27.0)), q);
    let creature = blend(blend(body, limbs(q), 4.0), head(q), 4.0);
    face(creature, q)
}

fn limbs(q: Vec3) -> f32 {
    let leg = limb(q, (v(15.0, 18.0, 2.0), 13.0), (v(17.0, 10.0, 10.0), 13.0));
    let arm = limb(q, (v(25.0, 54.0, 2.0), 9.0), (v(43.0, 42.0, 9.0), 10.5));
    min(leg, arm)
}

fn head(q: Vec3) -> f32 {
    let skull = ellipsoid(q, v(0.0, 88.0, 0.0), v(36.0, 30.0, 30.0));
    let ear = sphere(q, v(30.0, 111.0, -2.0), 12.5);
    let ear = cut(ear, sphere(q, v(31.0, 112.0, 12.5), 9.0), 2.0);
    blend(skull, ear, 4.0)
}

/// The seam of a round patch on the belly.
fn patch(d: f32, q: Vec3) -> f32 {
    if q.z < 0.0 || d.abs() > 6.0 {
        return d;
    }
    groove(d, ellipsoid(q, v(0.0, 42.0, 27.0), v(17.0, 19.0, 20.0)), 1.25)
}

fn face(d: f32, q: Vec3) -> f32 {
    if q.z < 0.0 || q.y < 60.0 {
        return d;
    }
    let snout = ellipsoid(q, v(0.0, 80.0, 27.0), v(13.0, 10.0, 9.0));
    let d = blend(d, snout, 3.0);
    let nose = ellipsoid(q, v(0.0, 85.0, 35.5), v(5.0, 3.6, 3.6));
    let smile = (v(q.x, q.y - 85.5, 0.0).length() - 9.0).abs();
    let d = if q.y < 80.0 && q.x < 8.0 && q.z > 28.0 { groove(d, smile, 1.4) } else { d };
    let eye = sphere(q, v(14.0, 94.0, 24.5), 5.6);
    min(min(d, nose), eye)
}
