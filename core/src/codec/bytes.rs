//! Fixed-width little-endian bytes, written to and read from the caller's buffer.

/// The error of a decoder: the bytes end within the value at this offset, or the value is invalid.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BadBytes {
    /// Offset of the value from the start of the bytes.
    pub offset: usize,
    /// The expected value, for messages.
    pub expected: &'static str,
}

/// Writes values in sequence to a buffer. Values that don't fit are counted but not written, so writing
/// to an empty buffer measures the length needed.
#[derive(Debug)]
pub struct ByteWriter<'a> {
    bytes: &'a mut [u8],
    len: usize,
}

impl<'a> ByteWriter<'a> {
    /// Creates a writer at the front of `bytes`.
    #[must_use]
    pub fn new(bytes: &'a mut [u8]) -> Self {
        ByteWriter { bytes, len: 0 }
    }

    /// Returns the number of bytes written so far, including those that didn't fit.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns `true` if nothing was written.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Returns `true` if everything fitted.
    #[must_use]
    pub fn fits(&self) -> bool {
        self.len <= self.bytes.len()
    }

    /// Writes bytes.
    pub fn bytes(&mut self, value: &[u8]) {
        let end = self.len + value.len();
        if let Some(room) = self.bytes.get_mut(self.len..end) {
            room.copy_from_slice(value);
        }
        self.len = end;
    }

    /// Writes a byte.
    pub fn u8(&mut self, value: u8) {
        self.bytes(&[value]);
    }
}

/// Reads values in sequence from a slice.
#[derive(Debug)]
pub struct ByteReader<'a> {
    bytes: &'a [u8],
    offset: usize,
}

impl<'a> ByteReader<'a> {
    /// Creates a reader at the front of `bytes`.
    #[must_use]
    pub const fn new(bytes: &'a [u8]) -> Self {
        ByteReader { bytes, offset: 0 }
    }

    /// Returns the offset of the next value.
    #[must_use]
    pub const fn offset(&self) -> usize {
        self.offset
    }

    /// Reads the next `len` bytes.
    ///
    /// # Errors
    /// [`BadBytes`] if there are fewer.
    pub fn bytes(&mut self, len: usize) -> Result<&'a [u8], BadBytes> {
        let end = self.offset.saturating_add(len);
        let value = self.bytes.get(self.offset..end).ok_or(self.error_here("more bytes"))?;
        self.offset = end;
        Ok(value)
    }

    /// Reads a byte.
    ///
    /// # Errors
    /// [`BadBytes`] at the end.
    pub fn u8(&mut self) -> Result<u8, BadBytes> {
        Ok(self.bytes(1)?[0])
    }

    /// Checks that no bytes are left.
    ///
    /// # Errors
    /// [`BadBytes`] if there are bytes left.
    pub fn expect_end(&self) -> Result<(), BadBytes> {
        if self.offset == self.bytes.len() { Ok(()) } else { Err(self.error_here("the end")) }
    }

    /// Returns the error for an invalid next value.
    #[must_use]
    pub const fn error_here(&self, expected: &'static str) -> BadBytes {
        BadBytes { offset: self.offset, expected }
    }
}

macro_rules! numbers {
    ($($t:ident)*) => {
        impl ByteWriter<'_> {$(
            #[doc = concat!("A ", stringify!($t), ".")]
            pub fn $t(&mut self, value: $t) {
                self.bytes(&value.to_le_bytes());
            }
        )*}
        impl ByteReader<'_> {$(
            #[doc = concat!("A ", stringify!($t), ".")]
            ///
            /// # Errors
            /// [`BadBytes`] at the end.
            pub fn $t(&mut self) -> Result<$t, BadBytes> {
                let mut value = [0; size_of::<$t>()];
                value.copy_from_slice(self.bytes(size_of::<$t>())?);
                Ok($t::from_le_bytes(value))
            }
        )*}
    };
}

numbers! { u16 u32 u64 i8 i16 i32 f32 }
