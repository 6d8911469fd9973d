#include "engine/assets.hpp"

namespace bris {

std::filesystem::path assets_folder() { return BRIS_ASSETS; } // defined for this file alone

} // namespace bris
