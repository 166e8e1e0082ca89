// A function with NEUVV_VECTOR_CLONES, and what it calls, is compiled twice: for processors with AVX2 and for all.
// Which one runs is chosen when the program starts. Both compute the same numbers, as AVX2 alone fuses no operations.
#pragma once

// Sanitizers are not ready yet when the choice is made.
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define NEUVV_VECTOR_CLONES __attribute__((flatten, target_clones("avx2", "default")))
#else
#define NEUVV_VECTOR_CLONES
#endif
