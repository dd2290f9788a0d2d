//! What the renderer does where the driver fails: memory that runs out at any call of the start, and
//! a device that is lost at any frame. Each is a clear error; nothing is left on the device, as
//! validation tells when it goes; and the next start draws the same picture.
//!
//! Faults that were found so: a fence, a framebuffer, a sampler, a pool of commands and a pipeline
//! that nobody destroyed where a later call failed.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use paros_core::maps::Maps;
use paros_shaders::field::Field;
use paros_shaders::gpu::faults::{self, Calls, Fault, Why};
use paros_shaders::gpu::{Context, Error, Gpu, Instance, Offscreen, Options, Renderer, Sync};
use paros_shell::require::require;
use paros_tests::models::dense::Dense;
use paros_tests::models::desk::{AHEAD, alone};

const N: usize = 32;
const SIZE: [u32; 2] = [96, 80];

/// Faults are a process's: one test at a time.
static ALONE: Mutex<()> = Mutex::new(());

/// An instance that validation looks at, whose devices can fail; none where there is none.
fn instance() -> Option<(MutexGuard<'static, ()>, Arc<Instance>)> {
    let guard = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    faults::plan(None);
    faults::arm();
    let options = Options { validation: true, ..Options::default() };
    let instance = require(Instance::new(&options)).expect("Vulkan and its validation")?;
    // The layers alone are no driver.
    require(device(&instance)).expect("a Vulkan device")?;
    Some((guard, instance))
}

fn device(instance: &Arc<Instance>) -> Result<Context, Error> {
    Gpu::new(instance.clone(), &Options::default(), |_, _| true)
}

fn ball() -> Box<Field<N>> {
    let middle = N as f32 / 2.0;
    let dense = Dense::from_fn(N, |at| {
        at.iter().map(|c| (*c as f32 + 0.5 - middle).powi(2)).sum::<f32>() < 12.0 * 12.0
    });
    let mut maps = Box::new(Maps::<N>::new());
    dense.write_maps(&mut maps);
    let mut field = Box::new(Field::new());
    field.rebuild(&maps);
    field
}

/// From the device to some frames of a picture: all that a shell does.
fn start(gpu: &Context, field: &Field<N>, frames: u32) -> Result<Vec<[u8; 4]>, Error> {
    let mut renderer = Renderer::new(gpu, Offscreen::format(4, 1, false), N, &[])?;
    let screen = Offscreen::new(gpu, &renderer, SIZE)?;
    let mut loaded = Ok(());
    field.whole(|region, bytes| {
        if loaded.is_ok() {
            loaded = renderer.load(region, bytes);
        }
    });
    loaded?;
    for _ in 0..frames {
        renderer.begin()?;
        renderer.draw(&alone(&[AHEAD]), &screen.surface, 0, Sync::default())?;
    }
    renderer.finish()?;
    screen.pixels(0)
}

#[test]
fn memory_may_run_out_at_any_call_of_the_start() {
    let Some((_alone, instance)) = instance() else { return };
    let field = ball();
    for (calls, least) in [(Calls::Memory, 20), (Calls::Making, 150)] {
        let mut failures = 0;
        for after in 0.. {
            let why = if after % 2 == 0 { Why::DeviceMemory } else { Why::HostMemory };
            let gpu = device(&instance).expect("a device");
            // Some more calls fail with it, as memory does not come back by itself.
            faults::plan(Some(Fault { calls, after, times: 1 + after % 3, why }));
            let started = start(&gpu, &field, 1);
            let failed = faults::failed();
            faults::plan(None);
            drop(gpu);
            assert_eq!(instance.messages(), Vec::<String>::new(), "{calls:?} {after}: {started:?}");
            if failed == 0 {
                assert!(started.is_ok(), "{started:?}");
                break;
            }
            failures += 1;
            let error = started.expect_err("a call failed");
            let text = error.to_string();
            assert!(!error.is_lost() && text.contains("memory"), "{text}");
            assert!(text.starts_with("Vulkan could not "), "{text}");
        }
        println!("{failures} calls of {calls:?} failed");
        assert!(failures >= least, "{failures} calls of {calls:?}");
    }
}

#[test]
fn a_lost_device_is_told_and_the_next_draws_the_same() {
    let Some((_alone, instance)) = instance() else { return };
    let field = ball();
    let whole = start(&device(&instance).expect("a device"), &field, 3).expect("a picture");
    assert!(whole.iter().any(|pixel| *pixel != whole[0]), "the ball is seen");
    let mut losses = 0;
    for after in 0.. {
        let gpu = device(&instance).expect("a device");
        faults::plan(Some(Fault { calls: Calls::Submit, after, times: 1, why: Why::Lost }));
        let started = start(&gpu, &field, 3);
        let failed = faults::failed();
        faults::plan(None);
        drop(gpu);
        if failed == 0 {
            break;
        }
        losses += 1;
        let error = started.expect_err("the device is lost");
        assert!(error.is_lost(), "{error}");
        let again = start(&device(&instance).expect("a device"), &field, 3).expect("a picture");
        assert!(again == whole, "after the loss at submission {after}");
    }
    println!("lost at each of {losses} submissions");
    assert!(losses >= 10, "{losses}");
    assert_eq!(instance.messages(), Vec::<String>::new());
}

/// A frame whose commands were never handed over is no reason to wait for it.
#[test]
fn a_frame_that_failed_is_not_waited_for() {
    let Some((_alone, instance)) = instance() else { return };
    let gpu = device(&instance).expect("a device");
    let mut renderer =
        Renderer::new(&gpu, Offscreen::format(1, 1, false), N, &[]).expect("a renderer");
    let screen = Offscreen::new(&gpu, &renderer, SIZE).expect("an image");
    for i in 0..6 {
        let fault = Fault { calls: Calls::Submit, after: 0, times: 1, why: Why::HostMemory };
        faults::plan((i % 2 == 1).then_some(fault));
        renderer.begin().expect("no wait");
        let drawn = renderer.draw(&alone(&[AHEAD]), &screen.surface, 0, Sync::default());
        assert_eq!(drawn.is_ok(), i % 2 == 0, "{drawn:?}");
    }
    faults::plan(None);
    drop((screen, renderer, gpu));
    assert_eq!(instance.messages(), Vec::<String>::new());
}

/// Asked for density maps, a device without them says so once, and draws without.
#[test]
fn without_density_maps_pictures_are_shaded_alike() {
    let Some((_alone, instance)) = instance() else { return };
    let field = ball();
    let plain = device(&instance).expect("a device");
    assert_eq!(plain.lacks, Vec::<&str>::new());
    let whole = start(&plain, &field, 1).expect("a picture");
    let options = Options { density_map: true, ..Options::default() };
    let gpu = Gpu::new(instance.clone(), &options, |_, _| true).expect("a device");
    if gpu.needs.density_map {
        println!("{} has density maps: nothing to see here", gpu.name);
        return;
    }
    assert_eq!(gpu.lacks.len(), 1);
    assert!(gpu.lacks[0].contains("VK_EXT_fragment_density_map"), "{}", gpu.lacks[0]);
    let format = Offscreen::format(4, 1, false);
    let asked = paros_shaders::gpu::Format { density_map: true, ..format };
    let renderer = Renderer::new(&gpu, asked, N, &[]).expect("a renderer");
    assert_eq!(*renderer.format(), format);
    drop(renderer);
    assert!(start(&gpu, &field, 1).expect("a picture") == whole);
    assert_eq!(instance.messages(), Vec::<String>::new());
}
