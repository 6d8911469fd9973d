#include "scenarios/stream/sequence_track.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr std::int64_t longest_gap = 1 << 20; // samples
constexpr double longest_pause = 86400;       // s, of a sensor that sleeps between trains
constexpr double tolerance = 1;               // s, of the time of a sample
constexpr double longest_late = 10; // s, by which what contradicts a message is behind the last one
constexpr unsigned agreeing = 3;    // messages that follow each other, from which they are believed
constexpr std::uint64_t silence = 100; // messages of a second sensor after which the first is gone
constexpr std::size_t most_gaps = 64;

/// Whether `b` follows `a` without a gap.
bool follows(const SequenceTrack::Message& a, const SequenceTrack::Message& b) {
    const double expected = a.time + a.samples * a.interval;
    return b.sequence == a.sequence + a.samples && b.time >= a.time &&
           std::abs(b.time - expected) <= tolerance + a.samples * a.interval;
}

} // namespace

SequenceTrack::Verdict SequenceTrack::take(const Message& m) {
    if (!begun_) {
        begin_at(m);
        accept(m);
        return Verdict::accepted;
    }
    const std::int64_t ahead =
        static_cast<std::int32_t>(m.sequence - static_cast<std::uint32_t>(next_));
    const double jump = m.time - (last_time_ + static_cast<double>(ahead + 1) * m.interval);
    if (ahead >= 0 && ahead <= longest_gap && m.time >= last_time_ - tolerance &&
        jump >= -tolerance - 0.05 * static_cast<double>(ahead) * m.interval &&
        jump <= longest_pause) {
        if (ahead > 0) {
            ++counters_.gaps;
            counters_.missing += static_cast<std::uint64_t>(ahead);
            missing_.emplace_back(next_, next_ + ahead);
            if (missing_.size() > most_gaps) missing_.erase(missing_.begin());
            next_ += ahead;
        }
        counters_.pauses += static_cast<std::uint64_t>(jump > tolerance + m.interval);
        accept(m);
        return Verdict::accepted;
    }
    if (ahead < 0 && ahead >= -longest_gap && m.time <= last_time_ + tolerance) {
        if (fills_gap(next_ + ahead, next_ + ahead + m.samples)) {
            counters_.samples += m.samples;
            ++counters_.late;
            remember(m);
            return Verdict::late;
        }
        if (const Verdict verdict = known(m); verdict != Verdict::accepted) {
            ++(verdict == Verdict::duplicate ? counters_.duplicates : counters_.contradictions);
            return verdict;
        }
    }
    return unexpected(m);
}

void SequenceTrack::begin_at(const Message& m) {
    begun_ = true;
    next_ = m.sequence;
    missing_.clear();
    recent_count_ = 0;
    held_count_ = 0;
}

void SequenceTrack::accept(const Message& m) {
    next_ += m.samples;
    last_time_ = m.time + (m.samples - 1) * m.interval;
    counters_.samples += m.samples;
    ++accepted_since_held_;
    rivals_alone_ = 0;
    remember(m);
}

void SequenceTrack::remember(const Message& m) { recent_[recent_count_++ % recent_.size()] = m; }

/// Whether all of the samples are missing; then they are no longer.
bool SequenceTrack::fills_gap(std::int64_t from, std::int64_t to) {
    const auto gap = std::ranges::find_if(
        missing_, [&](const Interval& i) { return i.first <= from && to <= i.second; });
    if (gap == missing_.end()) return false;
    counters_.missing -= static_cast<std::uint64_t>(to - from);
    const Interval after{to, gap->second};
    gap->second = from;
    if (gap->first == gap->second) missing_.erase(gap);
    if (after.first < after.second) missing_.push_back(after);
    if (missing_.size() > most_gaps) missing_.erase(missing_.begin());
    return true;
}

/// What a message is by its sequence number, time and contents; accepted: it is not known, as after
/// a restart or a wrap.
SequenceTrack::Verdict SequenceTrack::known(const Message& m) const {
    const std::size_t count = std::min(recent_count_, recent_.size());
    Verdict verdict = Verdict::accepted;
    for (std::size_t k = 0; k < count; ++k) {
        const Message& before = recent_[k];
        if (before.sequence != m.sequence) continue;
        if (before.hash == m.hash) return Verdict::duplicate;
        if (m.time >= last_time_ - longest_late &&
            std::abs(before.time - m.time) <= m.samples * m.interval)
            verdict = Verdict::contradiction;
    }
    return verdict;
}

/// A message that continues nothing: the sensor has restarted, its clock has been set, or another
/// sensor sends with the same id. Only what follows can tell.
SequenceTrack::Verdict SequenceTrack::unexpected(const Message& m) {
    const bool continues = held_count_ > 0 && follows(held_, m);
    if (!continues) {
        counters_.forgotten += std::min<unsigned>(held_count_, agreeing - 1);
        held_count_ = 1;
        held_samples_ = m.samples;
        accepted_since_held_ = 0;
        held_ = m;
        return Verdict::held_anew;
    }
    held_ = m;
    ++held_count_;
    if (held_count_ < agreeing) {
        held_samples_ += m.samples;
        return Verdict::held;
    }
    if (accepted_since_held_ > 0 && ++rivals_alone_ < silence) { // beside the first sequence
        ++counters_.rivals;
        held_count_ = agreeing;
        return Verdict::rival;
    }
    ++counters_.restarts;
    counters_.samples += held_samples_;
    begin_at(m);
    accept(m);
    return Verdict::adopted;
}

} // namespace bris
