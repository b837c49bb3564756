//! Requests and their frames, as the page sees them.

mod commands;
mod hand;
mod requests;
mod time;

use crate::Session;
use serde_json::{Value, json};

/// A session, and its last frame.
#[derive(Default)]
struct Page {
    session: Session,
    frame: Vec<u8>,
}

impl Page {
    /// With this open.
    fn open(name: &str) -> Page {
        let mut page = Page::default();
        page.ask(&json!({ "commands": [{ "do": "open", "name": name }] }));
        page
    }

    /// The header of the frame that answers a text.
    fn say(&mut self, text: &str) -> Value {
        self.session.request(text, &mut self.frame);
        let length = u32::from_le_bytes(self.frame[..4].try_into().unwrap()) as usize;
        assert!(length.is_multiple_of(4));
        serde_json::from_slice(&self.frame[4..4 + length]).unwrap()
    }

    /// The same of a request that is not refused.
    fn ask(&mut self, request: &Value) -> Value {
        let header = self.say(&request.to_string());
        assert_eq!(header["error"], Value::Null, "{request}");
        header
    }

    fn command(&mut self, command: Value) -> Value {
        self.ask(&json!({ "commands": [command], "want": ["ledger"] }))
    }

    fn steps(&mut self, steps: u32) -> Value {
        self.ask(&json!({ "steps": steps, "want": ["ledger"] }))
    }

    /// Why a command is refused, which changes nothing.
    fn refused(&mut self, command: Value) -> String {
        let before = self.steps(0);
        let after = self.say(&json!({ "commands": [command], "steps": 3 }).to_string());
        for key in ["hash", "step", "settings", "name", "past"] {
            assert_eq!(before[key], after[key], "{key} after {command}");
        }
        after["error"].as_str().unwrap_or_else(|| panic!("{command} is not refused")).to_owned()
    }

    /// Numbers of a section of the last frame.
    fn numbers(&self, header: &Value, name: &str) -> Vec<f32> {
        let start = 4 + u32::from_le_bytes(self.frame[..4].try_into().unwrap()) as usize;
        let sections = header["sections"].as_array().unwrap();
        let section = sections.iter().find(|section| section["name"] == name).unwrap();
        let number = |key: &str| section[key].as_u64().unwrap() as usize;
        let bytes = &self.frame[start + number("offset")..][..4 * number("count")];
        bytes.chunks(4).map(|number| f32::from_le_bytes(number.try_into().unwrap())).collect()
    }

    /// Where the last so many shapes of dynamic bodies are: those that were made last.
    fn made(&mut self, count: usize) -> Vec<[f32; 3]> {
        let header = self.ask(&json!({ "want": ["scene"] }));
        let (instances, poses) = (self.numbers(&header, "instances"), self.numbers(&header, "poses"));
        let dynamic = instances.chunks(2).zip(poses.chunks(8)).filter(|(instance, _)| instance[1] < 5.0);
        let all: Vec<[f32; 3]> = dynamic.map(|(_, pose)| [pose[0], pose[1], pose[2]]).collect();
        all[all.len() - count..].to_vec()
    }

    /// A count of the ledger.
    fn count(header: &Value, name: &str) -> u64 {
        let counts = header["ledger"]["counts"].as_array().unwrap();
        counts.iter().find(|count| count[0] == name).unwrap()[1].as_u64().unwrap()
    }
}
