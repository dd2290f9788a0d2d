//! The numbers after the header of a PLY file, in text and binary.

use super::super::text::{self, Lines, parse_number, quote};
use super::header::{Element, Encoding, Header, Number, Property};

/// A reader of numbers.
pub(super) enum Body<'a> {
    Text(TextBody<'a>),
    Binary { bytes: &'a [u8], length: usize, encoding: Encoding },
}

/// The words of a text. If each element has its own line, elements start at line starts, and a line may have
/// more words than the header says. Otherwise an element may take several lines.
pub(super) struct TextBody<'a> {
    lines: Lines<'a>,
    line: &'a [u8],
    lines_of_header: usize,
    has_element_per_line: bool,
}

impl<'a> Body<'a> {
    pub(super) fn new(header: &Header, bytes: &'a [u8]) -> Self {
        if header.encoding != Encoding::Text {
            return Body::Binary { bytes, length: bytes.len(), encoding: header.encoding };
        }
        let with_properties = header.elements.iter().filter(|e| !e.properties.is_empty());
        let elements = with_properties.fold(0usize, |sum, e| sum.saturating_add(e.count));
        let filled = Lines::new(bytes).filter(|line| !text::trim(line).is_empty()).count();
        Body::Text(TextBody {
            lines: Lines::new(bytes),
            line: b"",
            lines_of_header: header.lines,
            has_element_per_line: filled >= elements,
        })
    }

    /// Checks that the file is long enough for the elements, before memory is allocated for them.
    pub(super) fn check_room_for(&self, element: &Element) -> Result<(), String> {
        let (left, least) = match self {
            Body::Text(text) => (text.line.len() + text.lines.rest().len(), 1),
            Body::Binary { bytes, .. } => {
                let least = element.properties.iter().map(|p| p.count.unwrap_or(p.number).size());
                (bytes.len(), least.sum::<usize>().max(1))
            }
        };
        if element.count.checked_mul(least).is_some_and(|needed| needed <= left) {
            return Ok(());
        }
        let Element { name, count, .. } = element;
        Err(format!(
            "found {left} bytes for {count} elements `{name}`; expected at least {least} for each"
        ))
    }

    pub(super) fn begin_element(&mut self) {
        if let Body::Text(text) = self
            && text.has_element_per_line
        {
            text.line = b"";
        }
    }

    /// Skips all elements of a kind.
    pub(super) fn skip_elements(&mut self, element: &Element) -> Result<(), String> {
        self.check_room_for(element)?;
        if let (Body::Binary { bytes, .. }, Some(size)) = (&mut *self, element.fixed_size()) {
            *bytes = &bytes[element.count * size..];
            return Ok(());
        }
        for i in 0..element.count {
            self.begin_element();
            for property in &element.properties {
                self.skip_property(property).map_err(|why| self.place(element, i, &why))?;
            }
        }
        Ok(())
    }

    pub(super) fn skip_property(&mut self, property: &Property) -> Result<(), String> {
        let count = match property.count {
            Some(count) => self.read_count(count)?,
            None => 1,
        };
        match self {
            Body::Text(text) => (0..count).try_for_each(|_| text.next_word().map(drop)),
            Body::Binary { .. } => {
                let size = count.checked_mul(property.number.size());
                self.take(size.unwrap_or(usize::MAX)).map(drop)
            }
        }
    }

    pub(super) fn read_list(
        &mut self,
        property: &Property,
        into: &mut Vec<f64>,
    ) -> Result<(), String> {
        into.clear();
        let count = self.read_count(property.count.unwrap_or(property.number))?;
        if let Body::Binary { bytes, .. } = self
            && count > bytes.len()
        {
            return Err(format!("found a list of {count}; expected at most {}", bytes.len()));
        }
        for _ in 0..count {
            into.push(self.read_number(property.number)?);
        }
        Ok(())
    }

    fn read_count(&mut self, number: Number) -> Result<usize, String> {
        let found = self.read_number(number)?;
        text::size_from_number(found)
            .ok_or_else(|| format!("found {found} as a list's length; expected a number from 0 on"))
    }

    pub(super) fn read_number(&mut self, number: Number) -> Result<f64, String> {
        let bytes = match self {
            Body::Text(text) => {
                let word = text.next_word()?;
                return parse_number(word)
                    .ok_or_else(|| format!("found {}; expected a number", quote(word)));
            }
            Body::Binary { .. } => self.take(number.size())?,
        };
        let Body::Binary { encoding, .. } = self else { return Ok(0.0) };
        let push = |bits: u64, byte: &u8| bits << 8 | u64::from(*byte);
        let bits = match encoding {
            Encoding::BigEndian => bytes.iter().fold(0, push),
            _ => bytes.iter().rev().fold(0, push),
        };
        Ok(match number {
            Number::Unsigned(_) => bits as f64,
            Number::Signed(size) => {
                let unused = 64 - 8 * size as u32;
                ((bits << unused) as i64 >> unused) as f64
            }
            Number::Float(4) => f64::from(f32::from_bits(bits as u32)),
            Number::Float(_) => f64::from_bits(bits),
        })
    }

    fn take(&mut self, size: usize) -> Result<&'a [u8], String> {
        let Body::Binary { bytes, .. } = self else { return Ok(&[]) };
        let (taken, rest) = bytes
            .split_at_checked(size)
            .ok_or_else(|| format!("found {} bytes; expected {size}", bytes.len()))?;
        *bytes = rest;
        Ok(taken)
    }

    /// Returns a message with its place: line or byte, element and its index.
    pub(super) fn place(&self, element: &Element, index: usize, why: &str) -> String {
        let colon = if why.is_empty() { "" } else { ": " };
        let name = &element.name;
        match self {
            Body::Text(text) => {
                let line = text.lines_of_header + text.lines.number;
                format!("line {line}: {name} {index}{colon}{why}")
            }
            Body::Binary { bytes, length, .. } => {
                let byte = length - bytes.len();
                format!("byte {byte} after the header: {name} {index}{colon}{why}")
            }
        }
    }
}

impl<'a> TextBody<'a> {
    fn next_word(&mut self) -> Result<&'a [u8], String> {
        loop {
            if let Some(word) = text::words(self.line).next() {
                let blanks = self.line.iter().take_while(|&&byte| text::is_blank(byte)).count();
                self.line = &self.line[blanks + word.len()..];
                return Ok(word);
            }
            self.line = self.lines.next().ok_or("the text ends; expected a number")?;
        }
    }
}
