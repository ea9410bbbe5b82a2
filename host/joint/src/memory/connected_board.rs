//! Connects to the board whose memory is addressed, and rejects a board whose image estimates no parameters.

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

/// A connected board that has answered.
pub(super) struct ConnectedBoard {
    pub session: Session<'static>,
    pub hello: Hello,
    /// Name of the board in messages.
    pub name: String,
    /// Options that select the board again, for commands in help texts.
    pub options: String,
    emulated: bool,
}

impl ConnectedBoard {
    /// Connects to the board, or starts the emulated one, and reads its identity.
    pub fn connect(place: &BoardArguments, loaded: &Loaded, progress: &Progress) -> Outcome<Self> {
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
            return Err(Failure::new(format!("{name} has an image of role `{role}`, which estimates no parameters"))
                .with_help(format!("flash an observer: {flash}")));
        }
        Ok(Self { session, hello, name, options, emulated: place.line.port.is_none() })
    }

    /// Returns true for the emulated board, which has no flash.
    pub fn is_emulated(&self) -> bool {
        self.emulated
    }

    /// Error: the board's flash holds no memory.
    pub fn no_memory_error(&self) -> Failure {
        if self.emulated {
            return Failure::new("the emulated board has no flash, so it stores no memory")
                .with_help("name a real board by --port");
        }
        if self.hello.memory == MemoryState::Damaged {
            return Failure::new(format!("the stored memory of {} cannot be read", self.name))
                .with_help(format!("erase it: joint memory erase{}", self.options));
        }
        Failure::new(format!("{} has no stored memory", self.name))
            .with_help(format!("run it once, then save its parameters: joint memory keep{}", self.options))
    }

    /// Error: the memory was not written to the board's flash.
    pub fn write_error(&self, outcome: MemoryOutcome) -> Failure {
        if self.emulated {
            return self.no_memory_error();
        }
        if outcome == MemoryOutcome::LowSupply {
            return Failure::new(format!(
                "the supply of {} is too low to write its flash: nothing was changed",
                self.name
            ))
            .with_help("supply 3.3 V, at least 3.1 V, and try again");
        }
        Failure::new(format!("the flash of {} does not read back as written", self.name))
            .with_help("try again; if the error persists, the flash is worn out or write-protected (option bytes)")
    }
}

fn emulated(place: &BoardArguments, loaded: &Loaded, progress: &Progress) -> Outcome<Connection> {
    let say = |line: &str| progress.print_message(line);
    let role = place.role.map_or(Role::Observer, Role::from);
    let joint = image::joint_file(&place.joint, &loaded.name);
    Connection::emulated(progress, |board| {
        progress.stage("preparing the toolchain");
        let toolchain = Toolchain::prepare(&say)?;
        progress.stage("building the firmware");
        image::build_image(&toolchain, &joint, board, role, CONTROL_RATE, false, &say)
    })
}
