//! Help for errors about a board with a wrong image, or about a host command of another version. The check itself is in
//! `identity`.

use link::PROTOCOL_VERSION;

use report::failure::Failure;

/// Remedy for a board with a wrong image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BoardHelp {
    /// Command that flashes the right image.
    Flash(String),
    /// Command that flashes the right image, which was built just now: a board that already has it points to the host
    /// command.
    FlashBuilt(String),
    /// The image was built just now and no other can be on the board: the host command is built from other sources.
    Rebuild,
}

/// Help for a host command built from other sources than its images.
const REBUILD: &str = "the image was built just now from the sources in this checkout, and this `joint` was built from others: \
                       build it anew, as `cargo joint` does by itself (else: cargo build --package joint)";

impl BoardHelp {
    /// Help for a board with another image.
    pub fn of_another_image(&self) -> String {
        match self {
            Self::Flash(command) => format!("flash the right image: {command}"),
            Self::FlashBuilt(command) => {
                format!("flash the right image: {command}\nif the board has that one already: {REBUILD}")
            }
            Self::Rebuild => REBUILD.to_owned(),
        }
    }

    /// Help for a line without a valid frame; `first` names the first thing to check.
    pub fn of_silence(&self, first: &str) -> String {
        match self {
            Self::Flash(command) | Self::FlashBuilt(command) => {
                format!("{first}; flash the image if need be: {command}")
            }
            Self::Rebuild => {
                "run again; if it stays silent its firmware does not start: `joint hil --check` tests that".to_owned()
            }
        }
    }

    /// Failure for a board with another protocol version.
    pub fn of_protocol(&self, board: u16) -> Failure {
        let host = PROTOCOL_VERSION;
        let message = format!("the board speaks version {board} of the link protocol, this host version {host}");
        let help = match self {
            Self::Rebuild => REBUILD.to_owned(),
            Self::Flash(command) | Self::FlashBuilt(command) if board > host => format!(
                "this `joint` is older than the board's image: build it anew from the sources of that image, as `cargo joint` \
                 does by itself, or go back to this one's image: {command}"
            ),
            Self::Flash(command) | Self::FlashBuilt(command) => {
                format!("the board's image is older than this `joint`: flash one of these sources: {command}")
            }
        };
        Failure::new(message).with_help(help)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_older_of_image_and_program_is_the_one_to_be_renewed() {
        let flash = BoardHelp::Flash("cargo joint flash q1".to_owned());
        let help = |help: &BoardHelp, board| help.of_protocol(board).help().expect("a help").to_owned();
        let newer = help(&flash, PROTOCOL_VERSION + 1);
        assert!(newer.contains("this `joint` is older") && newer.contains("cargo joint flash q1"), "{newer}");
        let older = help(&flash, PROTOCOL_VERSION - 1);
        assert!(older.contains("image is older") && older.contains("cargo joint flash q1"), "{older}");
    }

    #[test]
    fn an_image_that_was_built_just_now_is_not_to_be_flashed_again() {
        for help in [
            BoardHelp::Rebuild.of_another_image(),
            BoardHelp::Rebuild.of_protocol(1).help().expect("a help").to_owned(),
        ] {
            assert!(help.contains("build it anew") && !help.contains("flash"), "{help}");
        }
        let built = BoardHelp::FlashBuilt("probe-rs download x".to_owned()).of_another_image();
        assert!(built.contains("probe-rs download x") && built.contains("build it anew"), "{built}");
    }
}
