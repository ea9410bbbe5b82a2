//! A run of the twin: clients, bus, pace, control socket and log together.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use live::{Commands, Feed, Live};
use report::failure::{Failure, Outcome};
use report::interruption::{self, UninterruptedWork};
use report::output;
use report::progress::Progress;
use scenario::rig::RunError;

use crate::arguments::Arguments;
use crate::bus::Bus;
use crate::bus_report::BusReport;
use crate::can::Rate;
use crate::clock::Clock;
use crate::control::{self, Socket};
use crate::endpoint::{Client, Endpoint};
use crate::event::{ClientId, Event};
use crate::gate::Gate;
use crate::joint::{Choices, Joint, Prepared};
use crate::log::TwinLog;
use crate::protocol::DriveName;
use crate::summary::Summary;
use wires::{Packet, WireName};

/// Longest wait for an event, so that Ctrl-C is heard.
const MAX_WAIT: Duration = Duration::from_millis(20);

/// Longest time for which the joints wait in lockstep until the bus is silent [s]. A bus that its drives fill never is.
const MAX_BUS_TIME: f64 = 0.02;
/// Frames of clients that wait for the bus before the clients have to wait.
const MAX_WAITING: usize = 256;

/// Runs the twin until its time is over or the user ends it.
pub fn run(arguments: &Arguments, progress: &Progress) -> Outcome<()> {
    let wire = wire_of(arguments)?;
    if arguments.lockstep.is_some_and(|step| !(0.001..=1000.0).contains(&step)) {
        return Err(Failure::new("`--lockstep` is out of range").with_help("write 0.001 to 1000 ms"));
    }
    let choices = Choices {
        drive: arguments.drive,
        plant: arguments.plant,
        seed: arguments.seed,
        compensation: arguments.compensation,
        is_calibrated: !arguments.uncalibrated,
        supply: arguments.supply.unwrap_or(arguments.drive.usual_supply()),
        image: arguments.image.clone(),
    };
    progress.stage("designing the joints");
    let prepared = joints(arguments)?
        .iter()
        .map(|(id, path)| Prepared::load(*id, Path::new(path), &choices))
        .collect::<Outcome<Vec<_>>>()?;
    let started = prepared.iter().map(|joint| joint.start(&choices)).collect::<Outcome<Vec<_>>>()?;
    check_rates(&started)?;
    let rate = arguments.bitrate.map(|nominal| Rate { nominal, ..Rate::USUAL });
    let bus = Bus::new(started, rate, arguments.seed);
    progress.clear();
    let _orderly = UninterruptedWork::begin();
    let (sender, events) = channel();
    let gate = Gate::default();
    let (endpoint, client) = Endpoint::open(wire, arguments.port, arguments.link.as_deref(), &sender, &gate)?;
    let _control = arguments.control.as_ref().map(|path| Socket::listen(path, &sender)).transpose()?;
    let live = Live::start(&arguments.live, "joint twin", None, Some(commands(&sender)))?;
    let log = arguments.log.as_ref().map(|path| TwinLog::begin(path, &bus.joints, remarks(arguments))).transpose()?;
    announce(arguments, wire, &endpoint.name, &bus, live.as_ref())?;
    live.iter().for_each(Live::wait);
    // The time of a feed counts from its start, so that it begins with the run.
    let feeds =
        live.iter().flat_map(|live| bus.joints.iter().filter_map(|joint| live.feed(joint.description().clone())));
    let feeds: Vec<Feed> = feeds.collect();
    let session = Session {
        bus,
        wire,
        gate,
        clients: client.into_iter().collect(),
        log,
        feeds,
        duration: arguments.duration.unwrap_or(f64::INFINITY),
        received: 0,
        sent: 0,
        left: (0, 0),
        started: Instant::now(),
    };
    let summary = match arguments.lockstep {
        Some(step) => session.run_in_lockstep(events, 1e-3 * step),
        None => session.run_by_clock(events, arguments.speed),
    }?;
    arguments.json.as_ref().map_or(Ok(()), |path| output::write_json(path, &output::json("summary", &summary)?))?;
    output::print(&summary.text())
}

