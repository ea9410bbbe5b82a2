//! Figures of a run.

use serde::Serialize;

use crate::bus_report::BusReport;
use crate::clock::Lateness;

/// Figures of a run.
#[derive(Debug, Serialize)]
pub struct Summary {
    /// Name and version of the record.
    pub schema: &'static str,
    /// Simulated time [s].
    pub time_s: f64,
    /// Time on the clock [s].
    pub elapsed_s: f64,
    /// Packets of clients.
    pub received: u64,
    /// Packets of drives.
    pub sent: u64,
    /// Packets that a client did not read in time.
    pub dropped: u64,
    /// Lines and frames that made no sense.
    pub malformed: u64,
    /// Figures of a CAN bus.
    pub bus: Option<BusReport>,
    /// Lateness of the periods; `None` in lockstep.
    pub lateness: Option<Lateness>,
}

impl Summary {
    /// Lines for the terminal.
    pub fn text(&self) -> String {
        let Self { time_s, elapsed_s, received, sent, dropped, malformed, .. } = self;
        let mut text = format!(
            "time:     {time_s:.3} s simulated in {elapsed_s:.3} s\nframes:   {received} from clients, {sent} from drives"
        );
        if *dropped > 0 {
            text += &format!(", {dropped} not read in time");
        }
        if *malformed > 0 {
            text += &format!(", {malformed} malformed");
        }
        text.push('\n');
        text += &self.bus.as_ref().map_or_else(String::new, BusReport::text);
        if let Some(late) = &self.lateness {
            text += &format!(
                "lateness: median {:.0} us, 99 % below {:.0} us, worst {:.1} ms\n",
                1e6 * late.median_s,
                1e6 * late.p99_s,
                1e3 * late.worst_s
            );
            if late.lost_s > 0.0 {
                text += &format!(
                    "warning:  this machine lost {:.3} s: the run was not in real time; try --plant core or fewer joints\n",
                    late.lost_s
                );
            }
        }
        text
    }
}
