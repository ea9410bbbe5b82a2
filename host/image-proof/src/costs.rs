//! Compares the instructions stated by the certificate with those counted on the emulated board: a step while contact
//! holds and with all teeth apart. Also checks that neither a searched state nor a path through the machine code
//! exceeds the certificate's bound.

use model_core::gears::design::{Cost, Substeps};
use parameters::{Excitation, JointParameters};

use super::bound::Bound;
use super::joints::{TEST_JOINTS, write_files};
use super::worst_case::Search;
use board::device::image::DEFAULT_TICK_RATE;
use board::device::toolchain::Toolchain;
use board::device::{Say, measuring};
use report::failure::{Failure, Outcome};

/// Relative tolerance of a prediction; the fits over joints leave 5 %.
const MARGIN: f64 = 0.06;
/// Limit of the certificate's bound over the worst state found; a bound above it is too loose to be useful.
const WIDEST: f64 = 1.6;

/// Instructions counted for a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Counted {
    /// Name of the joint.
    pub name: String,
    /// Sub-steps of a tick in which contacts change.
    pub parts: Substeps,
    /// Instructions under a load.
    pub holding: u32,
    /// Instructions at rest in the middle of the gaps.
    pub apart: u32,
}

/// Counts instructions on the emulated board.
pub fn count(toolchain: &Toolchain, say: Say<'_>) -> Outcome<Vec<Counted>> {
    let files = write_files(toolchain.target_directory())?;
    let elf = measuring::build_measuring(toolchain, "costs", &files, DEFAULT_TICK_RATE, say)?;
    measuring::read(&elf, parse)
}

fn parse(line: &str) -> Option<Counted> {
    let mut fields = line.split(';');
    let name = fields.next()?.to_owned();
    let parts = super::parts(&mut fields)?;
    let mut number = || fields.next()?.parse().ok();
    Some(Counted { name, parts, holding: number()?, apart: number()? })
}

/// Compares predictions with counts, and bounds with the searched worst case and with the machine code. Returns a line
/// per joint.
pub fn judge(counted: &[Counted], searched: &[Search], bounds: &[Bound]) -> Outcome<Vec<String>> {
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

fn compare(parameters: &JointParameters, counted: &Counted, most: u32, proven: u32) -> Outcome<String> {
    let cost = Cost::new(parameters);
    let Counted { name, parts: divided, .. } = counted;
    // A prescribed excitation may be too fast for the exponential flow; teeth without backlash are never apart.
    let holds = matches!(parameters.excitation, Excitation::Angle);
    let parts = [&parameters.sun_planet, &parameters.ring_planet]
        .iter()
        .all(|mesh| mesh.half_backlash.iter().all(|half_backlash| *half_backlash > 0.0));
    for (what, predicted, found, applies) in [
        ("while contact holds", cost.contact_holds(*divided), counted.holding, holds),
        ("with all teeth apart", cost.contact_changes(*divided), counted.apart, parts),
    ] {
        let off = predicted / f64::from(found) - 1.0;
        if applies && off.abs() > MARGIN {
            return Err(Failure::check_failed(format!(
                "joint {name}: {predicted:.0} instructions are promised {what}, but {found} were counted"
            ))
            .with_help("count anew and change the constants of model-core/src/gears/design/cost.rs"));
        }
    }
    let bound = cost.bound(*divided);
    if !(f64::from(most)..WIDEST * f64::from(most)).contains(&bound) {
        return Err(Failure::check_failed(format!(
            "joint {name}: a step is said to take at most {bound:.0} instructions, but the worst that was found takes {most}"
        ))
        .with_help("change the constants of model-core/src/gears/design/cost.rs"));
    }
    if bound < f64::from(proven) {
        return Err(Failure::check_failed(format!(
            "joint {name}: a step is said to take at most {bound:.0} instructions, but a way through its machine code takes {proven}"
        ))
        .with_help("change the constants of model-core/src/gears/design/cost.rs"));
    }
    Ok(format!(
        "{name}: contact holds {} of {:.0} promised, apart {} of {:.0}, worst {most} of {bound:.0}",
        counted.holding,
        cost.contact_holds(*divided),
        counted.apart,
        cost.contact_changes(*divided)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_off_by_more_than_the_margin_fail_and_so_does_a_worst_case_above_the_bound() {
        let joint = TEST_JOINTS[0].read().unwrap().parameters;
        let cost = Cost::new(&joint);
        let parts = Substeps::Corrected(2);
        let (holding, apart) = (cost.contact_holds(parts) as u32, cost.contact_changes(parts) as u32);
        let good = Counted { name: "Q1".into(), parts, holding, apart };
        let most = (0.9 * cost.bound(parts)) as u32;
        assert!(compare(&joint, &good, most, most).is_ok());
        let dear = Counted { holding: good.holding + good.holding / 10, ..good.clone() };
        assert!(compare(&joint, &dear, most, most).unwrap_err().message().contains("while contact holds"));
        assert!(compare(&joint, &good, 2 * most, most).unwrap_err().message().contains("the worst that was found"));
        assert!(compare(&joint, &good, most, 2 * most).unwrap_err().message().contains("machine code"));
    }

    #[test]
    fn a_line_of_the_board_is_read() {
        let counted = |parts| Counted { name: "Q1".into(), parts, holding: 2567, apart: 2925 };
        assert_eq!(parse("Q1;2;0;2567;2925"), Some(counted(Substeps::Corrected(2))));
        assert_eq!(parse("Q1;2;5;2567;2925"), Some(counted(Substeps::Verlet(5))));
        assert_eq!(parse("panicked at x.rs"), None);
    }
}
