#pragma once

#include <filesystem>

namespace bris {

/// Folder of the data files that come with the code: clumps, gradings, example recordings.
std::filesystem::path assets_folder();

} // namespace bris
