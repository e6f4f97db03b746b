// PARIAN_HOT marks a hot kernel: a non-template free function over plain pointers that is
// compiled for several instruction sets and chosen at run time. Contraction to fused operations is
// off everywhere and kernels keep one order of summation, so every clone gives the same bits.
#pragma once

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(PARIAN_NO_CLONES)
#define PARIAN_HOT __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define PARIAN_HOT
#endif

#define PARIAN_RESTRICT __restrict__

// Before a loop whose iterations touch places of their own, where a compiler cannot see that: what
// it gathers by index is not what it stores.
#if defined(__GNUC__) && !defined(__clang__)
#define PARIAN_INDEPENDENT _Pragma("GCC ivdep")
#else
#define PARIAN_INDEPENDENT
#endif
