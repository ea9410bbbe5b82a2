//! Coverage of the trials of a joint: every class of contact occurs, in every kind of trial made for it, and a seed
//! reproduces its trials.

use model_core::gears::design::design;
use model_core::gears::{Model, Tables};
use stimuli::outcome::Class;
use stimuli::states::{Kind, Trial, Trials};

const TRIALS: usize = 30_000;

fn tables() -> Tables<f32, 3> {
    let text = joint_file::preset("q1").expect("the preset");
    design(&joint_file::read(text).expect("a sound joint").parameters, 20_000).expect("tables")
}

/// Returns every trial with its class.
fn run(tables: &Tables<f32, 3>) -> Vec<(Trial<3>, Class)> {
    let (mut trials, mut model) = (Trials::new(tables, 1), Model::new(tables));
    let mut step = |index: usize| {
        let trial = trials.make();
        model.set_state(trial.state);
        let before = model.outputs();
        model.step(trial.torques);
        trials.stepped(&trial, model.state(), index == 100);
        (trial, Class::of(&before, &model.outputs()))
    };
    (0..TRIALS).map(&mut step).collect()
}

#[test]
fn every_contact_class_frequent() {
    let tables = tables();
    let found = run(&tables);
    for class in Class::ALL {
        let count = found.iter().filter(|(_, of)| *of == class).count();
        println!("{}: {count}", class.name());
        assert!(count > TRIALS / 1000, "{}: {count}", class.name());
    }
    for kind in Kind::ALL {
        let count = found.iter().filter(|(trial, _)| trial.kind == kind).count();
        assert!(count > TRIALS / 10, "{}: {count}", kind.name());
    }
    let crossing =
        |kind: Kind| found.iter().filter(|(trial, of)| trial.kind == kind && *of == Class::AllChanged).count();
    assert!(crossing(Kind::AllCrossing) > TRIALS / 100, "{}", crossing(Kind::AllCrossing));
}

#[test]
fn same_seed_same_trials() {
    let tables = tables();
    let (first, second) = (run(&tables), run(&tables));
    let text = |found: &[(Trial<3>, Class)]| found.iter().map(|trial| format!("{trial:?}")).collect::<Vec<_>>();
    assert_eq!(text(&first[..2000]), text(&second[..2000]));
}
