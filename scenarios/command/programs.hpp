#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// Names of all scenarios, whether their programs are there or not, in alphabetical order.
std::vector<std::string> scenario_names();

/// The program of a scenario: beside this one, or in ../libexec/bris or ../lib/bris as seen from
/// there. Empty: it has not been built.
std::filesystem::path program_of(const std::string& scenario);

/// What a program says of itself: the first paragraph of its --help, in one line.
std::string description_of(const std::filesystem::path& program);

/// Becomes the program of a scenario, with the same arguments. Throws InputError if there is no
/// such scenario, OutputError if its program cannot be started.
[[noreturn]] void become(const std::string& scenario, const std::vector<std::string>& arguments);

/// The first program of this name along PATH; empty: there is none.
std::filesystem::path on_path(const std::string& name);

} // namespace bris
