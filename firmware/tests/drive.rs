//! Role `drive` without a board: frames through the queue of the interrupt, the tick, and a peripheral of this test.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use drives::drive::State;
use drives::frame::{Id, standard};
use drives::{Drive, Frame};
use firmware::can::{CanReceiver, CanSender, FRAMES, PERIODS, Received};
use firmware::drive::DriveTick;
use model_core::VirtualJointDesign;
use virtual_drive::maker::{Cia402, Maker, Odrive3};
use virtual_drive::{DriveDesign, VirtualDrive};

/// Frames of a peripheral: those in its FIFO, and those that were handed over.
#[derive(Default)]
struct Bus {
    fifo: VecDeque<Frame>,
    is_off: bool,
    sent: Vec<Frame>,
    /// Frames that find room in a tick.
    room: usize,
}

type Shared = Rc<RefCell<Bus>>;

struct Half(Shared);

impl CanReceiver for Half {
    fn acknowledge(&mut self) {}

    fn receive(&mut self) -> Option<Frame> {
        self.0.borrow_mut().fifo.pop_front()
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

    fn is_off(&mut self) -> bool {
        self.0.borrow().is_off
    }
}

fn id(command: u16) -> Id {
    standard(1 << 5 | command)
}

/// Joint Q1 behind the drive of a maker, with identifier 1.
fn with_drive<M: Maker, R>(run: impl FnOnce(VirtualDrive<'_, M, 3>) -> R) -> R {
    let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
    let tables = VirtualJointDesign::<3>::new(&q1, 10_000).unwrap();
    let design = DriveDesign::new(&q1.parameters, &q1.surroundings, 40.0, true);
    run(VirtualDrive::new(tables.joint(), &design, 1))
}

/// Runs a drive for some ticks; `each` receives the number of the tick and the bus, and returns the room for frames.
fn run<M: Maker>(ticks: usize, mut each: impl FnMut(usize, &mut Bus) -> usize) -> (Vec<Frame>, Drive) {
    let bus = Shared::default();
    let mut received = Received::new();
    let (mut interrupt, inbox) = received.split(Half(Rc::clone(&bus)));
    let drive = with_drive::<M, _>(|drive| {
        let mut tick = DriveTick::new(drive, Half(Rc::clone(&bus)), inbox);
        for number in 0..ticks {
            let room = each(number, &mut bus.borrow_mut());
            bus.borrow_mut().room = room;
            for _ in 0..4 {
                interrupt.service();
            }
            interrupt.begin_period();
            assert!(!tick.tick());
        }
        tick.drive().clone()
    });
    let sent = std::mem::take(&mut bus.borrow_mut().sent);
    (sent, drive)
}

#[test]
fn drive_obeys_and_answers_in_order() {
    let (sent, drive) = run::<Odrive3>(3000, |tick, bus| {
        match tick {
            100 => bus.fifo.extend(Frame::classic(id(0x07), &[8, 0, 0, 0])),
            200 => bus.fifo.extend([0x17, 0x14].map(|command| Frame::remote(id(command), 8).unwrap())),
            _ => {}
        }
        3
    });
    assert_eq!(drive.state(), State::Enabled);
    let answers: Vec<Id> = sent.iter().map(|frame| frame.id).filter(|it| [id(0x17), id(0x14)].contains(it)).collect();
    assert_eq!(answers, [id(0x17), id(0x14)]);
    assert!(sent.iter().filter(|frame| frame.id == id(0x01)).count() >= 2, "heartbeats");
}

/// Frames wait while the bus is busy, and those beyond the outbox are lost.
#[test]
fn frames_wait_for_a_busy_bus() {
    let (sent, _) = run::<Odrive3>(1000, |tick, bus| {
        if tick < 10 {
            bus.fifo.extend((0..5).filter_map(|_| Frame::remote(id(0x17), 8)));
        }
        usize::from(tick >= 500)
    });
    let answers = sent.iter().filter(|frame| frame.id == id(0x17)).count();
    assert!((30..=32).contains(&answers), "{answers}");
}

/// A full queue keeps the oldest frames, and frames that arrive in a period are left to the next one.
#[test]
fn frames_belong_to_the_period_before() {
    let frames = |numbers: std::ops::Range<u16>| numbers.filter_map(|it| Frame::classic(standard(it), &[]));
    let bus = Shared::default();
    bus.borrow_mut().fifo.extend(frames(0..FRAMES as u16 + 3));
    let mut received = Received::new();
    let (mut interrupt, mut inbox) = received.split(Half(Rc::clone(&bus)));
    (0..10).for_each(|_| interrupt.service());
    assert_eq!(inbox.count(), 0);
    interrupt.begin_period();
    assert!(inbox.begin_tick());
    assert_eq!(inbox.count(), FRAMES);
    let taken: Vec<u32> = (0..FRAMES).filter_map(|_| inbox.take()).map(|frame| frame.raw_id()).collect();
    assert_eq!(taken, (0..FRAMES as u32).collect::<Vec<_>>());
    bus.borrow_mut().fifo.extend(frames(100..102));
    interrupt.service();
    assert_eq!(inbox.count(), 0);
    interrupt.begin_period();
    assert!(inbox.begin_tick());
    assert_eq!((inbox.count(), inbox.take().map(|frame| frame.raw_id())), (2, Some(100)));
}

/// A tick that is late takes the frames of its own period; beyond four periods all but the last are lost.
#[test]
fn late_ticks_keep_their_frames() {
    let bus = Shared::default();
    let mut received = Received::new();
    let (mut interrupt, mut inbox) = received.split(Half(Rc::clone(&bus)));
    let mut begin = |frames: std::ops::Range<u16>| {
        bus.borrow_mut().fifo.extend(frames.filter_map(|it| Frame::classic(standard(it), &[])));
        interrupt.service();
        interrupt.begin_period();
    };
    begin(0..1);
    begin(1..3);
    let mut counts = Vec::new();
    while inbox.begin_tick() {
        counts.push((inbox.behind(), inbox.count()));
        while inbox.count() > 0 {
            assert!(inbox.take().is_some());
        }
    }
    assert_eq!(counts, [(1, 1), (0, 2)]);
    (0..PERIODS as u16 + 1).for_each(|period| begin(period..period + 1));
    assert!(inbox.begin_tick());
    assert_eq!((inbox.behind(), inbox.count()), (0, PERIODS + 1));
}

/// A drive on CANopen reports that its controller went off the bus.
#[test]
fn bus_off_reaches_the_server() {
    let (sent, _) = run::<Cia402>(1500, |tick, bus| {
        bus.is_off = (1000..1014).contains(&tick);
        3
    });
    let emergencies = sent.iter().filter(|frame| frame.id == standard(0x81));
    let codes: Vec<&[u8]> = emergencies.map(|frame| &frame.data()[..2]).collect();
    assert_eq!(codes, [[0x40, 0x81], [0, 0]]);
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
    // Some ticks after the last cyclic frames, so that all frames find room.
    const TICKS: usize = 2050;
    let (sent, _) = run::<Odrive3>(TICKS, |tick, bus| {
        bus.fifo.extend(due(tick));
        1
    });
    let mut expected = Vec::new();
    with_drive::<Odrive3, _>(|mut drive| {
        for tick in 0..TICKS {
            due(tick).for_each(|frame| drive.receive(&frame, &mut |answer| expected.push(answer)));
            drive.step(&mut |frame| expected.push(frame));
        }
    });
    assert!(sent.len() > 40);
    assert_eq!(sent, expected);
}