/// Wire that suits the drive.
fn wire_of(arguments: &Arguments) -> Outcome<WireName> {
    let wire = arguments.wire.unwrap_or(arguments.drive.usual_wire());
    if (wire == WireName::Serial) != arguments.drive.is_serial() {
        let (bus, help) = match arguments.drive.is_serial() {
            true => ("a serial bus", "leave --wire out, or write --wire serial"),
            false => ("a CAN bus", "write --wire slcan, fdcanusb or socketcand"),
        };
        return Err(Failure::new(format!("`{}` is on {bus}", arguments.drive.word())).with_help(help));
    }
    if wire == WireName::Serial && arguments.bitrate.is_some() {
        return Err(Failure::new(format!("--bitrate sets the rate of a CAN bus, and {}", on_serial_bus(arguments)))
            .with_help("leave --bitrate out: bytes of a serial bus take no time"));
    }
    if wire == WireName::Serial && arguments.same_id {
        return Err(Failure::new(format!(
            "--same-id makes frames on a CAN bus collide, and {}",
            on_serial_bus(arguments)
        ))
        .with_help("leave --same-id out"));
    }
    if arguments.same_id && arguments.live.is_wanted() {
        return Err(Failure::new(
            "--same-id gives several joints one identifier, by which a live view tells them apart",
        )
        .with_help("leave the live view out, or give each joint an identifier of its own without --same-id"));
    }
    if wire == WireName::Socketcand && arguments.drive == DriveName::Moteus {
        return Err(
            Failure::new("socketcand has no CAN FD, which moteus needs").with_help("write --wire fdcanusb or slcan")
        );
    }
    if wire == WireName::Socketcand && arguments.link.is_some() {
        return Err(
            Failure::new("--link names a pseudo-terminal, and socketcand has none").with_help("leave --link out")
        );
    }
    Ok(wire)
}

fn on_serial_bus(arguments: &Arguments) -> String {
    format!("`{}` is on a serial bus", arguments.drive.word())
}

/// Identifiers and files of the joints.
fn joints(arguments: &Arguments) -> Outcome<Vec<(u8, String)>> {
    if arguments.ids.is_empty() {
        let file = arguments.file.as_deref().unwrap_or(Path::new("q1"));
        return Ok(vec![(1, file.display().to_string())]);
    }
    let mut joints = Vec::new();
    let most = arguments.drive.max_id();
    for assignment in &arguments.ids {
        let parsed = assignment.split_once('=').and_then(|(id, file)| Some((id.parse::<u8>().ok()?, file.to_owned())));
        let Some((id, file)) = parsed.filter(|(id, file)| (1..=most).contains(id) && !file.is_empty()) else {
            return Err(Failure::new(format!("--id {assignment}: this names no joint"))
                .with_help(format!("write ID=FILE with an identifier from 1 to {most}, such as --id 1=q1")));
        };
        if !arguments.same_id && joints.iter().any(|(known, _)| *known == id) {
            return Err(Failure::new(format!("--id {assignment}: the identifier {id} is taken")).with_help(
                "give each joint an identifier of its own, or write --same-id to see their frames collide",
            ));
        }
        joints.push((id, file));
    }
    Ok(joints)
}

/// Joints of one bus run in step, so that they need one control rate.
fn check_rates(joints: &[Joint<'_>]) -> Outcome<()> {
    let Some(first) = joints.first() else { return Ok(()) };
    match joints.iter().find(|joint| joint.period() != first.period()) {
        None => Ok(()),
        Some(other) => Err(Failure::new(format!(
            "{} has a control rate of {:.0} Hz, {} of {:.0} Hz",
            first.name,
            1.0 / first.period(),
            other.name,
            1.0 / other.period()
        ))
        .with_help("write one control_rate_Hz into all joint files of a bus")),
    }
}

/// Commands of the live view, carried out as those of the control socket.
fn commands(events: &Sender<Event>) -> Commands {
    let events = events.clone();
    Arc::new(move |line| control::ask(line, &events))
}

fn remarks(arguments: &Arguments) -> BTreeMap<String, String> {
    [
        ("drive", arguments.drive.word()),
        ("plant", arguments.plant.word().to_owned()),
        ("seed", arguments.seed.to_string()),
        ("compensation", arguments.compensation.to_string()),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_owned(), value))
    .collect()
}

