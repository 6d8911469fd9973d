#include "engine/parallel.hpp"

#include "engine/loop_times.hpp"

#include <thread>
#include <utility>

#ifdef BRIS_STD_THREADS
#include <atomic>
#include <memory>
#include <vector>
#else
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>
#endif

namespace bris {

namespace {

unsigned all_cores() {
    const unsigned n = std::thread::hardware_concurrency();
    return n == 0 ? 1 : n;
}

/// The team whose leader this thread is, unless it is working on a loop.
thread_local detail::Team* led = nullptr;

/// Changes the team that this thread leads, and restores it at the end of the scope.
class Lead {
public:
    explicit Lead(detail::Team* team) : before_(std::exchange(led, team)) {}
    ~Lead() { led = before_; }
    Lead(const Lead&) = delete;

private:
    detail::Team* before_;
};

/// Does something at the end of a scope, however it ends.
template <class Do>
struct AtEnd {
    Do do_it;
    ~AtEnd() { do_it(); }
};
template <class Do>
AtEnd(Do) -> AtEnd<Do>;

/// Lets the team run the chunks, if there is one.
bool run_with_team(std::size_t chunks, detail::ChunkBody body, void* context) {
    detail::Team* const team = led;
    if (team == nullptr) return false;
    const ManyLeaders nobody; // a loop inside a chunk must not use the team
    team->run(chunks, body, context);
    return true;
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
    struct Helper {
        std::shared_ptr<std::atomic<bool>> has_left;
        std::jthread thread;
    };
    std::vector<Helper> helpers;
    detail::Team others(count_, [&](const auto& help) {
        std::erase_if(helpers, [](const Helper& helper) { return helper.has_left->load(); });
        auto has_left = std::make_shared<std::atomic<bool>>(false);
        helpers.push_back({has_left, std::jthread([help, has_left] {
                               help();
                               *has_left = true;
                           })});
    });
    const AtEnd dismiss{[&] {
        others.leave();
        helpers.clear(); // joins them
        team = 1;
    }};
    const Lead lead(count_ > 1 ? &others : nullptr);
    work();
}

unsigned team_size() { return team; }

void detail::run_chunks(std::size_t chunks, ChunkBody body, void* context) {
    if (chunks > 1 &&
        (LoopTimes::run(chunks, body, context) || run_with_team(chunks, body, context)))
        return;
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) body(context, chunk);
}

#else

struct Threads::Arena {
    explicit Arena(unsigned count) : arena(static_cast<int>(count)) {
        // More threads than cores may be requested, to test that nothing depends on the division.
        // Set once for the process, since the lowest of several limits would hold.
        static const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism,
                                                 4096);
    }
    tbb::task_arena arena;
};

Threads::Threads(unsigned count)
    : count_(count == 0 ? all_cores() : count), arena_(std::make_unique<Arena>(count_)) {}
Threads::~Threads() = default;

void Threads::run(const std::function<void()>& work) {
    arena_->arena.execute([&] {
        if (count_ == 1) return work();
        tbb::task_group helpers;
        detail::Team team(count_, [&](const auto& help) { helpers.run(help); });
        const AtEnd dismiss{[&] {
            team.leave();
            helpers.wait();
        }};
        const Lead lead(&team);
        work();
    });
}

unsigned team_size() { return static_cast<unsigned>(tbb::this_task_arena::max_concurrency()); }

void detail::run_chunks(std::size_t chunks, ChunkBody body, void* context) {
    if (chunks > 1 && LoopTimes::run(chunks, body, context)) return;
    if (chunks <= 1 || team_size() == 1) {
        for (std::size_t chunk = 0; chunk < chunks; ++chunk) body(context, chunk);
        return;
    }
    if (run_with_team(chunks, body, context)) return;
    // isolated, because a thread that waits here must not start work of another system
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) { body(context, chunk); });
    });
}

#endif

ManyLeaders::ManyLeaders() : team_(std::exchange(led, nullptr)) {}
ManyLeaders::~ManyLeaders() { led = team_; }

} // namespace bris
