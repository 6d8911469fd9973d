// Compiled for every processor of its kind (CMakeLists.txt), so that it can say what is missing
// before anything is used that is. For the same reason it calls nothing but the C library: inline
// functions of C++ may be those of another file.
#include "engine/processor.hpp"

#include "engine/exit_codes.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <unistd.h>

namespace bris {

bool has_instructions(const char* name) {
#ifdef __x86_64__
#define BRIS_ANSWER(known)                                                                         \
    if (std::strcmp(name, known) == 0) return __builtin_cpu_supports(known) != 0
    BRIS_ANSWER("sse4.2");
    BRIS_ANSWER("popcnt");
    BRIS_ANSWER("avx");
    BRIS_ANSWER("avx2");
    BRIS_ANSWER("bmi");
    BRIS_ANSWER("bmi2");
    BRIS_ANSWER("fma");
    BRIS_ANSWER("avx512f");
    BRIS_ANSWER("avx512cd");
    BRIS_ANSWER("avx512dq");
    BRIS_ANSWER("avx512bw");
    BRIS_ANSWER("avx512vl");
    BRIS_ANSWER("avx512vbmi");
    BRIS_ANSWER("avx512vbmi2");
    BRIS_ANSWER("avx512ifma");
    BRIS_ANSWER("avx512vnni");
    BRIS_ANSWER("avx512bitalg");
    BRIS_ANSWER("avx512vpopcntdq");
#undef BRIS_ANSWER
#endif
    (void)name;
    return true;
}

} // namespace bris

/// Runs before all other constructors of the program, whose link asks for it by this name.
extern "C" [[gnu::constructor(101)]] void bris_check_processor() {
#ifdef __x86_64__
    __builtin_cpu_init();
#endif
    bool lacks = false;
    for (const char* const* name = bris::detail::needed_instructions; *name != nullptr; ++name) {
        if (bris::has_instructions(*name)) continue;
        if (lacks)
            std::fprintf(stderr, ", %s", *name);
        else
            std::fprintf(stderr,
                         "%s: expected a processor with the instructions of this build, found one "
                         "without %s",
                         program_invocation_short_name, *name);
        lacks = true;
    }
    if (!lacks) return;
    std::fprintf(stderr, "; build BRIS on this machine\n");
    _exit(static_cast<int>(bris::ExitCode::bad_input));
}
