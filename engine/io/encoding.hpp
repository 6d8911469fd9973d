#pragma once

#include <string>

namespace bris {

/// A text file as UTF-8 without a byte order mark. UTF-8 and UTF-16 are recognised (UTF-16 by its
/// mark, or by the zero bytes of its first characters); a byte that is not part of valid UTF-8 is
/// read as Windows-1252, which contains Latin-1. Throws InputError without a place for UTF-32.
std::string as_utf8(std::string bytes);

} // namespace bris
