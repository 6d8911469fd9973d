#include "scenarios/records/date_text.hpp"

#include "engine/io/csv.hpp"

#include <chrono>
#include <cmath>
#include <string>

namespace bris {

namespace {

/// Takes digits, `least` to `most` of them, from the beginning of the text.
std::optional<int> take_digits(std::string_view& text, std::size_t least, std::size_t most) {
    std::size_t count = 0;
    int number = 0;
    for (; count < most && count < text.size() && text[count] >= '0' && text[count] <= '9'; ++count)
        number = 10 * number + (text[count] - '0');
    if (count < least) return {};
    text.remove_prefix(count);
    return number;
}

bool take(std::string_view& text, char sign) {
    if (!text.starts_with(sign)) return false;
    text.remove_prefix(1);
    return true;
}

/// Days since 1970 of a date at the beginning of the text.
std::optional<double> take_date(std::string_view& text) {
    std::string_view rest = text;
    const auto first = take_digits(rest, 1, 4);
    if (!first || rest.empty()) return {};
    const char sign = rest.front();
    const bool year_first = sign == '-' || sign == '/';
    if ((!year_first && sign != '.') || (year_first && *first < 1900)) return {};
    rest.remove_prefix(1);
    const auto month = take_digits(rest, 1, 2);
    if (!month || !take(rest, sign)) return {};
    const auto last = take_digits(rest, year_first ? 1 : 4, year_first ? 2 : 4);
    if (!last) return {};
    const std::chrono::year_month_day day{
        std::chrono::year(year_first ? *first : *last),
        std::chrono::month(static_cast<unsigned>(*month)),
        std::chrono::day(static_cast<unsigned>(year_first ? *last : *first))};
    if (!day.ok()) return {};
    text = rest;
    return static_cast<double>(std::chrono::sys_days(day).time_since_epoch().count());
}

/// Seconds of a time of day at the beginning of the text.
std::optional<double> take_time(std::string_view& text) {
    std::string_view rest = text;
    const auto hour = take_digits(rest, 1, 2);
    if (!hour || *hour > 24 || !take(rest, ':')) return {};
    const auto minute = take_digits(rest, 2, 2);
    if (!minute || *minute > 59) return {};
    double seconds = 3600.0 * *hour + 60.0 * *minute;
    if (take(rest, ':')) {
        const auto second = take_digits(rest, 2, 2);
        if (!second || *second > 60) return {};
        seconds += *second;
        if (!rest.empty() && (rest.front() == '.' || rest.front() == ',' || rest.front() == ':')) {
            rest.remove_prefix(1);
            const std::size_t length = rest.size();
            const auto fraction = take_digits(rest, 1, 9);
            if (!fraction) return {};
            seconds += *fraction * std::pow(10.0, -static_cast<double>(length - rest.size()));
            while (take_digits(rest, 1, 9)) {
            } // finer than a nanosecond
        }
    }
    text = rest;
    return seconds;
}

/// Whether the text is a time zone or nothing; adds its offset.
bool is_zone(std::string_view text, DateText& date) {
    text = trimmed(text);
    if (text.empty()) return true;
    date.has_zone = true;
    if (text == "Z" || text == "z" || text == "UTC" || text == "GMT") return true;
    const double sign = text.front() == '-' ? -1 : 1;
    if (text.front() != '+' && text.front() != '-') return false;
    text.remove_prefix(1);
    const auto hours = take_digits(text, 2, 2);
    take(text, ':');
    const auto minutes = text.empty() ? std::optional<int>(0) : take_digits(text, 2, 2);
    if (!hours || !minutes || !text.empty()) return false;
    date.seconds -= sign * (3600.0 * *hours + 60.0 * *minutes);
    return true;
}

} // namespace

std::optional<DateText> date_in(std::string_view text) {
    text = trimmed(text);
    DateText date;
    if (const auto days = take_date(text)) {
        date.has_date = true;
        date.seconds = 86400 * *days;
        if (!text.empty() && !take(text, 'T') && !take(text, ' ') && !take(text, '_') &&
            !take(text, '-'))
            return {};
    }
    if (const auto seconds = take_time(text)) {
        date.has_time = true;
        date.seconds += *seconds;
    }
    if (!date.has_date && !date.has_time) return {};
    if (date.has_time ? !is_zone(text, date) : !text.empty()) return {};
    return date;
}

} // namespace bris
