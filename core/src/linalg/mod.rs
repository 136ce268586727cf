//! The small dense linear algebra of the regressions, over the packed triangles of [`matrix`](crate::matrix).

pub(crate) mod givens;
pub(crate) mod ldlt;
