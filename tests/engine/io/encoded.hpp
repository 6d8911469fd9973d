#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace bris::testing {

/// The encodings in which `encoded` writes.
inline const std::vector<std::string>& encodings() {
    static const std::vector<std::string> all{"UTF-8", "UTF-8 with a mark", "Latin-1", "UTF-16LE",
                                              "UTF-16BE"};
    return all;
}

/// A text in UTF-8, of characters below 0x100, in another encoding.
inline std::string encoded(std::string_view utf8, const std::string& encoding) {
    if (encoding == "UTF-8") return std::string(utf8);
    if (encoding == "UTF-8 with a mark") return "\xef\xbb\xbf" + std::string(utf8);
    std::string bytes = encoding == "UTF-16LE"   ? "\xff\xfe"
                        : encoding == "UTF-16BE" ? "\xfe\xff"
                                                 : "";
    for (std::size_t k = 0; k < utf8.size(); ++k) {
        auto code = static_cast<std::uint32_t>(static_cast<unsigned char>(utf8[k]));
        if (code >= 0x80)
            code = (code & 0x1fu) << 6 | (static_cast<unsigned char>(utf8[++k]) & 0x3fu);
        if (encoding == "UTF-16BE") bytes += '\0';
        bytes += static_cast<char>(code);
        if (encoding == "UTF-16LE") bytes += '\0';
    }
    return bytes;
}

} // namespace bris::testing
