//! Checks that the board runs the image that the joint file asks for. A board with another protocol version may send
//! messages that this host cannot decode, so the first fields of its hello are decoded separately.

use std::fmt;

use link::PROTOCOL_VERSION;
use link::messages::{Hello, Role};
use serde::de::{Deserializer, Error, SeqAccess, Visitor};

use super::BoardHelp;
use crate::device::image::role_name;
use report::failure::{Failure, Outcome};

/// Identity that the board must have.
#[derive(Debug, Clone, PartialEq)]
pub struct Expected {
    /// Name of the joint.
    pub joint: String,
    /// Digest over the joint's parameters and tables.
    pub digest: u64,
    /// Rate of fixed steps [Hz].
    pub tick_rate: u32,
    /// Number of planets.
    pub planets: usize,
    /// Role of the board.
    pub role: Role,
    /// Digest over the controller's tables, if the role has a controller.
    pub control_digest: Option<u64>,
    /// Remedy for a board with another identity.
    pub help: BoardHelp,
}

impl Expected {
    /// Rejects a board with another identity.
    pub fn verify(&self, hello: &Hello) -> Outcome<()> {
        verify_protocol(hello.protocol, &self.help)?;
        let refuse = |what: String| Err(Failure::new(what).with_help(self.help.wrong_image()));
        if hello.role != self.role {
            let (board, host) = (role_name(hello.role), role_name(self.role));
            return refuse(format!("the board's image has the role `{board}`, this run asks for `{host}`"));
        }
        if !hello.digest_good {
            return refuse(format!("the board's tables of joint `{}` do not match their own digest", hello.joint));
        }
        if hello.tick_rate != self.tick_rate {
            let (board, host) = (hello.tick_rate, self.tick_rate);
            return refuse(format!("the board's image steps at {board} Hz, this run asks for {host} Hz"));
        }
        if hello.joint_digest != self.digest || usize::from(hello.planets) != self.planets {
            return refuse(format!(
                "the board's image was built from another joint: it has `{}` ({:016x}), the file gives `{}` ({:016x})",
                hello.joint, hello.joint_digest, self.joint, self.digest
            ));
        }
        if hello.control_digest != self.control_digest {
            return refuse(format!(
                "the board's image was built for another controller of joint `{}`: its tables differ",
                hello.joint
            ));
        }
        Ok(())
    }
}

fn verify_protocol(protocol: u16, help: &BoardHelp) -> Outcome<()> {
    if protocol == PROTOCOL_VERSION { Ok(()) } else { Err(help.other_protocol(protocol)) }
}

/// First fields of a hello, whose places are the same in every version.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HelloHead {
    protocol: u16,
    role: u32,
}

impl HelloHead {
    /// Failure for a board whose hello could not be decoded.
    pub fn refusal(self, help: &BoardHelp) -> Failure {
        let Err(failure) = verify_protocol(self.protocol, help) else {
            let message = format!("the board's image has a role that this host does not know (number {})", self.role);
            return Failure::new(message).with_help(help.wrong_image());
        };
        failure
    }

    /// Returns whether this host cannot decode the rest of the hello.
    pub fn is_undecodable(self) -> bool {
        self.protocol != PROTOCOL_VERSION || self.role > Role::Loop as u32
    }
}

impl<'de> serde::Deserialize<'de> for HelloHead {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // The length exceeds the bytes of any frame: the visitor skips all remaining bytes.
        deserializer.deserialize_tuple(link::framing::MAX_FRAME, HeadVisitor)
    }
}

struct HeadVisitor;

impl<'de> Visitor<'de> for HeadVisitor {
    type Value = HelloHead;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the head of a hello")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut fields: A) -> Result<HelloHead, A::Error> {
        let short = || A::Error::custom("too short");
        let variant: u32 = fields.next_element()?.ok_or_else(short)?;
        if variant != 0 {
            return Err(A::Error::custom("not a hello"));
        }
        let protocol = fields.next_element()?.ok_or_else(short)?;
        let _version: [u8; 3] = fields.next_element()?.ok_or_else(short)?;
        let role = fields.next_element()?.ok_or_else(short)?;
        while let Ok(Some(_)) = fields.next_element::<u8>() {}
        Ok(HelloHead { protocol, role })
    }
}

