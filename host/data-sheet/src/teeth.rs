//! Tooth numbers for a ratio: coaxial (ring = sun + 2 planet), assembling with equal spacing ((sun + ring) / planets is
//! whole), with clearance between neighbours, and without undercut if possible.

use std::f64::consts::PI;

use report::failure::{Failure, Outcome};

/// Least teeth without undercut by a rack of 20 degrees: 2 / sin^2(20 deg) = 17.1, in practice 17.
pub const UNDERCUT_TEETH: u32 = 17;
/// Least teeth of a gear, and largest numbers of the sun's and of the ring's teeth.
const TEETH_MIN: u32 = 9;
const SUN_TEETH_MAX: u32 = 80;
const RING_TEETH_MAX: u32 = 400;
/// Clearance between neighbouring tips [modules].
const TIP_CLEARANCE: f64 = 0.2;

/// Tooth numbers of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "numbers of teeth")]
pub struct Teeth {
    pub planets: u32,
    pub sun: u32,
    pub planet: u32,
    pub ring: u32,
}

impl Teeth {
    /// Ratio 1 + ring / sun.
    pub fn ratio(&self) -> f64 {
        1.0 + f64::from(self.ring) / f64::from(self.sun)
    }

    /// Warning for undercut teeth.
    pub fn undercut(&self) -> Option<String> {
        let (name, teeth) = if self.sun <= self.planet { ("sun", self.sun) } else { ("planets", self.planet) };
        (teeth < UNDERCUT_TEETH).then(|| {
            format!(
                "{teeth} teeth of the {name} are fewer than {UNDERCUT_TEETH}: at 20 deg they are undercut, unless their profile is shifted"
            )
        })
    }

    /// Returns true if the tips of neighbouring planets are clear of each other.
    fn neighbours_are_clear(&self) -> bool {
        let spacing = f64::from(self.sun + self.planet) * (PI / f64::from(self.planets)).sin();
        spacing > f64::from(self.planet) + 2.0 + TIP_CLEARANCE
    }

    /// Cost: undercut first, then the size of the ring, in which a ratio off by 2 % counts as much as doubling the
    /// ring.
    fn cost(&self, ratio: f64) -> (u32, f64) {
        let smallest = self.sun.min(self.planet);
        let off = (self.ratio() / ratio - 1.0).abs();
        (UNDERCUT_TEETH.saturating_sub(smallest), f64::from(self.ring) * (1.0 + 50.0 * off))
    }
}

/// All tooth numbers that assemble with `planets` planets.
fn all_assembling(planets: u32) -> impl Iterator<Item = Teeth> {
    let suns = TEETH_MIN..=SUN_TEETH_MAX;
    let all = suns.flat_map(move |sun| {
        (TEETH_MIN..=(RING_TEETH_MAX - sun) / 2).map(move |planet| Teeth {
            planets,
            sun,
            planet,
            ring: sun + 2 * planet,
        })
    });
    all.filter(|teeth| (teeth.sun + teeth.ring).is_multiple_of(teeth.planets) && teeth.neighbours_are_clear())
}

/// Best tooth numbers within a tolerance [percent] of a ratio.
pub fn find(ratio: f64, tolerance: f64, planets: u32) -> Outcome<Teeth> {
    let off = |teeth: &Teeth| 100.0 * (teeth.ratio() / ratio - 1.0).abs();
    let by_cost = |one: &Teeth, other: &Teeth| {
        one.cost(ratio).partial_cmp(&other.cost(ratio)).unwrap_or(std::cmp::Ordering::Equal)
    };
    if let Some(teeth) = all_assembling(planets).filter(|teeth| off(teeth) <= tolerance + 1e-9).min_by(by_cost) {
        return Ok(teeth);
    }
    let message = format!("no teeth of ratio {ratio} within {tolerance} % assemble with {planets} planets");
    let nearest = all_assembling(planets).min_by(|one, other| off(one).total_cmp(&off(other)));
    let near = nearest.map_or(String::new(), |teeth| {
        format!("the nearest ratio is {:.4} ({}, {}, {} teeth): ", teeth.ratio(), teeth.sun, teeth.planet, teeth.ring)
    });
    let fewer = if planets > 3 { ", fewer planets" } else { "" };
    Err(Failure::new(message).with_help(format!("{near}give another --ratio, a larger --ratio-tolerance{fewer}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every ratio from 3 to 12 has teeth that assemble, unless the planets leave no room.
    #[test]
    fn teeth_assemble_for_ratios_3_to_12() {
        for hundredth in 300..=1200 {
            let ratio = f64::from(hundredth) / 100.0;
            for planets in 3..=5 {
                let found = find(ratio, 1.0, planets);
                let Ok(teeth) = found else {
                    // Four planets leave room up to a ratio of 6.8, five up to 4.85.
                    let room = 2.0 / (1.0 - (PI / f64::from(planets)).sin());
                    assert!(ratio > 0.92 * room, "{ratio}, {planets}: room up to {room}");
                    continue;
                };
                assert_eq!(teeth.ring, teeth.sun + 2 * teeth.planet, "{teeth:?}");
                assert_eq!((teeth.sun + teeth.ring) % planets, 0, "{teeth:?}");
                assert!((teeth.ratio() / ratio - 1.0).abs() <= 0.01 + 1e-9, "{ratio}: {teeth:?}");
                let apart = f64::from(teeth.sun + teeth.planet) * (PI / f64::from(planets)).sin();
                assert!(apart > f64::from(teeth.planet + 2), "{teeth:?}");
                assert_eq!(teeth.undercut().is_some(), teeth.sun.min(teeth.planet) < 17, "{teeth:?}");
                assert!(planets > 3 || teeth.undercut().is_none(), "{ratio}: {teeth:?}");
            }
        }
    }

    /// A ratio without room for the planets is rejected with the nearest possible ratio.
    #[test]
    fn impossible_ratio_names_the_nearest() {
        let failure = find(9.0, 1.0, 5).expect_err("no room");
        assert!(failure.message().contains("5 planets"), "{failure}");
        assert!(
            failure.help().is_some_and(|help| help.contains("nearest ratio is 4.") && help.contains("fewer planets"))
        );
    }

    /// Common ratios are met exactly, and undercut teeth give a warning.
    #[test]
    fn common_ratios_are_met_exactly() {
        for ratio in [4.5, 6.0, 6.25, 9.0] {
            assert_eq!(find(ratio, 1.0, 3).expect("teeth").ratio(), ratio);
        }
        let few = Teeth { planets: 3, sun: 12, planet: 42, ring: 96 };
        assert!(few.undercut().is_some_and(|said| said.contains("12 teeth of the sun") && said.contains("17")));
    }
}
