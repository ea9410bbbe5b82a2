//! The observer's own counts and steady-state filters, by its own tables, in f64 and without what late readings need.

use std::f64::consts::TAU;

use model_core::observer::tables::{EncoderTable, MOST_DELAY};
use model_core::observer::{ObserverTables, Samples};

/// What one period comes to.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sensed {
    /// Motor less ratio times link along the line of action [m].
    pub deflection: f64,
    /// The same by the counts alone, without what the link's filter makes of them [m].
    pub counted: f64,
    /// Its rate [m/s].
    pub rate: f64,
    /// What the motor side loses [N].
    pub lost: f64,
    /// Direction of the motor, -1 to 1.
    pub direction: f64,
    /// [rad/s].
    pub link_speed: f64,
    /// Places of motor, output and mesh [rad].
    pub phases: [f64; 3],
    /// Innovations of motor and output [rad]; `None` without a fresh reading.
    pub innovations: [Option<f64>; 2],
    /// By how many counts motor and output went on.
    pub went: [i64; 2],
    /// Torque in the air gap [N m].
    pub air_gap: f64,
}

#[derive(Debug, Clone, Copy, Default)]
struct Counter {
    raw: u32,
    began: bool,
    place: i64,
}

impl Counter {
    fn take(&mut self, table: &EncoderTable<f64>, raw: u32) -> i64 {
        let range = i64::from(table.last) + 1;
        if !self.began {
            *self = Self { raw, began: true, place: i64::from(raw) };
            return 0;
        }
        let up = (i64::from(raw) - i64::from(self.raw)).rem_euclid(range);
        let by = if up > range / 2 { up - range } else { up };
        self.raw = raw;
        self.place += by;
        by
    }

    fn phase(&self, table: &EncoderTable<f64>) -> f64 {
        self.place.rem_euclid(i64::from(table.turn)) as f64 * TAU / f64::from(table.turn)
    }
}

/// Both sides.
#[derive(Debug, Clone, Copy)]
pub struct Filters {
    motor: Counter,
    output: Counter,
    difference: i64,
    fresh_time: u32,
    motor_time: u32,
    commands: [f64; MOST_DELAY],
    air_gap: f64,
    /// Angle beyond the counts, speed, torque: motor, then link.
    pub drive: [f64; 3],
    /// See above.
    pub load: [f64; 3],
    mesh_torque: f64,
    /// What corrects: motor, output.
    used: [bool; 2],
    /// Place of the output, as the motor implies it while its encoder is not used [rad].
    place: f64,
}

impl Default for Filters {
    fn default() -> Self {
        Self {
            motor: Counter::default(),
            output: Counter::default(),
            difference: 0,
            fresh_time: 0,
            motor_time: 0,
            commands: [0.0; MOST_DELAY],
            air_gap: 0.0,
            drive: [0.0; 3],
            load: [0.0; 3],
            mesh_torque: 0.0,
            used: [true; 2],
            place: 0.0,
        }
    }
}

impl Filters {
    /// Which encoders correct from now on.
    pub fn rely(&mut self, used: [bool; 2]) {
        self.used = used;
    }

    /// The motor's encoder is used again: the motor turns as the link does.
    pub fn restart(&mut self, tables: &ObserverTables<f64>) {
        self.drive = [0.0, self.load[1] * tables.levers.ratio, 0.0];
    }

    /// The motor is taken to stand where its counts are.
    pub fn hold(&mut self) {
        self.drive = [0.0; 3];
        self.mesh_torque = 0.0;
    }

    /// The link turns as the motor does.
    pub fn follow(&mut self, tables: &ObserverTables<f64>) {
        self.load = [0.0, self.drive[1] * tables.levers.per_ratio, self.load[2]];
    }

    /// Torque that the link feels in the next period [N m].
    pub fn pass(&mut self, mesh_torque: f64) {
        self.mesh_torque = mesh_torque;
    }

    /// One period.
    pub fn step(&mut self, tables: &ObserverTables<f64>, samples: &Samples<f32>) -> Sensed {
        let counts = &tables.counts;
        let age = |time: u32| f64::from(samples.time.wrapping_sub(time) as i32) * tables.clock.tick;
        let motor_fresh = samples.motor.time != self.motor_time || !self.motor.began;
        self.motor_time = samples.motor.time;
        let motor_by = self.motor.take(&counts.motor, samples.motor.counts);
        let fresh = samples.output.filter(|reading| !self.output.began || reading.time != self.fresh_time);
        let output_by = fresh.map_or(0, |reading| {
            self.fresh_time = reading.time;
            self.output.take(&counts.output, reading.counts)
        });
        self.difference += motor_by * counts.motor_weight - output_by * counts.output_weight;

        let command = f64::from(samples.torque);
        self.commands.rotate_right(1);
        self.commands[0] = command;
        let at = |ago: u32| self.commands.get(ago as usize).copied().unwrap_or(command);
        let current = &tables.current;
        let newer = at(current.whole_delay);
        let wanted = newer + current.part_delay * (at(current.whole_delay + 1) - newer);
        let [ahead, speed, taken] = &mut self.drive;
        let [from_speed, from_taken, from_air_gap, from_wanted] = tables.drive.angle;
        *ahead += from_speed * *speed + from_taken * *taken + from_air_gap * self.air_gap + from_wanted * wanted
            - motor_by as f64 * counts.motor.angle;
        let [from_taken, from_air_gap, from_wanted] = tables.drive.speed;
        *speed += from_taken * *taken + from_air_gap * self.air_gap + from_wanted * wanted;
        self.air_gap += current.rise * (wanted - self.air_gap);
        let motor_innovation =
            (motor_fresh && age(samples.motor.time) < tables.period).then_some(*speed * age(samples.motor.time) - *ahead);
        if self.used[0] {
            correct(&mut self.drive, &tables.drive.gain, motor_innovation);
        }

        let [ahead, speed, torque] = &mut self.load;
        let net = self.mesh_torque - *torque;
        let [from_speed, from_net] = tables.load.angle;
        *ahead += from_speed * *speed + from_net * net - output_by as f64 * counts.output.angle;
        *speed += tables.load.speed * net;
        let output_innovation = fresh.map(|reading| *speed * age(reading.time) - *ahead);
        if self.used[1] {
            correct(&mut self.load, &tables.load.gain, output_innovation);
        }

        let levers = &tables.levers;
        if self.used[1] {
            self.place = self.output.phase(&counts.output);
        } else {
            self.place += motor_by as f64 * counts.motor.angle * levers.per_ratio;
        }
        let place = self.place;
        Sensed {
            deflection: counts.length * self.difference as f64 + levers.sun * self.drive[0]
                - levers.output * self.load[0],
            counted: counts.length * self.difference as f64 + levers.sun * self.drive[0],
            rate: levers.sun * self.drive[1] - levers.output * self.load[1],
            lost: self.drive[2] * levers.per_sun,
            direction: (self.drive[1] * tables.contact.per_turning).clamp(-1.0, 1.0),
            link_speed: self.load[1],
            phases: [self.motor.phase(&counts.motor), place, place * counts.mesh_periods],
            innovations: [motor_innovation, output_innovation],
            went: [motor_by, output_by],
            air_gap: self.air_gap,
        }
    }
}

fn correct(state: &mut [f64; 3], gain: &[f64; 3], innovation: Option<f64>) {
    if let Some(innovation) = innovation {
        state.iter_mut().zip(gain).for_each(|(value, gain)| *value += gain * innovation);
    }
}
