#pragma once

#include "engine/named_value.hpp"

#include <string>
#include <vector>

namespace bris {

/// The compiler of this binary with its version, as "g++ 12.2.0".
std::string compiler();

/// The instruction set of this binary: the one asked for, and the widest vectors that it has, as
/// "native, AVX-512".
std::string instruction_set();

/// What made this binary, under flat keys: bris_version, bris_commit (ending in "-dirty" where
/// files differed from it, "unknown" where there is no repository), compiler, instruction_set,
/// libraries. Every summary.json and every run file has them.
std::vector<NamedValue> version_entries();

/// The text of --version: the program and one line for each entry.
std::string version_text(const std::string& program);

namespace detail {
/// What only the build knows; from engine/build_facts.cpp.in.
struct BuildFacts {
    const char *version, *commit, *arch, *libraries;
};
extern const BuildFacts build_facts;
} // namespace detail

} // namespace bris
