#include "engine/interrupt.hpp"

#include <atomic>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <unistd.h>

namespace bris {

namespace {

// a signal handler can only access static data; lock-free, so that both the handler and threads may
// use it
std::atomic<int> requests{0};
std::atomic<std::int64_t> first_request{0}; // s
static_assert(std::atomic<std::int64_t>::is_always_lock_free);

constexpr std::int64_t patience = 5; // s; queueing systems send a signal twice at once

extern "C" void ask_to_stop(int signal) {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    std::int64_t first = 0; // two threads may handle two signals at once
    if (first_request.compare_exchange_strong(first, now.tv_sec)) first = now.tv_sec;
    const bool is_again = requests.fetch_add(1) > 0, is_impatient = now.tv_sec - first >= patience;
    if (is_again && (signal == SIGINT || (signal == SIGTERM && is_impatient))) _exit(130);
}

} // namespace

void catch_interrupts() {
    struct sigaction action {};
    action.sa_handler = ask_to_stop;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART; // a write in progress is completed and does not fail
    for (const int signal : {SIGINT, SIGTERM, SIGUSR1, SIGXCPU})
        sigaction(signal, &action, nullptr);
    // under nohup a run goes on when its terminal is closed
    if (struct sigaction before{};
        sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler != SIG_IGN)
        sigaction(SIGHUP, &action, nullptr);
    // a file beyond the limit of its size is an error of that write
    action.sa_handler = SIG_IGN;
    sigaction(SIGXFSZ, &action, nullptr);
}

bool interrupted() { return requests.load(std::memory_order_relaxed) > 0; }

} // namespace bris
