//! Window edges of set P, from rest and carried, and independence of the number of threads.

use paper::numerics::attractor::Class;
use paper::{StudyRecord, study};
use report::progress::Progress;

use super::{SHORT, from_rest, plan, subject};

/// Classes from rest match the known windows.
#[test]
fn windows_from_rest_match_known_edges() {
    let paper = subject("paper", None);
    // One micrometre to either side of every known edge.
    let known = [
        (18.0, Class::Periodic(1)),
        (20.0, Class::Periodic(2)),
        (33.5, Class::Periodic(2)),
        (36.0, Class::Chaotic),
        (40.0, Class::Chaotic),
        (45.0, Class::Chaotic),
        (47.5, Class::Periodic(3)),
        (68.0, Class::Periodic(3)),
        (70.0, Class::Periodic(6)),
        (72.0, Class::Chaotic),
        (150.0, Class::Chaotic),
    ];
    for (half_backlash, class) in known {
        let found = from_rest(&paper, half_backlash, &SHORT);
        assert_eq!(found.class, class, "b = {half_backlash}, exponent {}", found.exponent);
    }
}

fn studied(words: &[&str], threads: usize) -> StudyRecord {
    let plan = plan(words).expect("a good plan");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let mut record = pool.install(|| study(&plan, &Progress::new())).expect("it runs");
    record.identity.date.clear();
    record
}

/// Carried upward, period two holds longer than from rest.
#[test]
fn carried_period_two_lasts_longer() {
    let record = studied(&["paper", "--b", "60", "--grid", "30:42:1", "--sweep", "all"], 2);
    let last_of_two = |start: &str| {
        let sweep = record.readings[0].sweeps.iter().find(|sweep| sweep.start == start).expect("a sweep");
        let two = sweep.windows.iter().filter(|window| window.class == Class::Periodic(2));
        two.map(|window| window.to_m * 1e6).fold(0.0, f64::max)
    };
    assert!((last_of_two("rest") - 34.0).abs() < 1e-6, "{}", last_of_two("rest"));
    assert!((last_of_two("up") - 40.0).abs() <= 1.0, "{}", last_of_two("up"));
}

/// Records do not depend on the number of threads.
#[test]
fn thread_count_changes_nothing() {
    let words = ["paper_printed", "--b", "60", "--grid", "100:104:1", "--sweep", "all"];
    let (one, two) = (studied(&words, 1), studied(&words, 2));
    assert!(one == two, "records differ");
}
