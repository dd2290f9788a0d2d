//! The calls of a frame into OpenXR and Vulkan, with a clock around each. A function that is not
//! named here is called as it is, and its time passes for the shell's own.

use std::ffi::{CStr, c_char};
use std::mem::transmute_copy;
use std::ptr;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicPtr, Ordering};

use openxr::sys;
use sys::pfn;

use crate::clock::elsewhere;

/// Room for the functions of both.
const ROOM: usize = 64;

/// The functions themselves.
static REAL: [AtomicPtr<()>; ROOM] = [const { AtomicPtr::new(ptr::null_mut()) }; ROOM];

/// The runtime's own `xrEnumerateViewConfigurationViews`.
static VIEWS: AtomicPtr<()> = AtomicPtr::new(ptr::null_mut());

/// The views of a headset of few pixels, so that a device of software keeps pace: how many there
/// are is nothing to the thread that is looked at.
unsafe extern "system" fn small_views(
    instance: sys::Instance,
    system: sys::SystemId,
    kind: sys::ViewConfigurationType,
    capacity: u32,
    count: *mut u32,
    views: *mut sys::ViewConfigurationView,
) -> sys::Result {
    let real = VIEWS.load(Ordering::Relaxed);
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

/// A frame was ended.
static ENDED: AtomicBool = AtomicBool::new(false);

/// Whether a frame was ended since this was asked last.
pub(crate) fn frame_has_ended() -> bool {
    ENDED.swap(false, Ordering::Relaxed)
}

/// A function that can have a clock around it.
trait Timed: Copy {
    /// A function that calls this one, which is kept under a number of its own.
    fn timed<const I: usize>(self) -> Self;
}

macro_rules! timed {
    ($($($argument:ident: $ty:ident),*;)*) => {$(
        impl<R, $($ty),*> Timed for unsafe extern "system" fn($($ty),*) -> R {
            fn timed<const I: usize>(self) -> Self {
                unsafe extern "system" fn around<const I: usize, R, $($ty),*>(
                    $($argument: $ty),*
                ) -> R {
                    let real = REAL[I].load(Ordering::Relaxed);
                    type Real<R, $($ty),*> = unsafe extern "system" fn($($ty),*) -> R;
                    // SAFETY: the one function under this number is of this type.
                    let real: Real<R, $($ty),*> = unsafe { transmute_copy(&real) };
                    if I == Number::EndFrame as usize {
                        ENDED.store(true, Ordering::Relaxed);
                    }
                    // SAFETY: as the caller has it.
                    elsewhere(|| unsafe { real($($argument),*) })
                }
                REAL[I].store(self as *mut (), Ordering::Relaxed);
                around::<I, R, $($ty),*>
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
        /// Their numbers.
        #[derive(Clone, Copy)]
        #[expect(non_camel_case_types, reason = "named as the functions are")]
        enum Number {
            $($ty,)*
            $($field,)*
            Count,
        }

        const _: () = assert!(Number::Count as usize <= ROOM);

        /// A function of OpenXR with a clock around it, if it has a number.
        ///
        /// # Safety
        /// It is the function of this name.
        unsafe fn around(name: &CStr, real: pfn::VoidFunction) -> pfn::VoidFunction {
            match name.to_bytes() {
                b"xrEnumerateViewConfigurationViews" => {
                    // SAFETY: the type goes with the name.
                    unsafe { VIEWS.store(transmute_copy(&real), Ordering::Relaxed) };
                    let small: pfn::EnumerateViewConfigurationViews = small_views;
                    // SAFETY: who calls it gives it its type again.
                    unsafe { transmute_copy(&small) }
                }
                $($name => {
                    // SAFETY: the type goes with the name.
                    let real: pfn::$ty = unsafe { transmute_copy(&real) };
                    let timed = real.timed::<{ Number::$ty as usize }>();
                    // SAFETY: who calls it gives it its type again.
                    unsafe { transmute_copy(&timed) }
                })*
                _ => real,
            }
        }

        /// A device with clocks around its functions.
        pub(crate) fn device(device: ash::Device) -> ash::Device {
            let mut table = device.fp_v1_0().clone();
            $({
                let real: unsafe extern "system" fn($($any),*) -> _ = table.$field;
                let timed = real.timed::<{ Number::$field as usize }>();
                // SAFETY: it is the field's type, but for lifetimes.
                unsafe { put(timed, &raw mut table.$field) };
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

/// Puts a function in place of one.
///
/// # Safety
/// They are of one type, but for lifetimes.
unsafe fn put<F, T>(function: F, place: *mut T) {
    // SAFETY: the caller's.
    unsafe { place.cast::<F>().write(function) };
}

/// The loader's own way to its functions.
static LOADER: OnceLock<openxr::Entry> = OnceLock::new();

/// A way to a loader's functions with clocks around them. It is the only one of its kind.
pub(crate) fn entry(loader: openxr::Entry) -> openxr::Result<openxr::Entry> {
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
            *function = (*function).map(|real| around(CStr::from_ptr(name), real));
        }
    }
    found
}
