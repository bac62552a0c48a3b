// A function compiled for several instruction sets, the best one chosen when the program is loaded.
#pragma once

// For small loops over floats. The same bits on every machine need -ffp-contract=off in that file. Left out
// where the loader's choice comes before a sanitizer is ready.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define TILTMAP_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define TILTMAP_CLONES
#endif
