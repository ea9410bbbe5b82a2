//! Role `drive` without a board: frames through the queue of the interrupt, the tick, and a peripheral of this test.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use drives::bus::CanServer;
use drives::drive::{State, VirtualPower};
use drives::frame::{Id, standard};
use drives::{Drive, Frame};
use firmware::can::{CanReceiver, CanSender, FRAMES, Received};
use firmware::drive::DriveTick;
use model_core::VirtualJointDesign;
use virtual_drive::DriveDesign;
use virtual_drive::maker::{Maker, Odrive3};

/// Frames of a peripheral: those in its FIFO, and those that were handed over.
#[derive(Default)]
struct Bus {
    fifo: VecDeque<Frame>,
    overran: bool,
    sent: Vec<Frame>,
    /// Frames that find room in a tick.
    room: usize,
}

type Shared = Rc<RefCell<Bus>>;

struct Half(Shared);

impl CanReceiver for Half {
    fn receive(&mut self) -> Option<Frame> {
        self.0.borrow_mut().fifo.pop_front()
    }

    fn overran(&mut self) -> bool {
        std::mem::take(&mut self.0.borrow_mut().overran)
    }
}

impl CanSender for Half {
    fn send(&mut self, frame: &Frame) -> bool {
        let mut bus = self.0.borrow_mut();
        let has_room = bus.room > 0;
        if has_room {
            bus.room -= 1;
            bus.sent.push(frame.clone());
        }
        has_room
    }

    fn recover(&mut self) {}
}

fn id(command: u16) -> Id {
    standard(1 << 5 | command)
}

/// Runs a drive for some ticks; `each` receives the number of the tick and the bus, and returns the room for frames.
fn run(ticks: usize, mut each: impl FnMut(usize, &mut Bus) -> usize) -> (Vec<Frame>, Drive, (u32, u32)) {
    let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
    let tables = VirtualJointDesign::<3>::new(&q1, 10_000).unwrap();
    let numbers = DriveDesign::new(&q1.parameters, &q1.surroundings, 40.0, true);
    let settings = Odrive3::settings(numbers.settings(Odrive3::PEAK_CURRENT, Odrive3::SUPPLY, true));
    let bus = Shared::default();
    let mut received = Received::new();
    let (mut interrupt, inbox) = received.split(Half(Rc::clone(&bus)));
    let mut tick = DriveTick::new(
        tables.joint(),
        Drive::new(settings),
        Odrive3::server(1, &settings),
        VirtualPower::new(Odrive3::SUPPLY),
        Half(Rc::clone(&bus)),
        inbox,
    );
    for number in 0..ticks {
        let room = each(number, &mut bus.borrow_mut());
        bus.borrow_mut().room = room;
        for _ in 0..4 {
            interrupt.service();
        }
        tick.tick();
    }
    let sent = std::mem::take(&mut bus.borrow_mut().sent);
    (sent, tick.drive().clone(), tick.losses())
}

#[test]
fn drive_obeys_and_answers_in_order() {
    let (sent, drive, lost) = run(3000, |tick, bus| {
        match tick {
            100 => bus.fifo.extend(Frame::classic(id(0x07), &[8, 0, 0, 0])),
            200 => bus.fifo.extend([0x17, 0x14].map(|command| Frame::remote(id(command), 8).unwrap())),
            _ => {}
        }
        3
    });
    assert_eq!((drive.state(), lost), (State::Enabled, (0, 0)));
    let answers: Vec<Id> = sent.iter().map(|frame| frame.id).filter(|it| [id(0x17), id(0x14)].contains(it)).collect();
    assert_eq!(answers, [id(0x17), id(0x14)]);
    assert!(sent.iter().filter(|frame| frame.id == id(0x01)).count() >= 2, "heartbeats");
}

/// Frames wait while the bus is busy, and those beyond the outbox are lost and counted.
#[test]
fn frames_wait_for_a_busy_bus() {
    let (sent, _, (_, unsent)) = run(1000, |tick, bus| {
        if tick < 10 {
            bus.fifo.extend((0..5).filter_map(|_| Frame::remote(id(0x17), 8)));
        }
        usize::from(tick >= 500)
    });
    let answers = sent.iter().filter(|frame| frame.id == id(0x17)).count();
    assert!((30..=32).contains(&answers), "{answers}");
    assert!(unsent >= 18, "{unsent}");
}

/// A FIFO that overran and a full queue are counted.
#[test]
fn lost_frames_are_counted() {
    let (_, _, (lost, _)) = run(2, |tick, bus| {
        if tick == 0 {
            bus.overran = true;
            bus.fifo.extend((0..FRAMES + 5).filter_map(|_| Frame::classic(standard(0x700), &[])));
        }
        3
    });
    // Four services take 12 frames; the overrun is one loss.
    assert_eq!(lost, 1);
    let burst = (0..FRAMES as u16 + 3).filter_map(|count| Frame::classic(standard(count), &[]));
    let bus = Shared::default();
    bus.borrow_mut().fifo.extend(burst);
    let mut received = Received::new();
    let (mut interrupt, mut inbox) = received.split(Half(Rc::clone(&bus)));
    (0..10).for_each(|_| interrupt.service());
    assert_eq!(inbox.lost(), 3);
    let first = inbox.take().unwrap();
    assert_eq!(first.raw_id(), 0);
}

/// The twin's order of work gives the frames of the tick, whatever the room in the peripheral.
#[test]
fn ticks_equal_a_plain_loop() {
    let orders: Vec<(usize, Frame)> = vec![
        (10, Frame::classic(id(0x07), &[8, 0, 0, 0]).unwrap()),
        (200, Frame::classic(id(0x0c), &[0, 0, 128, 62, 0, 0, 0, 0]).unwrap()),
        (201, Frame::remote(id(0x09), 8).unwrap()),
        (900, Frame::classic(id(0x02), &[]).unwrap()),
        (901, Frame::remote(id(0x03), 8).unwrap()),
    ];
    let due = |tick: usize| orders.iter().filter(move |(at, _)| *at == tick).map(|(_, frame)| frame.clone());
    let (sent, _, _) = run(1990, |tick, bus| {
        bus.fifo.extend(due(tick));
        1
    });
    let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
    let tables = VirtualJointDesign::<3>::new(&q1, 10_000).unwrap();
    let numbers = DriveDesign::new(&q1.parameters, &q1.surroundings, 40.0, true);
    let settings = Odrive3::settings(numbers.settings(Odrive3::PEAK_CURRENT, Odrive3::SUPPLY, true));
    let (mut joint, mut drive) = (tables.joint(), Drive::new(settings));
    let (mut server, mut power) = (Odrive3::server(1, &settings), VirtualPower::new(Odrive3::SUPPLY));
    let mut expected = Vec::new();
    for tick in 0..1990 {
        due(tick).for_each(|frame| server.receive(&frame, &mut drive, &mut |answer| expected.push(answer)));
        virtual_drive::step(&mut joint, &mut drive, &mut power);
        server.tick(&mut drive, &mut |frame| expected.push(frame));
    }
    assert_eq!(sent, expected);
}
