#include "engine/version.hpp"

#include "engine/processor.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

/// The widest vector instructions that the compiler may use.
const char* widest_vectors() {
#if defined __AVX512F__
    return "AVX-512";
#elif defined __AVX2__
    return "AVX2";
#elif defined __AVX__
    return "AVX";
#elif defined __SSE2__
    return "SSE2";
#elif defined __ARM_FEATURE_SVE
    return "SVE";
#elif defined __ARM_NEON
    return "NEON";
#else
    return "no vectors";
#endif
}

/// What a processor must have, as the last words of a line.
std::string needed() {
    std::string names;
    for (auto name = detail::needed_instructions; *name != nullptr; ++name)
        names += (names.empty() ? " with " : ", ") + std::string(*name);
    return "for processors" + (names.empty() ? " of this kind" : names);
}

} // namespace

std::string compiler() {
#ifdef __clang__
    return "clang " __clang_version__;
#else
    return "g++ " __VERSION__;
#endif
}

std::string instruction_set() {
    const std::string arch = detail::build_facts.arch;
    return fmt::format("{}, {}", arch.empty() ? "baseline" : arch, widest_vectors());
}

std::vector<NamedValue> version_entries() {
    const detail::BuildFacts& facts = detail::build_facts;
    return {{"bris_version", facts.version},
            {"bris_commit", facts.commit},
            {"compiler", compiler()},
            {"instruction_set", instruction_set()},
            {"libraries", facts.libraries}};
}

std::string version_text(const std::string& program) {
    const detail::BuildFacts& facts = detail::build_facts;
    return fmt::format("{} of BRIS {}\n"
                       "commit           {}\n"
                       "compiler         {}\n"
                       "instruction set  {}, {}\n"
                       "libraries        {}\n",
                       program, facts.version, facts.commit, compiler(), instruction_set(),
                       needed(), facts.libraries);
}

} // namespace bris
