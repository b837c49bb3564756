//! The commands in README and docs are commands.

use super::Options;
use clap::Parser;
use clap::error::ErrorKind;
use std::path::Path;

/// Lines of blocks of shell, continued ones joined, and text in backquotes.
fn commands(page: &str) -> Vec<String> {
    let mut lines = Vec::new();
    for (i, block) in page.split("```").enumerate() {
        if i % 2 == 0 {
            lines.extend(block.split('`').skip(1).step_by(2).map(|span| span.replace('\n', " ")));
        } else if let Some(text) = block.strip_prefix("sh\n") {
            lines.extend(text.replace("\\\n", " ").lines().map(str::to_owned));
        }
    }
    lines
}

/// The words of a command up to a comment or a pipe, as a shell splits them; none if it is another program's.
fn words(line: &str) -> Option<Vec<String>> {
    let line = line.trim().trim_start_matches("$ ");
    let line = line.strip_prefix("cargo ").unwrap_or(line).strip_prefix("backstop ")?;
    let words = line.split_whitespace().take_while(|word| !["#", "|", ">", ";"].contains(word));
    let word = |word: &str| {
        word.replace("\"$SLURM_ARRAY_TASK_ID/32\"", "1/32").replace("$iterations", "10").replace('"', "")
    };
    Some(std::iter::once("backstop".to_owned()).chain(words.map(word)).collect())
}

/// A word that stands for another.
fn is_placeholder(word: &str) -> bool {
    word.starts_with('$') || word == "n" || word.chars().all(|c| c.is_ascii_uppercase())
}

#[test]
fn each_command_of_the_documentation_is_parsed() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let folder = std::fs::read_dir(root.join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let pages = folder.chain(["README.md", "bindings/web/README.md"].map(|page| root.join(page)));
    let mut count = 0;
    for path in pages.filter(|path| path.extension().is_some_and(|ending| ending == "md")) {
        let page = std::fs::read_to_string(&path).unwrap();
        for words in commands(&page).iter().filter_map(|line| words(line)) {
            count += 1;
            let Err(error) = Options::try_parse_from(&words) else { continue };
            let is_told = match error.kind() {
                ErrorKind::DisplayHelp => true,
                // A command that is only named.
                ErrorKind::MissingRequiredArgument | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
                    true
                }
                ErrorKind::ValueValidation | ErrorKind::InvalidValue | ErrorKind::InvalidSubcommand => {
                    words.iter().any(|word| is_placeholder(word))
                }
                _ => false,
            };
            assert!(is_told, "{}: {}\n{error}", path.display(), words.join(" "));
        }
    }
    // Not by a page that is not found.
    assert!(count > 60, "{count}");
}
