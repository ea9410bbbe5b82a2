//! Reads `[mesh]` with `[mesh.sun_planet]` and `[mesh.ring_planet]`: common values stand in `[mesh]`, differing values
//! in the family's section.

use model_core::gears::StiffnessSeries;
use parameters::{Geometry, Mesh, MeshPhases, PerPlanet, StiffnessWave};

use crate::section::{PerPlanetValue, Section};
use crate::sheet;

/// Section of one mesh family, with the common section as fallback.
struct Layers<'s, 'a> {
    own: Option<&'s Section<'a>>,
    shared: &'s Section<'a>,
    planets: Option<usize>,
    geometry: Option<&'s Geometry>,
}

/// Reads sun-planet and ring-planet meshes; `None` after a noted problem.
pub(crate) fn read(shared: &Section<'_>, planets: Option<usize>, geometry: Option<&Geometry>) -> Option<[Mesh; 2]> {
    let own = ["sun_planet", "ring_planet"].map(|name| shared.section(name, "mesh"));
    let [sun_planet, ring_planet] = own.map(|own| Layers { own: own.as_ref(), shared, planets, geometry }.read());
    Some([sun_planet?, ring_planet?])
}

impl Layers<'_, '_> {
    fn read(&self) -> Option<Mesh> {
        let mean_stiffness = self.required("mean_stiffness_N_per_m");
        let stiffness_wave = self.stiffness_wave();
        let damping_ratio = self.required("damping_ratio");
        let half_backlash = self.half_backlash();
        let transmission_error = self.list("transmission_error_um", 1.0);
        let phases = self.phases();
        Some(Mesh {
            mean_stiffness: mean_stiffness?,
            stiffness_wave: stiffness_wave?,
            damping_ratio: damping_ratio?,
            half_backlash: half_backlash?,
            transmission_error: transmission_error?,
            phases: phases?,
        })
    }

    /// Section that holds any of the keys, the family's own first.
    fn holder(&self, keys: &[&str]) -> &Section<'_> {
        self.own.filter(|own| keys.iter().any(|key| own.has(key))).unwrap_or(self.shared)
    }

    fn required(&self, key: &str) -> Option<f64> {
        self.holder(&[key]).required_number(key)
    }

    /// Values for every planet, times `factor`.
    fn list(&self, key: &'static str, factor: f64) -> Option<PerPlanet> {
        let section = self.holder(&[key]);
        if !section.has(key) {
            section.missing(key);
        }
        let value = section.per_planet(key, self.planets)?;
        let planets = self.planets?;
        match value {
            PerPlanetValue::One(value) => Some((0..planets).map(|_| value * factor).collect()),
            PerPlanetValue::List(values) if values.len() == planets => {
                Some(values.iter().map(|value| value * factor).collect())
            }
            PerPlanetValue::List(_) => None,
        }
    }

    /// Half-backlash b, stated, from the backlash 2b, or from the lost motion of all meshes together.
    fn half_backlash(&self) -> Option<PerPlanet> {
        const LOST_MOTION: &str = "lost_motion_arcmin";
        let keys = ["half_backlash_um", "backlash_um"];
        if let Some(own) = self.own.filter(|own| own.has(LOST_MOTION)) {
            let message = format!("`{LOST_MOTION}` is for all meshes together, not for {}", own.called());
            own.notes.error(own.place(LOST_MOTION), message, "write it in [mesh], or give the backlash of this family");
            return None;
        }
        if self.shared.has(LOST_MOTION) {
            self.shared.one_of(&[LOST_MOTION, keys[0], keys[1]], true)?;
            if let Some((own, key)) = self.own.and_then(|own| Some((own, keys.iter().find(|key| own.has(key))?))) {
                let message =
                    format!("`{key}` of {} and `{LOST_MOTION}` of [mesh] both state the backlash", own.called());
                own.notes.error(own.place(key), message, "keep one of them");
                return None;
            }
            let lost_motion = self.shared.number(LOST_MOTION)?;
            let half_backlash = sheet::half_backlash(lost_motion, self.geometry?);
            return Some((0..self.planets?).map(|_| half_backlash).collect());
        }
        match self.holder(&keys).one_of(&keys, true)? {
            "backlash_um" => self.list("backlash_um", 0.5),
            key => self.list(key, 1.0),
        }
    }

    fn stiffness_wave(&self) -> Option<StiffnessWave> {
        let holder = self.holder(&["stiffness_wave"]);
        let wave = if holder.has("stiffness_wave") { holder.choice("stiffness_wave")? } else { "harmonic" };
        let ratio_key = "stiffness_ratio";
        let stiffness_ratio = self.required(ratio_key);
        if wave != "rectangular" {
            for key in ["contact_ratio", "order"] {
                let section = self.holder(&[key]);
                if section.has(key) {
                    let message = format!("`{key}` belongs to the rectangular wave, and this one is harmonic");
                    section.notes.error(section.place(key), message, "write stiffness_wave = \"rectangular\"");
                }
            }
            return stiffness_ratio.map(|stiffness_ratio| StiffnessWave::Harmonic { stiffness_ratio });
        }
        let contact_ratio = self.required("contact_ratio");
        let order = self.holder(&["order"]).required_whole("order");
        let wave = StiffnessWave::Rectangular {
            stiffness_ratio: stiffness_ratio?,
            contact_ratio: contact_ratio?,
            order: order? as usize,
        };
        let swing = largest_swing(&wave);
        if swing >= 1.0 {
            let section = self.holder(&[ratio_key]);
            let message = format!("the harmonics of this wave sum to {swing:.3} of the mean: the stiffness may vanish");
            let largest = 0.999 * stiffness_ratio? / swing;
            let help = format!("at this contact ratio and order, `{ratio_key}` must stay below {largest:.3}");
            section.notes.error(section.place(ratio_key), message, help);
            return None;
        }
        Some(wave)
    }

    /// Lists state every planet's phase, single numbers the phase of planet 0. Stiffness and error phase must have the
    /// same form.
    fn phases(&self) -> Option<MeshPhases> {
        let keys = ["stiffness_phase_rad", "error_phase_rad"];
        let [stiffness, error] = keys.map(|key| {
            let section = self.holder(&[key]);
            if section.has(key) { section.per_planet(key, self.planets) } else { Some(PerPlanetValue::One(0.0)) }
        });
        match (stiffness?, error?) {
            (PerPlanetValue::One(stiffness), PerPlanetValue::One(error)) => {
                Some(MeshPhases::FromTeeth { stiffness, error })
            }
            (PerPlanetValue::List(stiffness), PerPlanetValue::List(error)) => {
                let fits = |list: &[f64]| self.planets == Some(list.len());
                (fits(&stiffness) && fits(&error)).then(|| MeshPhases::Given {
                    stiffness: stiffness.into_iter().collect(),
                    error: error.into_iter().collect(),
                })
            }
            (stiffness, _) => {
                let (list, other) = if matches!(stiffness, PerPlanetValue::List(_)) { (0, 1) } else { (1, 0) };
                let section = self.holder(&[keys[list]]);
                let message = format!("`{}` is a list and `{}` is not", keys[list], keys[other]);
                let help = "state every planet's phase for both, or let both follow from the teeth";
                section.notes.error(section.place(keys[list]), message, help);
                None
            }
        }
    }
}

/// Sum of the harmonics' amplitudes, the largest deviation of K / K_m from 1. The fixed step has the same requirement.
fn largest_swing(wave: &StiffnessWave) -> f64 {
    (1..=wave.order()).map(|harmonic| wave.coefficients(harmonic)).map(|(sine, cosine)| sine.hypot(cosine)).sum()
}
