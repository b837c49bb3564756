//! Files of settings: `trade --out` writes them, `run --settings` takes them.

use crate::args;
use crate::files;
use crate::report::output::exact;
use anyhow::{Context, bail};
use backstop::Settings;
use backstop_lab::WorldMethod;
use backstop_scene::write_file;
use serde_json::{Map, Value, json};
use std::io::Write;
use std::path::Path;

/// The settings that `trade` chooses, which its files always have.
const CHOSEN: [&str; 8] = [
    "substeps",
    "iterations",
    "friction_model",
    "friction_cone",
    "continuous",
    "continuous_method",
    "recycling",
    "joint_trees",
];
/// Settings of the scene or the machine, which no file of `trade` has.
const LEFT_OUT: [&str; 3] = ["gravity", "threads", "budget"];
/// Bytes of the largest file that is read.
const LARGEST: u64 = 1 << 20;

/// The contents of a file; missing settings have their defaults.
#[derive(Clone, Debug)]
pub(crate) struct SettingsFile {
    /// Length of a step [s].
    pub(crate) dt: Option<f32>,
    /// Whether gravity is among the settings.
    pub(crate) has_gravity: bool,
    /// The method of the lab that solves steps, if not the engine's own solver.
    pub(crate) solver: Option<WorldMethod>,
    pub(crate) world: Settings,
}

impl SettingsFile {
    pub(crate) fn read(path: &Path) -> anyhow::Result<SettingsFile> {
        SettingsFile::with(Some(path), &[])
    }

    /// A file, if there is one, and settings that count more.
    pub(crate) fn with(path: Option<&Path>, set: &[(String, Value)]) -> anyhow::Result<SettingsFile> {
        let mut fields = Map::new();
        if let Some(path) = path {
            let about = || format!("can't read settings from {}", path.display());
            let text = files::read_text(path, LARGEST).with_context(about)?;
            fields = object_of(&text).with_context(about)?;
            SettingsFile::of(fields.clone()).with_context(about)?;
        }
        fields.extend(set.iter().cloned());
        SettingsFile::of(fields)
    }

    fn of(mut fields: Map<String, Value>) -> anyhow::Result<SettingsFile> {
        let dt = fields.remove("dt").map(|dt| seconds(&dt)).transpose()?;
        let solver = fields.remove("solver").map(|name| method(&name)).transpose()?;
        // This field is for human readers.
        fields.remove("about");
        let known = || Settings::FIELDS.iter().map(|field| field.name);
        if let Some(name) = fields.keys().find(|name| !known().any(|known| known == *name)) {
            bail!("there is no setting \"{name}\"; there are {}", known().collect::<Vec<_>>().join(", "));
        }
        let has_gravity = fields.contains_key("gravity");
        for (name, value) in &fields {
            let alone = Value::Object(Map::from_iter([(name.clone(), value.clone())]));
            serde_json::from_value::<Settings>(alone)
                .with_context(|| format!("\"{name}\" can't be {value}"))?;
        }
        let world: Settings = serde_json::from_value(Value::Object(fields))?;
        world.validate()?;
        Ok(SettingsFile { dt, has_gravity, solver, world })
    }
}

fn seconds(dt: &Value) -> anyhow::Result<f32> {
    let text = dt.as_str().map_or_else(|| dt.to_string(), str::to_owned);
    args::seconds(&text).map_err(|why| anyhow::anyhow!("\"dt\" can't be {dt}: it {why}"))
}

fn method(name: &Value) -> anyhow::Result<WorldMethod> {
    let known = name.as_str().and_then(WorldMethod::by_name);
    known.with_context(|| format!("\"solver\" can't be {name}: it must be the name of a method of the lab"))
}

fn object_of(text: &str) -> anyhow::Result<Map<String, Value>> {
    match serde_json::from_str(text).context("it is no JSON")? {
        Value::Object(fields) => Ok(fields),
        _ => bail!("it is no JSON object"),
    }
}

