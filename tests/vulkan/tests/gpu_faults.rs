//! The renderer under driver failures: memory that runs out at any call of the start, and a device that is
//! lost at any frame. Each failure must be a clear error, leave no object on the device (validation checks
//! this when the device is destroyed), and the next start must draw the same picture.
//!
//! Faults found by these tests: a fence, a framebuffer, a sampler, a command pool and a pipeline that were
//! leaked when a later call failed.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use paros_core::RangeMaps;
use paros_faults::{self as faults, CallGroup, FailureCause, PlannedFault};
use paros_models::cases::scaled_step;
use paros_models::dense::DenseVolume;
use paros_shaders::field::DensityField;
use paros_shaders::gpu::{
    Error, FrameSemaphores, Gpu, Instance, OffscreenTarget, Options, Renderer, SharedGpu,
};
use paros_shaders::upload::VolumeFormat;
use paros_shell::require::require_or_skip;
use paros_tests_vulkan::test_renderer::{AHEAD, metre_wide_sculpture_at_origin};

const N: usize = 32;
const SIZE: [u32; 2] = [96, 80];

/// Serialises the tests, because fault injection is global to the process.
static ALONE: Mutex<()> = Mutex::new(());

/// Returns an instance with validation whose devices can fail; `None` if there is no device.
fn locked_instance() -> Option<(MutexGuard<'static, ()>, Arc<Instance>)> {
    let guard = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    faults::set_planned_fault(None);
    let options = Options { validation: true, ..Options::default() };
    let instance =
        require_or_skip(Instance::create(&options)).expect("Vulkan and its validation")?;
    // The layers may be installed without a driver.
    require_or_skip(create_device(&instance)).expect("a Vulkan device")?;
    Some((guard, instance))
}

fn create_device(instance: &Arc<Instance>) -> Result<SharedGpu, Error> {
    Gpu::choose(instance.clone(), &failing_options(), |_, _| true)
}

/// Returns the options of a device whose calls can fail.
fn failing_options() -> Options {
    Options { device_hook: Some(faults::wrap_device), ..Options::default() }
}

fn ball_field() -> Box<DensityField<N>> {
    let middle = N as f32 / 2.0;
    let dense = DenseVolume::from_fn(N, |at| {
        at.iter().map(|c| (*c as f32 + 0.5 - middle).powi(2)).sum::<f32>() < 12.0 * 12.0
    });
    let mut maps = Box::new(RangeMaps::<N>::new());
    dense.write_maps(&mut maps);
    let mut field = Box::new(DensityField::new());
    field.rebuild_from(&maps);
    field
}

/// Does everything that a shell does, from the device to some frames of a picture.
fn start_and_draw(
    gpu: &SharedGpu,
    field: &DensityField<N>,
    frames: u32,
) -> Result<Vec<[u8; 4]>, Error> {
    let mut renderer = Renderer::new(
        gpu,
        OffscreenTarget::readback_format(4, 1, false),
        VolumeFormat::of::<N, 1>(),
        &[],
    )?;
    let screen = OffscreenTarget::new(gpu, &renderer, SIZE)?;
    let mut loaded = Ok(());
    field.emit_all_regions(|region, bytes| {
        if loaded.is_ok() {
            loaded = renderer.submit_upload_between_frames(region, bytes);
        }
    });
    loaded?;
    for _ in 0..frames {
        renderer.wait_and_begin_frame()?;
        renderer.draw_frame(
            &metre_wide_sculpture_at_origin(&[AHEAD]),
            &screen.target,
            0,
            FrameSemaphores::default(),
        )?;
    }
    renderer.wait_for_frames()?;
    screen.read_pixels(0)
}

