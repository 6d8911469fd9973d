#pragma once

#include "scenarios/library/specimen_library.hpp"

#include <filesystem>

namespace bris {

/// Adds the specimens of `other` (read from the file `name`) to a library; they are numbered after
/// those that it has. Rocks, procedure, pressures, strains, rings and sensor rocks must be the
/// same; ranges of parameters, seed and number of packings may differ, and the ranges of the joined
/// library include both. Throws InputError, naming what differs, also if both have a specimen with
/// the same packing, which would count twice.
void join(SpecimenLibrary& library, const SpecimenLibrary& other,
          const std::filesystem::path& name);

} // namespace bris
