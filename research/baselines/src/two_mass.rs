//! Gap model common in control: two masses, one gap, and either a spring-damper at its ends or an impact with restitution. It has no
//! planets, ripple or errors, so only output angle and force can be read from it.

use model_core::numbers::Real;

/// Contact at the ends of the gap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contact {
    /// Spring with a damper that only pushes; stepped by the classical Runge-Kutta method.
    SpringDamper,
    /// Impact; the masses then stick together until the torques separate them.
    Restitution,
}

/// Model delta'' = acceleration by torques - force, all lengths over b_c and times by omega_n.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoMass<T: Real> {
    /// Contact at the ends of the gap.
    pub contact: Contact,
    /// Step h omega_n.
    pub step: T,
    /// Half the gap.
    pub half_backlash: T,
    /// Relative deceleration per unit of overlap.
    pub stiffness: T,
    /// Relative deceleration per unit of the overlap's rate.
    pub damping: T,
    /// Speed after an impact over the speed before it.
    pub restitution: T,
    /// Relative acceleration per N m of drive and of load torque.
    pub gains: [T; 2],
    /// Link angle less the rigid carrier's angle [rad] per unit of relative displacement.
    pub link_offset: T,
    /// Force of a mesh [N] per unit of relative deceleration.
    pub force: T,
}

/// Model in motion.
#[derive(Debug, Clone)]
pub struct TwoMassPeer<'a, T: Real> {
    model: &'a TwoMass<T>,
    place: T,
    rate: T,
    push: T,
    force: T,
    engaged: bool,
}

impl<'a, T: Real> TwoMassPeer<'a, T> {
    /// Model at a displacement of motor against link (both along the output's line of action, over b_c) and its rate.
    pub fn new(model: &'a TwoMass<T>, place: T, rate: T) -> Self {
        Self { model, place, rate, push: T::ZERO, force: T::ZERO, engaged: false }
    }

    /// Sets the torques [N m].
    pub fn set_torques(&mut self, drive: T, load: T) {
        self.push = self.model.gains[0] * drive + self.model.gains[1] * load;
    }

    /// Advances by one step.
    pub fn step(&mut self) {
        match self.model.contact {
            Contact::SpringDamper => self.step_spring(),
            Contact::Restitution => self.step_impact(),
        }
    }

    /// Link angle less the rigid carrier's angle [rad].
    pub fn link_offset(&self) -> T {
        self.model.link_offset * self.place
    }

    /// Force of a mesh [N].
    pub fn mesh_force(&self) -> T {
        self.model.force * self.force
    }

    #[inline(always)]
    fn spring(&self, place: T, rate: T) -> T {
        let model = self.model;
        if place > model.half_backlash {
            let force = model.stiffness * (place - model.half_backlash) + model.damping * rate;
            if force > T::ZERO { force } else { T::ZERO }
        } else if place < -model.half_backlash {
            let force = model.stiffness * (place + model.half_backlash) + model.damping * rate;
            if force < T::ZERO { force } else { T::ZERO }
        } else {
            T::ZERO
        }
    }

    fn step_spring(&mut self) {
        let step = self.model.step;
        let half = step * T::HALF;
        let acceleration = |place: T, rate: T| self.push - self.spring(place, rate);
        let (place, rate) = (self.place, self.rate);
        let first = acceleration(place, rate);
        let second = acceleration(place + half * rate, rate + half * first);
        let third = acceleration(place + half * (rate + half * first), rate + half * second);
        let fourth = acceleration(place + step * (rate + half * second), rate + step * third);
        let sixth = step * T::SIXTH;
        self.place = place + step * (rate + sixth * (first + second + third));
        self.rate = rate + sixth * (first + T::TWO * (second + third) + fourth);
        self.force = self.spring(self.place, self.rate);
    }

    fn step_impact(&mut self) {
        let model = self.model;
        if self.engaged {
            let front = self.place > T::ZERO;
            if (self.push > T::ZERO) == front {
                self.force = self.push;
                return;
            }
            self.engaged = false;
        }
        self.force = T::ZERO;
        let coasting_rate = self.rate + model.step * self.push;
        self.place += model.step * T::HALF * (self.rate + coasting_rate);
        self.rate = coasting_rate;
        let front = self.place > T::ZERO;
        let end = if front { model.half_backlash } else { -model.half_backlash };
        let beyond = if front { self.place > end } else { self.place < end };
        if !beyond || (self.rate > T::ZERO) != front {
            return;
        }
        // Returns to the impact and leaves it with the rebound speed for the rest of the step. Rate and displacement have one sign here, so
        // the quotient is finite.
        let since = (self.place - end) / self.rate;
        let since = if since < model.step { since } else { model.step };
        let leaving = -(model.restitution * (self.rate - since * self.push));
        self.rate = leaving + since * self.push;
        self.place = end + since * T::HALF * (leaving + self.rate);
        // A rebound that the torques reverse within eight steps counts as sticking: it is too short to resolve.
        let (rebound, pressed) = if front { (-leaving, self.push) } else { (leaving, -self.push) };
        if rebound <= T::TWO * T::TWO * model.step * pressed {
            self.place = end;
            self.rate = T::ZERO;
            self.engaged = true;
            self.force = self.push;
        }
    }
}
