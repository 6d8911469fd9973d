#include "engine/interrupt.hpp"

#include "engine/printable.hpp"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <mutex>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <unistd.h>
#include <utility>

namespace bris {

namespace {

constexpr double grace = 0.3;                           // s, for an end in order
constexpr double patience = 1.5, longest_patience = 10; // s, of processor time and by the clock
constexpr double until_again = 5;   // s; queueing systems send a signal twice at once
constexpr long glance = 10'000'000; // ns
constexpr int exit_code = 130;

constexpr std::array requests_to_stop{SIGINT, SIGTERM, SIGUSR1, SIGXCPU, SIGHUP};

// A signal handler can only access static data; lock-free, so that both the handler and threads may
// use it.
std::atomic<int> requests{0};
std::atomic<std::int64_t> first_request{0}; // ns
std::atomic<bool> at_once{false};
std::atomic<pid_t> watched{0}; // process in which the watching thread runs
std::atomic<int> runs_to_save{0}, runs_that_save{0};
static_assert(std::atomic<std::int64_t>::is_always_lock_free);
sem_t asked; // posted by each request

std::int64_t nanoseconds(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}

double seconds(clockid_t clock) { return 1e-9 * static_cast<double>(nanoseconds(clock)); }

extern "C" void ask_to_stop(int signal) {
    if (watched != getpid()) _exit(exit_code); // a child process: nobody watches it
    const std::int64_t now = nanoseconds(CLOCK_MONOTONIC);
    std::int64_t first = 0; // two threads may handle two signals at once
    if (first_request.compare_exchange_strong(first, now)) first = now;
    const bool is_again = requests.fetch_add(1) > 0,
               is_late = 1e-9 * static_cast<double>(now - first) >= until_again;
    if (is_again && (signal == SIGINT || (signal == SIGTERM && is_late))) at_once = true;
    sem_post(&asked);
}

/// What the end of the program needs. Never destroyed, because the thread that watches may look at
/// it while the program ends.
struct Ending {
    std::mutex mutex; // of all below
    std::list<std::function<void()>> cleanups;
    std::string program, how_to_continue;
    bool is_caught = false, is_silent = false;
    std::array<struct sigaction, requests_to_stop.size() + 1> before{};
};
Ending& ending() {
    static auto& all = *new Ending;
    return all;
}

/// Writes to a stream of the system, unless nobody takes it: then it would wait for ever.
void write_if_taken(int stream, const std::string& text) {
    pollfd ready{stream, POLLOUT, 0};
    if (poll(&ready, 1, 0) == 1 && (ready.revents & POLLOUT) != 0)
        (void)!write(stream, text.data(), text.size());
}

[[noreturn]] void end_program() {
    Ending& e = ending();
    e.mutex.lock(); // for good: files that are renamed or removed meanwhile wait
    for (const auto& action : e.cleanups) action();
    const char* const why =
        runs_to_save > 0 ? " before its state could be saved; its last checkpoint, if there is "
                           "one, is some 30 s old"
                         : "";
    const std::string line =
        printable(fmt::format("{}: interrupted{}{}{}", e.program, why,
                              e.how_to_continue.empty() ? "" : "; ", e.how_to_continue));
    if (!e.is_silent)
        write_if_taken(STDERR_FILENO,
                       fmt::format("{}{}\n", isatty(STDERR_FILENO) != 0 ? "\n" : "", line));
    // what was printed into a pipe or a file is in a buffer, whose owner may wait for its reader
    if (pollfd ready{STDOUT_FILENO, POLLOUT, 0};
        poll(&ready, 1, 0) == 1 && ready.revents == POLLOUT && ftrylockfile(stdout) == 0)
        std::fflush(stdout);
    _exit(exit_code);
}

/// Time since a run was last seen to save, or since there was something to save or not.
class Wait {
public:
    bool is_over() {
        const bool saves = runs_that_save > 0, has_state = runs_to_save > 0;
        if (saves || has_state != has_state_) *this = Wait(has_state);
        const double waited = seconds(CLOCK_MONOTONIC) - since_,
                     used = seconds(CLOCK_PROCESS_CPUTIME_ID) - used_;
        if (saves) return false;
        if (!has_state) return waited >= grace;
        return (waited >= patience && used >= patience) || waited >= longest_patience;
    }
    explicit Wait(bool has_state) : has_state_(has_state) {}

private:
    bool has_state_;
    double since_ = seconds(CLOCK_MONOTONIC), used_ = seconds(CLOCK_PROCESS_CPUTIME_ID);
};

void* watch(void*) {
    while (sem_wait(&asked) != 0) {
    }
    for (Wait wait(runs_to_save > 0);;) {
        const bool is_caught = [] {
            const std::lock_guard lock(ending().mutex);
            return ending().is_caught;
        }();
        if (is_caught && (at_once || wait.is_over())) end_program();
        const timespec interval{0, glance};
        nanosleep(&interval, nullptr);
    }
}

void begin_to_watch() {
    if (watched == getpid()) return;
    sem_init(&asked, 0, 0);
    pthread_attr_t small;
    pthread_attr_init(&small);
    pthread_attr_setstacksize(&small, 1 << 20);
    pthread_attr_setdetachstate(&small, PTHREAD_CREATE_DETACHED);
    pthread_t thread{};
    // without a thread the first signal ends the program
    if (pthread_create(&thread, &small, watch, nullptr) == 0) watched = getpid();
    pthread_attr_destroy(&small);
}

} // namespace

CatchInterrupts::CatchInterrupts(const std::string& program) {
    begin_to_watch();
    Ending& e = ending();
    const std::lock_guard lock(e.mutex);
    e.program = program;
    e.is_caught = true;
    struct sigaction action {};
    action.sa_handler = ask_to_stop;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART; // a write in progress is completed and does not fail
    for (std::size_t k = 0; k < requests_to_stop.size(); ++k) {
        sigaction(requests_to_stop[k], nullptr, &e.before[k]);
        // under nohup a run goes on when its terminal is closed
        if (requests_to_stop[k] == SIGHUP && e.before[k].sa_handler == SIG_IGN) continue;
        sigaction(requests_to_stop[k], &action, nullptr);
    }
    // a file beyond the limit of its size is an error of that write
    action.sa_handler = SIG_IGN;
    sigaction(SIGXFSZ, &action, &e.before.back());
}

CatchInterrupts::~CatchInterrupts() {
    Ending& e = ending();
    const std::lock_guard lock(e.mutex);
    for (std::size_t k = 0; k < requests_to_stop.size(); ++k)
        sigaction(requests_to_stop[k], &e.before[k], nullptr);
    sigaction(SIGXFSZ, &e.before.back(), nullptr);
    e.is_caught = false;
}

void CatchInterrupts::be_silent() {
    const std::lock_guard lock(ending().mutex);
    ending().is_silent = true;
}

namespace {

/// The calls of other programs, of which several threads may make some at once.
struct Calls {
    std::mutex mutex;
    unsigned now = 0;
    struct sigaction before {};
};
Calls& calls() {
    static auto& all = *new Calls;
    return all;
}

extern "C" void note_request(int) { ++requests; }

} // namespace

InterruptibleCall::InterruptibleCall() {
    Calls& c = calls();
    const std::lock_guard lock(c.mutex);
    if (c.now++ > 0) return;
    struct sigaction action {};
    action.sa_handler = note_request;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, &c.before);
}

