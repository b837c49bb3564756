//! `include/backstop.h` is what cbindgen makes of the sources, with the engine's sentences where a field has
//! none of its own. After a change of the interface: `BS_WRITE_HEADER=1 cargo test --test header`, which
//! writes it anew.

use backstop::{CharacterSettings, Field, Material, Settings, StepReport};
use std::path::{Path, PathBuf};
use std::{env, fs};

#[test]
fn the_header_is_that_of_the_sources() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let plain = Path::new(env!("CARGO_TARGET_TMPDIR")).join("plain");
    let _ = fs::remove_dir_all(&plain);
    write_plain(&folder.join("src"), &plain);
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).expect("a configuration");
    let bindings = cbindgen::Builder::new().with_config(config).with_src(plain.join("lib.rs")).generate();
    let mut made = Vec::new();
    bindings.expect("sources that cbindgen reads").write(&mut made);
    let made = String::from_utf8(made).expect("a header in UTF-8");
    let path = folder.join("include/backstop.h");
    if env::var_os("BS_WRITE_HEADER").is_some() {
        fs::write(&path, &made).expect("a header that can be written");
    }
    let kept = fs::read_to_string(&path).unwrap_or_default();
    let first = made.lines().zip(kept.lines()).find(|(made, kept)| made != kept);
    assert!(made == kept, "include/backstop.h is of other sources; the first line that differs: {first:?}");
}

/// Each field of what has a twin is in C: one by itself, or as the comment of another says.
#[test]
fn no_field_of_the_engine_is_left_out() {
    let header = include_str!("../include/backstop.h");
    let members = |names: &[&str]| -> String {
        let block = |name: &&str| {
            let after = header.split_once(&format!("typedef struct {name} {{")).expect("a struct").1;
            after.split_once("\n}").expect("its end").0
        };
        names.iter().map(block).collect()
    };
    let has = |names: &[&str], fields: &[Field], elsewhere: &[&str]| {
        let members = members(names);
        for field in fields.iter().filter(|field| !elsewhere.contains(&field.name)) {
            let is_there = members.lines().any(|line| {
                let name = line.trim().trim_end_matches(';').rsplit([' ', '*']).next().unwrap_or_default();
                !line.trim().starts_with("//") && name.split('[').next() == Some(field.name)
            });
            assert!(is_there, "{names:?} lacks {}: {}", field.name, field.about);
        }
    };
    has(&["BsMaterial", "BsSurface"], Material::FIELDS, &[]);
    has(&["BsSettings"], Settings::FIELDS, &[]);
    has(&["BsCharacterSettings"], CharacterSettings::FIELDS, &[]);
    has(&["BsBodyDesc"], backstop::BodyDesc::FIELDS, &[]);
    has(&["BsFilter"], backstop::Filter::FIELDS, &[]);
    // Its times are there one by one.
    has(&["BsStepReport"], StepReport::FIELDS, &["times"]);
}

/// Copies sources with plain structs in the place of records, for cbindgen.
fn write_plain(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("sources") {
        let path: PathBuf = entry.expect("an entry").path();
        let copy = to.join(path.file_name().expect("a name"));
        match path.is_dir() {
            true => write_plain(&path, &copy),
            false => fs::write(copy, plain(&fs::read_to_string(path).expect("a source"))).expect("a copy"),
        }
    }
}

/// A source without `record!`: what is in it stays, but for what `of`, `=` and `default` say.
fn plain(source: &str) -> String {
    let (mut out, mut inside, mut fields) = (String::new(), false, None);
    let mut has_comment = false;
    for line in source.lines() {
        let text = line.trim();
        let mut kept = line.to_owned();
        match (inside, line) {
            (false, "record! {") => (inside, kept) = (true, String::new()),
            (true, "}") => (inside, fields, kept) = (false, None, String::new()),
            (true, _) if text.starts_with("default ") => kept.clear(),
            (true, _) if text.starts_with("pub struct ") => {
                if let Some((name, of)) = text.split_once(" of ") {
                    let of = of.trim_end_matches(" {").split_once(": ").expect("a type").1;
                    (fields, kept) = (Some(fields_of(of)), format!("{name} {{"));
                }
            }
            (true, _) if text.starts_with("pub ") => {
                let name = text.trim_start_matches("pub ").split(':').next().unwrap_or_default();
                let field = fields.and_then(|fields| fields.iter().find(|field| field.name == name));
                if let (false, Some(field)) = (has_comment, field) {
                    out.push_str(&comment(field));
                }
                kept = text.split(" = ").next().unwrap_or_default().trim_end_matches(',').to_owned() + ",";
            }
            _ => {}
        }
        has_comment = text.starts_with("///");
        out.push_str(&kept);
        out.push('\n');
    }
    out
}

fn fields_of(engine: &str) -> &'static [Field] {
    match engine {
        "Material" => Material::FIELDS,
        "Settings" => Settings::FIELDS,
        "CharacterSettings" => CharacterSettings::FIELDS,
        "StepReport" => StepReport::FIELDS,
        _ => &[],
    }
}

/// The first paragraph about a field, in the names of this interface, with range and default.
fn comment(field: &Field) -> String {
    let mut text = field.about.split("\n\n").next().unwrap_or_default().replace('\n', "");
    // Links are their texts.
    while let Some(start) = text.find("[`") {
        let end = start + text[start..].find(']').expect("the end of a link");
        let after = &text[end + 1..];
        let rest =
            if after.starts_with('(') { after.split_once(')').map_or("", |(_, rest)| rest) } else { after };
        text = format!("{}{}{rest}", &text[..start], &text[start + 1..end]);
    }
    for name in ["Settings::", "StepReport::"] {
        text = text.replace(&format!("`{name}"), &format!("`Bs{name}"));
    }
    let text = text.replace("`Material::", "`BsSurface::");
    let range = field.range.map_or(String::new(), |range| format!(" Must be {range}."));
    let default = field
        .default
        .map_or(String::new(), |default| format!(" Default {}.", in_c(&default.replace(" :: ", "::"))));
    let mut lines = vec![String::from("///")];
    for word in format!("{}{range}{default}", text.trim()).split_whitespace() {
        if lines.last().is_some_and(|line| line.len() + word.len() > 104) {
            lines.push("///".into());
        }
        let last = lines.last_mut().expect("a line");
        *last = format!("{last} {word}");
    }
    lines.join("\n") + "\n"
}

/// A default in Rust as a person writes it in C.
fn in_c(default: &str) -> String {
    match default {
        "true" => "yes".into(),
        "false" => "no".into(),
        "Vec3::ZERO" => "zero".into(),
        _ => match default.split_once("::") {
            Some((_, numbers)) if numbers.starts_with("new(") => in_c(&numbers[3..]),
            Some((of, one)) => format!("`BS_{}_{}`", of.to_uppercase(), one.to_uppercase()),
            None => default.replace(".0,", ",").replace(".0)", ")").trim_end_matches(".0").into(),
        },
    }
}
