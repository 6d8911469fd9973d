#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace bris {

/// What is recorded of why a passage vibrates as it does. Only this explains a change: never time.
struct PassageCause {
    std::string condition = {}; ///< class of train, track or speed; empty: none stated
    std::string session = {};   ///< day or recording; empty: none stated
    std::map<std::string, double> numbers = {}; ///< such as speed_m_s, axle_load_kN, temperature_C
};

/// Reads causes by name of passage from a CSV file: a line of names with `passage`, and perhaps
/// `condition`, `session`, and any others, which are numbers; # begins a comment. An empty cell is
/// not stated. No file: none. Throws InputError with file:line, OutputError.
std::map<std::string, PassageCause> read_causes(const std::filesystem::path& csv);

} // namespace bris
