//! Settings by their names.

use crate::Refusal;
use backstop::{Escaped, Settings};
use serde_json::{Map, Value, json};

/// Settings of a world and the length of its steps [s].
pub(crate) struct Chosen {
    pub(crate) world: Settings,
    pub(crate) dt: f32,
}

/// These settings, but for those that are named. `budget` is a number of bytes, or null.
pub(crate) fn changed(now: &Settings, dt: f32, fields: &Map<String, Value>) -> Result<Chosen, Refusal> {
    let cant = |name: &str, value: &Value, why: &dyn std::fmt::Display| {
        Refusal::told(format!("\"{}\" can't be {}: {why}", Escaped(name), Escaped(value)))
    };
    let mut all = as_json(now)?;
    let mut new_dt = dt;
    for (name, value) in fields {
        if name == "dt" {
            let seconds = value.as_f64().map(|seconds| seconds as f32).filter(|s| (1e-6..=1.0).contains(s));
            new_dt = seconds.ok_or_else(|| cant(name, value, &"it must be in 0.000001..=1"))?;
            continue;
        }
        if !Settings::FIELDS.iter().any(|field| field.name == name) {
            return Err(Refusal::told(format!("there is no setting \"{}\"", Escaped(name))));
        }
        let value = match (name.as_str(), value) {
            ("budget", Value::Null | Value::Number(_)) => json!({ "total": value, "categories": {} }),
            _ => value.clone(),
        };
        // By itself first, so that the name is told.
        let alone = Value::Object(Map::from_iter([(name.clone(), value.clone())]));
        serde_json::from_value::<Settings>(alone).map_err(|why| cant(name, &value, &why))?;
        all.insert(name.clone(), value);
    }
    let world: Settings =
        serde_json::from_value(Value::Object(all)).map_err(|why| Refusal::told(why.to_string()))?;
    world.validate()?;
    Ok(Chosen { world, dt: new_dt })
}

/// All settings by their names. The budget is a number of bytes if it limits only the whole.
pub(crate) fn told(settings: &Settings) -> Result<Value, Refusal> {
    let mut all = as_json(settings)?;
    let budget = settings.budget;
    if budget.is_none() {
        all.insert("budget".into(), Value::Null);
    } else if let Some(bytes) = budget.limit().filter(|&bytes| budget == backstop::Budget::total(bytes)) {
        all.insert("budget".into(), bytes.into());
    }
    Ok(Value::Object(all))
}

fn as_json(settings: &Settings) -> Result<Map<String, Value>, Refusal> {
    match serde_json::to_value(settings) {
        Ok(Value::Object(fields)) => Ok(fields),
        Ok(_) => Err(Refusal::told("settings are no object")),
        Err(why) => Err(Refusal::told(why.to_string())),
    }
}

/// What a form needs to know of each setting.
pub(crate) fn fields() -> Value {
    let field = |field: &backstop::Field| {
        let mut told = json!({ "name": field.name, "about": field.about });
        let more = [("unit", field.unit()), ("range", field.range), ("default", field.default)];
        for (key, text) in more {
            if let Some(text) = text {
                told[key] = text.into();
            }
        }
        told
    };
    Settings::FIELDS.iter().map(field).collect()
}
