#pragma once

#include "engine/named_value.hpp"

#include <string>
#include <vector>

namespace bris {

/// The compiler of this binary with its version, for example "g++ 12.2.0".
std::string compiler();

/// The instruction set of this binary: the architecture requested at build time and its widest
/// vectors, for example "native, AVX-512".
std::string instruction_set();

/// How this binary was built, under flat keys: bris_version, bris_commit (ending in "-dirty" if
/// files differed from that commit, "unknown" if there was no repository), compiler,
/// instruction_set, libraries. Every summary.json and every run file contains them.
std::vector<NamedValue> version_entries();

/// The text of --version: the program's name and version, and one line for each other entry.
std::string version_text(const std::string& program);

namespace detail {
/// Facts known only to the build system; defined in engine/build_facts.cpp.in.
struct BuildFacts {
    const char *version, *commit, *arch, *libraries;
};
extern const BuildFacts build_facts;
} // namespace detail

} // namespace bris