fn announce(arguments: &Arguments, wire: WireName, port: &str, bus: &Bus<'_>, live: Option<&Live>) -> Outcome<()> {
    let joints: Vec<String> = bus.joints.iter().map(|joint| describe(joint)).collect();
    let mut text = format!(
        "port:     {port}\nclient:   {}\njoints:   {}\n",
        arguments.drive.client(wire, port),
        joints.join(", ")
    );
    if let Some(path) = &arguments.control {
        text += &format!("control:  {}\n", path.display());
    }
    text += live.map_or("", Live::text);
    if arguments.duration.is_none() {
        text += "Ctrl-C ends it\n";
    }
    output::print(&text)
}

/// Identifier, name and model of a joint.
fn describe(joint: &Joint<'_>) -> String {
    let model = joint.model.as_ref().map_or_else(String::new, |model| format!(" (type {model})"));
    format!("{} = {}{model}", joint.id, joint.name)
}

/// Running twin.
struct Session<'d> {
    bus: Bus<'d>,
    wire: WireName,
    gate: Gate,
    clients: Vec<Client>,
    log: Option<TwinLog>,
    /// Feeds of the live view, one for each joint; empty without it.
    feeds: Vec<Feed>,
    /// Simulated time of the run [s].
    duration: f64,
    received: u64,
    sent: u64,
    /// Packets that clients who left did not read, and their malformed ones.
    left: (u64, u64),
    started: Instant,
}

