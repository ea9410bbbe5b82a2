//! Kinematics of the gears: lever of the carrier, and the ratio from radii and from teeth.
//!
//! Equations: (P2) in docs/theory/paper.md.

use parameters::Geometry;

/// Lever and ratios of a geometry.
///
/// ```
/// use model_core::gears::Kinematics;
///
/// let geometry = joint_file::read(joint_file::preset("q1").unwrap()).unwrap().parameters.geometry;
/// // 15 teeth of the sun and 75 of the ring.
/// assert_eq!(geometry.ratio_by_teeth(), 6.0);
/// assert!((geometry.ratio_by_radii() - 6.0).abs() < 1e-9, "coaxial gears agree");
/// // Half-backlashes of 40 um in either mesh let the link turn by 13 arcmin while the motor stands.
/// let lost_motion_rad = 2.0 * 40e-6 / geometry.carrier_base_radius();
/// assert!((lost_motion_rad.to_degrees() * 60.0 - 13.0).abs() < 0.1);
/// ```
pub trait Kinematics {
    /// r_c cos(alpha), the carrier's lever on either line of action [m].
    fn carrier_base_radius(&self) -> f64;

    /// Ratio of sun to carrier angle by radii, 2 r_c cos(alpha) / r_bs (the rigid solution of eq. 4) [-].
    fn ratio_by_radii(&self) -> f64;

    /// Ratio of sun to carrier angle by teeth, 1 + Zr/Zs [-].
    fn ratio_by_teeth(&self) -> f64;
}

impl Kinematics for Geometry {
    fn carrier_base_radius(&self) -> f64 {
        self.carrier_radius * libm::cos(self.working_pressure_angle)
    }

    fn ratio_by_radii(&self) -> f64 {
        2.0 * self.carrier_base_radius() / self.sun_base_radius
    }

    fn ratio_by_teeth(&self) -> f64 {
        1.0 + f64::from(self.ring_teeth) / f64::from(self.sun_teeth)
    }
}
