//! Post-processing of the SPIR-V words that `naga` writes.

/// Opcodes and operands of the SPIR-V specification.
const OP_CAPABILITY: u32 = 17;
const OP_LOOP_MERGE: u32 = 246;
const DONT_UNROLL: u32 = 2;
/// Storage of 16 bits in buffers and interfaces, which `naga` declares for any half-precision arithmetic.
/// The programs don't use it, and few phones offer it.
const STORAGE_16: [u32; 3] = [4433, 4434, 4436];

/// Permission for a driver to unroll a program's loops.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum LoopUnrolling {
    Allowed,
    /// Every loop is marked `DontUnroll`: a phone's driver needs three times the registers when it unrolls
    /// a march.
    Forbidden,
}

/// Removes unused capabilities from a program's SPIR-V words, and marks its loops.
pub(crate) fn postprocess_spirv(words: &[u32], unrolling: LoopUnrolling) -> Vec<u32> {
    const HEADER: usize = 5;
    let mut out = words[..HEADER].to_vec();
    let mut rest = &words[HEADER..];
    while let [first, ..] = rest {
        let (instruction, after) = rest.split_at((first >> 16) as usize);
        rest = after;
        match (first & 0xffff, instruction) {
            (OP_CAPABILITY, [_, capability]) if STORAGE_16.contains(capability) => {}
            (OP_LOOP_MERGE, [_, merge, next, _]) if unrolling == LoopUnrolling::Forbidden => {
                out.extend([*first, *merge, *next, DONT_UNROLL]);
            }
            _ => out.extend(instruction),
        }
    }
    out
}
