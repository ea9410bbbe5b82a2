//! Finds the known word nearest to a misspelt one.

/// Candidate nearest to `word`, if it is near enough for a suggestion.
pub fn nearest<'c>(word: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    candidates
        .into_iter()
        .filter_map(|candidate| Some((cost(word, candidate)?, candidate)))
        .min_by_key(|(cost, _)| *cost)
        .map(|(_, candidate)| candidate)
}

/// Edits between the words, if they are few for the length of the words and of their differing parts; a word with a
/// missing or another unit (`half_backlash`, `half_backlash_mm`) is near.
fn cost(word: &str, candidate: &str) -> Option<usize> {
    let (word, candidate) = (word.to_lowercase(), candidate.to_lowercase());
    let stem = |text: &str| text.rsplit_once('_').map_or(text.to_owned(), |(stem, _)| stem.to_owned());
    let pairs =
        [(word.clone(), candidate.clone(), 0), (word.clone(), stem(&candidate), 1), (stem(&word), stem(&candidate), 1)];
    // Words with very different lengths are not compared letter by letter; one may be very long.
    let may_be_near = |(from, to, more): &&(String, String, usize)| {
        is_near(from.chars().count().abs_diff(to.chars().count()) + more, from.len().max(to.len()))
    };
    pairs
        .iter()
        .filter(may_be_near)
        .filter(|(from, to, _)| parts_are_near(from, to))
        .map(|(from, to, more)| (edits(from, to) + more, from.len().max(to.len())))
        .filter(|(cost, length)| is_near(*cost, *length))
        .map(|(cost, _)| cost)
        .min()
}

/// Returns true if two words without their common parts are near. Parts common to many keys do not count:
/// `no_load_torque_N_m` is no misspelt `cogging_torque_N_m`.
fn parts_are_near(from: &str, to: &str) -> bool {
    // Complete name without its unit.
    if to.strip_prefix(from).is_some_and(|rest| rest.starts_with('_')) {
        return true;
    }
    let mut own: Vec<&str> = from.split('_').collect();
    let mut others: Vec<&str> = to.split('_').collect();
    own.retain(|part| match others.iter().position(|other| other == part) {
        Some(place) => {
            others.remove(place);
            false
        }
        None => true,
    });
    let [from, to] = [own.join("_"), others.join("_")];
    let longest = from.len().max(to.len());
    is_near(from.chars().count().abs_diff(to.chars().count()), longest) && is_near(edits(&from, &to), longest)
}

/// Returns true if the edits are few for the length.
fn is_near(cost: usize, length: usize) -> bool {
    3 * cost <= length + 2
}

/// Insertions, deletions and substitutions of one letter.
fn edits(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (i, letter) in from.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for j in 0..to.len() {
            let exchanged = diagonal + usize::from(letter != to[j]);
            diagonal = row[j + 1];
            row[j + 1] = exchanged.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[to.len()]
}

#[cfg(test)]
mod tests {
    use super::nearest;

    const KEYS: [&str; 3] = ["half_backlash_um", "mean_stiffness_N_per_m", "stiffness_ratio"];

    #[test]
    fn lost_letter_is_found() {
        assert_eq!(nearest("half_backlsh_um", KEYS), Some("half_backlash_um"));
    }

    /// A key with another unit or none is found.
    #[test]
    fn other_unit_is_found() {
        assert_eq!(nearest("half_backlash_mm", KEYS), Some("half_backlash_um"));
        assert_eq!(nearest("half_backlash", KEYS), Some("half_backlash_um"));
        assert_eq!(nearest("mean_stiffness_N_per_um", KEYS), Some("mean_stiffness_N_per_m"));
    }

    /// Parts common to many keys do not make two keys near.
    #[test]
    fn common_parts_do_not_count() {
        let drive_train = ["cogging_torque_N_m", "load_coulomb_friction_N_m", "link_inertia_kg_m2", "sun_teeth"];
        for word in ["no_load_torque_N_m", "coulomb_friction_N_m", "sun_inertia_kg_m2", "ring_teeth"] {
            assert_eq!(nearest(word, drive_train), None, "{word}");
        }
        assert_eq!(nearest("coging_torque_Nm", drive_train), Some("cogging_torque_N_m"));
        assert_eq!(nearest("link_inertia", drive_train), Some("link_inertia_kg_m2"));
    }

    #[test]
    fn strange_word_has_no_suggestion() {
        assert_eq!(nearest("colour", KEYS), None);
    }
}
