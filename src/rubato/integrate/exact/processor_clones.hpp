#pragma once

/// A function with this attribute is compiled for wider vectors too, and the processor's own are taken when the program
/// starts. Fused multiplications are off everywhere, so that all clones give the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define RUBATO_CLONES __attribute__((target_clones("default", "avx2", "avx512f"), flatten))
#else
#define RUBATO_CLONES
#endif
