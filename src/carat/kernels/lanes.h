#pragma once
// For kernels that compute several elements at a time, one lane each: the loop over lanes becomes
// vector instructions of whatever width there is.

// One version a register width, chosen when the program starts.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define CARAT_MULTIVERSION [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]]
#else
#define CARAT_MULTIVERSION
#endif
