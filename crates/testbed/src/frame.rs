//! The bytes of an answer: a header in JSON, and the numbers to be drawn.

use serde_json::{Map, Value, json};

/// An answer that is put together.
#[derive(Default)]
pub(crate) struct Frame {
    pub(crate) header: Map<String, Value>,
    sections: Vec<Value>,
    numbers: Vec<f32>,
}

impl Frame {
    /// A value of the header.
    pub(crate) fn set(&mut self, key: &str, value: impl Into<Value>) {
        self.header.insert(key.into(), value.into());
    }

    /// Numbers under a name.
    pub(crate) fn section(&mut self, name: impl Into<String>, fill: impl FnOnce(&mut Vec<f32>)) {
        let from = self.numbers.len();
        fill(&mut self.numbers);
        let (offset, count) = (from * size_of::<f32>(), self.numbers.len() - from);
        self.sections.push(json!({ "name": name.into(), "offset": offset, "count": count }));
    }

    /// Writes it: the length of the header, the header with spaces up to a multiple of four bytes, and the
    /// sections, all numbers little-endian.
    pub(crate) fn write(mut self, out: &mut Vec<u8>) {
        self.header.insert("sections".into(), self.sections.into());
        let mut header = Value::Object(self.header).to_string();
        while !header.len().is_multiple_of(size_of::<f32>()) {
            header.push(' ');
        }
        out.clear();
        out.extend((header.len() as u32).to_le_bytes());
        out.extend(header.as_bytes());
        out.reserve(size_of::<f32>() * self.numbers.len());
        out.extend(self.numbers.iter().flat_map(|number| number.to_le_bytes()));
    }
}
