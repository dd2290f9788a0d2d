// Texture upload by one compute dispatch: boxes of staged bytes into the 3D textures. On some
// drivers a copy takes two microseconds for each slice of each box.
#import paros::constants::{BINDING_CELL_IMAGE, BINDING_GRADIENT_IMAGE, BINDING_LEVELS}
#import paros::constants::{BINDING_PATCHES, BINDING_STAGED}

// Mirrored in `src/gpu/pipelines/scatter.rs`; the build checks the offsets.
struct Patch {
    texture: u32,
    // Index of its first byte among those staged.
    at: u32,
    min: array<u32, 3>,
    size: array<u32, 3>,
}

@group(0) @binding(BINDING_PATCHES) var<storage, read> patches: array<Patch>;
// Four bytes each, the first one lowest.
@group(0) @binding(BINDING_STAGED) var<storage, read> staged: array<u32>;
@group(0) @binding(BINDING_LEVELS) var level_0: texture_storage_3d<r8unorm, write>;
@group(0) @binding(BINDING_LEVELS + 1u) var level_1: texture_storage_3d<r8unorm, write>;
@group(0) @binding(BINDING_LEVELS + 2u) var level_2: texture_storage_3d<r8unorm, write>;
@group(0) @binding(BINDING_LEVELS + 3u) var level_3: texture_storage_3d<r8unorm, write>;
@group(0) @binding(BINDING_CELL_IMAGE) var cells: texture_storage_3d<r8unorm, write>;
@group(0) @binding(BINDING_GRADIENT_IMAGE) var gradient: texture_storage_3d<rgba8snorm, write>;

const THREADS: u32 = 64;

@compute @workgroup_size(THREADS)
fn compute(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let upload = patches[group.x];
    let row = upload.size[0];
    let slice = row * upload.size[1];
    let min_texel = vec3<u32>(upload.min[0], upload.min[1], upload.min[2]);
    for (var i = group.y * THREADS + thread; i < slice * upload.size[2]; i += groups.y * THREADS) {
        let texel_position = min_texel + vec3<u32>(i % row, i / row % upload.size[1], i / slice);
        let at = upload.at + i;
        let texel = vec4<f32>(f32(extractBits(staged[at / 4u], at % 4u * 8u, 8u)) / 255.0);
        switch upload.texture {
            case 0u: { textureStore(level_0, texel_position, texel); }
            case 1u: { textureStore(level_1, texel_position, texel); }
            case 2u: { textureStore(level_2, texel_position, texel); }
            case 3u: { textureStore(level_3, texel_position, texel); }
            case 4u: { textureStore(cells, texel_position, texel); }
            // Four bytes a texel.
            default: {
                textureStore(gradient, texel_position, unpack4x8snorm(staged[upload.at / 4u + i]));
            }
        }
    }
}
