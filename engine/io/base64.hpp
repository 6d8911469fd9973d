#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace bris {

/// Bytes as text, and back (RFC 4648, with padding). Nothing: the text is none of these.
std::string to_base64(std::string_view bytes);
std::optional<std::string> from_base64(std::string_view text);

} // namespace bris
