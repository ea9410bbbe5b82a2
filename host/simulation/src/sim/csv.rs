//! History of a run as CSV: one row for each sample, units in the column names, numbers that parse to equal bits.

use std::io::{self, Write};

use parameters::JointParameters;
use report::contacts::families;

use super::quantities::{QUANTITIES, contact_word};
use super::snapshot::Snapshot;

/// Writes the column names for a number of planets.
pub fn write_head(out: &mut impl Write, planets: usize) -> io::Result<()> {
    let mut names = vec!["time_s".to_owned()];
    names.extend(QUANTITIES.iter().map(|quantity| quantity.column.to_owned()));
    for kind in families(planets) {
        for planet in 1..=planets {
            let number = if planets == 1 { String::new() } else { format!("_{planet}") };
            let quantities = ["deflection_m", "deflection_rate_m_per_s", "force_N", "contact"];
            names.extend(quantities.map(|quantity| format!("{kind}{number}_{quantity}")));
        }
    }
    writeln!(out, "{}", names.join(","))
}

/// Writes one row.
pub fn write_row(out: &mut impl Write, joint: &JointParameters, snapshot: &Snapshot) -> io::Result<()> {
    write!(out, "{:?}", snapshot.time)?;
    for quantity in &QUANTITIES {
        write!(out, ",{:?}", (quantity.value)(snapshot, joint))?;
    }
    for teeth in &snapshot.teeth {
        write!(out, ",{:?},{:?},{:?},{}", teeth.deflection, teeth.rate, teeth.force, contact_word(teeth.contact))?;
    }
    writeln!(out)
}
