//! Tests of all controller ports: each returns the controller's own answer, at most a tick later, or reports its
//! absence. Motions are invented; other tests cover the quality of the answers.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::spi::{ErrorType, Operation, SpiDevice};
use firmware::port::shared_memory::SharedMemory;
use firmware::port::spi_slave::{Broken, SlaveBus, SpiSlave, Transfers};
use firmware::port::{ControllerPort, Direct, PortError, SerialPort, SpiGuest, SpiPort, serial, spi};
use firmware::serial::{Line, Uart};
use link::controller::{Answered, Exchange, WireProbed};
use link::framing::{Receiver, encode, sealed, unsealed};
use link::messages::{Accepted, FromBoard, Schedule, ToBoard};
use model_core::compensation::{Command, Motion, Position};
use model_core::controller::{Answer, Controller};
use model_core::observer::{Reading, Samples};
use model_core::width_probe::ProbeProgress;

mod control {
    #![allow(missing_docs, dead_code, clippy::all, clippy::excessive_precision, reason = "generated numbers")]
    include!(concat!(env!("OUT_DIR"), "/control.rs"));
}

fn controller() -> Direct<'static> {
    Direct(Controller::with_tables(&control::OBSERVER, &control::COMPENSATION).with_probe(control::PROBE.as_ref()))
}

/// Samples and command of one tick of a motion to and fro.
fn tick(number: u32) -> (Samples<f32>, Command<f32>) {
    let time = 1000 * number;
    let turned = (0.02 * number as f32).sin();
    let reading = |range: f32| Reading { counts: ((turned * range) as i32).rem_euclid(range as i32) as u32, time };
    let motion = Motion { position: Position { turns: 0, fraction: turned }, speed: 0.1, acceleration: 0.0 };
    let samples = Samples { time, motor: reading(16384.0), output: Some(reading(131072.0)), torque: 0.1 * turned };
    (samples, Command::Position { now: motion, ahead: Some(motion) })
}

/// Answers of the controller without a port.
fn expected(ticks: u32) -> Vec<Answer<f32>> {
    let mut controller = controller();
    (0..ticks).map(tick).map(|(samples, command)| controller.exchange(&samples, &command).unwrap()).collect()
}

/// Part of an answer that is sent: the rest serves the compensation on the board only.
fn sent(mut answer: Answer<f32>) -> Answer<f32> {
    (answer.estimates.cogging, answer.estimates.motor_lead) = ([0.0; 2], 0.0);
    answer
}

/// Expected answers as another board sends them.
fn sent_of(ticks: u32) -> Vec<Answer<f32>> {
    expected(ticks).into_iter().map(sent).collect()
}

/// Samples of a joint at rest in a tick of a probe.
fn still(number: u32) -> Samples<f32> {
    let time = 1000 * number;
    let reading = Reading { counts: 5, time };
    Samples { time, motor: reading, output: Some(reading), torque: 0.0 }
}

#[test]
fn probe_works_through_every_port() {
    let settle = control::PROBE.as_ref().expect("Q1 can be probed").settle;
    let ticks = settle + 100;
    let mut alone = controller();
    let direct: Vec<_> = (0..ticks).map(|number| alone.probe(&still(number)).unwrap()).collect();
    let pushing = direct.iter().position(|answer| answer.shaped.torque != 0.0).expect("it pushes");
    // After the first period the probe needs time to observe the joint.
    assert_eq!(pushing as u32, settle + 1);
    assert!(direct.iter().all(|answer| answer.probed == Some(ProbeProgress::Running)));
    let mut memory = SharedMemory::new();
    let (mut host, mut guest) = memory.split();
    let mut behind = controller();
    for number in 0..ticks {
        let said = host.probe(&still(number));
        assert!(guest.serve(&mut behind));
        assert_eq!(said.ok(), number.checked_sub(1).map(|before| direct[before as usize]));
    }
    let mut behind = SpiGuest::new(controller());
    let mut frame = [0; spi::FRAME_BYTES];
    for number in 0..ticks {
        sealed(&Exchange::probing(number, &still(number)), &mut frame).unwrap();
        let answered: Answered = unsealed(&behind.answer(&frame).unwrap()).unwrap();
        assert_eq!(answered.answer(), Some(direct[number as usize]));
    }
    assert_eq!(alone.exchange(&still(ticks), &tick(0).1).unwrap().probed, None);
}

/// The answers are bit-identical to those of a direct call.
#[test]
fn shared_memory_guest_answers_one_tick_later() {
    let mut memory = SharedMemory::new();
    let (mut host, mut guest) = memory.split();
    let mut behind = controller();
    let mut said = Vec::new();
    for number in 0..50 {
        let (samples, command) = tick(number);
        said.push(host.exchange(&samples, &command));
        assert!(guest.serve(&mut behind));
    }
    assert_eq!(said[0], Err(PortError::Late));
    let said: Vec<_> = said.into_iter().skip(1).map(Result::unwrap).collect();
    assert_eq!(said, expected(49));
}

