#include "scenarios/stream/log_replay.hpp"

#include "engine/interrupt.hpp"

#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

namespace bris {

LogReplay::LogReplay(const std::filesystem::path& path, double speed, std::uint64_t until)
    : reader_(path, until), speed_(speed), coming_(reader_.next()) {
    if (coming_) first_ = coming_->arrival;
}

std::optional<LogEntry> LogReplay::next(double timeout) {
    const Instant called = this_instant();
    const auto due = [&] { // so is what has no arrival
        return speed_ <= 0 || !(coming_->arrival - first_ > speed_ * seconds_since(began_));
    };
    while (coming_ && !due()) {
        if (interrupted() || seconds_since(called) >= timeout) return {};
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    if (!coming_) return {};
    auto entry = std::exchange(coming_, reader_.next());
    const bool came =
        entry->kind != LogEntry::Kind::published && entry->kind != LogEntry::Kind::session;
    if (came && !std::isnan(entry->arrival)) now_ = entry->arrival;
    return entry;
}

} // namespace bris
