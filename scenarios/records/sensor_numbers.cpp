#include "scenarios/records/sensor_numbers.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>

namespace bris {

namespace {

constexpr unsigned largest_number = 999'999;

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// The whole number at the beginning of the text, below a million.
std::optional<unsigned> leading_number(std::string_view text) {
    unsigned number = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_fraction =
        stop + 1 < text.data() + text.size() && *stop == '.' && is_digit(stop[1]);
    if (error != std::errc{} || number > largest_number || is_fraction) return {};
    return number;
}

/// A word of one or two letters stands alone: "s3" and "run_s3", not "4s3" or "s3x", which are
/// parts of other names.
bool is_apart(std::string_view name, std::string_view word, std::size_t at, std::size_t digits) {
    if (at > 0 && is_letter(name[at - 1])) return false;
    if (word.size() > 2) return true;
    while (digits < name.size() && is_digit(name[digits])) ++digits;
    return (at == 0 || !is_digit(name[at - 1])) &&
           (digits == name.size() || !is_letter(name[digits]));
}

std::optional<unsigned> number_after_word(const std::string& text) {
    std::string name;
    for (const char c : text)
        name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (const std::string_view word : {"sensor", "rock", "node", "logger", "id", "s"})
        for (auto at = name.find(word); at != std::string::npos; at = name.find(word, at + 1)) {
            std::size_t digits = at + word.size();
            while (digits < name.size() &&
                   std::string_view(" _-#").find(name[digits]) != std::string_view::npos)
                ++digits;
            if (!is_apart(name, word, at, digits)) continue;
            if (const auto number = leading_number(std::string_view(name).substr(digits)))
                return number;
        }
    return {};
}

/// The number at the end of a name, without punctuation after it.
std::optional<unsigned> number_at_end(std::string_view name) {
    while (!name.empty() && !is_digit(name.back()) && !is_letter(name.back()))
        name.remove_suffix(1);
    std::size_t begin = name.size();
    while (begin > 0 && is_digit(name[begin - 1])) --begin;
    return begin == name.size() ? std::nullopt : leading_number(name.substr(begin));
}

} // namespace

std::optional<unsigned> number_in_name(const std::filesystem::path& file) {
    if (const auto number = number_after_word(file.stem().string())) return number;
    return number_after_word(file.parent_path().filename().string());
}

std::vector<unsigned> numbers_of_names(const std::vector<std::string>& names) {
    std::vector<unsigned> numbers;
    std::set<unsigned> different;
    for (const std::string& name : names)
        if (const auto number = number_at_end(name); number && different.insert(*number).second)
            numbers.push_back(*number);
    if (numbers.size() == names.size()) return numbers;
    numbers.clear();
    for (std::size_t k = 0; k < names.size(); ++k) numbers.push_back(static_cast<unsigned>(k + 1));
    return numbers;
}

} // namespace bris
