#pragma once
// CARAT_MULTIVERSION before a function: one version a register width, chosen when the program
// starts. For files that are compiled without fused operations, so that all give the same bits.

#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define CARAT_MULTIVERSION [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]]
#else
#define CARAT_MULTIVERSION
#endif
