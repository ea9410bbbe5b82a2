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
const REBUILD: &str = "the image was built just now from this checkout, but this `joint` was built from other sources: rebuild \
                       it with `cargo build --package joint` (`cargo joint` does so by itself)";

impl BoardHelp {
    /// Help for a board with another image.
    pub fn wrong_image(&self) -> String {
        match self {
            Self::Flash(command) => format!("flash the right image: {command}"),
            Self::FlashBuilt(command) => {
                format!("flash the right image: {command}\nif that image is already on the board: {REBUILD}")
            }
            Self::Rebuild => REBUILD.to_owned(),
        }
    }

    /// Help for a line without a valid frame; `first` names the first thing to check.
    pub fn no_valid_frame(&self, first: &str) -> String {
        match self {
            Self::Flash(command) | Self::FlashBuilt(command) => {
                format!("{first}; flash the image if necessary: {command}")
            }
            Self::Rebuild => {
                "run again; if it stays silent its firmware does not start: `joint hil --check` tests that".to_owned()
            }
        }
    }

    /// Failure for a board with another protocol version.
    pub fn other_protocol(&self, board: u16) -> Failure {
        let host = PROTOCOL_VERSION;
        let message = format!("the board speaks version {board} of the link protocol, this host version {host}");
        let help = match self {
            Self::Rebuild => REBUILD.to_owned(),
            Self::Flash(command) | Self::FlashBuilt(command) if board > host => format!(
                "this `joint` is older than the board's image: rebuild it from the sources of that image (`cargo joint` \
                 does so), or flash the image of this version: {command}"
            ),
            Self::Flash(command) | Self::FlashBuilt(command) => {
                format!("the board's image is older than this `joint`: flash an image of this checkout: {command}")
            }
        };
        Failure::new(message).with_help(help)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The help asks to renew the older of image and program.
    #[test]
    fn protocol_help_renews_older_side() {
        let flash = BoardHelp::Flash("cargo joint flash q1".to_owned());
        let help = |help: &BoardHelp, board| help.other_protocol(board).help().expect("a help").to_owned();
        let newer = help(&flash, PROTOCOL_VERSION + 1);
        assert!(newer.contains("this `joint` is older") && newer.contains("cargo joint flash q1"), "{newer}");
        let older = help(&flash, PROTOCOL_VERSION - 1);
        assert!(older.contains("image is older") && older.contains("cargo joint flash q1"), "{older}");
    }

    /// For an image built just now the help asks to rebuild the program.
    #[test]
    fn fresh_image_help_rebuilds_program() {
        for help in
            [BoardHelp::Rebuild.wrong_image(), BoardHelp::Rebuild.other_protocol(1).help().expect("a help").to_owned()]
        {
            assert!(help.contains("rebuild it") && !help.contains("flash"), "{help}");
        }
        let built = BoardHelp::FlashBuilt("probe-rs download x".to_owned()).wrong_image();
        assert!(built.contains("probe-rs download x") && built.contains("rebuild it"), "{built}");
    }
}
