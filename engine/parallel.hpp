#pragma once

#include "engine/team.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

namespace bris {

/// The threads of one simulation. All parallel loops of BRIS run through this class: on std::thread
/// with BRIS_STD_THREADS (for the thread sanitizer), otherwise on a oneTBB arena.
class Threads {
public:
    /// `count`: number of threads; 0: all cores.
    explicit Threads(unsigned count);
    ~Threads();
    Threads(const Threads&) = delete;
    unsigned count() const { return count_; }
    /// Runs `work` with this team; loops inside it use these threads only.
    void run(const std::function<void()>& work);

private:
    struct Arena;
    unsigned count_;
    std::unique_ptr<Arena> arena_;
};

/// Number of threads that a loop started at this point runs on.
unsigned team_size();

/// While it exists, loops do not use the team of Threads::run, but the tasks of several threads
/// that run loops at once.
class ManyLeaders {
public:
    ManyLeaders();
    ~ManyLeaders();
    ManyLeaders(const ManyLeaders&) = delete;

private:
    detail::Team* team_;
};

namespace detail {
void run_chunks(std::size_t chunks, ChunkBody body, void* context);
} // namespace detail

/// Calls body(chunk, first, last) for chunks of `grain` rows, in any order and on any thread. The
/// division into chunks depends on n and grain only. A body must write only what belongs to its
/// rows or its chunk.
template <class Body>
void for_chunks(std::size_t n, std::size_t grain, Body&& body) {
    const std::size_t chunks = (n + grain - 1) / grain;
    struct Context {
        std::size_t n, grain;
        Body& body;
    } context{n, grain, body};
    detail::run_chunks(
        chunks,
        [](void* p, std::size_t chunk) {
            auto& c = *static_cast<Context*>(p);
            const std::size_t first = chunk * c.grain;
            c.body(chunk, first, first + c.grain < c.n ? first + c.grain : c.n);
        },
        &context);
}

/// Calls body(row) for n rows, in any order and on any thread. A body must write only what belongs
/// to its row.
template <class Body>
void for_rows(std::size_t n, Body&& body) {
    for_chunks(n, 1024, [&](std::size_t, std::size_t first, std::size_t last) {
        for (std::size_t row = first; row < last; ++row) body(static_cast<std::uint32_t>(row));
    });
}

} // namespace bris