impl Session<'_> {
    /// Runs by the clock. The end drops the events, so that no thread waits for the answer to a command.
    fn run_by_clock(mut self, events: Receiver<Event>, speed: f64) -> Outcome<Summary> {
        let mut clock = Clock::new(speed);
        while self.goes_on() {
            let time = self.time();
            let wait = clock.wait(time);
            if wait.is_zero() {
                clock.begin(time);
                self.let_clients_send();
                self.period()?;
            }
            // An event is handled at once, and so are all that wait; then the next period has its turn.
            match events.recv_timeout(wait.min(MAX_WAIT)) {
                Ok(event) => drop(self.handle(event)?),
                Err(RecvTimeoutError::Timeout) => self.clients.iter_mut().for_each(Client::flush),
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        let lateness = Some(clock.lateness());
        self.finish(lateness)
    }

    /// Runs in lockstep with the client. The end drops the events, so that no thread waits for the answer to a command.
    fn run_in_lockstep(mut self, events: Receiver<Event>, step: f64) -> Outcome<Summary> {
        // The first period reads the encoders, so that the first answer has a position.
        self.period()?;
        let mut target = self.time();
        while self.goes_on() {
            match events.recv_timeout(MAX_WAIT) {
                Ok(Event::Bytes { client, bytes, .. }) => {
                    for (packet, is_complete) in self.packets(client, &bytes) {
                        self.deliver(packet)?;
                        target += if is_complete { step } else { 0.0 };
                        let tolerance = 0.5 * self.bus.joints.first().map_or(step, |joint| joint.period());
                        while self.time() + tolerance < target {
                            self.period()?;
                        }
                        // The answer takes its time on the bus as well.
                        let latest = target + MAX_BUS_TIME;
                        while self.bus.is_busy() && self.time() < latest {
                            self.period()?;
                            target = target.max(self.time());
                        }
                    }
                    self.gate.handled(bytes.len());
                }
                Ok(event) => drop(self.handle(event)?),
                Err(RecvTimeoutError::Timeout) => self.clients.iter_mut().for_each(Client::flush),
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        self.finish(None)
    }

    fn goes_on(&self) -> bool {
        !interruption::requested() && self.time() < self.duration
    }

    fn time(&self) -> f64 {
        self.bus.time()
    }

    fn period(&mut self) -> Outcome<()> {
        let packets = self.bus.period().map_err(broken)?;
        if let Some(log) = &mut self.log {
            log.sample(&self.bus.joints)?;
        }
        for (joint, feed) in self.bus.joints.iter().zip(&mut self.feeds) {
            feed.publish(joint.time(), || joint.live_sample());
        }
        self.send(&packets)
    }

    /// Lets the clients send more frames, unless too many of theirs wait for the bus. Not in lockstep, where the frames of
    /// the clients advance the time and so empty the queue.
    fn let_clients_send(&self) {
        self.gate.set(self.bus.client_backlog() < MAX_WAITING);
    }

    fn handle(&mut self, event: Event) -> Outcome<()> {
        match event {
            Event::Bytes { client, bytes, .. } => {
                for (packet, _) in self.packets(client, &bytes) {
                    self.deliver(packet)?;
                }
                self.gate.handled(bytes.len());
                self.let_clients_send();
            }
            Event::Connected(id, stream) => self.clients.push(Client::connected(id, self.wire, stream)),
            Event::Left(id) => {
                let gone = |client: &mut Client| client.id == id;
                for client in self.clients.extract_if(.., gone) {
                    self.left.0 += client.dropped;
                    self.left.1 += client.malformed;
                }
            }
            Event::Control(line, answer) => {
                // A client of the socket that left does not wait for its answer.
                let _ = answer.send(control::execute(&line, &mut self.bus));
            }
        }
        Ok(())
    }

    fn packets(&mut self, client: ClientId, bytes: &[u8]) -> Vec<(Packet, bool)> {
        let client = self.clients.iter_mut().find(|known| known.id == client);
        client.map_or_else(Vec::new, |client| client.receive(bytes))
    }

    fn deliver(&mut self, packet: Packet) -> Outcome<()> {
        self.received += 1;
        let time = self.time();
        if let Some(log) = &mut self.log {
            log.packet(time, &packet, true)?;
        }
        let answers = self.bus.receive(packet);
        self.send(&answers)
    }

    fn send(&mut self, packets: &[Packet]) -> Outcome<()> {
        let time = self.time();
        for packet in packets {
            self.sent += 1;
            self.clients.iter_mut().for_each(|client| client.send(packet));
            if let Some(log) = &mut self.log {
                log.packet(time, packet, false)?;
            }
        }
        Ok(())
    }

    fn finish(mut self, lateness: Option<crate::clock::Lateness>) -> Outcome<Summary> {
        let time_s = self.time();
        if let Some(log) = self.log.take() {
            log.finish()?;
        }
        let sum = |of: fn(&Client) -> u64| self.clients.iter().map(of).sum::<u64>();
        let bus = BusReport::new(&self.bus);
        Ok(Summary {
            bus,
            schema: "joint-twin/1",
            time_s,
            elapsed_s: self.started.elapsed().as_secs_f64(),
            received: self.received,
            sent: self.sent,
            dropped: self.left.0 + self.bus.cut_off + sum(|client| client.dropped),
            malformed: self.left.1 + sum(|client| client.malformed),
            lateness,
        })
    }
}

fn broken(error: RunError) -> Failure {
    match error {
        RunError::Broke(message) => Failure::check_failed(message),
        other => Failure::check_failed(format!("the run ended: {other:?}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A viewer's thread that waited for its answer would hang.
    #[test]
    fn end_answers_waiting_commands() {
        for by_clock in [true, false] {
            let session = Session {
                bus: Bus::new(Vec::new(), None, 1),
                wire: WireName::Slcan,
                gate: Gate::default(),
                clients: Vec::new(),
                log: None,
                feeds: Vec::new(),
                duration: 0.0,
                received: 0,
                sent: 0,
                left: (0, 0),
                started: Instant::now(),
            };
            let (sender, events) = channel();
            let (answered, answer) = channel();
            sender.send(Event::Control("{}".to_owned(), answered)).expect("the twin runs");
            let run =
                || if by_clock { session.run_by_clock(events, 1.0) } else { session.run_in_lockstep(events, 1e-3) };
            run().expect("it ends");
            assert!(
                answer.recv_timeout(Duration::from_secs(1)).is_err_and(|error| error == RecvTimeoutError::Disconnected)
            );
        }
    }
}
