//! The compensation: from the observer's estimates and a set-point to a motor torque.

use model_core::compensation::{Command, Compensation, ImpedancePoint, Motion, Position, Shaped, Stage};

use crate::estimates::JointContact;
use crate::fp_mode;
use crate::object::{Kind, look, open, read, start, usable};
use crate::observer::{AnyObserver, JointObserver};
use crate::status::JointStatus;

/// 64-bit words of a compensation.
pub const JOINT_COMPENSATION_WORDS: usize = 36;

/// Storage of a compensation. Its content is the library's own.
#[repr(C)]
pub struct JointCompensation {
    storage: [u64; JOINT_COMPENSATION_WORDS],
}

impl Kind for Compensation<'static, f32> {
    type Storage = JointCompensation;
    const MARK: u32 = 0xc0e4_1a70;
}

/// Where the link shall be at one moment, on the scale of the observer's link shaft.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointMotion {
    /// Whole turns.
    pub turns: i32,
    /// What is left.
    pub fraction_turns: f32,
    /// Speed.
    pub speed_rad_per_s: f32,
    /// Acceleration.
    pub acceleration_rad_per_s2: f32,
}

impl JointMotion {
    #[inline(always)]
    pub(crate) fn motion(&self) -> Result<Motion<f32>, JointStatus> {
        finite([self.fraction_turns, self.speed_rad_per_s, self.acceleration_rad_per_s2])?;
        Ok(Motion {
            position: Position { turns: self.turns, fraction: self.fraction_turns },
            speed: self.speed_rad_per_s,
            acceleration: self.acceleration_rad_per_s2,
        })
    }
}

/// A spring and damper about a moving point, on the scale of the observer's link shaft.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointImpedance {
    /// Whole turns of the point.
    pub turns: i32,
    /// What is left.
    pub fraction_turns: f32,
    /// Its speed.
    pub speed_rad_per_s: f32,
    /// Torque at the link, on top of spring and damper.
    pub torque_Nm: f32,
    /// Stiffness at the link.
    pub stiffness_Nm_per_rad: f32,
    /// Damping at the link.
    pub damping_Nm_s_per_rad: f32,
}

impl JointImpedance {
    #[inline(always)]
    fn point(&self) -> Result<ImpedancePoint<f32>, JointStatus> {
        finite([self.fraction_turns, self.speed_rad_per_s, self.torque_Nm])?;
        finite([self.stiffness_Nm_per_rad, self.damping_Nm_s_per_rad, 0.0])?;
        Ok(ImpedancePoint {
            position: Position { turns: self.turns, fraction: self.fraction_turns },
            speed: self.speed_rad_per_s,
            torque: self.torque_Nm,
            stiffness: self.stiffness_Nm_per_rad,
            damping: self.damping_Nm_s_per_rad,
        })
    }
}

/// Fails if one of three is not finite.
#[inline(always)]
pub(crate) fn finite([one, two, three]: [f32; 3]) -> Result<(), JointStatus> {
    // Nothing times what is infinite or not a number is not a number, and nor is what it is added to.
    if 0.0 * one + 0.0 * two + 0.0 * three == 0.0 { Ok(()) } else { Err(JointStatus::NotFinite) }
}

/// What the compensation is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum JointStage {
    /// A flank carries.
    Touching = 0,
    /// On the way through the gap.
    Crossing = 1,
    /// Closing on a flank at a small speed.
    Landing = 2,
    /// Control without compensation: the gap cannot be seen.
    Plain = 3,
    /// No torque: it is not known where the motor is.
    Off = 4,
}