InterruptibleCall::~InterruptibleCall() {
    Calls& c = calls();
    const std::lock_guard lock(c.mutex);
    if (--c.now > 0) return;
    sigaction(SIGINT, &c.before, nullptr);
    if (requests.exchange(0) > 0) raise(SIGINT);
}

bool interrupted() { return requests.load(std::memory_order_relaxed) > 0; }

std::string how_to_continue() {
    const std::lock_guard lock(ending().mutex);
    return ending().how_to_continue;
}

SavesWhenInterrupted::SavesWhenInterrupted(std::string continuation)
    : continuation_(std::move(continuation)) {
    ++runs_to_save;
}

SavesWhenInterrupted::~SavesWhenInterrupted() {
    if (interrupted()) {
        const std::lock_guard lock(ending().mutex);
        ending().how_to_continue = std::move(continuation_);
    }
    --runs_to_save;
}

Saving::Saving() { ++runs_that_save; }
Saving::~Saving() { --runs_that_save; }

Cleanup::Cleanup(std::function<void()> action) {
    Ending& e = ending();
    const std::lock_guard lock(e.mutex);
    place_ = e.cleanups.insert(e.cleanups.begin(), std::move(action)); // the newest first
}

Cleanup::~Cleanup() {
    Ending& e = ending();
    const std::lock_guard lock(e.mutex);
    e.cleanups.erase(place_);
}

} // namespace bris