#[cfg(test)]
mod tests {
    use link::framing::{Receiver, encode};
    use link::messages::{Clock, ClockSource, FromBoard};

    use super::*;

    fn hello() -> Hello {
        Hello {
            protocol: PROTOCOL_VERSION,
            firmware_version: [0, 1, 0],
            role: Role::Plant,
            board: heapless::String::try_from("olimex-h405").expect("room"),
            joint: heapless::String::try_from("q1").expect("room"),
            joint_digest: 0x1234,
            digest_good: true,
            tick_rate: 20_000,
            timer_rate: 168_000_000,
            clock: Clock { source: ClockSource::Crystal, tolerance: 100 },
            planets: 3,
            queue_capacity: 64,
            last_panic: None,
            watchdog_reset: false,
            control_digest: None,
            memory: link::messages::MemoryState::Nothing,
            forced: false,
        }
    }

    fn expected() -> Expected {
        let help = BoardHelp::Flash("cargo joint flash joints/q1.toml".to_owned());
        Expected {
            joint: "q1".into(),
            digest: 0x1234,
            tick_rate: 20_000,
            planets: 3,
            role: Role::Plant,
            control_digest: None,
            help,
        }
    }

    fn refused(change: impl FnOnce(&mut Hello)) -> Failure {
        let mut hello = hello();
        change(&mut hello);
        let failure = expected().verify(&hello).expect_err("another board");
        assert!(failure.help().is_some_and(|help| help.contains("cargo joint flash joints/q1.toml")), "{failure}");
        assert_eq!(failure.exit_code(), 2);
        failure
    }

    /// A board with the expected identity is accepted.
    #[test]
    fn expected_board_accepted() {
        expected().verify(&hello()).expect("the right board");
    }

    /// Each difference of identity is rejected, with the command that flashes the right image.
    #[test]
    fn other_board_rejected_with_command() {
        assert!(refused(|hello| hello.joint_digest = 0x99).message().contains("0000000000000099"));
        assert!(refused(|hello| hello.tick_rate = 10_000).message().contains("10000 Hz"));
        assert!(refused(|hello| hello.protocol = PROTOCOL_VERSION + 1).message().contains("protocol"));
        assert!(refused(|hello| hello.digest_good = false).message().contains("tables"));
        assert!(refused(|hello| hello.planets = 4).message().contains("another joint"));
        assert!(refused(|hello| hello.role = Role::Loop).message().contains("`loop`"));
        assert!(refused(|hello| hello.control_digest = Some(1)).message().contains("another controller"));
    }

    fn head_of<M: serde::Serialize>(message: &M) -> Option<HelloHead> {
        let frame = encode(message).expect("a short message");
        let mut receiver = Receiver::new();
        frame.into_iter().find_map(|byte| receiver.push_beginning(byte))
    }

    /// The head of a hello with an unknown role or version is still decoded.
    #[test]
    fn head_of_foreign_hello_decoded() {
        let own = head_of(&FromBoard::Hello(hello())).expect("a head");
        assert!(!own.is_undecodable());
        let other_role = head_of(&(0u32, PROTOCOL_VERSION, [1u8, 2, 3], 7u32, "with fields", 1.5f64)).expect("a head");
        assert!(other_role.is_undecodable());
        assert!(other_role.refusal(&BoardHelp::Rebuild).message().contains("(number 7)"));
        let other_version = head_of(&(0u32, PROTOCOL_VERSION + 1, [1u8, 2, 3], 0u32)).expect("a head");
        assert!(other_version.is_undecodable());
        assert!(
            other_version.refusal(&BoardHelp::Rebuild).message().contains(&format!("version {}", PROTOCOL_VERSION + 1))
        );
    }

    /// Messages other than a hello have no head.
    #[test]
    fn other_messages_have_no_hello_head() {
        assert_eq!(head_of(&FromBoard::Tripped(link::messages::Trip::BadDigest)), None);
    }
}
