#include "tests/fuzz/mutator.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace bris {

namespace {

/// Numbers and words at which readers have gone wrong elsewhere.
constexpr std::array<std::string_view, 34> words{"nan",
                                                 "-nan",
                                                 "inf",
                                                 "-inf",
                                                 "1e999",
                                                 "-1e999",
                                                 "1e-999",
                                                 "0",
                                                 "-0",
                                                 "-1",
                                                 "1",
                                                 "2147483648",
                                                 "4294967296",
                                                 "18446744073709551616",
                                                 "9223372036854775808",
                                                 "0x10",
                                                 "1e308",
                                                 "5e-324",
                                                 "",
                                                 "-",
                                                 "\"",
                                                 "\"\"",
                                                 ",",
                                                 ",,",
                                                 "{",
                                                 "}",
                                                 "[[[[[[[[",
                                                 "null",
                                                 "\\u0000",
                                                 "# x = 1",
                                                 "\r\n",
                                                 "\t",
                                                 "=",
                                                 "1.7976931348623159e308"};

/// One draw after the other.
class Draws {
public:
    Draws(std::uint64_t seed, std::uint64_t number) : random_(seed, number) {}
    /// From 0 to n - 1.
    std::size_t below(std::size_t n) {
        return std::min(n - 1,
                        static_cast<std::size_t>(random_.uniform(0, 1) * static_cast<double>(n)));
    }

private:
    Random random_;
};

/// A part of the text: where it begins, and its length.
struct Part {
    std::size_t begin, size;
};

Part block(const std::string& text, Draws& draws) {
    const std::size_t begin = draws.below(text.size() + 1);
    return {begin, draws.below(std::min<std::size_t>(text.size() - begin, 64) + 1)};
}

/// The number or word about a place, or the line.
Part around(const std::string& text, std::size_t at, bool line) {
    const auto inside = [&](char c) {
        return line ? c != '\n'
                    : std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' ||
                          c == '+';
    };
    std::size_t begin = at, end = at;
    while (begin > 0 && inside(text[begin - 1])) --begin;
    while (end < text.size() && inside(text[end])) ++end;
    return {begin, end - begin + (line && end < text.size() ? 1u : 0u)};
}

void change(std::string& text, const std::vector<std::string>& valid, Draws& draws) {
    const std::size_t at = draws.below(text.size() + 1);
    switch (draws.below(11)) {
    case 0: // a bit
        if (at < text.size())
            text[at] =
                static_cast<char>(static_cast<unsigned char>(text[at]) ^ (1u << draws.below(8)));
        break;
    case 1: // a byte
        if (at < text.size()) text[at] = static_cast<char>(draws.below(256));
        break;
    case 2:
        text.insert(at, words[draws.below(words.size())]);
        break;
    case 3: { // a number or word
        const Part part = around(text, at, false);
        text.replace(part.begin, part.size, words[draws.below(words.size())]);
        break;
    }
    case 4: { // a line is removed
        const Part part = around(text, at, true);
        text.erase(part.begin, part.size);
        break;
    }
    case 5: { // a line is repeated
        const Part part = around(text, at, true);
        const std::string line = text.substr(part.begin, part.size);
        for (std::size_t k = draws.below(4) + 1; k-- > 0;) text.insert(part.begin, line);
        break;
    }
    case 6: { // a block is removed
        const Part part = block(text, draws);
        text.erase(part.begin, part.size);
        break;
    }
    case 7: { // a block is copied to another place
        const Part part = block(text, draws);
        text.insert(at, text.substr(part.begin, part.size));
        break;
    }
    case 8: // the end is cut off
        text.resize(at);
        break;
    case 9: { // a part of another input
        const std::string& other = valid[draws.below(valid.size())];
        const Part part = block(other, draws);
        text.insert(at, other.substr(part.begin, part.size));
        break;
    }
    default: // one byte many times
        text.insert(at, draws.below(300), static_cast<char>(draws.below(256)));
    }
}

/// Overwrites bytes, without moving any: a file with addresses is refused at once otherwise.
void overwrite(std::string& text, Draws& draws) {
    if (text.empty()) return;
    const std::size_t at = draws.below(text.size()),
                      size = std::min(text.size() - at, std::size_t{1} << draws.below(4));
    switch (draws.below(20)) {
    case 0: // the end is cut off
        text.resize(at);
        break;
    case 1: // a block is copied to another place
        text.replace(at, size, text.substr(draws.below(text.size() - size + 1), size));
        break;
    case 2:
    case 3: // the smallest or largest number
        text.replace(at, size, size, draws.below(2) == 0 ? '\0' : '\xff');
        break;
    case 4:
    case 5:
    case 6: // a bit
        text[at] = static_cast<char>(static_cast<unsigned char>(text[at]) ^ (1u << draws.below(8)));
        break;
    default: // a byte
        text[at] = static_cast<char>(draws.below(256));
    }
}

} // namespace

std::string Mutator::input(std::uint64_t number) const {
    Draws draws(seed_, number);
    std::string text = valid_[draws.below(valid_.size())];
    for (std::size_t k = draws.below(6) + 1; k-- > 0;)
        if (in_place_)
            overwrite(text, draws);
        else
            change(text, valid_, draws);
    return text;
}

} // namespace bris
