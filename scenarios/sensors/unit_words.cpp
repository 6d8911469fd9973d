#include "scenarios/sensors/unit_words.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace bris {

namespace {

/// Spellings of each unit in the form of `simplified`. Those of more than two letters are read in
/// upper and lower case; in shorter ones the case may be a prefix (mPa, MPa).
struct Spellings {
    const char* unit;
    std::vector<std::string_view> words;
};

const std::vector<Spellings>& spellings() {
    static const std::vector<Spellings> all{
        {"s", {"sec", "secs", "second", "seconds", "sekunden"}},
        {"ms", {"msec", "msecs", "millis", "millisecond", "milliseconds"}},
        {"us", {"usec", "usecs", "micros", "microsecond", "microseconds"}},
        {"ns", {"nsec", "nanos", "nanosecond", "nanoseconds"}},
        {"min", {"mins", "minute", "minutes"}},
        {"h", {"hr", "hrs", "hour", "hours"}},
        {"m/s2", {"m/s/s", "m/(s2)", "ms-2", "m/sec2", "mps2", "mpss"}},
        {"g", {"G", "gn", "g0", "gs"}},
        {"mg", {"mG"}},
        {"rad/s", {"rads-1", "rad/sec", "radian/s", "radians/s", "radians/sec"}},
        {"mrad/s", {"mrad/sec"}},
        {"deg/s",
         {"dps", "\u00b0/s", "\u00b0/sec", "\u00b0s-1", "deg/sec", "degs-1", "degree/s",
          "degrees/s", "degrees/sec", "degrees/second"}},
        {"mdeg/s", {"mdps", "m\u00b0/s"}},
        {"rpm", {"r/min", "rev/min"}},
        {"T", {"tesla"}},
        {"mT", {"millitesla"}},
        {"uT", {"microtesla"}},
        {"nT", {"nanotesla"}},
        {"G", {"Gs", "gauss"}},
        {"mG", {"mGs", "mgauss", "milligauss"}},
        {"m", {"meter", "meters", "metre", "metres"}},
        {"mm", {"millimeter", "millimeters", "millimetre", "millimetres"}},
        {"um", {"micron", "microns", "micrometer", "micrometre"}},
        {"1", {"-", "m/m", "mm/mm", "ratio"}},
        {"%", {"percent", "pct"}},
        {"cycles", {"cycle"}},
        {"deg", {"\u00b0", "degree", "degrees"}},
        {"rad", {"radian", "radians"}},
        {"K", {"kelvin"}},
        {"C", {"\u00b0C", "degC", "celsius", "degreesC", "degree_Celsius"}},
        {"F", {"\u00b0F", "degF", "fahrenheit", "degreesF", "degree_Fahrenheit"}},
        {"V", {"volt", "volts"}},
        {"mV", {"millivolt", "millivolts"}},
        {"N", {"newton", "newtons"}},
        {"kN", {"KN", "kilonewton", "kilonewtons"}},
        {"ml", {"mL", "milliliter", "milliliters", "millilitre", "millilitres"}},
        {"cm3", {"cc", "ccm"}},
        {"mm3", {}},
        {"m3", {}},
        {"l", {"L", "liter", "liters", "litre", "litres"}},
        {"Pa", {"N/m2", "pascal"}},
        {"kPa", {"kpa", "KPa", "kN/m2", "kilopascal"}},
        {"MPa", {"N/mm2", "MN/m2", "megapascal"}}};
    return all;
}

/// Without blanks and signs of multiplication or power, and with one spelling of each character.
std::string simplified(std::string_view word) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 15> characters{
        {{" ", ""},
         {"\u00a0", ""},
         {"*", ""},
         {"^", ""},
         {"\u00b7", ""},
         {".", ""},
         {"\u00b2", "2"},
         {"\u00b3", "3"},
         {"\u00ba", "\u00b0"},
         {"\u02da", "\u00b0"},
         {"\u03bc", "u"},
         {"\u00b5", "u"},
         {"\u2212", "-"},
         {"\u207b", "-"},
         {"\u00b9", "1"}}};
    std::string text;
    while (!word.empty()) {
        const auto* const found = std::ranges::find_if(
            characters, [&](const auto& c) { return word.starts_with(c.first); });
        const bool is_special = found != characters.end();
        text += is_special ? found->second : word.substr(0, 1);
        word.remove_prefix(is_special ? found->first.size() : 1);
    }
    return text;
}

std::string in_lower_case(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

} // namespace

std::string unit_named(std::string_view word, const std::vector<ColumnUnit>& units) {
    const std::string exact = simplified(word);
    const auto is_here = [&](std::string_view unit) {
        return std::ranges::find(units, unit, &ColumnUnit::name) != units.end();
    };
    if (is_here(exact)) return exact;
    for (const Spellings& s : spellings()) {
        if (!is_here(s.unit)) continue;
        for (const std::string_view spelling : s.words)
            if (exact == spelling || (spelling.size() > 2 &&
                                      in_lower_case(exact) == in_lower_case(std::string(spelling))))
                return s.unit;
    }
    return {};
}

bool is_unit(std::string_view word) {
    std::vector<ColumnUnit> all;
    for (const Spellings& s : spellings()) all.push_back({s.unit});
    return !unit_named(word, all).empty();
}

} // namespace bris
