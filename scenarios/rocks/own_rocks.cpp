#include "scenarios/rocks/own_rocks.hpp"

#include "engine/assets.hpp"
#include "engine/io/csv.hpp"
#include "engine/message.hpp"
#include "scenarios/rocks/clump_library.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

Grading grading_named(const std::string& name) {
    return read_grading(asset_or_file("--grading", "gradings", name, ".csv"));
}

void say_how_read(const Grading& grading) {
    if (!grading.read_as.empty())
        say(fmt::format("grading {}: read with {}", grading.name, grading.read_as));
}

std::vector<Clump> clumps_of(const std::filesystem::path& folder) {
    return read_clumps(folder.empty() ? assets_folder() / "clumps" : folder);
}

std::vector<Clump> rocks_among(std::vector<Clump> clumps) {
    std::erase_if(clumps, [](const Clump& c) { return c.name == "cube"; });
    return clumps;
}

std::vector<Clump> sensor_shapes_named(const std::string& names, const std::vector<Clump>& library,
                                       const std::string& option) {
    std::vector<Clump> shapes;
    for (const auto name : cells_of(names)) {
        const auto found = std::ranges::find(library, name, &Clump::name);
        shapes.push_back(
            found != library.end()
                ? *found
                : read_clump(asset_or_file(option, "clumps", std::string(name), ".csv")));
    }
    return shapes;
}

} // namespace bris
