//! Materials of gears and their properties.

/// Material of the gears.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Material {
    /// Hardened steel
    #[default]
    Steel,
    /// A technical plastic such as POM
    Plastic,
}

impl Material {
    /// Name of the material.
    pub fn word(self) -> &'static str {
        match self {
            Self::Steel => "steel",
            Self::Plastic => "plastic",
        }
    }

    /// Density [kg/m^3].
    pub fn density(self) -> f64 {
        match self {
            Self::Steel => 7850.0,
            Self::Plastic => 1410.0,
        }
    }

    /// Mean stiffness of a mesh per face width [N/m^2]: 14 N/(mm um) by ISO 6336-1 for steel, scaled by Young's
    /// modulus, 2.9 over 206 GPa, for POM.
    pub fn stiffness_per_width(self) -> f64 {
        match self {
            Self::Steel => 1.4e10,
            Self::Plastic => 1.4e10 * 2.9 / 206.0,
        }
    }

    /// Design stress at the root of a tooth at rated torque [Pa].
    pub fn stress(self) -> f64 {
        match self {
            Self::Steel => 100e6,
            Self::Plastic => 12e6,
        }
    }
}
