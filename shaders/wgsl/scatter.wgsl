// Boxes of staged bytes into the solid textures, all by one dispatch: a copy takes some drivers two
// microseconds for each slice of each one.

// As `src/gpu/scatter.rs` has it.
struct Patch {
    texture: u32,
    // The first of its bytes, among those staged.
    at: u32,
    min: array<u32, 3>,
    size: array<u32, 3>,
}

@group(0) @binding(0) var<storage, read> boxes: array<Patch>;
// Four bytes each.
@group(0) @binding(1) var<storage, read> staged: array<u32>;
@group(0) @binding(2) var level_0: texture_storage_3d<r8unorm, write>;
@group(0) @binding(3) var level_1: texture_storage_3d<r8unorm, write>;
@group(0) @binding(4) var level_2: texture_storage_3d<r8unorm, write>;
@group(0) @binding(5) var level_3: texture_storage_3d<r8unorm, write>;
@group(0) @binding(6) var cells: texture_storage_3d<r8unorm, write>;

const THREADS: u32 = 64;

@compute @workgroup_size(THREADS)
fn compute(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let one = boxes[group.x];
    let row = one.size[0];
    let slice = row * one.size[1];
    let least = vec3<u32>(one.min[0], one.min[1], one.min[2]);
    for (var i = group.y * THREADS + thread; i < slice * one.size[2]; i += groups.y * THREADS) {
        let place = least + vec3<u32>(i % row, i / row % one.size[1], i / slice);
        let at = one.at + i;
        let texel = vec4<f32>(f32(extractBits(staged[at / 4u], at % 4u * 8u, 8u)) / 255.0);
        switch one.texture {
            case 0u: { textureStore(level_0, place, texel); }
            case 1u: { textureStore(level_1, place, texel); }
            case 2u: { textureStore(level_2, place, texel); }
            case 3u: { textureStore(level_3, place, texel); }
            default: { textureStore(cells, place, texel); }
        }
    }
}
