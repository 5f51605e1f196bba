//! An empty library. The benchmarks are in `benches/`.
