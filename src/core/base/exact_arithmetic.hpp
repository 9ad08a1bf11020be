// Same input, same bits, whatever the compiler and its flags: no operation is
// contracted (a * b + c as one rounding), reordered or done in a wider format.
// The first header of every source file, by way of memory.hpp.
#pragma once

#if defined(__FAST_MATH__) || (defined(_MSC_VER) && defined(_M_FP_FAST))
#error "hmf needs IEEE arithmetic as written: compile it without -ffast-math, -Ofast and the like"
#endif

#include <cfloat>
#if !defined(_MSC_VER) && FLT_EVAL_METHOD != 0
#error "hmf needs doubles without excess precision: on i386 compile it with -msse2 -mfpmath=sse"
#endif

#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__) && (defined(__FP_FAST_FMA) || defined(__FMA__) || defined(__FP_FAST_FMAL))
// gcc contracts if the machine has such an instruction, even with -std=c++17. The pragma is set only then, because it
// marks each function.
#pragma GCC optimize("fp-contract=off")
#elif defined(_MSC_VER)
#pragma fp_contract(off)
#endif
