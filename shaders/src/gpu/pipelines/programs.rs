//! The shader programs, as SPIR-V compiled at build time.

/// A SPIR-V program with one entry point.
#[derive(Clone, Copy, Debug)]
pub struct ShaderProgram {
    /// The name of the program and of its file.
    pub name: &'static str,
    bytes: &'static [u8],
}

impl ShaderProgram {
    /// Returns the SPIR-V words.
    #[must_use]
    pub fn words(&self) -> Vec<u32> {
        let word = |bytes: &[u8]| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        self.bytes.chunks_exact(4).map(word).collect()
    }
}

include!(concat!(env!("OUT_DIR"), "/programs.rs"));
