//! Accessors: the numbers of a buffer, of any component type, normalised or not, sparse or not.

use super::super::text::size_from_number;
use super::container::Buffers;
use super::items;
use serde_json::Value;

/// Extensions that compress a mesh.
const COMPRESSIONS: [&str; 3] =
    ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// The type of a component.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn from_code(code: u64) -> Option<Self> {
        Some(match code {
            5120 => Component::I8,
            5121 => Component::U8,
            5122 => Component::I16,
            5123 => Component::U16,
            5125 => Component::U32,
            5126 => Component::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Component::I8 | Component::U8 => 1,
            Component::I16 | Component::U16 => 2,
            Component::U32 | Component::F32 => 4,
        }
    }

    /// Decodes a component. A normalised integer is a fraction of its greatest value.
    fn decode(self, bytes: &[u8], is_normalised: bool) -> f64 {
        let bits = bytes.iter().rev().fold(0u32, |bits, &byte| bits << 8 | u32::from(byte));
        let (value, greatest) = match self {
            Component::I8 => (f64::from(bits as i8), f64::from(i8::MAX)),
            Component::U8 => (f64::from(bits), f64::from(u8::MAX)),
            Component::I16 => (f64::from(bits as i16), f64::from(i16::MAX)),
            Component::U16 => (f64::from(bits), f64::from(u16::MAX)),
            Component::U32 => (f64::from(bits), f64::from(u32::MAX)),
            Component::F32 => return f64::from(f32::from_bits(bits)),
        };
        if is_normalised { (value / greatest).max(-1.0) } else { value }
    }
}

/// Elements of M components, checked to lie inside the buffer.
pub(super) struct Accessor<'a, const M: usize> {
    /// `None` where all elements but those of `sparse` are zero.
    elements: Option<Elements<'a>>,
    sparse: Option<Sparse<'a>>,
    component: Component,
    is_normalised: bool,
    pub(super) count: usize,
}

/// The bytes of elements in a buffer, starting with the first element.
#[derive(Clone, Copy)]
struct Elements<'a> {
    bytes: &'a [u8],
    /// Bytes from one element to the next.
    stride: usize,
}

/// Elements that replace some of the others.
struct Sparse<'a> {
    count: usize,
    indices: Elements<'a>,
    index: Component,
    values: Elements<'a>,
}

/// Loads the buffers of an accessor.
pub(super) fn load(json: &Value, buffers: &mut Buffers<'_>, index: &Value) -> Result<(), String> {
    let accessor = find(json, "accessors", index)?;
    let sparse = &accessor["sparse"];
    for holder in [accessor, &sparse["indices"], &sparse["values"]] {
        if !holder["bufferView"].is_null() {
            let view = find(json, "bufferViews", &holder["bufferView"])?;
            if let Some(name) = find_compression(view)
                && has_no_data(json, view)
            {
                return Err(describe_compression(name));
            }
            buffers.load(number(&view["buffer"]).ok_or("a buffer view names no buffer")?)?;
        }
    }
    Ok(())
}

/// Returns `true` if the buffer of a compressed view is a placeholder, which holds nothing.
fn has_no_data(json: &Value, view: &Value) -> bool {
    let Ok(buffer) = find(json, "buffers", &view["buffer"]) else { return false };
    let is_placeholder = COMPRESSIONS
        .iter()
        .any(|name| buffer["extensions"][*name]["fallback"].as_bool() == Some(true));
    buffer["uri"].is_null() && (is_placeholder || number(&view["buffer"]) != Some(0))
}

/// Returns the extension that compresses an object, if any.
pub(super) fn find_compression(object: &Value) -> Option<&'static str> {
    COMPRESSIONS.into_iter().find(|name| !object["extensions"][*name].is_null())
}

pub(super) fn describe_compression(name: &str) -> String {
    format!(
        "mesh compression {name} is not supported; expected plain data. Export the file without \
         compression"
    )
}

/// Returns the object at an index of a list.
pub(super) fn find<'a>(json: &'a Value, list: &str, index: &Value) -> Result<&'a Value, String> {
    let objects = items(&json[list]);
    number(index).and_then(|index| objects.get(index)).ok_or_else(|| {
        format!("found index {index} into `{list}`; expected less than {}", objects.len())
    })
}

/// Returns a whole number, even if it is written as a float.
pub(super) fn number(value: &Value) -> Option<usize> {
    match value.as_u64() {
        Some(number) => usize::try_from(number).ok(),
        None => value.as_f64().and_then(size_from_number),
    }
}

