//! Fixed-width little-endian bytes, written to and read from the caller's buffer.

/// The bytes end before the value at this offset, or the value there can't be.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BadBytes {
    /// Offset of the value from the start of the bytes.
    pub offset: usize,
    /// What should be there.
    pub expected: &'static str,
}

/// Writes values one after the other. What doesn't fit is counted but not written, so that a
/// buffer's needed length can be learnt from an empty one.
#[derive(Debug)]
pub struct Writer<'a> {
    bytes: &'a mut [u8],
    len: usize,
}

impl<'a> Writer<'a> {
    /// Starts at the front of `bytes`.
    #[must_use]
    pub fn new(bytes: &'a mut [u8]) -> Self {
        Writer { bytes, len: 0 }
    }

    /// Bytes written so far, or that would have been.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether nothing was written.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether all of it fitted.
    #[must_use]
    pub fn fits(&self) -> bool {
        self.len <= self.bytes.len()
    }

    /// Copies bytes.
    pub fn bytes(&mut self, value: &[u8]) {
        let end = self.len + value.len();
        if let Some(room) = self.bytes.get_mut(self.len..end) {
            room.copy_from_slice(value);
        }
        self.len = end;
    }

    /// A byte.
    pub fn u8(&mut self, value: u8) {
        self.bytes(&[value]);
    }
}

/// Reads values one after the other.
#[derive(Debug)]
pub struct Reader<'a> {
    bytes: &'a [u8],
    offset: usize,
}

impl<'a> Reader<'a> {
    /// Starts at the front of `bytes`.
    #[must_use]
    pub const fn new(bytes: &'a [u8]) -> Self {
        Reader { bytes, offset: 0 }
    }

    /// Where the next value is.
    #[must_use]
    pub const fn offset(&self) -> usize {
        self.offset
    }

    /// The next `len` bytes.
    ///
    /// # Errors
    /// [`BadBytes`] if there are fewer.
    pub fn bytes(&mut self, len: usize) -> Result<&'a [u8], BadBytes> {
        let end = self.offset.saturating_add(len);
        let value = self.bytes.get(self.offset..end).ok_or(self.bad("more bytes"))?;
        self.offset = end;
        Ok(value)
    }

    /// A byte.
    ///
    /// # Errors
    /// [`BadBytes`] at the end.
    pub fn u8(&mut self) -> Result<u8, BadBytes> {
        Ok(self.bytes(1)?[0])
    }

    /// That nothing is left.
    ///
    /// # Errors
    /// [`BadBytes`] if something is.
    pub fn end(&self) -> Result<(), BadBytes> {
        if self.offset == self.bytes.len() { Ok(()) } else { Err(self.bad("the end")) }
    }

    /// The error that the next value isn't what is expected.
    #[must_use]
    pub const fn bad(&self, expected: &'static str) -> BadBytes {
        BadBytes { offset: self.offset, expected }
    }
}

macro_rules! numbers {
    ($($t:ident)*) => {
        impl Writer<'_> {$(
            #[doc = concat!("A ", stringify!($t), ".")]
            pub fn $t(&mut self, value: $t) {
                self.bytes(&value.to_le_bytes());
            }
        )*}
        impl Reader<'_> {$(
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
