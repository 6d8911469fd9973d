#include "engine/loop_times.hpp"

#include <algorithm>
#include <utility>

namespace bris {

namespace {
thread_local LoopTimes* timing = nullptr;
} // namespace

LoopTimes::LoopTimes() : before_(std::exchange(timing, this)) {}
LoopTimes::~LoopTimes() { timing = before_; }

bool LoopTimes::run(std::size_t chunks, detail::ChunkBody body, void* context) {
    if (timing == nullptr) return false;
    timing->time(chunks, body, context);
    return true;
}

void LoopTimes::time(std::size_t chunks, detail::ChunkBody body, void* context) {
    Instant began = this_instant();
    const bool is_first = loops_.empty(), is_inner = inside_; // a loop in a chunk is part of it
    if (!is_first && !is_inner) outside_ += std::chrono::duration<double>(began - ended_).count();
    std::vector<double> seconds(chunks);
    struct Inside { // until the end of the loop, however it ends
        bool &now, before;
        ~Inside() { now = before; }
    } inside{inside_, std::exchange(inside_, true)};
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        body(context, chunk);
        const Instant ended = this_instant();
        seconds[chunk] = std::chrono::duration<double>(ended - std::exchange(began, ended)).count();
    }
    if (is_inner) return;
    loops_.push_back(std::move(seconds));
    ended_ = this_instant();
}

double time_on_threads(std::span<const double> chunk_seconds, unsigned threads) {
    struct Part {
        std::size_t first, last;
        double busy = 0; ///< s, until its thread is free
    };
    std::vector<Part> parts;
    for (std::size_t t = 0; t < threads; ++t)
        parts.push_back(
            {chunk_seconds.size() * t / threads, chunk_seconds.size() * (t + 1) / threads});
    for (std::size_t left = chunk_seconds.size(); left > 0; --left) {
        const auto own = std::ranges::min_element(parts, {}, &Part::busy);
        auto from = own;
        while (from->first == from->last) from = from + 1 == parts.end() ? parts.begin() : from + 1;
        own->busy += chunk_seconds[from == own ? from->first++ : --from->last];
    }
    return std::ranges::max(parts, {}, &Part::busy).busy;
}

} // namespace bris
