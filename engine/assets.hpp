#pragma once

#include <filesystem>

namespace bris {

/// The folder of the data files that come with the code: clumps, gradings, example recordings.
std::filesystem::path assets_folder();

} // namespace bris
