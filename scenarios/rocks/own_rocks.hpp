#pragma once

#include "scenarios/rocks/grading.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// Texts for --help, the same in every scenario with rocks.
inline constexpr auto help_grading =
    "Grading of the rocks: a file of assets/gradings without its ending, or the path of a file of "
    "the same format.";
inline constexpr auto help_clumps =
    "Folder of the shapes of the rocks, as the scenario clumps writes it. Default: assets/clumps.";

/// The grading that the option --grading names: a file of assets/gradings without its ending, or a
/// path. Throws InputError.
Grading grading_named(const std::string& name);

/// Prints one line if the file of the grading is in another form than those of assets/gradings.
void say_how_read(const Grading& grading);

/// The clumps of a folder (--clumps); of assets/clumps if the path is empty. Throws InputError.
std::vector<Clump> clumps_of(const std::filesystem::path& folder);

/// The clumps that rocks are made of: all but the cube, which is the shape of a sensor rock.
std::vector<Clump> rocks_among(std::vector<Clump> clumps);

/// The shapes of sensor rocks that a list such as "rock_01,cube,own/shell.csv" names: clumps of
/// `library` (those of --clumps), else of assets/clumps, else paths of files. Throws InputError
/// that names `option`.
std::vector<Clump> sensor_shapes_named(const std::string& names, const std::vector<Clump>& library,
                                       const std::string& option);

} // namespace bris
