#include "engine/io/base64.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace bris {

namespace {

constexpr std::string_view digits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::uint8_t no_digit = 64;

constexpr auto values = [] {
    std::array<std::uint8_t, 256> all{};
    all.fill(no_digit);
    for (std::size_t k = 0; k < digits.size(); ++k)
        all[static_cast<unsigned char>(digits[k])] = static_cast<std::uint8_t>(k);
    return all;
}();

} // namespace

std::string to_base64(std::string_view bytes) {
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t k = 0; k < bytes.size(); k += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - k);
        std::uint32_t bits = 0;
        for (std::size_t i = 0; i < 3; ++i)
            bits = bits << 8 | (i < count ? static_cast<unsigned char>(bytes[k + i]) : 0u);
        for (std::size_t i = 0; i < 4; ++i)
            text += i <= count ? digits[bits >> (18 - 6 * i) & 63] : '=';
    }
    return text;
}

std::optional<std::string> from_base64(std::string_view text) {
    if (text.size() % 4 != 0) return {};
    const std::size_t padding = text.ends_with("==") ? 2 : text.ends_with('=') ? 1 : 0;
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < text.size(); ++k) {
        const bool is_padding = k + padding >= text.size();
        const std::uint8_t value = is_padding ? 0 : values[static_cast<unsigned char>(text[k])];
        if (value == no_digit) return {};
        bits = bits << 6 | value;
        if (k % 4 != 3) continue;
        for (const unsigned shift : {16u, 8u, 0u}) bytes += static_cast<char>(bits >> shift & 255);
        bits = 0;
    }
    for (std::size_t k = 0; k < padding; ++k) {
        if (bytes.back() != 0) return {}; // bits that no byte has
        bytes.pop_back();
    }
    return bytes;
}

} // namespace bris