fn object(settings: &Settings) -> anyhow::Result<Map<String, Value>> {
    match exact(settings)? {
        Value::Object(fields) => Ok(fields),
        _ => bail!("settings are no object"),
    }
}

/// The settings of a file: those that `trade` chooses, and others that differ from the default.
pub(crate) fn fields(
    hz: u32,
    settings: &Settings,
    solver: Option<WorldMethod>,
) -> anyhow::Result<Map<String, Value>> {
    let usual = object(&Settings::default())?;
    let mut fields = object(settings)?;
    fields.retain(|name, value| {
        CHOSEN.contains(&name.as_str())
            || (!LEFT_OUT.contains(&name.as_str()) && usual.get(name) != Some(value))
    });
    if let Some(solver) = solver {
        fields.insert("solver".into(), json!(solver.name()));
    }
    // As a fraction, which is exact.
    fields.insert("dt".into(), json!(format!("1/{hz}")));
    Ok(fields)
}

/// Writes a file; `about` describes its origin.
pub(crate) fn write(path: &Path, fields: &Map<String, Value>, about: &str) -> anyhow::Result<()> {
    let mut fields = fields.clone();
    fields.insert("about".into(), json!(about));
    let mut text = serde_json::to_string_pretty(&fields)?;
    text.push('\n');
    write_file(path, |file| file.write_all(text.as_bytes()))
        .with_context(|| format!("can't write {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use backstop::FrictionModel;

    #[test]
    fn what_is_written_is_read() {
        let settings = Settings::default()
            .with_substeps(2)
            .with_friction_model(FrictionModel::Point)
            .with_slop(0.1)
            .with_threads(7);
        let text =
            serde_json::to_string(&fields(120, &settings, WorldMethod::by_name("admm")).unwrap()).unwrap();
        let file = SettingsFile::of(object_of(&text).unwrap()).unwrap();
        assert_eq!((file.dt, file.has_gravity), (Some(1.0 / 120.0), false));
        assert_eq!(file.solver.map(|solver| solver.name()), Some("admm"));
        assert_eq!(file.world, settings.with_threads(1));
    }

    /// Each field of the settings can be set by its name, which overrides a file.
    #[test]
    fn any_setting_is_set_by_its_name() {
        let usual = object(&Settings::default()).unwrap();
        for field in Settings::FIELDS {
            let text = match &usual[field.name] {
                Value::String(name) => format!("{}={name}", field.name),
                value => format!("{}={value}", field.name),
            };
            let set = args::setting(&text).unwrap();
            assert_eq!(SettingsFile::with(None, &[set]).unwrap().world, Settings::default(), "{text}");
        }
        let set = ["slop=0.1", "friction_model=point", "dt=1/30"].map(|text| args::setting(text).unwrap());
        let file = SettingsFile::with(None, &set).unwrap();
        let expected = Settings::default().with_slop(0.1).with_friction_model(FrictionModel::Point);
        assert_eq!((file.world, file.dt), (expected, Some(1.0 / 30.0)));
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, reason) in [
            ("", "no JSON"),
            ("[]", "no JSON object"),
            (r#"{"substep": 4}"#, "no setting \"substep\""),
            (r#"{"substeps": "many"}"#, "\"substeps\" can't be \"many\""),
            (r#"{"substeps": 65}"#, "substeps must be in 1..=64"),
            (r#"{"friction_model": "square"}"#, "\"friction_model\" can't be \"square\""),
            (r#"{"solver": "magic"}"#, "\"solver\" can't be \"magic\""),
            (r#"{"dt": 2}"#, "\"dt\" can't be 2"),
            (r#"{"dt": "1/0"}"#, "\"dt\" can't be \"1/0\""),
        ] {
            let error = format!("{:#}", object_of(text).and_then(SettingsFile::of).unwrap_err());
            assert!(error.contains(reason), "{text}: {error}");
        }
    }
}