/// What the compensation answers.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointTorque {
    /// Torque for the motor's shaft: over the torque constant, the current to ask for. Finite and within the limit.
    pub motor_torque_Nm: f32,
    /// What it is about.
    pub stage: JointStage,
    /// The flank that carries or is being gone to.
    pub flank: JointContact,
    /// Torque that the teeth will have to pass on after a crossing that began now.
    pub demand_Nm: f32,
    /// What brakes the link besides dry friction, as learnt.
    pub load_Nm: f32,
    /// Dry friction of the link, as learnt.
    pub friction_Nm: f32,
    /// Share of the compensation in the torque, the rest being control without: 0 to 1.
    pub trust: f32,
    /// 1 if the law asks for more torque than the motor has, or brakes early because of that; else 0.
    pub short_of_torque: u32,
}

impl JointTorque {
    #[inline(always)]
    fn new(of: &Shaped<f32>) -> Self {
        let [load_Nm, friction_Nm] = of.load;
        Self {
            motor_torque_Nm: of.torque,
            stage: match of.stage {
                Stage::Touching => JointStage::Touching,
                Stage::Crossing => JointStage::Crossing,
                Stage::Landing => JointStage::Landing,
                Stage::Plain => JointStage::Plain,
                Stage::Off => JointStage::Off,
            },
            flank: match of.flank {
                Some(model_core::gears::Flank::Drive) => JointContact::DriveSide,
                Some(model_core::gears::Flank::Back) => JointContact::BackSide,
                None => JointContact::Separated,
            },
            demand_Nm: of.demand,
            load_Nm,
            friction_Nm,
            trust: of.trust,
            short_of_torque: of.short_of_torque.into(),
        }
    }
}

/// Starts a compensation. `bytes` is sizeof(JointCompensation). The tables must stay as they are for as long as it is used.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_compensation_start(
    compensation: *mut JointCompensation,
    bytes: usize,
    tables: *const u64,
    tables_bytes: usize,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's word, as the header asks for it.
        unsafe { start(compensation, bytes, tables, tables_bytes, |blob| Ok(Compensation::new(blob.compensation()?))) }
    })
    .into()
}

/// One control period of position control, after the observer's step: follow a motion. `ahead` is the motion by
/// `lead_s` (joint_tables_facts) later than `now`, or NULL if that is not known.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_compensation_follow(
    compensation: *mut JointCompensation,
    observer: *const JointObserver,
    now: *const JointMotion,
    ahead: *const JointMotion,
    torque: *mut JointTorque,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's word, as the header asks for it.
        let now = unsafe { read(now) }?.motion()?;
        let ahead = match ahead.is_null() {
            true => None,
            // SAFETY: likewise.
            false => Some(unsafe { read(ahead) }?.motion()?),
        };
        // SAFETY: likewise.
        unsafe { step(compensation, observer, &Command::Position { now, ahead }, torque) }
    })
    .into()
}

/// One control period of impedance control, after the observer's step: be a spring and damper at the link.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_compensation_yield(
    compensation: *mut JointCompensation,
    observer: *const JointObserver,
    impedance: *const JointImpedance,
    torque: *mut JointTorque,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's word, as the header asks for it.
        let point = unsafe { read(impedance) }?.point()?;
        // SAFETY: likewise.
        unsafe { step(compensation, observer, &Command::Impedance(point), torque) }
    })
    .into()
}

#[inline(always)]
unsafe fn step(
    compensation: *mut JointCompensation,
    observer: *const JointObserver,
    command: &Command<f32>,
    torque: *mut JointTorque,
) -> Result<(), JointStatus> {
    // SAFETY: the caller's word, as the header asks for it.
    let object = unsafe { open::<Compensation<'static, f32>>(compensation) }?;
    // SAFETY: likewise; the marks of both say that they are two.
    let seen = unsafe { look::<AnyObserver>(observer) }?;
    if object.tables_digest != seen.tables_digest {
        return Err(JointStatus::OtherTables);
    }
    usable(torque)?;
    let shaped = object.value.step(seen.value.estimates(), command);
    // SAFETY: aligned, not NULL, and the caller's to give.
    unsafe { torque.write(JointTorque::new(&shaped)) };
    Ok(())
}
