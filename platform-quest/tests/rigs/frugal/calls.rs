//! Function interposition: a frame's calls into OpenXR and Vulkan, each wrapped by a clock. A function
//! that is not listed here is called directly, and its time counts as the shell's own.

use std::ffi::{CStr, c_char};
use std::mem::transmute_copy;
use std::ptr;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicPtr, Ordering};

use openxr::sys;
use sys::pfn;

use crate::clock::time_foreign_call;

/// The greatest number of functions, of OpenXR and Vulkan together.
const MAX_FUNCTIONS: usize = 64;

/// The original functions, by [`TimedFunction`].
static ORIGINALS: [AtomicPtr<()>; MAX_FUNCTIONS] =
    [const { AtomicPtr::new(ptr::null_mut()) }; MAX_FUNCTIONS];

/// The runtime's own `xrEnumerateViewConfigurationViews`.
static ENUMERATE_VIEWS: AtomicPtr<()> = AtomicPtr::new(ptr::null_mut());

/// Implements `xrEnumerateViewConfigurationViews` with views of 32 x 24 pixels, so that a software device
/// keeps pace. The number of pixels doesn't affect the measured thread.
unsafe extern "system" fn enumerate_low_resolution_views(
    instance: sys::Instance,
    system: sys::SystemId,
    kind: sys::ViewConfigurationType,
    capacity: u32,
    count: *mut u32,
    views: *mut sys::ViewConfigurationView,
) -> sys::Result {
    let real = ENUMERATE_VIEWS.load(Ordering::Relaxed);
    // SAFETY: it was stored as what it is.
    let real: pfn::EnumerateViewConfigurationViews = unsafe { transmute_copy(&real) };
    // SAFETY: as the caller has it.
    let done = unsafe { real(instance, system, kind, capacity, count, views) };
    for i in 0..capacity as usize {
        // SAFETY: the caller has room for so many.
        let view = unsafe { &mut *views.add(i) };
        (view.recommended_image_rect_width, view.recommended_image_rect_height) = (32, 24);
    }
    done
}

/// `true` if `xrEndFrame` was called since the last [`take_frame_ended`].
static FRAME_ENDED: AtomicBool = AtomicBool::new(false);

/// Returns `true` if a frame has ended since the last call.
pub(crate) fn take_frame_ended() -> bool {
    FRAME_ENDED.swap(false, Ordering::Relaxed)
}

/// A function pointer that can be wrapped by a clock.
trait AddClock: Copy {
    /// Returns a function that times this one and stores it as original number `SLOT`.
    fn with_clock<const SLOT: usize>(self) -> Self;
}

macro_rules! timed {
    ($($($argument:ident: $ty:ident),*;)*) => {$(
        impl<R, $($ty),*> AddClock for unsafe extern "system" fn($($ty),*) -> R {
            fn with_clock<const SLOT: usize>(self) -> Self {
                unsafe extern "system" fn call_with_clock<const SLOT: usize, R, $($ty),*>(
                    $($argument: $ty),*
                ) -> R {
                    let real = ORIGINALS[SLOT].load(Ordering::Relaxed);
                    type Real<R, $($ty),*> = unsafe extern "system" fn($($ty),*) -> R;
                    // SAFETY: the one function under this number is of this type.
                    let real: Real<R, $($ty),*> = unsafe { transmute_copy(&real) };
                    if SLOT == TimedFunction::EndFrame as usize {
                        FRAME_ENDED.store(true, Ordering::Relaxed);
                    }
                    // SAFETY: as the caller has it.
                    time_foreign_call(|| unsafe { real($($argument),*) })
                }
                ORIGINALS[SLOT].store(self as *mut (), Ordering::Relaxed);
                call_with_clock::<SLOT, R, $($ty),*>
            }
        }
    )*};
}

timed! {
    a: A;
    a: A, b: B;
    a: A, b: B, c: C;
    a: A, b: B, c: C, d: D;
    a: A, b: B, c: C, d: D, e: E;
    a: A, b: B, c: C, d: D, e: E, f: F;
    a: A, b: B, c: C, d: D, e: E, f: F, g: G;
    a: A, b: B, c: C, d: D, e: E, f: F, g: G, h: H;
    a: A, b: B, c: C, d: D, e: E, f: F, g: G, h: H, i: J;
    a: A, b: B, c: C, d: D, e: E, f: F, g: G, h: H, i: J, j: K;
}

