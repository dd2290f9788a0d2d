//! What keeping the fast path's textures up to date costs a frame, in bytes; under Callgrind with
//! `--toggle-collect=field_work::counted --dump-after=field_work::counted`, in instructions too.
//!
//! `field_work 128|256 stroke|load`: a stroke of radius 6 over a ball, or the load of a ball.

use std::hint::black_box;
use std::sync::{Mutex, PoisonError};

use glam::IVec3;
use paros_core::brush::Brush;
use paros_core::dirty::Dirty;
use paros_core::edit::{Edit, EditScratch, Operation, apply};
use paros_core::maps::Maps;
use paros_core::pose::SUB;
use paros_core::row::Bits;
use paros_core::size::{Grid, Size};
use paros_core::volume::Volume;
use paros_shaders::field::{Budget, Field};

struct Studio<const N: usize>
where
    Grid<N>: Size,
{
    volume: Volume<N>,
    mask: Maps<N>,
    scratch: EditScratch<N>,
}

impl<const N: usize> Studio<N>
where
    Grid<N>: Size,
{
    const fn new() -> Self {
        Studio { volume: Volume::new(), mask: Maps::new(), scratch: EditScratch::new() }
    }
}

fn ball<const N: usize>(volume: &mut Volume<N>)
where
    Grid<N>: Size,
{
    let half = N as i32 / 2;
    volume.set_voxels(|plane| {
        for (y, z) in (0..N * N).map(|i| (i / N, i % N)) {
            for x in 0..N {
                let away = [x, y, z].map(|c| (2 * c as i32 + 1 - 2 * half).pow(2));
                if away.iter().sum::<i32>() <= (2 * (half - 6)).pow(2) {
                    plane.row_mut(y, z).insert(x);
                }
            }
        }
    });
}

#[inline(never)]
fn counted<const N: usize>(
    field: &mut Field<N>,
    noted: Option<(&Maps<N>, &Dirty)>,
) -> (usize, usize) {
    let (mut bytes, mut regions) = (0, 0);
    if let Some((maps, dirty)) = noted {
        field.note(maps, black_box(dirty));
    }
    field.advance(Budget::frame(N), &mut |_, region| {
        bytes += black_box(region).len();
        regions += 1;
    });
    black_box((bytes, regions))
}

fn measure<const N: usize>(studio: &Mutex<Studio<N>>, stroke: bool)
where
    Grid<N>: Size,
{
    let mut studio = studio.lock().unwrap_or_else(PoisonError::into_inner);
    let Studio { volume, mask, scratch } = &mut *studio;
    let mut field = Field::<N>::new();
    let mut dirty = Dirty::new();
    ball(volume);
    if !stroke {
        dirty.note_all(N);
        let mut frame = counted(&mut field, Some((volume.maps(), &dirty)));
        println!("{} bytes in {} regions", frame.0, frame.1);
        while field.pending() {
            frame = counted(&mut field, None);
            println!("{} bytes in {} regions", frame.0, frame.1);
        }
        return;
    }
    field.rebuild(volume.maps());
    let half = N as f32 / 2.0;
    for i in 0..60 {
        let angle = i as f32 * 0.03;
        let at = |along: f32| ((half + along * (half - 6.0)) * SUB as f32) as i32;
        let centre = IVec3::new(at(0.8 * angle.sin()), at(0.8 * angle.cos()), at(0.6));
        let brush = Brush::sphere(centre, 6 * SUB);
        let operation = Operation::Carve { depth: 2 };
        dirty.clear();
        let edit = Edit { brush: &brush, operation, mirrored: false };
        let _ = apply(volume, mask, &edit, scratch, &mut dirty);
        dirty.close();
        let (bytes, regions) = counted(&mut field, Some((volume.maps(), &dirty)));
        println!("{bytes} bytes in {regions} regions, pending {}", field.pending());
    }
}

fn main() {
    static SMALL: Mutex<Studio<128>> = Mutex::new(Studio::new());
    static LARGE: Mutex<Studio<256>> = Mutex::new(Studio::new());
    let arguments: Vec<String> = std::env::args().collect();
    let stroke = arguments.iter().any(|a| a == "stroke");
    match arguments.iter().any(|a| a == "256") {
        true => measure(&LARGE, stroke),
        false => measure(&SMALL, stroke),
    }
}
