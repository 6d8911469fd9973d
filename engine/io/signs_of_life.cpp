#include "engine/io/signs_of_life.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace bris {

namespace {

constexpr std::size_t longest_name = 60;

std::string topic_of(const std::string& run) {
    std::string name = run.substr(0, longest_name);
    std::ranges::replace_if(
        name,
        [](char c) {
            return !(('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || ('0' <= c && c <= '9') ||
                     std::string_view("-_.").find(c) != std::string_view::npos);
        },
        '_');
    return "bris/run/" + name;
}

/// JSON has no NaN.
nlohmann::json number(double x, double parts_of_one) {
    return std::isfinite(x) ? nlohmann::json(std::round(x * parts_of_one) / parts_of_one)
                            : nlohmann::json();
}

} // namespace

SignsOfLife::SignsOfLife(const std::string& run) : topic_(topic_of(run)) {}

void SignsOfLife::report(const std::string& doing, double left) {
    const std::lock_guard lock(mutex_);
    doing_ = doing;
    left_ = left;
    reported_ = signed_ = this_instant();
}

void SignsOfLife::sign() {
    const std::lock_guard lock(mutex_);
    signed_ = this_instant();
}

void SignsOfLife::end() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
}

bool SignsOfLife::is_due() const {
    const std::lock_guard lock(mutex_);
    return beats_ == 0 || seconds_since(beaten_) >= interval;
}

std::string SignsOfLife::heartbeat(double time, bool last) {
    const std::lock_guard lock(mutex_);
    if (beats_++ == 0) began_ = time;
    beaten_ = this_instant();
    const double left = std::max(0.0, left_ - seconds_since(reported_));
    return nlohmann::json{{"state", !last    ? "running"
                                    : ended_ ? "ended"
                                             : "stopped"},
                          {"time", number(time, 1000)},
                          {"began", number(began_, 1000)},
                          {"beat", beats_},
                          {"doing", doing_},
                          {"left_s", number(std::isnan(left_) ? left_ : left, 10)},
                          {"silent_s", number(seconds_since(signed_), 10)}}
        .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

} // namespace bris
