//! Connects to the board whose memory is asked for, and refuses a board whose image learns nothing.

use link::messages::{Hello, MemoryOutcome, MemoryState, Role};

use super::arguments::BoardArguments;
use board::connection::Connection;
use board::device::image;
use board::device::image::CONTROL_RATE;
use board::device::image::role_name;
use board::device::toolchain::Toolchain;
use board::session::{BoardHelp, Session};
use joint_file::named::Loaded;
use report::failure::{Failure, Outcome};
use report::progress::Progress;

/// A board that has answered.
pub(super) struct AnsweringBoard {
    pub session: Session<'static>,
    pub hello: Hello,
    /// As a user knows it.
    pub name: String,
    /// The options that name it again.
    pub options: String,
    emulated: bool,
}

impl AnsweringBoard {
    /// Finds the board and calls it.
    pub fn call(place: &BoardArguments, loaded: &Loaded, progress: &Progress) -> Outcome<Self> {
        let file = place.joint.display();
        let (connection, options) = match &place.line.port {
            Some(path) => {
                let baud = place.line.baud_rate();
                (Connection::on_port(path, baud, || Ok(None))?, place.line.repeated_options())
            }
            None => (emulated(place, loaded, progress)?, String::new()),
        };
        progress.stage("calling the board");
        let flash = format!("cargo joint flash {file} --role observer --board {}", place.line.board_argument());
        let help = if place.line.port.is_some() { BoardHelp::Flash(flash.clone()) } else { BoardHelp::Rebuild };
        let mut session = Session::new(connection.line, connection.supervisor);
        let hello = session.wait_for_hello(&help, connection.timeout)?;
        let name =
            place.line.port.as_ref().map_or("the emulated board".to_owned(), |path| format!("the board on {path}"));
        if hello.role == Role::Plant {
            let role = role_name(hello.role);
            return Err(Failure::new(format!("{name} has an image of role `{role}`, which learns nothing"))
                .with_help(format!("flash one that does: {flash}")));
        }
        Ok(Self { session, hello, name, options, emulated: place.line.port.is_none() })
    }

    /// Whether its flash is none.
    pub fn is_emulated(&self) -> bool {
        self.emulated
    }

    /// Its flash is empty.
    pub fn keeps_nothing(&self) -> Failure {
        if self.emulated {
            return Failure::new("the emulated board has no flash, so it keeps no memory")
                .with_help("name a real board by --port");
        }
        if self.hello.memory == MemoryState::Damaged {
            return Failure::new(format!("what {} keeps cannot be read", self.name))
                .with_help(format!("erase it: joint memory erase{}", self.options));
        }
        Failure::new(format!("{} keeps no memory", self.name))
            .with_help(format!("let it learn in a run, then have it kept: joint memory keep{}", self.options))
    }

    /// Its flash takes nothing.
    pub fn not_written(&self, outcome: MemoryOutcome) -> Failure {
        if self.emulated {
            return self.keeps_nothing();
        }
        if outcome == MemoryOutcome::LowSupply {
            return Failure::new(format!(
                "the supply of {} is too low to write its flash: nothing was changed",
                self.name
            ))
            .with_help("feed it with 3.3 V, 3.1 V at least, and try again");
        }
        Failure::new(format!("the flash of {} does not read as it was written", self.name))
            .with_help("try again; if it stays so it is worn out or write-protected (option bytes)")
    }
}

fn emulated(place: &BoardArguments, loaded: &Loaded, progress: &Progress) -> Outcome<Connection> {
    let say = |line: &str| progress.say(line);
    let role = place.role.map_or(Role::Observer, Role::from);
    let joint = image::joint_file(&place.joint, &loaded.name);
    Connection::emulated(progress, |board| {
        progress.stage("preparing the toolchain");
        let toolchain = Toolchain::prepare(&say)?;
        progress.stage("building the firmware");
        image::build_image(&toolchain, &joint, board, role, CONTROL_RATE, false, &say)
    })
}
