//! The laboratory of the cloth solver. So far it holds the benchmarks, see `benches/`.
