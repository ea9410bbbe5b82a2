//! History of a run as a log, with the names, units and words of the CSV.

use parameters::JointParameters;
use report::contacts::families;
use report::log::{Message, field};

use super::quantities::{QUANTITIES, contact_word};
use super::snapshot::{MeshSnapshot, Snapshot};

/// Topic of the motion.
pub const TOPIC: &str = "/joint/motion";
/// Name of the topic's schema.
pub const SCHEMA_NAME: &str = "joint_msgs/msg/Motion";

/// Fields with one number for each planet.
const LISTS: [(&str, &str); 3] = [("deflection_m", "[m]"), ("deflection_rate_m_per_s", "[m/s]"), ("force_N", "[N]")];

/// Schema of the message for a number of planets, in the text form of ROS 2.
pub fn schema(planets: usize) -> String {
    let of_each = if planets == 1 { "of the one contact" } else { "one for each planet" };
    let numbers = QUANTITIES.iter().map(|quantity| field("float64", quantity.column, quantity.meaning));
    let lists = families(planets).into_iter().flat_map(|family| {
        let list = move |kind, name: &str, meaning: &str| {
            field(kind, &format!("{family}_{name}"), &format!("{meaning}, {of_each}"))
        };
        let numbers = LISTS.iter().map(move |(name, meaning)| list("float64[]", name, meaning));
        numbers.chain([list("string[]", "contact", "separated, drive_side or back_side")])
    });
    [field("float64", "time_s", "since the start [s]")].into_iter().chain(numbers).chain(lists).collect()
}

/// Snapshot as a message.
pub fn message(joint: &JointParameters, snapshot: &Snapshot) -> Message {
    let mut message = Message::default();
    message.number(snapshot.time);
    for quantity in &QUANTITIES {
        message.number((quantity.value)(snapshot, joint));
    }
    let (sun, ring) = snapshot.teeth.split_at(snapshot.teeth.len() / 2);
    for teeth in [sun, ring] {
        let values: [fn(&MeshSnapshot) -> f64; LISTS.len()] =
            [|teeth| teeth.deflection, |teeth| teeth.rate, |teeth| teeth.force];
        for value in values {
            message.numbers(teeth.iter().map(value));
        }
        message.words(teeth.iter().map(|teeth| contact_word(teeth.contact)));
    }
    message
}