impl<'a, const M: usize> Accessor<'a, M> {
    /// Finds the elements of an accessor that was loaded.
    pub(super) fn find(
        json: &Value,
        buffers: &'a Buffers<'_>,
        index: &Value,
    ) -> Result<Self, String> {
        let at = |what: String| format!("accessor {index}: {what}");
        let accessor = find(json, "accessors", index)?;
        let kind = match M {
            1 => "SCALAR",
            3 => "VEC3",
            4 => "VEC4",
            _ => "MAT4",
        };
        if accessor["type"].as_str() != Some(kind) {
            return Err(at(format!("found type {}; expected {kind}", accessor["type"])));
        }
        let component = read_component(accessor).map_err(at)?;
        let count = number(&accessor["count"]);
        let count = count.ok_or_else(|| at(format!("found count {}", accessor["count"])))?;
        let size = component.size() * M;
        let elements = match &accessor["bufferView"] {
            Value::Null => None,
            _ => Some(Elements::find(json, buffers, accessor, size, count).map_err(at)?),
        };
        let sparse = match &accessor["sparse"] {
            Value::Null => None,
            sparse => Some(Sparse::find(json, buffers, sparse, size).map_err(at)?),
        };
        if elements.is_none() && sparse.is_none() {
            return Err(at("found no `bufferView`; expected one".into()));
        }
        let is_normalised = accessor["normalized"].as_bool() == Some(true);
        Ok(Accessor { elements, sparse, component, is_normalised, count })
    }

    /// Returns element `i`, which must be less than the count.
    pub(super) fn get(&self, i: usize) -> [f64; M] {
        let size = self.component.size();
        let sparse = self.sparse.as_ref().and_then(|sparse| sparse.find_element(i, size * M));
        let plain = || self.elements.map(|elements| elements.get(i, size * M));
        let Some(bytes) = sparse.or_else(plain) else { return [0.0; M] };
        std::array::from_fn(|k| {
            self.component.decode(&bytes[k * size..][..size], self.is_normalised)
        })
    }
}

fn read_component(holder: &Value) -> Result<Component, String> {
    let code = &holder["componentType"];
    let component = number(code).and_then(|code| Component::from_code(code as u64));
    component.ok_or_else(|| format!("found componentType {code}; expected one of glTF's"))
}

impl<'a> Elements<'a> {
    /// Finds `count` elements of `size` bytes in the buffer view that a holder names.
    fn find(
        json: &Value,
        buffers: &'a Buffers<'_>,
        holder: &Value,
        size: usize,
        count: usize,
    ) -> Result<Self, String> {
        let view = find(json, "bufferViews", &holder["bufferView"])?;
        let buffer = buffers.bytes(number(&view["buffer"]).unwrap_or(usize::MAX))?;
        let offset = number(&view["byteOffset"]).unwrap_or(0);
        let length = number(&view["byteLength"]).unwrap_or(usize::MAX);
        let bytes = buffer.get(offset..).and_then(|bytes| bytes.get(..length)).ok_or_else(|| {
            format!(
                "its view of {length} bytes at byte {offset} ends outside its buffer; expected at most {} \
                 bytes",
                buffer.len()
            )
        })?;
        let stride = number(&view["byteStride"]).filter(|stride| *stride > 0).unwrap_or(size);
        let bytes = bytes.get(number(&holder["byteOffset"]).unwrap_or(0)..).unwrap_or(&[]);
        let fitting = bytes.len().checked_sub(size).map_or(0, |last| last / stride + 1);
        if count > fitting {
            return Err(format!("its view holds {fitting} elements; expected {count}"));
        }
        Ok(Elements { bytes, stride })
    }

    fn get(self, i: usize, size: usize) -> &'a [u8] {
        &self.bytes[i * self.stride..][..size]
    }
}

impl<'a> Sparse<'a> {
    fn find(
        json: &Value,
        buffers: &'a Buffers<'_>,
        sparse: &Value,
        size: usize,
    ) -> Result<Self, String> {
        let count = number(&sparse["count"]);
        let count = count.ok_or_else(|| format!("found sparse count {}", sparse["count"]))?;
        let (indices, values) = (&sparse["indices"], &sparse["values"]);
        let index = read_component(indices)?;
        let indices = Elements::find(json, buffers, indices, index.size(), count)?;
        let values = Elements::find(json, buffers, values, size, count)?;
        Ok(Sparse { count, indices, index, values })
    }

    /// Returns the bytes that replace an element, by binary search: the indices increase.
    fn find_element(&self, i: usize, size: usize) -> Option<&'a [u8]> {
        let index_of = |k: usize| {
            let bytes = self.indices.get(k, self.index.size());
            self.index.decode(bytes, false)
        };
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low + (high - low) / 2;
            if index_of(middle) < i as f64 {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        (low < self.count && index_of(low) == i as f64).then(|| self.values.get(low, size))
    }
}