/// Nothing waits for a late guest.
#[test]
fn late_guest_costs_unanswered_ticks() {
    let mut memory = SharedMemory::new();
    let (mut host, mut guest) = memory.split();
    let mut behind = controller();
    for number in 0..20 {
        let (samples, command) = tick(number);
        assert_eq!(host.exchange(&samples, &command), Err(PortError::Late));
    }
    while guest.serve(&mut behind) {}
    let (samples, command) = tick(20);
    // Three questions had room: the newest answer belongs to the last of them.
    assert_eq!(host.exchange(&samples, &command), Ok(expected(3)[2]));
}

/// Bus with a guest at its other end, which can corrupt bytes.
struct Bus {
    guest: SpiGuest<Direct<'static>>,
    next: spi::Frame,
    /// Byte to corrupt in the next transfer; `true` if on the way to the guest.
    flip: Rc<Cell<Option<(usize, bool)>>>,
}

impl Bus {
    fn new() -> Self {
        Self { guest: SpiGuest::new(controller()), next: [0; spi::FRAME_BYTES], flip: Rc::default() }
    }
}

impl ErrorType for Bus {
    type Error = Infallible;
}

impl SpiDevice for Bus {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        let [Operation::TransferInPlace(bytes)] = operations else { panic!("one transfer a tick") };
        let mut frame: spi::Frame = bytes[..].try_into().expect("a whole frame");
        bytes.copy_from_slice(&self.next);
        match self.flip.take() {
            Some((at, true)) => frame[at] ^= 4,
            Some((at, false)) => bytes[at] ^= 4,
            None => {}
        }
        self.next = self.guest.answer(&frame).unwrap_or([0; spi::FRAME_BYTES]);
        Ok(())
    }
}

/// The answers are bit-identical to those of a direct call.
#[test]
fn spi_guest_answers_one_tick_later() {
    let mut port = SpiPort::new(Bus::new());
    let said: Vec<_> = (0..50).map(tick).map(|(samples, command)| port.exchange(&samples, &command)).collect();
    assert_eq!(said[0], Err(PortError::Damaged), "an empty frame is no answer");
    assert_eq!(said[1..].iter().map(|answer| answer.unwrap()).collect::<Vec<_>>(), sent_of(49));
}

/// A damaged frame is never taken for an answer.
#[test]
fn changed_spi_byte_costs_one_answer() {
    for towards_guest in [true, false] {
        for at in [0, 7, 60, spi::FRAME_BYTES - 1] {
            let bus = Bus::new();
            let flip = bus.flip.clone();
            let mut port = SpiPort::new(bus);
            let mut said = Vec::new();
            for number in 0..10 {
                let (samples, command) = tick(number);
                flip.set((number == 5).then_some((at, towards_guest)));
                said.push(port.exchange(&samples, &command));
            }
            let bad = if towards_guest { 6 } else { 5 };
            for (number, answer) in said.iter().enumerate().skip(1) {
                assert_eq!(answer.is_err(), number == bad, "tick {number}, byte {at}");
            }
        }
    }
}

/// Hardware of a slave between transfers: received frame or error, and the next frame to send.
struct Wires(Rc<RefCell<(Result<spi::Frame, Broken>, spi::Frame)>>, spi::Frame);

impl SlaveBus for Wires {
    fn finish(&mut self) -> Result<&spi::Frame, Broken> {
        self.1 = self.0.borrow().0?;
        Ok(&self.1)
    }

    fn arm(&mut self, next: &spi::Frame) {
        self.0.borrow_mut().1 = *next;
    }
}

/// Recovers from short, overrun and damaged transfers.
#[test]
fn slave_recovers_with_next_good_transfer() {
    let wires = Rc::new(RefCell::new((Err(Broken::Overrun), [9; spi::FRAME_BYTES])));
    let mut slave = SpiSlave::new(Wires(wires.clone(), [0; spi::FRAME_BYTES]), controller());
    assert_eq!(wires.borrow().1, [0; spi::FRAME_BYTES], "there is nothing to say yet");
    let (mut own, mut said) = (controller(), Vec::new());
    for number in 0..20 {
        let (samples, command) = tick(number);
        let mut frame = [0; spi::FRAME_BYTES];
        sealed(&Exchange::new(number, &samples, &command), &mut frame).unwrap();
        let broken = match number {
            5 => Some(Broken::Short(20)),
            6 => Some(Broken::Overrun),
            _ => None,
        };
        frame[40] ^= u8::from(number == 9);
        let answered: Option<Answered> = unsealed(&wires.borrow().1);
        said.push(answered.map(|answered| (answered.tick, answered.answer().unwrap())));
        wires.borrow_mut().0 = broken.map_or(Ok(frame), Err);
        slave.serve();
    }
    assert_eq!(slave.transfers(), Transfers { answered: 17, damaged: 1, short: 1, overrun: 1 });
    assert_eq!(said[0], None);
    for (number, said) in (0..19).zip(&said[1..]) {
        let (samples, command) = tick(number);
        let expected =
            (!matches!(number, 5 | 6 | 9)).then(|| (number + 1, sent(own.exchange(&samples, &command).unwrap())));
        assert_eq!(*said, expected, "tick {number}");
    }
}

