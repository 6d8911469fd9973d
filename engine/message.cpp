#include "engine/message.hpp"

#include "engine/printable.hpp"

#include <cstdio>
#include <string>

namespace bris {

void say(std::string_view line) {
    const std::string text = printable(line) + "\n";
    std::fwrite(text.data(), 1, text.size(), stderr);
}

} // namespace bris