macro_rules! functions {
    (
        openxr: $($name:literal: $ty:ident,)*;
        vulkan: $($field:ident($($any:tt),*),)*
    ) => {
        /// The index of each function in [`ORIGINALS`].
        #[derive(Clone, Copy)]
        #[expect(non_camel_case_types, reason = "named as the functions are")]
        enum TimedFunction {
            $($ty,)*
            $($field,)*
            Count,
        }

        const _: () = assert!(TimedFunction::Count as usize <= MAX_FUNCTIONS);

        /// Returns a function of OpenXR, wrapped by a clock if it is listed.
        ///
        /// # Safety
        /// It is the function of this name.
        unsafe fn with_clock_by_name(name: &CStr, real: pfn::VoidFunction) -> pfn::VoidFunction {
            match name.to_bytes() {
                b"xrEnumerateViewConfigurationViews" => {
                    // SAFETY: the type goes with the name.
                    unsafe { ENUMERATE_VIEWS.store(transmute_copy(&real), Ordering::Relaxed) };
                    let small: pfn::EnumerateViewConfigurationViews = enumerate_low_resolution_views;
                    // SAFETY: who calls it gives it its type again.
                    unsafe { transmute_copy(&small) }
                }
                $($name => {
                    // SAFETY: the type goes with the name.
                    let real: pfn::$ty = unsafe { transmute_copy(&real) };
                    let timed = real.with_clock::<{ TimedFunction::$ty as usize }>();
                    // SAFETY: who calls it gives it its type again.
                    unsafe { transmute_copy(&timed) }
                })*
                _ => real,
            }
        }

        /// Returns the device with its listed functions wrapped by clocks.
        pub(crate) fn device_with_clocks(device: ash::Device) -> ash::Device {
            let mut table = device.fp_v1_0().clone();
            $({
                let real: unsafe extern "system" fn($($any),*) -> _ = table.$field;
                let timed = real.with_clock::<{ TimedFunction::$field as usize }>();
                // SAFETY: it is the field's type, but for lifetimes.
                unsafe { replace_function(timed, &raw mut table.$field) };
            })*
            let (first, second, third) = (device.fp_v1_1(), device.fp_v1_2(), device.fp_v1_3());
            let (first, second, third) = (first.clone(), second.clone(), third.clone());
            ash::Device::from_parts_1_3(device.handle(), table, first, second, third)
        }
    };
}

functions! {
    openxr:
        b"xrPollEvent": PollEvent,
        b"xrWaitFrame": WaitFrame,
        b"xrBeginFrame": BeginFrame,
        b"xrEndFrame": EndFrame,
        b"xrAcquireSwapchainImage": AcquireSwapchainImage,
        b"xrWaitSwapchainImage": WaitSwapchainImage,
        b"xrReleaseSwapchainImage": ReleaseSwapchainImage,
        b"xrLocateSpace": LocateSpace,
        b"xrLocateViews": LocateViews,
        b"xrLocateHandJointsEXT": LocateHandJointsEXT,
        b"xrSyncActions": SyncActions,
        b"xrGetActionStateBoolean": GetActionStateBoolean,
        b"xrGetActionStateFloat": GetActionStateFloat,
        b"xrGetActionStateVector2f": GetActionStateVector2f,
        b"xrGetCurrentInteractionProfile": GetCurrentInteractionProfile,
        b"xrApplyHapticFeedback": ApplyHapticFeedback,;
    vulkan:
        wait_for_fences(_, _, _, _, _),
        reset_fences(_, _, _),
        get_query_pool_results(_, _, _, _, _, _, _, _),
        queue_submit(_, _, _, _),
        begin_command_buffer(_, _),
        end_command_buffer(_),
        cmd_begin_query(_, _, _, _),
        cmd_begin_render_pass(_, _, _),
        cmd_bind_descriptor_sets(_, _, _, _, _, _, _, _),
        cmd_bind_index_buffer(_, _, _, _),
        cmd_bind_pipeline(_, _, _),
        cmd_bind_vertex_buffers(_, _, _, _, _),
        cmd_clear_color_image(_, _, _, _, _, _),
        cmd_copy_buffer(_, _, _, _, _),
        cmd_copy_buffer_to_image(_, _, _, _, _, _),
        cmd_draw(_, _, _, _, _),
        cmd_draw_indexed(_, _, _, _, _, _),
        cmd_end_query(_, _, _),
        cmd_end_render_pass(_),
        cmd_pipeline_barrier(_, _, _, _, _, _, _, _, _, _),
        cmd_reset_query_pool(_, _, _, _),
        cmd_set_scissor(_, _, _, _),
        cmd_set_viewport(_, _, _, _),
        cmd_write_timestamp(_, _, _, _),
}

/// Writes a function into a field of a function table.
///
/// # Safety
/// They are of one type, but for lifetimes.
unsafe fn replace_function<F, T>(function: F, field: *mut T) {
    // SAFETY: the caller's.
    unsafe { field.cast::<F>().write(function) };
}

/// The loader's entry, to which the wrapped one forwards.
static LOADER: OnceLock<openxr::Entry> = OnceLock::new();

/// Returns the loader's entry with its listed functions wrapped by clocks. A process has one.
pub(crate) fn entry_with_clocks(loader: openxr::Entry) -> openxr::Result<openxr::Entry> {
    LOADER.get_or_init(|| loader);
    // SAFETY: all functions are the loader's, though some have a clock around them.
    unsafe { openxr::Entry::from_get_instance_proc_addr(get_instance_proc_addr, &()) }
}

unsafe extern "system" fn get_instance_proc_addr(
    instance: sys::Instance,
    name: *const c_char,
    function: *mut Option<pfn::VoidFunction>,
) -> sys::Result {
    let loader = LOADER.get().expect("an entry was made");
    // SAFETY: as the caller has it.
    let found = unsafe { (loader.fp().get_instance_proc_addr)(instance, name, function) };
    // SAFETY: the call has succeeded, and the name is a C string.
    unsafe {
        if found == sys::Result::SUCCESS {
            *function = (*function).map(|real| with_clock_by_name(CStr::from_ptr(name), real));
        }
    }
    found
}
