//! Verlet sub-steps: for joints with light planets on processors without time for the number wanted, and for joints with heavy planets
//! where corrected sub-steps do not fit.

use model_core::gears::design::{Effort, Processor, StepSize, Substeps};
use reference::scenarios::{q1, with_teeth};

fn preset_step_size(name: &str) -> StepSize {
    StepSize::new(&joint_file::read(joint_file::preset(name).expect("a preset")).expect("a sound joint").parameters)
}

/// A processor short of time gets as many stable Verlet sub-steps as fit.
#[test]
fn slow_processor_takes_fewer_verlet_substeps() {
    let size = preset_step_size("q1");
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
    let on_g474 = |rate| size.substeps(rate, Effort::Within(Processor::STM32G474)).ok();
    assert_eq!(on_g474(40_000), Some(Substeps::Verlet(3)), "three are wanted and fit");
    assert_eq!(on_g474(42_500), Some(Substeps::Verlet(2)), "three, as wanted, take more than the period");
}

/// Heavy planets get Verlet sub-steps where corrected ones do not fit.
#[test]
fn heavy_planets_fall_back_to_verlet() {
    let processor = Processor { share: 0.75, ..Processor::STM32F405 };
    for name in ["paper", "l1"] {
        let size = preset_step_size(name);
        let (mut corrected, mut verlet, mut neither) = (0, 0, 0);
        for rate in (10_000..=150_000).step_by(2_500) {
            let fits = |substeps| size.cost().all_crossing(substeps) <= processor.affordable(rate);
            let effort = Effort::Within(processor);
            let smooth = size.corrected_substeps(rate, effort).expect("stable");
            // Verlet sub-steps chosen where corrected ones would damp the planets' own mode are a different case.
            if size.phase(rate, smooth) > 1.0 {
                continue;
            }
            match size.substeps(rate, effort).expect("stable") {
                Substeps::Corrected(count) if count == smooth && fits(Substeps::Corrected(smooth)) => corrected += 1,
                found @ Substeps::Verlet(_) if !fits(Substeps::Corrected(smooth)) && fits(found) => verlet += 1,
                Substeps::Corrected(_) if !fits(Substeps::Verlet(1)) => neither += 1,
                found => panic!("{name} at {rate} Hz: {found}"),
            }
        }
        assert!(corrected > 2 && verlet > 2 && neither > 2, "{name}: {corrected}, {verlet}, {neither}");
    }
}

/// Five light planets take at most three fifths of an STM32G4 at 40 kHz.
#[test]
fn five_light_planets_fit_an_stm32g4() {
    // Memory without wait states; worst case with every mesh crossing to its flank.
    let processor = Processor { flash_wait: 0.0, share: 0.6, ..Processor::STM32G474 };
    let size = StepSize::new(&with_teeth(q1(), 5, [30, 20, 70]));
    let chosen = size.substeps(40_000, Effort::Within(processor)).expect("stable");
    assert_eq!(chosen, Substeps::Verlet(1));
    let worst = size.cost().all_crossing(chosen);
    assert!(processor.part(worst, 40_000) <= 0.6 && worst >= size.cost().contact_holds(chosen), "{worst}");
}
