#pragma once

#include "engine/stopwatch.hpp"
#include "engine/team.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace bris {

/// Times the parallel loops that a thread starts: what they would take on processors that this
/// machine does not have. While it exists, they run on this thread alone, but in the chunks of its
/// team.
class LoopTimes {
public:
    LoopTimes();
    ~LoopTimes();
    LoopTimes(const LoopTimes&) = delete;

    /// Wall time (s) outside of loops of more than one chunk, from the first loop to the last.
    double outside() const { return outside_; }
    /// Wall time (s) of each chunk, loop after loop.
    const std::vector<std::vector<double>>& loops() const { return loops_; }

    /// Runs a loop of more than one chunk if this thread is being timed; otherwise returns false.
    static bool run(std::size_t chunks, detail::ChunkBody body, void* context);

private:
    void time(std::size_t chunks, detail::ChunkBody body, void* context);

    std::vector<std::vector<double>> loops_;
    Instant ended_; ///< the last loop
    double outside_ = 0;
    bool inside_ = false; ///< of a chunk
    LoopTimes* before_;
};

/// Time (s) from the beginning of a loop until its last chunk is done, if `threads` >= 1 threads of
/// equal speed take chunks as in detail::Division and lose no time to each other.
double time_on_threads(std::span<const double> chunk_seconds, unsigned threads);

} // namespace bris
