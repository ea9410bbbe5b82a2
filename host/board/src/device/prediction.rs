//! Predicts before a build whether the image of a role fits a board by size and by time, from sizes of images of joint
//! Q1 linked for the chip, instructions counted in the emulator, and cycles estimated for the chip.

use std::fmt;

use board_file::ImageSize;
use link::messages::Role;
use parameters::JointParameters;

use super::board::Board;
use super::tick_time::{Obstacle, RateCheck, TickTime};

/// Origin of every prediction, as printed.
pub const ORIGIN: &str = "images of Q1 linked before, instructions counted in the emulator, cycles estimated";

/// Predicted size and worst tick of a role at a rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Memory of the image; `None` if no such image was ever linked for the chip.
    size: Option<ImageSize>,
    /// Limits of the image in flash and of its statics in RAM [byte].
    limits: [u32; 2],
    /// Steps a second [Hz].
    rate: u32,
    /// Reason for which the rate is rejected.
    obstacle: Option<Obstacle>,
    /// Worst tick, if a step is stable at the rate.
    time: Option<TickTime>,
    /// Nearest rate that is accepted [Hz].
    nearest: Option<u32>,
}

impl Prediction {
    /// Predicts the image that `--role` calls `image` and whose tick is the tick of `role`.
    pub fn new(board: &Board, joint: &JointParameters, image: &str, role: Role, rate: u32) -> Self {
        let on_board = RateCheck::new(joint, board, role);
        let obstacle = on_board.obstacle(rate);
        Self {
            size: board.chip().image_size(image),
            limits: [board.description.image_bytes(), board.description.static_bytes()],
            rate,
            nearest: obstacle.as_ref().and_then(|_| on_board.nearest_accepted(rate)),
            obstacle,
            time: on_board.tick_time(rate),
        }
    }

    /// Returns whether flash and RAM suffice; true if the size is unknown.
    pub fn has_room(&self) -> bool {
        let [flash, ram] = self.limits;
        self.size.is_none_or(|size| size.flash <= flash && size.ram <= ram)
    }

    /// Returns whether the role fits by size and by time.
    pub fn fits(&self) -> bool {
        self.has_room() && self.obstacle.is_none()
    }

    fn room(&self) -> String {
        let [flash, ram] = self.limits;
        let Some(size) = self.size else { return "size not known for this chip".to_owned() };
        let part = |taken: u32, limit: u32| 100.0 * f64::from(taken) / f64::from(limit);
        match self.has_room() {
            true => format!("{:.0} % of flash, {:.0} % of RAM", part(size.flash, flash), part(size.ram, ram)),
            false => format!("{} of {flash} B of flash, {} of {ram} B of RAM beside the stack", size.flash, size.ram),
        }
    }

    fn time(&self) -> String {
        let rate = self.rate;
        let taken = self.time.map_or_else(String::new, |TickTime { part, share, .. }| {
            format!("{:.0} % of the period at {rate} Hz (limit {:.0} %)", 100.0 * part, 100.0 * share)
        });
        let nearest = || match self.nearest {
            Some(nearest) => format!("; {nearest} Hz fits"),
            None => "; no rate fits".to_owned(),
        };
        match &self.obstacle {
            None => taken,
            Some(Obstacle::NoTime(_)) => taken + &nearest(),
            Some(Obstacle::Unstable(lowest)) => format!("not stable at {rate} Hz, below {lowest} Hz") + &nearest(),
            Some(Obstacle::NoMultiple(clock)) => format!("{rate} Hz does not divide {clock} Hz") + &nearest(),
        }
    }
}

impl fmt::Display for Prediction {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = match (self.has_room(), self.obstacle.is_none()) {
            (true, true) => "fits",
            (false, true) => "no room",
            (true, false) => "no time",
            (false, false) => "no room, no time",
        };
        write!(formatter, "{verdict}: {}; {}", self.room(), self.time())
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn predicted(board: &str, image: &str, role: Role, rate: u32) -> Prediction {
        let joint = joint_file::named::load(Path::new("q1")).unwrap().file.parameters;
        Prediction::new(&Board::load(board).unwrap(), &joint, image, role, rate)
    }

    /// A chip with 1 MiB of flash has room and time for plant and observer.
    #[test]
    fn large_chip_fits_every_role() {
        for (image, role, rate) in [("plant", Role::Plant, 20_000), ("observer", Role::Observer, 10_000)] {
            assert!(predicted("olimex-h405", image, role, rate).fits(), "{image}");
        }
    }

    /// A chip with 128 KiB of flash has room for plant, SPI slave and drive only.
    #[test]
    fn small_chip_fits_small_roles() {
        let on = |image: &str, role: Role, rate: u32| predicted("b-g431b-esc1", image, role, rate);
        assert!(on("plant", Role::Plant, 20_000).has_room());
        assert!(on("spi-observer", Role::Observer, 5000).has_room());
        assert!(on("drive", Role::Loop, 5000).has_room());
        let observer = on("observer", Role::Observer, 10_000);
        assert!(!observer.fits());
        let said = observer.to_string();
        assert!(said.starts_with("no room: 173192 of 126976 B of flash, 26164 of 14336 B of RAM"), "{said}");
    }

    /// A rate that is too high is reported with the nearest accepted rate.
    #[test]
    fn slow_rate_prediction_names_nearest() {
        let said = predicted("nucleo-g474re", "loop", Role::Loop, 10_000).to_string();
        assert!(said.starts_with("no time:") && said.contains("at 10000 Hz") && said.contains("Hz fits"), "{said}");
    }
}
