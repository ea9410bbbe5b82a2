//! Built-in joint files. Each number carries its source, or the word "assumed".

/// Names of the presets, the default first.
pub const PRESETS: [&str; 7] = ["q1", "s1", "d2", "l1", "c1", "paper", "paper_printed"];

/// Text of a preset, by its name.
pub fn preset(name: &str) -> Option<&'static str> {
    Some(match name {
        "q1" => include_str!("../../../joints/q1.toml"),
        "s1" => include_str!("../../../joints/s1.toml"),
        "d2" => include_str!("../../../joints/d2.toml"),
        "l1" => include_str!("../../../joints/l1.toml"),
        "c1" => include_str!("../../../joints/c1.toml"),
        "paper" => include_str!("../../../joints/paper.toml"),
        "paper_printed" => include_str!("../../../joints/paper_printed.toml"),
        _ => return None,
    })
}
