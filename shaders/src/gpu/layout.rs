//! What the programs read, as bytes: the mirror of `wgsl/layout.wgsl`.

use bytemuck::{Pod, Zeroable};

/// An eye; see the shader's structure of this name.
#[derive(Clone, Copy, Default, Pod, Zeroable, Debug)]
#[repr(C)]
#[allow(missing_docs)] // they are the shader's, which says what they are
pub struct View {
    pub clip_from_room: [[f32; 4]; 4],
    pub eye: [f32; 4],
    pub ray_base: [f32; 4],
    pub ray_x: [f32; 4],
    pub ray_y: [f32; 4],
}

/// The sculpture and the light; see the shader's structure of this name.
#[derive(Clone, Copy, Default, Pod, Zeroable, Debug)]
#[repr(C)]
#[allow(missing_docs)] // they are the shader's, which says what they are
pub struct Frame {
    pub views: [View; 2],
    pub shadow_from_grid: [[f32; 4]; 4],
    pub room_from_grid: [[f32; 4]; 4],
    pub sun_grid: [f32; 4],
    pub sun_room: [f32; 4],
    pub sun_color: [f32; 4],
    pub ambient: [[f32; 4]; 9],
    pub depth: [f32; 4],
    pub extent: [f32; 4],
    pub cells: [f32; 4],
}

const _: () = {
    assert!(size_of::<View>() == VIEW_BYTES, "View differs from the shader's");
    assert!(size_of::<Frame>() == FRAME_BYTES, "Frame differs from the shader's");
};

include!(concat!(env!("OUT_DIR"), "/layout.rs"));