#[test]
fn samples_and_answers_fit_spi_frame() {
    let (samples, command) = tick(3);
    let samples = Samples { time: u32::MAX, motor: Reading { counts: u32::MAX, time: u32::MAX }, ..samples };
    assert!(sealed(&Exchange::new(u32::MAX, &samples, &command), &mut [0; spi::FRAME_BYTES]).is_ok());
    assert!(sealed(&answered(u32::MAX), &mut [0; spi::FRAME_BYTES]).is_ok());
}

/// Returns the longest answer.
fn answered(tick: u32) -> Answered {
    let mut estimates = Answer::<f32>::default().estimates;
    (estimates.motor.turns, estimates.link.turns) = (i32::MIN, i32::MIN);
    Answered {
        tick,
        digest: u64::MAX,
        shaped: (&Answer::default().shaped).into(),
        estimates: Some((&estimates).into()),
        probed: Some(WireProbed::Done((1.0, 1.0, true))),
        computation: u16::MAX,
    }
}

#[test]
fn line_rate_set_by_longest_frames() {
    let motion = Motion { position: Position { turns: i32::MIN, fraction: 0.0 }, speed: 0.0, acceleration: 0.0 };
    let reading = Reading { counts: u32::MAX, time: u32::MAX };
    let samples = Samples { time: u32::MAX, motor: reading, output: Some(reading), torque: 0.0 };
    let command = Command::Position { now: motion, ahead: Some(motion) };
    let commands = [Exchange::new(u32::MAX, &samples, &command)].into_iter().collect();
    let there =
        encode(&ToBoard::Exchanges(Schedule { sequence: u16::MAX, horizon: u32::MAX, commands })).unwrap().len();
    let accepted = Accepted { sequence: u16::MAX, queue_free: u16::MAX, tick: u32::MAX };
    let back = encode(&FromBoard::Accepted(accepted)).unwrap().len()
        + encode(&FromBoard::Answer(answered(u32::MAX))).unwrap().len();
    assert_eq!([there as u32, back as u32], serial::FRAME_BYTES);
    assert_eq!([230_400, 921_600].map(serial::exchanges_per_second), [107, 430]);
}

/// Both directions of a line.
#[derive(Default)]
struct Wire {
    out: VecDeque<u8>,
    back: VecDeque<u8>,
}

struct End(Rc<RefCell<Wire>>);

impl Uart for End {
    fn read(&mut self) -> Option<u8> {
        self.0.borrow_mut().back.pop_front()
    }
    fn overran(&mut self) -> bool {
        false
    }
    fn can_write(&self) -> bool {
        true
    }
    fn write(&mut self, byte: u8) {
        self.0.borrow_mut().out.push_back(byte);
    }
    fn interrupt_on_write(&mut self, _: bool) {}
    fn interrupt_again(&mut self) {}
}

#[test]
fn line_board_asked_after_its_answer_only() {
    let wire = Rc::new(RefCell::new(Wire::default()));
    let mut line = Line::new();
    let (mut uart, end) = line.split(End(wire.clone()), || {});
    let mut port = SerialPort::new(end);
    let mut behind = controller();
    let mut receiver = Receiver::new();
    let (mut asked, mut said) = (Vec::new(), Vec::new());
    for number in 0..40 {
        let (samples, command) = tick(number);
        said.push(port.exchange(&samples, &command));
        (0..40).for_each(|_| uart.service());
        // The board needs two ticks of the controller per exchange.
        let bytes: Vec<u8> = if number % 3 == 2 { wire.borrow_mut().out.drain(..).collect() } else { Vec::new() };
        for byte in bytes {
            let Some(ToBoard::Exchanges(schedule)) = receiver.push(byte) else { continue };
            let [exchange] = &schedule.commands[..] else { panic!("one at a time") };
            asked.push((exchange.tick, exchange.time));
            let answer = behind.exchange(&exchange.samples(), &exchange.command().unwrap()).unwrap();
            let message = FromBoard::Answer(Answered {
                tick: exchange.tick + 1,
                shaped: (&answer.shaped).into(),
                estimates: Some((&answer.estimates).into()),
                probed: None,
                ..answered(0)
            });
            wire.borrow_mut().back.extend(encode(&message).unwrap());
        }
        (0..40).for_each(|_| uart.service());
    }
    assert_eq!(asked[..3], [(0, 0), (1, 3000), (2, 6000)]);
    assert_eq!(said.iter().filter(|answer| answer.is_ok()).count(), 13);
    assert!(said.iter().all(|answer| matches!(answer, Ok(_) | Err(PortError::Late))));
}
