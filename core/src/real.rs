//! The two floating-point types the estimators run in.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// `f64` where the target has it in hardware, `f32` elsewhere. Sealed: no other type implements it.
///
/// Only operations that IEEE 754 defines to the last bit, or that `libm` computes in software, are used, so every
/// target with such operations (x87 has none) returns the same bits. The type of the workspace decides in which
/// precision an estimate is computed.
pub trait Real:
    sealed::Sealed
    + Copy
    + Debug
    + Default
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + From<f32>
    + Into<f64>
    + 'static
{
    /// 0
    const ZERO: Self;
    /// 1
    const ONE: Self;
    /// What is larger than any number.
    const INFINITY: Self;
    /// The spacing of numbers at 1.
    const EPSILON: Self;
    /// Whether squares of `f32` inputs can leave this type's range, so that they are scaled first.
    const NARROW: bool;

    /// Rounds to nearest.
    fn from_f64(value: f64) -> Self;
    /// Exact up to 2^24 for `f32`, and up to 2^53 for `f64`.
    fn from_usize(value: usize) -> Self;
    /// Rounds to nearest; what is too large becomes infinite.
    fn to_f32(self) -> f32;
    /// Exact.
    #[inline]
    fn to_f64(self) -> f64 {
        self.into()
    }
    /// The square root.
    fn sqrt(self) -> Self;
    /// e to the power of `self`.
    fn exp(self) -> Self;
    /// The natural logarithm.
    fn ln(self) -> Self;
    /// The cosine of an angle in radians.
    fn cos(self) -> Self;
    /// The absolute value.
    fn abs(self) -> Self;
    /// `self` times two to the power of `exponent`.
    fn scale(self, exponent: i32) -> Self;
    /// The exponent e of |self| = m 2^e with m in [1/2, 1); 0 for zero.
    fn exponent(self) -> i32;

    /// The larger of the two; `other` if `self` is NaN.
    #[inline]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    /// The smaller of the two; `other` if `self` is NaN.
    #[inline]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    /// Itself if positive, else one: a divisor that a compiler may use ahead of the decision whether there is one.
    #[inline]
    fn or_one(self) -> Self {
        if self > Self::ZERO { self } else { Self::ONE }
    }

    /// Neither NaN nor infinite.
    #[inline]
    fn is_finite(self) -> bool {
        self.abs() < Self::INFINITY
    }
}

/// What is smaller than this, relative to what it is left of, is rounding noise.
#[inline]
pub(crate) fn rounding<R: Real>() -> R {
    R::from_f64(64.0) * R::EPSILON
}

/// What is alike in both types, with the names that `libm` has for it.
macro_rules! real {
    ($type:ident, $narrow:literal, $sqrt:ident $exp:ident $cos:ident $abs:ident $exponent:ident; $($own:item)*) => {
        impl Real for $type {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const INFINITY: Self = $type::INFINITY;
            const EPSILON: Self = $type::EPSILON;
            const NARROW: bool = $narrow;

            #[inline]
            fn from_f64(value: f64) -> Self { value as Self }
            #[inline]
            fn from_usize(value: usize) -> Self { value as Self }
            #[inline]
            fn to_f32(self) -> f32 { self as f32 }
            #[inline]
            fn sqrt(self) -> Self { libm::$sqrt(self) }
            fn exp(self) -> Self { libm::$exp(self) }
            fn cos(self) -> Self { libm::$cos(self) }
            #[inline]
            fn abs(self) -> Self { libm::$abs(self) }
            fn exponent(self) -> i32 { libm::$exponent(self).1 }
            $($own)*
        }
    };
}

real! { f64, false, sqrt exp cos fabs frexp;
    fn ln(self) -> Self { libm::log(self) }
    fn scale(self, exponent: i32) -> Self { libm::scalbn(self, exponent) }
}

real! { f32, true, sqrtf expf cosf fabsf frexpf;
    // Of logf the compiler may compute what it returns for a negative number before it knows that there is none, an
    // invalid operation.
    fn ln(self) -> Self { libm::log(f64::from(self)) as f32 }
    // Rounded once, by the last cast. scalbnf multiplies in steps, and a compiler may take one more than there are.
    fn scale(self, exponent: i32) -> Self {
        (f64::from(self) * power_of_two(exponent)) as f32
    }
}

/// 2 to the power of `exponent`, or of what is nearest to it in -1022..=1023.
pub(crate) fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent.clamp(-1022, 1023) + 1023) as u64) << 52)
}

/// The nearest finite `f32`.
pub(crate) fn saturate(value: f64) -> f32 {
    value.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
}
