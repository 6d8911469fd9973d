#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// The number that follows one of the words sensor, rock, node, logger, id and s in the name of a
/// file or, if there is none, in that of its folder: "s2.csv", "rock_07/data.txt". Nothing: none.
std::optional<unsigned> number_in_name(const std::filesystem::path& file);

/// Numbers of sensors with these names: those at the end of the names, "S1:" or "node-12", if all
/// have one and no two the same; otherwise 1, 2, 3 in the order of the names.
std::vector<unsigned> numbers_of_names(const std::vector<std::string>& names);

} // namespace bris
