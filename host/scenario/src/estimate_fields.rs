//! Estimates of the observer as fields of a log: every value in SI with variance and validity, states as words. Logs of
//! runs and replays share this list.

use model_core::numbers::digest;
use model_core::observer::{Estimates, MotorFault, Notices, OutputFault, Source, TorqueResponse};
use parameters::ContactState;
use report::contacts::Contact;
use report::log::{Message, field};

/// A number or flag of the estimates.
#[derive(Debug, Clone, Copy)]
pub struct EstimateField {
    /// Name, with the unit.
    pub name: &'static str,
    /// Meaning.
    pub meaning: &'static str,
    value: Value,
}

/// Accessor of a field.
#[derive(Debug, Clone, Copy)]
enum Value {
    Number(fn(&Estimates<f32>) -> f32),
    Whole(fn(&Estimates<f32>) -> i32),
    Flag(fn(&Estimates<f32>) -> bool),
}

/// A field that is a word.
#[derive(Debug, Clone, Copy)]
pub struct WordField {
    /// Name.
    pub name: &'static str,
    /// Meaning.
    pub meaning: &'static str,
    /// Accessor of the word.
    pub word: fn(&Estimates<f32>) -> &'static str,
}

const fn number(name: &'static str, meaning: &'static str, value: fn(&Estimates<f32>) -> f32) -> EstimateField {
    EstimateField { name, meaning, value: Value::Number(value) }
}

const fn whole(name: &'static str, meaning: &'static str, value: fn(&Estimates<f32>) -> i32) -> EstimateField {
    EstimateField { name, meaning, value: Value::Whole(value) }
}

const fn flag(name: &'static str, meaning: &'static str, value: fn(&Estimates<f32>) -> bool) -> EstimateField {
    EstimateField { name, meaning, value: Value::Flag(value) }
}

/// Value, variance and validity of an estimate.
macro_rules! estimate {
    ($of:ident, $name:literal, $unit:literal, $square:literal, $meaning:literal) => {
        [
            number(concat!("estimated_", $name, $unit), $meaning, |all| all.$of.value),
            number(concat!("estimated_", $name, "_variance", $square), "of it", |all| all.$of.variance),
            flag(concat!("estimated_", $name, "_valid"), "whether the observer stands by it", |all| all.$of.valid),
        ]
    };
}

/// Estimates with variance and validity.
const ESTIMATES: [[EstimateField; 3]; 9] = [
    estimate!(gap, "gap", "_m", "_m2", "gap coordinate [m]"),
    estimate!(mesh_torque, "mesh_torque", "_Nm", "_N2m2", "between carrier and link [N m]"),
    estimate!(load_torque, "load_torque", "_Nm", "_N2m2", "what brakes the link [N m]"),
    estimate!(half_backlash, "half_backlash", "_m", "_m2", "of every mesh, as learnt [m]"),
    estimate!(encoder_offset, "encoder_offset", "_rad", "_rad2", "motor encoder ahead of the output's, there [rad]"),
    estimate!(compliance, "compliance", "_rad_per_Nm", "_rad2_per_N2m2", "from sun to link, there [rad/(N m)]"),
    estimate!(skew, "skew", "_s", "_s2", "age of output readings less that of the motor's [s]"),
    estimate!(torque_bias, "torque_bias", "_Nm", "_N2m2", "what the motor loses in either direction [N m]"),
    estimate!(motor_friction, "motor_friction", "_Nm", "_N2m2", "dry friction of the motor [N m]"),
];
/// Other numbers and flags.
const OTHER_FIELDS: [EstimateField; 15] = [
    number("estimated_link_inertia_ratio", "inertia of the link over the joint file's", |all| {
        all.link_inertia_ratio.value
    }),
    number("estimated_link_inertia_ratio_variance", "of it", |all| all.link_inertia_ratio.variance),
    flag("estimated_link_inertia_ratio_valid", "whether the observer stands by it", |all| all.link_inertia_ratio.valid),
    number("estimated_gap_rate_m_per_s", "of the gap coordinate [m/s]", |all| all.gap_rate),
    number("estimated_flank_shift_m", "of both flanks by the transmission error [m]", |all| all.flank_shift),
    number("estimated_flank_shift_slope_m_per_rad", "for each radian of the link [m/rad]", |all| all.flank_shift_slope),
    flag("estimated_side_valid", "whether the side may be used", |all| all.contact_valid),
    flag("estimated_settled", "contact has held for long enough to learn from", |all| all.settled),
    whole("estimated_motor_turns", "whole turns of the motor", |all| all.motor.turns),
    number("estimated_motor_fraction", "what is left of them [turns]", |all| all.motor.fraction),
    number("estimated_motor_speed_rad_per_s", "[rad/s]", |all| all.motor.speed),
    whole("estimated_link_turns", "whole turns of the link", |all| all.link.turns),
    number("estimated_link_fraction", "what is left of them [turns]", |all| all.link.fraction),
    number("estimated_link_speed_rad_per_s", "[rad/s]", |all| all.link.speed),
    flag("encoders_trusted", "both encoders are used", |all| all.source == Source::Both),
];

