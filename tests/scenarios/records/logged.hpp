#pragma once

#include "scenarios/sensors/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace bris::testing {

inline constexpr double logged_rate = 200; ///< Hz

/// A form in which a logger may write the same motion.
struct Logged {
    char delimiter, decimal;
    std::string time, force, rate; ///< unit or form; force "?": not stated; rate "": not recorded
    bool has_names;

    bool has_dates() const { return time.starts_with("epoch") || time.starts_with("da"); }
    bool needs_rate() const { return time == "count" || time == "none"; }
    bool is_possible() const {
        if (delimiter == ',' && decimal == ',') return false;
        if (delimiter == ' ' && (time == "date" || time == "date Z")) return false; // two cells
        return has_names || (has_dates() && rate.empty() && force == "?") ||
               (needs_rate() && rate.empty() && force == "?");
    }
    /// What the user has to add; nothing.
    std::string axes() const { return ""; }
};

inline std::string with_comma(double x) {
    std::string text = fmt::format("{}", x);
    std::ranges::replace(text, '.', ',');
    return text;
}

inline Vec3 logged_force(int k) {
    return {0.5 + 0.1 * std::sin(0.4 * k), -0.25, standard_gravity + 0.5 * std::cos(0.9 * k)};
}
inline Vec3 logged_rates(int k) { return {0.01 * k, -0.5, std::sin(0.3 * k)}; }

/// Cells of the time of a sample; begins on 2024-05-07 at 10:00:00.
inline std::vector<std::string> logged_time_of(const Logged& form, int k) {
    const long long micros = 5000LL * k;
    const auto count = [](long long n) { return fmt::format("{}", n); };
    constexpr long long epoch = 1715076000; // s
    const std::string clock =
        fmt::format("10:00:{:02}{}{:03}", micros / 1000000, form.decimal, micros / 1000 % 1000);
    if (form.time == "s") return {fmt::format("{:.3f}", 1e-6 * static_cast<double>(micros))};
    if (form.time == "ms") return {count(micros / 1000)};
    if (form.time == "us") return {count(micros)};
    if (form.time == "ns") return {count(1000 * micros)};
    if (form.time == "epoch s")
        return {fmt::format("{}.{:03}", epoch + micros / 1000000, micros / 1000 % 1000)};
    if (form.time == "epoch ms") return {count(1000 * epoch + micros / 1000)};
    if (form.time == "epoch us") return {count(1000000 * epoch + micros)};
    if (form.time == "epoch ns") return {count(1000000000 * epoch + 1000 * micros)};
    if (form.time == "date") return {"2024-05-07 " + clock};
    if (form.time == "date T") return {"2024-05-07T" + clock};
    if (form.time == "date Z") return {"2024-05-07 " + clock + "Z"};
    if (form.time == "day and time") return {"07.05.2024", clock};
    if (form.time == "count") return {count(1000 + k)};
    return {};
}

inline std::vector<std::string> logged_names(const Logged& form) {
    const auto unit = [](const std::string& u) { return u == "?" ? "" : " [" + u + "]"; };
    std::vector<std::string> names;
    if (form.time == "day and time")
        names = {"Date", "Clock"};
    else if (form.time == "count")
        names = {"sample"};
    else if (form.time != "none")
        names = {form.has_dates() ? "Timestamp" : "Time (" + form.time + ")"};
    for (const char axis : {'x', 'y', 'z'})
        names.push_back(fmt::format("Acc {}{}", axis, unit(form.force)));
    if (!form.rate.empty())
        for (const char axis : {'x', 'y', 'z'})
            names.push_back(fmt::format("Gyro {} ({})", axis, form.rate));
    return names;
}

/// The file.
inline std::string logged_text(const Logged& form, int samples) {
    const double per_force = form.force == "g"    ? 1 / standard_gravity
                             : form.force == "mg" ? 1000 / standard_gravity
                                                  : 1,
                 per_rate = form.rate == "deg/s" ? 180 / pi : 1;
    std::string text;
    const auto add = [&](const std::vector<std::string>& cells, bool is_names) {
        for (std::size_t c = 0; c < cells.size(); ++c) {
            const bool is_quoted = is_names && form.delimiter == ' ';
            if (c > 0) text += form.delimiter;
            text += is_quoted ? "\"" + cells[c] + "\"" : cells[c];
        }
        text += "\n";
    };
    if (form.has_names) add(logged_names(form), true);
    for (int k = 0; k < samples; ++k) {
        auto cells = logged_time_of(form, k);
        const std::size_t numbers = form.has_dates() && form.time[0] == 'd' ? cells.size() : 0;
        for (const double x : logged_force(k)) cells.push_back(fmt::format("{}", per_force * x));
        if (!form.rate.empty())
            for (const double x : logged_rates(k)) cells.push_back(fmt::format("{}", per_rate * x));
        for (std::size_t c = numbers; c < cells.size(); ++c)
            if (form.decimal == ',') std::ranges::replace(cells[c], '.', ',');
        add(cells, false);
    }
    return text;
}

/// Where a recording differs from what was written; "": nowhere.
inline std::string difference_from_logged(const Recording& r, const Logged& form) {
    if (std::abs(r.info.sampling_rate / logged_rate - 1) > 1e-4)
        return fmt::format("{} Hz", r.info.sampling_rate);
    if (r.rate.empty() != form.rate.empty()) return "rates";
    if (form.has_dates() && std::abs(r.time[0] - 1715076000) > 1e-6)
        return fmt::format("begins at {}", r.time[0]);
    for (std::size_t k = 0; k < r.size(); ++k) {
        const int n = static_cast<int>(k);
        if (std::abs(r.time[k] - r.time[0] - static_cast<double>(k) / logged_rate) > 1e-6)
            return fmt::format("time {}", k);
        if ((r.force[k] - logged_force(n)).norm() > 1e-12) return fmt::format("force {}", k);
        if (!r.rate.empty() && (r.rate[k] - logged_rates(n)).norm() > 1e-12)
            return fmt::format("rate {}", k);
    }
    return "";
}

} // namespace bris::testing
