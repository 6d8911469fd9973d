#include "scenarios/sensors/axis_titles.hpp"

#include "engine/io/csv.hpp"
#include "scenarios/sensors/channels.hpp"
#include "scenarios/sensors/unit_words.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <vector>

namespace bris {

namespace {

using Words = std::vector<std::string>;

constexpr std::string_view accelerations = "a acc accel accelerometer accelerometers acceleration "
                                           "accelerations accelero beschleunigung",
                           rates = "g gyr gyro gyroscope gyroscopes w omega rate angrate angular "
                                   "angularrate angularvelocity rotation rotationrate drehrate",
                           linear = "linear lin user free without nograv dynamic linacc useracc",
                           others = "mag magn magnetometer magnetic absolute abs norm magnitude "
                                    "quat quaternion euler orientation temp temperature position "
                                    "disp displacement gps strain",
                           beside_axes = "axis achse direction dir sensor imu channel ch of the";

bool is_one_of(std::string_view all, std::string_view word) {
    for (std::size_t k = 0; k < words_in(all); ++k)
        if (word_of(all, k) == word) return true;
    return false;
}

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }
bool is_upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }
bool is_alnum(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

std::optional<std::size_t> axis_of(std::string_view word) {
    for (const auto& [axis, words] : {std::pair{std::size_t{0}, "x longitudinal"},
                                      {std::size_t{1}, "y lateral"},
                                      {std::size_t{2}, "z vertical"}})
        if (is_one_of(words, word)) return axis;
    return {};
}

/// Adds a word of small letters: "accx" and "xacc" are two.
void add(Words& words, std::string word) {
    if (word.empty()) return;
    const auto is_known = [](std::string_view w) {
        return is_one_of(accelerations, w) || is_one_of(rates, w);
    };
    const std::string first = word.substr(0, 1), last = word.substr(word.size() - 1);
    if (word.size() > 1 && axis_of(last) && is_known(word.substr(0, word.size() - 1))) {
        words.push_back(word.substr(0, word.size() - 1));
        words.push_back(last);
    } else if (word.size() > 1 && axis_of(first) && is_known(word.substr(1))) {
        words.push_back(word.substr(1));
        words.push_back(first);
    } else {
        words.push_back(std::move(word));
    }
}

/// Words of a title in small letters; a capital letter after a small one, and a digit after a
/// letter or the reverse, begin a new one.
Words words_of(std::string_view title) {
    Words words;
    std::string word;
    char before = ' ';
    for (const char c : title) {
        const bool begins = !word.empty() && is_alnum(c) &&
                            ((is_upper(c) && !is_upper(before)) || is_digit(c) != is_digit(before));
        if (begins || !is_alnum(c)) add(words, std::exchange(word, ""));
        if (is_alnum(c)) word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        before = c;
    }
    add(words, std::move(word));
    return words;
}

/// The units of accelerations and angular rates.
const std::vector<ColumnUnit>& units_of_axes() {
    static const std::vector<ColumnUnit> all = [] {
        auto units = channel_of(&Recording::force).column_units();
        for (const ColumnUnit& unit : channel_of(&Recording::rate).column_units())
            units.push_back(unit);
        return units;
    }();
    return all;
}

/// Takes the unit from a title, in brackets or as its last word; "".
std::string take_unit(std::string& title) {
    if (const auto open = title.find_last_of("[("), close = title.find_last_of("])");
        open != std::string::npos && close != std::string::npos && close > open) {
        std::string word(trimmed(title.substr(open + 1, close - open - 1)));
        title = title.substr(0, open) + " " + title.substr(close + 1);
        return word == "-" ? "" : word;
    }
    for (auto at = title.find_first_of("_ ,/"); at != std::string::npos;
         at = title.find_first_of("_ ,/", at + 1)) {
        std::string word(trimmed(title.substr(at + 1)));
        if (at > 0 && !unit_named(word, units_of_axes()).empty()) {
            title.resize(at);
            return word;
        }
    }
    return {};
}

} // namespace

std::optional<AxisTitle> axis_title(const std::string& title) {
    AxisTitle found;
    std::string text = title;
    found.unit_word = take_unit(text);
    const Words words = words_of(text);
    const auto has = [&](std::string_view all) {
        return std::ranges::any_of(words, [&](const auto& word) { return is_one_of(all, word); });
    };
    if (words.size() == 2 && words[0] == "g" && words[1].size() == 2 && words[1][0] == 'f') {
        const auto axis = axis_of(words[1].substr(1)); // "gFx" is the acceleration over g
        if (!axis) return {};
        found.axis = *axis;
        found.unit_word = "g";
        return found;
    }
    std::size_t axes = 0;
    for (const std::string& word : words) {
        if (const auto axis = axis_of(word)) found.axis = *axis, ++axes;
        if (is_digit(word[0]) && word.size() < 6 && found.number == 0)
            found.number = static_cast<unsigned>(std::stoul(word));
    }
    const bool is_acceleration = has(accelerations), of_gravity = has("gravity grav");
    if (axes != 1 || has(others) || (of_gravity && !is_acceleration)) return {};
    if (is_acceleration && has("angular")) return {};
    found.is_linear = is_acceleration && has(linear);
    found.is_rate = !is_acceleration && has(rates);
    found.is_bare = !is_acceleration && !found.is_rate;
    const bool is_only_axis = std::ranges::all_of(words, [&](const std::string& word) {
        return axis_of(word) || is_digit(word[0]) || is_one_of(beside_axes, word);
    });
    if (found.is_bare && !is_only_axis) return {};
    if (found.is_bare &&
        !unit_named(found.unit_word, channel_of(&Recording::rate).column_units()).empty()) {
        found.is_rate = true; // "x-axis (deg/s)"
        found.is_bare = false;
    }
    return found;
}

} // namespace bris
