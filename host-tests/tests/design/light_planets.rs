//! Sub-steps of joints with light planets on processors that have no time for all that are wanted.

use model_core::gears::design::{Effort, Processor, StepSize, Substeps};

#[test]
fn a_processor_short_of_time_takes_as_many_verlet_sub_steps_as_it_can_and_as_are_stable() {
    let q1 = joint_file::read(joint_file::preset("q1").expect("a preset")).expect("a sound joint").parameters;
    let size = StepSize::new(&q1);
    let mut fewer = 0;
    for processor in [Processor::STM32F405, Processor::STM32G474] {
        for rate in (10_000..=90_000).step_by(2_500) {
            let Ok(Substeps::Verlet(count)) = size.substeps(rate, Effort::Within(processor)) else { continue };
            // One radian of the planets' own mode a sub-step.
            let wanted = size.phase(rate, 1).ceil() as u32;
            let in_time = |count| size.cost().all_crossing(Substeps::Verlet(count)) <= processor.affordable(rate);
            assert!(count <= wanted, "{rate} Hz: {count} of {wanted}");
            if count < wanted {
                assert!(
                    in_time(count) && !in_time(count + 1),
                    "{rate} Hz: {count} are not as many as there is time for"
                );
                assert!(size.phase(rate, count) < size.largest_phase(Substeps::Verlet(count)), "{rate} Hz: unstable");
                fewer += 1;
            }
        }
    }
    assert!(fewer > 5, "{fewer}");
    let at_40_khz = size.substeps(40_000, Effort::Within(Processor::STM32G474));
    assert_eq!(at_40_khz.ok(), Some(Substeps::Verlet(2)), "three, as wanted, take more than the period");
}