#[test]
fn memory_may_run_out_at_any_call_of_the_start() {
    let Some((_alone, instance)) = locked_instance() else { return };
    let field = ball_field();
    // Every third call in the check; the nightly run fails each call.
    let step = scaled_step(3);
    for (calls, least) in [(CallGroup::Memory, 20), (CallGroup::Making, 150)] {
        let mut failures = 0;
        for turn in 0.. {
            let after = turn * step;
            let why =
                if turn % 2 == 0 { FailureCause::DeviceMemory } else { FailureCause::HostMemory };
            let gpu = create_device(&instance).expect("a device");
            // Several calls in a row fail, because exhausted memory doesn't recover by itself.
            faults::set_planned_fault(Some(PlannedFault {
                calls,
                skipped_calls: after,
                failing_calls: 1 + turn % 3,
                cause: why,
            }));
            let started = start_and_draw(&gpu, &field, 1);
            let failed = faults::injected_failure_count();
            faults::set_planned_fault(None);
            drop(gpu);
            assert_eq!(
                instance.validation_messages(),
                Vec::<String>::new(),
                "{calls:?} {after}: {started:?}"
            );
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
        assert!(failures * step >= least, "{failures} calls of {calls:?}");
    }
}

#[test]
fn a_lost_device_is_told_and_the_next_draws_the_same() {
    let Some((_alone, instance)) = locked_instance() else { return };
    let field = ball_field();
    let whole =
        start_and_draw(&create_device(&instance).expect("a device"), &field, 3).expect("a picture");
    assert!(whole.iter().any(|pixel| *pixel != whole[0]), "the ball is seen");
    let mut losses = 0;
    for after in 0.. {
        let gpu = create_device(&instance).expect("a device");
        faults::set_planned_fault(Some(PlannedFault {
            calls: CallGroup::Submit,
            skipped_calls: after,
            failing_calls: 1,
            cause: FailureCause::Lost,
        }));
        let started = start_and_draw(&gpu, &field, 3);
        let failed = faults::injected_failure_count();
        faults::set_planned_fault(None);
        drop(gpu);
        if failed == 0 {
            break;
        }
        losses += 1;
        let error = started.expect_err("the device is lost");
        assert!(error.is_lost(), "{error}");
        let again = start_and_draw(&create_device(&instance).expect("a device"), &field, 3)
            .expect("a picture");
        assert!(again == whole, "after the loss at submission {after}");
    }
    println!("lost at each of {losses} submissions");
    assert!(losses >= 10, "{losses}");
    assert_eq!(instance.validation_messages(), Vec::<String>::new());
}

/// A frame whose commands were never submitted isn't waited for.
#[test]
fn a_frame_that_failed_is_not_waited_for() {
    let Some((_alone, instance)) = locked_instance() else { return };
    let gpu = create_device(&instance).expect("a device");
    let mut renderer = Renderer::new(
        &gpu,
        OffscreenTarget::readback_format(1, 1, false),
        VolumeFormat::of::<N, 1>(),
        &[],
    )
    .expect("a renderer");
    let screen = OffscreenTarget::new(&gpu, &renderer, SIZE).expect("an image");
    for i in 0..6 {
        let fault = PlannedFault {
            calls: CallGroup::Submit,
            skipped_calls: 0,
            failing_calls: 1,
            cause: FailureCause::HostMemory,
        };
        faults::set_planned_fault((i % 2 == 1).then_some(fault));
        renderer.wait_and_begin_frame().expect("no wait");
        let drawn = renderer.draw_frame(
            &metre_wide_sculpture_at_origin(&[AHEAD]),
            &screen.target,
            0,
            FrameSemaphores::default(),
        );
        assert_eq!(drawn.is_ok(), i % 2 == 0, "{drawn:?}");
    }
    faults::set_planned_fault(None);
    drop((screen, renderer, gpu));
    assert_eq!(instance.validation_messages(), Vec::<String>::new());
}

/// A device without density maps reports their lack once if they are requested, and draws without them.
#[test]
fn without_density_maps_pictures_are_shaded_alike() {
    let Some((_alone, instance)) = locked_instance() else { return };
    let field = ball_field();
    let plain = create_device(&instance).expect("a device");
    assert_eq!(plain.missing_features, Vec::<&str>::new());
    let whole = start_and_draw(&plain, &field, 1).expect("a picture");
    let options = Options { density_map: true, ..failing_options() };
    let gpu = Gpu::choose(instance.clone(), &options, |_, _| true).expect("a device");
    if gpu.features.density_map {
        println!("{} has density maps: nothing to see here", gpu.name);
        return;
    }
    assert_eq!(gpu.missing_features.len(), 1);
    assert!(
        gpu.missing_features[0].contains("VK_EXT_fragment_density_map"),
        "{}",
        gpu.missing_features[0]
    );
    let format = OffscreenTarget::readback_format(4, 1, false);
    let asked = paros_shaders::gpu::TargetFormat { density_map: true, ..format };
    let renderer = Renderer::new(&gpu, asked, VolumeFormat::of::<N, 1>(), &[]).expect("a renderer");
    assert_eq!(*renderer.format(), format);
    drop(renderer);
    assert!(start_and_draw(&gpu, &field, 1).expect("a picture") == whole);
    assert_eq!(instance.validation_messages(), Vec::<String>::new());
}
