//! Complains about keys that nobody knows, and says which was probably meant. What known keys hold is left to
//! `section`.

use toml::de::DeTable;

use crate::keys;
use crate::notes::Notes;
use crate::spelling;
use crate::wording::listed;

/// Notes every key of the table at `path` that is not among the keys of `schema`.
pub(crate) fn check(path: &str, schema: &str, table: &DeTable<'_>, notes: &Notes<'_>) {
    let known: Vec<&str> = keys::of(schema).map(|key| key.name).collect();
    let place = if path.is_empty() { "a joint file".to_owned() } else { format!("[{path}]") };
    for name in table.keys() {
        let word = name.get_ref().as_ref();
        if known.contains(&word) {
            continue;
        }
        let help = if let Some(near) = spelling::nearest(word, known.iter().copied()) {
            format!("did you mean `{near}`? {}", keys::find(schema, near).hint)
        } else if let Some(key) = keys::KEYS.iter().find(|key| key.name == word) {
            format!("it belongs {}", belongs(key.section))
        } else {
            format!("known here: {}", listed(&known))
        };
        notes.error(name.span(), format!("unknown key `{word}` in {place}"), help);
    }
}

fn belongs(section: &str) -> String {
    match section {
        "" => "at the top of the file, above all sections".to_owned(),
        "encoder" => "in [drive_train.motor_encoder] or [drive_train.output_encoder]".to_owned(),
        section => format!("in [{section}]"),
    }
}
