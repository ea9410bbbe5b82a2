//! The firmware of role observer in a thread, on any byte stream, with a page of flash that takes what is written or does
//! not. Its clock is the thread's own; interrupts are calls in turn.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::io::{ErrorKind, Read, Write};
use std::sync::{Arc, Mutex};

use embedded_hal::digital::{ErrorType, OutputPin};
use firmware::budget::TickTimer;
use firmware::control::Control;
use firmware::conversation::{Conversation, LogEnd};
use firmware::identity::{StartUp, hello};
use firmware::observer::{ObserverWords, Observing};
use firmware::page::{Page, judgement, recall};
use firmware::port::Direct;
use firmware::queues::Queues;
use firmware::serial::{Line, Serial, Uart};
use firmware::timing_report::Resources;
use firmware::work::Work;
use heapless::spsc::Queue;
use joint_file::JointFile;
use link::messages::Clock;
use model_core::compensation::design::{compensation_settings, design_compensation};
use model_core::compensation::{Command, CompensationTables, Motion, Position};
use model_core::controller::Controller;
use model_core::gears::design::{Effort, Processor, design_scheme};
use model_core::gears::{Scheme, Tables};
use model_core::observer::design::{design_observer, observer_settings};
use model_core::observer::{Estimates, Memory, ObserverTables};
use model_core::virtual_joint::design::design_surroundings;
use model_core::virtual_joint::{SurroundingsTable, VirtualJoint};

/// Timer counts between two ticks.
const PERIOD: u32 = 16_800;
/// Bandwidth of the loop [rad/s].
const BANDWIDTH: f64 = 60.0;

/// A preset, with values changed.
pub fn joint(changes: &[(&str, &str)]) -> JointFile {
    let mut text = joint_file::preset("q1").expect("the default preset").to_owned();
    for (key, value) in changes {
        text = joint_file::change(&text, key, value).expect("a key of joint files");
    }
    joint_file::read(&text).expect("a good joint")
}

/// A controller of a joint.
pub fn controller(joint: &JointFile) -> Controller<'static, f32> {
    let around = joint.surroundings;
    let observer: ObserverTables<f32> =
        design_observer(&joint.parameters, &observer_settings(&around)).expect("an observer");
    let compensation: CompensationTables<f32> =
        design_compensation(&joint.parameters, &compensation_settings(&around, BANDWIDTH)).expect("a compensation");
    Controller::new(Box::leak(Box::new(observer)), Box::leak(Box::new(compensation)))
}

/// What a controller that is told one joint learns of another in so many control periods, to and fro through the gap.
pub fn learnt(told: &JointFile, truth: &JointFile, periods: u32) -> (Memory, Estimates<f32>) {
    let around = truth.surroundings;
    let effort = Effort::Within(Processor::STM32F405);
    let tables: Tables<f32, 3> =
        design_scheme(&truth.parameters, around.control_rate, Scheme::Realtime, effort).expect("tables");
    let table: SurroundingsTable<f32> = design_surroundings(&truth.parameters, &around, &tables).expect("surroundings");
    let mut virtual_joint = VirtualJoint::<f32, 3>::new(&tables, &table);
    let mut controller = controller(told);
    let mut estimates = Estimates::default();
    for period in 0..periods {
        let (sine, cosine) = (core::f32::consts::TAU * 2.0 / around.control_rate as f32 * period as f32).sin_cos();
        let position = Position { turns: virtual_joint.output_turn(), fraction: 0.02 * sine };
        let now = Motion { position, speed: 1.6 * cosine, acceleration: -20.0 * sine };
        let answer = controller.step(&virtual_joint.samples(), &Command::Position { now, ahead: None });
        virtual_joint.advance(answer.shaped.torque, 0.0);
        estimates = answer.estimates;
    }
    (controller.save(), estimates)
}

/// A page of flash that a test can look at.
#[derive(Clone)]
pub struct Flash {
    pub memory: Arc<Mutex<Memory>>,
    works: bool,
}

impl Flash {
    pub fn new(memory: Memory, works: bool) -> Self {
        Self { memory: Arc::new(Mutex::new(memory)), works }
    }
}

impl Page for Flash {
    fn read(&self) -> Memory {
        *self.memory.lock().expect("no test panics in between")
    }

    fn write(&mut self, memory: &Memory) {
        if self.works {
            *self.memory.lock().expect("no test panics in between") = *memory;
        }
    }
}

/// The line's end in the chip.
#[derive(Default)]
struct Wire {
    to_board: VecDeque<u8>,
    from_board: Vec<u8>,
}

struct WireEnd(Arc<Mutex<Wire>>);

impl Uart for WireEnd {
    fn read(&mut self) -> Option<u8> {
        self.0.lock().expect("one thread").to_board.pop_front()
    }
    fn overran(&mut self) -> bool {
        false
    }
    fn can_write(&self) -> bool {
        true
    }
    fn write(&mut self, byte: u8) {
        self.0.lock().expect("one thread").from_board.push(byte);
    }
    fn interrupt_on_read(&mut self, _: bool) {}
    fn interrupt_on_write(&mut self, _: bool) {}
    fn interrupt_again(&mut self) {}
}

struct Enable;

impl ErrorType for Enable {
    type Error = Infallible;
}

impl OutputPin for Enable {
    fn set_low(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// Every tick takes no time.
struct Timer;

impl TickTimer for Timer {
    fn since_expiry(&self) -> u32 {
        0
    }
}

/// Starts a board for a joint on a stream with a short read timeout; it ends when the stream does.
pub fn start<S: Read + Write + Send + 'static>(mut stream: S, joint: JointFile, mut flash: Flash) {
    std::thread::spawn(move || {
        let mut work = Observing::new(Direct(controller(&joint)), true);
        let judged = recall(&flash).map(|memory| work.remember(&memory));
        let start_up = StartUp {
            board: "thread",
            timer_rate: 168_000_000,
            clock: Clock::NotModelled,
            last_panic: None,
            watchdog_reset: false,
            remembered: judgement(judged),
        };
        let wire = Arc::new(Mutex::new(Wire::default()));
        let (tick_end, idle_end) = Box::leak(Box::new(Queues::<ObserverWords>::new())).split();
        let line = Box::leak(Box::new(Line::new()));
        let (mut serial, line): (Serial<'_, WireEnd>, _) = line.split(WireEnd(wire.clone()), || {});
        let (_, bytes) = Box::leak(Box::new(Queue::<u8, 16>::new())).split();
        let mut control = Control::new(work, Enable, PERIOD, tick_end);
        let log = LogEnd { bytes, lost: || 0 };
        let hello = hello::<ObserverWords>(start_up, None);
        let mut conversation = Conversation::new(hello, PERIOD, idle_end, line, log);
        let mut buffer = [0; 512];
        loop {
            match stream.read(&mut buffer) {
                Ok(0) => return,
                Ok(count) => wire.lock().expect("one thread").to_board.extend(&buffer[..count]),
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                Err(_) => return,
            }
            for _ in 0..200 {
                serial.service();
                conversation.attend(&mut |_| Resources::default());
                conversation.serve_page(&mut flash, |write| write());
                control.tick(&Timer);
            }
            let said = std::mem::take(&mut wire.lock().expect("one thread").from_board);
            if stream.write_all(&said).is_err() {
                return;
            }
        }
    });
}
