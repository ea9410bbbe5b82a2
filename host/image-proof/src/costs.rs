//! Compares the instructions stated by the certificate with those counted on the emulated board: a step while contact
//! holds and with all teeth apart. Also checks that neither a searched state nor a path through the machine code
//! exceeds the certificate's bound.

use model_core::gears::design::{Cost, Substeps};
use parameters::{Excitation, JointParameters};

use super::bound::Bound;
use super::joints::{TEST_JOINTS, write_files};
use super::worst_case::SearchResult;
use board::device::image::DEFAULT_TICK_RATE;
use board::device::toolchain::Toolchain;
use board::device::{Say, measuring};
use report::failure::{Failure, Outcome};

/// Relative tolerance of a prediction; the fits over joints leave 5 %.
const PREDICTION_TOLERANCE: f64 = 0.06;
/// Limit of the certificate's bound over the worst state found; a bound above it is too loose to be useful.
const MAX_CERTIFICATE_RATIO: f64 = 1.6;

/// Instructions counted for a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct StepCounts {
    /// Name of the joint.
    pub name: String,
    /// Sub-steps of a tick in which contacts change.
    pub substeps: Substeps,
    /// Instructions under a load.
    pub holding: u32,
    /// Instructions at rest in the middle of the gaps.
    pub apart: u32,
}

/// Counts instructions on the emulated board.
pub fn count(toolchain: &Toolchain, say: Say<'_>) -> Outcome<Vec<StepCounts>> {
    let files = write_files(toolchain.target_directory())?;
    let elf = measuring::build_measuring(toolchain, "costs", &files, DEFAULT_TICK_RATE, say)?;
    measuring::read(&elf, parse)
}

fn parse(line: &str) -> Option<StepCounts> {
    let mut fields = line.split(';');
    let name = fields.next()?.to_owned();
    let substeps = super::parse_substeps(&mut fields)?;
    let mut number = || fields.next()?.parse().ok();
    Some(StepCounts { name, substeps, holding: number()?, apart: number()? })
}

/// Compares predictions with counts, and bounds with the searched worst case and with the machine code. Returns a line
/// per joint.
pub fn check(counted: &[StepCounts], searched: &[SearchResult], bounds: &[Bound]) -> Outcome<Vec<String>> {
    TEST_JOINTS
        .iter()
        .map(|joint| {
            let missing = || Failure::check_failed(format!("{}: not counted on the board", joint.name));
            let counted = counted.iter().find(|counted| counted.name == joint.name).ok_or_else(missing)?;
            let searched = searched.iter().find(|search| search.name == joint.name).ok_or_else(missing)?;
            let proven = bounds.iter().find(|bound| bound.name == joint.name).ok_or_else(missing)?;
            compare(&joint.read()?.parameters, counted, searched.most(), proven.instructions)
        })
        .collect()
}

fn compare(parameters: &JointParameters, counted: &StepCounts, most: u32, proven: u32) -> Outcome<String> {
    let cost = Cost::new(parameters);
    let StepCounts { name, substeps, .. } = counted;
    // A prescribed excitation may be too fast for the exponential flow; teeth without backlash are never apart.
    let contact_can_hold = matches!(parameters.excitation, Excitation::Angle);
    let teeth_part = [&parameters.sun_planet, &parameters.ring_planet]
        .iter()
        .all(|mesh| mesh.half_backlash.iter().all(|half_backlash| *half_backlash > 0.0));
    for (what, predicted, found, applies) in [
        ("while contact contact_can_hold", cost.contact_holds(*substeps), counted.holding, contact_can_hold),
        ("with all teeth apart", cost.contact_changes(*substeps), counted.apart, teeth_part),
    ] {
        let off = predicted / f64::from(found) - 1.0;
        if applies && off.abs() > PREDICTION_TOLERANCE {
            return Err(Failure::check_failed(format!(
                "joint {name}: {predicted:.0} instructions are predicted {what}, but {found} were counted"
            ))
            .with_help("update the constants of model-core/src/gears/design/cost.rs"));
        }
    }
    let bound = cost.bound(*substeps);
    if !(f64::from(most)..MAX_CERTIFICATE_RATIO * f64::from(most)).contains(&bound) {
        return Err(Failure::check_failed(format!(
            "joint {name}: the certificate's bound is {bound:.0} instructions, but the worst step found takes {most}"
        ))
        .with_help("change the constants of model-core/src/gears/design/cost.rs"));
    }
    if bound < f64::from(proven) {
        return Err(Failure::check_failed(format!(
            "joint {name}: the certificate's bound is {bound:.0} instructions, but a path through the machine code takes {proven}"
        ))
        .with_help("change the constants of model-core/src/gears/design/cost.rs"));
    }
    Ok(format!(
        "{name}: contact holds {} of {:.0} predicted, apart {} of {:.0}, worst {most} of {bound:.0}",
        counted.holding,
        cost.contact_holds(*substeps),
        counted.apart,
        cost.contact_changes(*substeps)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A count off by 10 %, and a state or a path above the bound, fail the check.
    #[test]
    fn wrong_counts_and_bounds_fail() {
        let joint = TEST_JOINTS[0].read().unwrap().parameters;
        let cost = Cost::new(&joint);
        let substeps = Substeps::Corrected(2);
        let (holding, apart) = (cost.contact_holds(substeps) as u32, cost.contact_changes(substeps) as u32);
        let good = StepCounts { name: "Q1".into(), substeps, holding, apart };
        let most = (0.9 * cost.bound(substeps)) as u32;
        assert!(compare(&joint, &good, most, most).is_ok());
        let dear = StepCounts { holding: good.holding + good.holding / 10, ..good.clone() };
        assert!(compare(&joint, &dear, most, most).unwrap_err().message().contains("while contact contact_can_hold"));
        assert!(compare(&joint, &good, 2 * most, most).unwrap_err().message().contains("the worst step found"));
        assert!(compare(&joint, &good, most, 2 * most).unwrap_err().message().contains("machine code"));
    }

    #[test]
    fn a_line_of_the_board_is_read() {
        let counted = |substeps| StepCounts { name: "Q1".into(), substeps, holding: 2567, apart: 2925 };
        assert_eq!(parse("Q1;2;0;2567;2925"), Some(counted(Substeps::Corrected(2))));
        assert_eq!(parse("Q1;2;5;2567;2925"), Some(counted(Substeps::Verlet(5))));
        assert_eq!(parse("panicked at x.rs"), None);
    }
}
