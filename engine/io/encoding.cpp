#include "engine/io/encoding.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace bris {

namespace {

std::uint32_t byte_at(std::string_view text, std::size_t k) {
    return static_cast<unsigned char>(text[k]);
}

void append(std::string& text, std::uint32_t code) {
    const auto put = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
    const auto follow = [&](unsigned shift) { put(0x80u | (code >> shift & 0x3fu)); };
    if (code < 0x80) {
        put(code);
    } else if (code < 0x800) {
        put(0xc0u | code >> 6);
        follow(0);
    } else if (code < 0x10000) {
        put(0xe0u | code >> 12);
        follow(6), follow(0);
    } else {
        put(0xf0u | code >> 18);
        follow(12), follow(6), follow(0);
    }
}

/// Number of bytes of the valid character of UTF-8 with which the text begins; 0: there is none.
std::size_t utf8_bytes(std::string_view text) {
    const std::uint32_t first = byte_at(text, 0);
    if (first < 0x80) return 1;
    const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : first >= 0xc2 ? 2 : 0;
    if (length == 0 || first > 0xf4 || text.size() < length) return 0;
    for (std::size_t k = 1; k < length; ++k)
        if ((byte_at(text, k) & 0xc0u) != 0x80) return 0;
    const std::uint32_t second = byte_at(text, 1);
    const bool is_long = (first == 0xe0 && second < 0xa0) || (first == 0xf0 && second < 0x90),
               is_no_character =
                   (first == 0xed && second >= 0xa0) || (first == 0xf4 && second >= 0x90);
    return is_long || is_no_character ? 0 : length;
}

/// The characters 0x80 to 0x9f of Windows-1252; those that it does not define stay controls.
constexpr std::array<std::uint16_t, 32> windows_1252{
    0x20ac, 0x0081, 0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021, 0x02c6, 0x2030, 0x0160,
    0x2039, 0x0152, 0x008d, 0x017d, 0x008f, 0x0090, 0x2018, 0x2019, 0x201c, 0x201d, 0x2022,
    0x2013, 0x2014, 0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0x009d, 0x017e, 0x0178};

std::string from_bytes(std::string_view bytes) {
    std::string text;
    text.reserve(bytes.size());
    while (!bytes.empty()) {
        const std::size_t length = utf8_bytes(bytes);
        if (length > 0) {
            text += bytes.substr(0, length);
        } else {
            const std::uint32_t byte = byte_at(bytes, 0);
            append(text, byte < 0xa0 ? windows_1252[byte - 0x80] : byte);
        }
        bytes.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return text;
}

std::string from_utf16(std::string_view bytes, bool big_endian) {
    std::string text;
    text.reserve(bytes.size());
    const auto unit = [&](std::size_t k) {
        const std::uint32_t first = byte_at(bytes, k), second = byte_at(bytes, k + 1);
        return big_endian ? first << 8 | second : second << 8 | first;
    };
    constexpr std::uint32_t replacement = 0xfffd;
    std::size_t k = 0;
    for (; k + 1 < bytes.size(); k += 2) {
        std::uint32_t code = unit(k);
        if (code >= 0xd800 && code < 0xe000) { // half of a character
            const std::uint32_t low = code < 0xdc00 && k + 3 < bytes.size() ? unit(k + 2) : 0;
            const bool is_pair = low >= 0xdc00 && low < 0xe000;
            code = is_pair ? 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00) : replacement;
            if (is_pair) k += 2;
        }
        append(text, code);
    }
    if (k < bytes.size()) append(text, replacement); // half a unit
    return text;
}

/// Whether the first characters are pairs of a zero byte and another one.
bool looks_like_utf16(std::string_view bytes, bool big_endian) {
    constexpr std::size_t most = 64;
    const std::size_t end = std::min(bytes.size(), most) / 2 * 2;
    for (std::size_t k = 0; k < end; k += 2)
        if ((bytes[k] == 0) != big_endian || (bytes[k + 1] == 0) == big_endian) return false;
    return end >= 4;
}

} // namespace

std::string as_utf8(std::string bytes) {
    using namespace std::string_view_literals;
    const std::string_view all = bytes;
    if (all.starts_with("\xff\xfe\0\0"sv) || all.starts_with("\0\0\xfe\xff"sv))
        throw InputError("expected a text in UTF-8, UTF-16 or Latin-1, found UTF-32");
    if (all.starts_with("\xff\xfe"sv)) return from_utf16(all.substr(2), false);
    if (all.starts_with("\xfe\xff"sv)) return from_utf16(all.substr(2), true);
    for (const bool big_endian : {false, true})
        if (looks_like_utf16(all, big_endian)) return from_utf16(all, big_endian);
    const std::string_view text = without_mark(all);
    const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 0x80; };
    if (!std::ranges::all_of(text, is_ascii)) return from_bytes(text);
    bytes.erase(0, all.size() - text.size());
    return bytes;
}

} // namespace bris