/// Fields that are words.
pub const WORD_FIELDS: [WordField; 4] = [
    WordField {
        name: "estimated_side",
        meaning: "flank that carries: separated, drive_side or back_side",
        word: |all| side(all.reported_contact),
    },
    WordField {
        name: "estimated_side_by_force",
        meaning: "the same by the mesh force alone",
        word: |all| side(all.contact),
    },
    WordField {
        name: "estimates_from",
        meaning: "encoders that the estimates stand on: both, motor_only or nothing",
        word: |all| source(all.source).0,
    },
    WordField {
        name: "encoder_fault",
        meaning: "why not both, such as output_frozen or motor_silent; none otherwise",
        word: |all| source(all.source).1,
    },
];

/// Field of all notices: name and meaning.
pub const NOTICES_FIELD: (&str, &str) = (
    "observer_notices",
    "what was wrong with the samples: torque_unknown, out_of_time, motor_implausible, motor_jumped; torque_reversed, which stays",
);

/// All fields that are numbers or flags.
pub fn fields() -> impl Iterator<Item = EstimateField> {
    ESTIMATES.into_iter().flatten().chain(OTHER_FIELDS)
}

impl EstimateField {
    /// Value of the field; a flag is 0 or 1.
    pub fn value(&self, estimates: &Estimates<f32>) -> f64 {
        match self.value {
            Value::Number(value) => value(estimates).into(),
            Value::Whole(value) => value(estimates).into(),
            Value::Flag(value) => u8::from(value(estimates)).into(),
        }
    }

    /// Returns true for a flag.
    pub fn is_flag(&self) -> bool {
        matches!(self.value, Value::Flag(_))
    }
}

/// Fields in the text form of ROS 2 messages.
pub fn schema() -> String {
    let numbers =
        fields().map(|known| field(if known.is_flag() { "bool" } else { "float64" }, known.name, known.meaning));
    let words = WORD_FIELDS.iter().map(|known| field("string", known.name, known.meaning));
    numbers.chain(words).chain([field("string[]", NOTICES_FIELD.0, NOTICES_FIELD.1)]).collect()
}

/// Adds the fields to a message. Without an observer numbers are zero, and words `none`.
pub fn add(message: &mut Message, estimates: Option<&Estimates<f32>>) {
    let known = estimates.copied().unwrap_or_default();
    for field in fields() {
        let value = if estimates.is_some() { field.value(&known) } else { 0.0 };
        if field.is_flag() { message.flag(value != 0.0) } else { message.number(value) }
    }
    for field in WORD_FIELDS {
        message.word(estimates.map_or("none", field.word));
    }
    message.words(estimates.map_or_else(Vec::new, notices).into_iter());
}

/// Digest over every bit of the estimates, in 32 bits. A difference in one period shows in the following periods too.
pub fn estimates_digest(estimates: &Estimates<f32>) -> u32 {
    let numbers = fields().map(|field| field.value(estimates).to_bits());
    let words = WORD_FIELDS.iter().flat_map(|field| (field.word)(estimates).bytes().map(u64::from));
    let notices = notices(estimates).into_iter().flat_map(|word| word.bytes().map(u64::from));
    let digest = numbers.chain(words).chain(notices).fold(digest::START, digest::chain);
    (digest ^ (digest >> 32)) as u32
}

/// Names of the active notices.
pub fn notices(of: &Estimates<f32>) -> Vec<&'static str> {
    let Notices { torque_unknown, out_of_time, motor_implausible, motor_jumped } = of.notices;
    let all = [
        ("torque_unknown", torque_unknown),
        ("out_of_time", out_of_time),
        ("motor_implausible", motor_implausible),
        ("motor_jumped", motor_jumped),
        ("torque_reversed", of.torque_response == TorqueResponse::Reversed),
    ];
    all.into_iter().filter(|(_, set)| *set).map(|(word, _)| word).collect()
}

fn side(contact: ContactState) -> &'static str {
    match contact {
        ContactState::Separated => Contact::Separated,
        ContactState::DriveSide => Contact::DriveSide,
        ContactState::BackSide => Contact::BackSide,
    }
    .word()
}

fn source(source: Source) -> (&'static str, &'static str) {
    match source {
        Source::Both => ("both", "none"),
        Source::MotorOnly(fault) => (
            "motor_only",
            match fault {
                OutputFault::Absent => "output_absent",
                OutputFault::Unheard => "output_unheard",
                OutputFault::Silent => "output_silent",
                OutputFault::Frozen => "output_frozen",
                OutputFault::OutOfRange => "output_out_of_range",
            },
        ),
        Source::Nothing(fault) => (
            "nothing",
            match fault {
                MotorFault::Silent => "motor_silent",
                MotorFault::Late => "motor_late",
                MotorFault::Frozen => "motor_frozen",
                MotorFault::Jumped => "motor_jumped",
            },
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digest_covers_every_field() {
        let whole = Estimates::<f32>::default();
        let mut others = vec![whole; 6];
        others[0].gap.variance = f32::from_bits(1);
        others[1].link_inertia_ratio.valid = true;
        others[2].notices.motor_jumped = true;
        others[3].reported_contact = ContactState::BackSide;
        others[4].source = Source::Nothing(MotorFault::Late);
        others[5].link.turns = -1;
        for other in others {
            assert_ne!(estimates_digest(&other), estimates_digest(&whole), "{other:?}");
        }
        assert_eq!(estimates_digest(&whole), estimates_digest(&whole.clone()));
    }

    #[test]
    fn field_names_differ_in_lower_case() {
        let mut names: Vec<String> = fields().map(|field| field.name.to_ascii_lowercase()).collect();
        names.extend(WORD_FIELDS.iter().map(|word| word.name.to_owned()));
        let all = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), all);
    }
}
