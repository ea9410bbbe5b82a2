//! Definitions and messages written by hand from the rules of their encoding.

use super::*;

const FORM: &str = "# a lab's own\nuint8 IDLE=0\nstd_msgs/Header header\nstring[] name\nfloat64[] position\nint16[2] raw 0 # \
                    two\nbool on\nfloat32 current\n===\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";

/// Written by hand from the rules: every number is aligned to its size behind the header.
fn message() -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend(7_i32.to_le_bytes());
    bytes.extend(500_000_000_u32.to_le_bytes());
    bytes.extend([2, 0, 0, 0, b'm', 0, 0, 0]);
    bytes.extend([1, 0, 0, 0, 3, 0, 0, 0, b'a', b'b', 0, 0]);
    bytes.extend([2, 0, 0, 0]);
    bytes.extend(1.5_f64.to_le_bytes());
    bytes.extend((-2.25_f64).to_le_bytes());
    bytes.extend((-3_i16).to_le_bytes());
    bytes.extend(4_i16.to_le_bytes());
    bytes.extend([1, 0, 0, 0]);
    bytes.extend(0.5_f32.to_le_bytes());
    bytes
}

/// Every number of a message has its path.
#[test]
fn message_numbers_have_paths() {
    let form = MessageDefinition::read(FORM).expect("a form");
    let numbers = form.numbers(&message()).expect("a message");
    let wanted = [
        ("header.stamp.sec", 7.0),
        ("header.stamp.nanosec", 5e8),
        ("position[0]", 1.5),
        ("position[1]", -2.25),
        ("raw[0]", -3.0),
        ("raw[1]", 4.0),
        ("on", 1.0),
        ("current", 0.5),
    ];
    assert_eq!(numbers.as_slice(), wanted.map(|(path, value)| (path.to_owned(), value)));
}

/// A message cut at any byte, or with an endless list, is rejected.
#[test]
fn message_cut_anywhere_is_rejected() {
    let form = MessageDefinition::read(FORM).expect("a form");
    let whole = message();
    for length in 0..whole.len() {
        assert!(form.numbers(&whole[..length]).is_err(), "{length}");
    }
    let mut endless = whole;
    endless[20..24].fill(0xff);
    assert!(form.numbers(&endless).is_err());
}

/// Invalid, recursive and incomplete definitions are rejected.
#[test]
fn invalid_definitions_are_rejected() {
    assert!(MessageDefinition::read("float64").is_err() && MessageDefinition::read("float64[x] a").is_err());
    let own = MessageDefinition::read("Own next\n===\nMSG: a/Own\nOwn next\n").expect("a form");
    assert!(own.numbers(&[0, 1, 0, 0]).is_err());
    assert!(MessageDefinition::read("a/Other other\n").expect("a form").numbers(&[0, 1, 0, 0]).is_err());
}

/// Nested lists take time in proportion to the message's bytes.
#[test]
fn nested_lists_take_bounded_time() {
    // Each message contains ten of the next one: 10^16 fields, none of which would take a byte.
    let mut text = "M1[10] next\n".to_owned();
    for depth in 1..16 {
        text += &format!("===\nMSG: a/M{depth}\nM{}[10] next\n", depth + 1);
    }
    let read = |last: &str| {
        let form = MessageDefinition::read(&format!("{text}===\nMSG: a/M16\n{last}\n"))?;
        form.numbers(&[[0, 1, 0, 0].as_slice(), &[0; 10_000]].concat())
    };
    assert_eq!(read("uint8[0] none"), Err("`uint8[0] none` is not a field of a message".to_owned()));
    assert_eq!(read("uint8 one"), Err("it has more than 4096 numbers".to_owned()));
    assert_eq!(read("string text"), Err("it is cut off".to_owned()));
    assert_eq!(read("uint8 ONLY=1"), Err("it is cut off".to_owned()), "a message without fields takes a byte");
}

/// The path of a number has a limited length.
#[test]
fn path_length_is_limited() {
    let form = MessageDefinition::read(&format!("uint8[] {}\n", "n".repeat(100_000))).expect("a form");
    let message = [[0, 1, 0, 0].as_slice(), &100_000_u32.to_le_bytes(), &[0; 100_000]].concat();
    assert_eq!(form.numbers(&message), Err("the path of a number in it has more than 256 letters".to_owned()));
}
