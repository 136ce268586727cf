//! What the tests share: the oracle, the integrands, the statistics.
