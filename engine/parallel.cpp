#include "engine/parallel.hpp"

#include <algorithm>
#include <thread>

#ifdef BRIS_STD_THREADS
#include <atomic>
#include <vector>
#else
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#endif

namespace bris {

namespace {

unsigned all_cores() {
    const unsigned n = std::thread::hardware_concurrency();
    return n == 0 ? 1 : n;
}

} // namespace

#ifdef BRIS_STD_THREADS

struct Threads::Arena {};

namespace {
std::atomic<unsigned> team{1}; // the sanitizer build supports one team at a time
}

Threads::Threads(unsigned count) : count_(count == 0 ? all_cores() : count) {}
Threads::~Threads() = default;

void Threads::run(const std::function<void()>& work) {
    team = count_;
    work();
    team = 1;
}

unsigned team_size() { return team; }

void detail::run_chunks(std::size_t chunks, ChunkBody body, void* context) {
    const std::size_t workers = chunks < team ? chunks : team.load();
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t chunk; (chunk = next.fetch_add(1)) < chunks;) body(context, chunk);
    };
    std::vector<std::thread> threads;
    for (std::size_t i = 1; i < workers; ++i) threads.emplace_back(work);
    work();
    for (auto& thread : threads) thread.join();
}

#else

struct Threads::Arena {
    explicit Arena(unsigned count) : arena(static_cast<int>(count)) {
        // More threads than cores may be requested, to test that nothing depends on their number.
        // Set once for the process, since the lowest of several limits would hold.
        static const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism,
                                                 4096);
    }
    tbb::task_arena arena;
};

Threads::Threads(unsigned count)
    : count_(count == 0 ? all_cores() : count), arena_(std::make_unique<Arena>(count_)) {}
Threads::~Threads() = default;

void Threads::run(const std::function<void()>& work) { arena_->arena.execute(work); }

unsigned team_size() { return static_cast<unsigned>(tbb::this_task_arena::max_concurrency()); }

void detail::run_chunks(std::size_t chunks, ChunkBody body, void* context) {
    if (chunks <= 1 || team_size() == 1) {
        for (std::size_t chunk = 0; chunk < chunks; ++chunk) body(context, chunk);
        return;
    }
    // isolated, because a thread that waits here must not start work of another system
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, chunks, 1),
            [&](const tbb::blocked_range<std::size_t>& range) {
                for (std::size_t chunk = range.begin(); chunk < range.end(); ++chunk)
                    body(context, chunk);
            },
            tbb::auto_partitioner{});
    });
}

#endif

} // namespace bris
