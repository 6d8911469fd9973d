#pragma once

#include <string>
#include <string_view>

namespace bris {

/// A text that a terminal can show: every byte that is a control character or not part of valid
/// UTF-8, and every character that controls the direction of text, is written as \xNN. A text from
/// a file could otherwise move the cursor, change colours, or hide parts of a message.
std::string printable(std::string_view text);

/// The first 40 bytes of a text, with "..." if there are more.
std::string beginning_of(std::string_view text);

} // namespace bris
