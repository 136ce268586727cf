//! Benchmarks of noisefloor.
