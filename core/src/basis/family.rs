//! The kinds of one-dimensional functions.

/// Which one-dimensional functions a basis is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Family {
    /// Orthonormal shifted Legendre polynomials.
    #[default]
    Legendre,
    /// Walsh functions: piecewise constant on eighths.
    Step,
    /// Half-waves sin(pi d x + pi/2).
    Sine,
    /// Isotropic Gaussians.
    Gaussian,
}

impl Family {
    /// Every one, in the order of their numbers in C.
    pub const ALL: [Family; 4] = [Self::Legendre, Self::Step, Self::Sine, Self::Gaussian];
}
