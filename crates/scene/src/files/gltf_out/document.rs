//! A glTF document under construction, and its two forms on disk.

use base64::Engine;
use glam::{Quat, Vec3};
use serde_json::{Map, Value, json};

/// JSON and one buffer; either new or as read from a file.
pub(super) struct Document {
    pub(super) json: Map<String, Value>,
    bytes: Vec<u8>,
}

/// The use of a buffer view (glTF 2.0, `bufferView.target`).
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
/// Component types (glTF 2.0, `accessor.componentType`).
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

impl Document {
    /// An empty one.
    pub(super) fn new() -> Self {
        let mut json = Map::new();
        json.insert("asset".into(), json!({ "version": "2.0", "generator": "backstop" }));
        Document { json, bytes: Vec::new() }
    }

    /// One that was read: its buffers become one.
    pub(super) fn from_parts(json: Map<String, Value>, buffers: &[Vec<u8>]) -> Self {
        let mut document = Document { json, bytes: Vec::new() };
        let mut starts = Vec::new();
        for buffer in buffers {
            document.align();
            starts.push(document.bytes.len());
            document.bytes.extend_from_slice(buffer);
        }
        for view in document.list("bufferViews") {
            let start = view["buffer"].as_u64().and_then(|b| starts.get(b as usize)).copied().unwrap_or(0);
            view["byteOffset"] = json!(view["byteOffset"].as_u64().unwrap_or(0).saturating_add(start as u64));
            view["buffer"] = json!(0);
        }
        document
    }

    /// A root list such as `nodes`; empty if there was none.
    pub(super) fn list(&mut self, name: &str) -> &mut Vec<Value> {
        let entry = self.json.entry(name).or_insert_with(|| Value::Array(Vec::new()));
        if !entry.is_array() {
            *entry = Value::Array(Vec::new());
        }
        match entry {
            Value::Array(list) => list,
            _ => unreachable!("it was just made an array"),
        }
    }

    /// Appends to a root list, returns the index.
    pub(super) fn push(&mut self, name: &str, value: Value) -> usize {
        let list = self.list(name);
        list.push(value);
        list.len() - 1
    }

    /// Appends unless it is there; returns the index.
    pub(super) fn intern(&mut self, name: &str, value: Value) -> usize {
        match self.list(name).iter().position(|v| *v == value) {
            Some(index) => index,
            None => self.push(name, value),
        }
    }

    /// Accessor of vertex positions, with the bounds that the format demands.
    pub(super) fn positions(&mut self, points: &[Vec3]) -> usize {
        let min = points.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let max = points.iter().copied().reduce(Vec3::max).unwrap_or_default();
        let view = self.view(bytemuck::cast_slice(points), Some(VERTICES));
        let accessor = json!({ "bufferView": view, "componentType": F32, "count": points.len(), "type": "VEC3",
            "min": min.to_array(), "max": max.to_array() });
        self.push("accessors", accessor)
    }

    /// Accessor of triangles over `vertices` vertices.
    pub(super) fn triangles(&mut self, triangles: &[[u32; 3]], vertices: usize) -> usize {
        // The largest number of each width is no valid index.
        let small = vertices <= usize::from(u16::MAX);
        let (kind, view) = if small {
            let narrow: Vec<u16> = triangles.iter().flatten().map(|&i| i as u16).collect();
            (U16, self.view(bytemuck::cast_slice(&narrow), Some(INDICES)))
        } else {
            (U32, self.view(bytemuck::cast_slice(triangles), Some(INDICES)))
        };
        let count = 3 * triangles.len();
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": kind, "count": count, "type": "SCALAR" }),
        )
    }

    /// Accessor of the times of frames, in ascending order.
    pub(super) fn times(&mut self, times: &[f32]) -> usize {
        let view = self.view(bytemuck::cast_slice(times), None);
        let accessor = json!({ "bufferView": view, "componentType": F32, "count": times.len(), "type": "SCALAR",
            "min": [times.first()], "max": [times.last()] });
        self.push("accessors", accessor)
    }

    /// Accessor of translations over time.
    pub(super) fn translations(&mut self, values: &[Vec3]) -> usize {
        let view = self.view(bytemuck::cast_slice(values), None);
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": F32, "count": values.len(), "type": "VEC3" }),
        )
    }

    /// Accessor of rotations over time.
    pub(super) fn rotations(&mut self, values: &[Quat]) -> usize {
        let values: Vec<[f32; 4]> = values.iter().map(|q| q.to_array()).collect();
        let view = self.view(bytemuck::cast_slice(&values), None);
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": F32, "count": values.len(), "type": "VEC4" }),
        )
    }

    /// Bytes of the buffer; every view starts at a multiple of four, which suits all component types.
    pub(super) fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.align();
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.bytes.extend_from_slice(bytes);
        self.push("bufferViews", view)
    }

    fn align(&mut self) {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
    }

    /// Binary glTF (glTF 2.0, section 4.4).
    pub(super) fn into_glb(mut self) -> Vec<u8> {
        self.align();
        self.close(None);
        let mut text = Value::Object(self.json).to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let binary = if self.bytes.is_empty() { 0 } else { 8 + self.bytes.len() };
        let mut out = Vec::with_capacity(20 + text.len() + binary);
        out.extend_from_slice(b"glTF");
        for word in [2, (20 + text.len() + binary) as u32, text.len() as u32] {
            out.extend_from_slice(&word.to_le_bytes());
        }
        out.extend_from_slice(b"JSON");
        out.extend_from_slice(&text);
        if binary > 0 {
            out.extend_from_slice(&(self.bytes.len() as u32).to_le_bytes());
            out.extend_from_slice(b"BIN\0");
            out.extend_from_slice(&self.bytes);
        }
        out
    }

    /// JSON with the buffer as a data URI.
    pub(super) fn into_gltf(mut self) -> Vec<u8> {
        let text = base64::engine::general_purpose::STANDARD.encode(&self.bytes);
        self.close(Some(format!("data:application/octet-stream;base64,{text}")));
        let mut text = format!("{:#}", Value::Object(self.json)).into_bytes();
        text.push(b'\n');
        text
    }

    /// The one buffer, and no empty lists, which the format forbids.
    fn close(&mut self, uri: Option<String>) {
        let buffers = self.list("buffers");
        buffers.clear();
        if !self.bytes.is_empty() {
            let mut buffer = json!({ "byteLength": self.bytes.len() });
            if let Some(uri) = uri {
                buffer["uri"] = json!(uri);
            }
            self.push("buffers", buffer);
        }
        self.json.retain(|_, v| v.as_array().is_none_or(|list| !list.is_empty()));
    }
}
