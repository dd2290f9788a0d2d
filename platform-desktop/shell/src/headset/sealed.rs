//! Small files of a headset: a magic number, a version, a body, and a checksum of all bytes before it.

use paros_core::codec::{BadBytes, ByteReader};
use paros_core::internals::{ByteWriter, checksum};

const VERSION: u16 = 1;

/// The bytes of a file that are not its body: magic number, version and checksum.
pub const SEAL_BYTES: usize = 4 + 2 + 8;

/// A kind of file.
#[derive(Clone, Copy, Debug)]
pub struct SealedFormat {
    /// The magic number.
    pub magic: [u8; 4],
    /// The expectation that the error names if the magic number differs.
    pub expected: &'static str,
}

impl SealedFormat {
    /// Encodes a file of `N` bytes; `write_body` writes the `N` - [`SEAL_BYTES`] bytes of the body.
    pub fn seal<const N: usize>(self, write_body: impl FnOnce(&mut ByteWriter<'_>)) -> [u8; N] {
        let mut bytes = [0; N];
        let (body, end) = bytes.split_at_mut(N - size_of::<u64>());
        let mut to = ByteWriter::new(body);
        to.bytes(&self.magic);
        to.u16(VERSION);
        write_body(&mut to);
        end.copy_from_slice(&checksum(body).to_le_bytes());
        bytes
    }

    /// Decodes a file; `read_body` decodes its body.
    ///
    /// # Errors
    /// Returns the first place at which the bytes differ from what [`Self::seal`] writes.
    pub fn open<T>(
        self,
        bytes: &[u8],
        read_body: impl FnOnce(&mut ByteReader<'_>) -> Result<T, BadBytes>,
    ) -> Result<T, BadBytes> {
        let mut from = ByteReader::new(bytes);
        let bad = from.error_here(self.expected);
        if from.bytes(4)? != self.magic {
            return Err(bad);
        }
        let bad = from.error_here("version 1");
        if from.u16()? != VERSION {
            return Err(bad);
        }
        let body = read_body(&mut from)?;
        let sealed = from.offset();
        let bad = from.error_here("the checksum of the bytes before it");
        if from.u64()? != checksum(&bytes[..sealed]) {
            return Err(bad);
        }
        from.expect_end()?;
        Ok(body)
    }
}
