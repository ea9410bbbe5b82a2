//! Two lists whose entries stand in an order: lines, rows, tags. Entries are compared one with one between what both lists
//! begin and end with; where one list has more of them there, those that only one of them has are named, so that a row
//! that is missing is one difference and not one of every row behind it.

use std::collections::HashMap;
use std::hash::Hash;

/// What to do about two lists.
#[derive(Debug, PartialEq, Eq)]
pub enum Step {
    /// These two stand at the same place and differ.
    Pair(usize, usize),
    /// Only the old list has this one.
    OnlyOld(usize),
    /// Only the new list has this one.
    OnlyNew(usize),
}

/// Where two lists differ.
pub fn steps<T: Eq + Hash>(old: &[T], new: &[T]) -> Vec<Step> {
    let head = old.iter().zip(new).take_while(|(a, b)| a == b).count();
    let tail = old[head..].iter().rev().zip(new[head..].iter().rev()).take_while(|(a, b)| a == b).count();
    let (old_end, new_end) = (old.len() - tail, new.len() - tail);
    if old_end == new_end {
        return (head..old_end).filter(|place| old[*place] != new[*place]).map(|at| Step::Pair(at, at)).collect();
    }
    let mut counts: HashMap<&T, i64> = HashMap::new();
    for entry in &old[head..old_end] {
        *counts.entry(entry).or_default() += 1;
    }
    for entry in &new[head..new_end] {
        *counts.entry(entry).or_default() -= 1;
    }
    // The last ones of several that are equal are taken as those that are too many.
    let (mut gone, mut come) = (Vec::new(), Vec::new());
    for place in (head..old_end).rev() {
        if let Some(count) = counts.get_mut(&old[place]).filter(|count| **count > 0) {
            *count -= 1;
            gone.push(Step::OnlyOld(place));
        }
    }
    for place in (head..new_end).rev() {
        if let Some(count) = counts.get_mut(&new[place]).filter(|count| **count < 0) {
            *count += 1;
            come.push(Step::OnlyNew(place));
        }
    }
    gone.into_iter().rev().chain(come.into_iter().rev()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_entry_is_one_difference() {
        assert_eq!(steps(&[1, 2, 3, 4, 5], &[1, 2, 4, 5]), [Step::OnlyOld(2)]);
        assert_eq!(steps(&[1, 1, 1], &[1, 1, 1, 1]), [Step::OnlyNew(3)]);
        assert_eq!(steps(&[1, 2, 3, 4], &[1, 9, 8, 4]), [Step::Pair(1, 1), Step::Pair(2, 2)]);
        assert_eq!(steps::<i32>(&[], &[]), []);
        assert_eq!(steps(&[1, 2, 3, 4, 5], &[1, 9, 3, 5]), [Step::OnlyOld(1), Step::OnlyOld(3), Step::OnlyNew(1)]);
    }
}
