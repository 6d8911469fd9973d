#include "engine/io/limited_child.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <exception>
#include <fcntl.h>
#include <fstream>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

#ifdef BRIS_SANITIZED
extern "C" { // of the sanitizers; g++ 12 does not install their <sanitizer/allocator_interface.h>
std::size_t __sanitizer_get_current_allocated_bytes();
int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void*,
                                                                  std::size_t),
                                              void (*free_hook)(const volatile void*));
}
#endif

namespace bris {

namespace {

constexpr int failed = 1, out_of_memory = 2; // exit codes of the child
constexpr std::size_t pipe_size = 1 << 16;   // bytes
constexpr int longest_wait = 120;            // s, for files on a system that does not answer
constexpr unsigned most_children = 3;

/// Processor time of a process, s.
double processor_time(pid_t process) {
    clockid_t clock{};
    timespec used{};
    if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &used) != 0) return 0;
    return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

#ifdef BRIS_SANITIZED
// The shadow of a sanitizer is address space, so its allocator is asked instead.
std::size_t most_allocated = 0;

void limit_memory_of_child(std::uint64_t bytes) {
    most_allocated = __sanitizer_get_current_allocated_bytes() + bytes;
    const auto look = [](const volatile void*, std::size_t size) {
        if (size > most_allocated || __sanitizer_get_current_allocated_bytes() > most_allocated)
            _exit(out_of_memory);
    };
    __sanitizer_install_malloc_and_free_hooks(look, [](const volatile void*) {});
}
#else
void limit_memory_of_child(std::uint64_t bytes) {
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlim_t most = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE)) + bytes;
    const rlimit limit{most, most};
    setrlimit(RLIMIT_AS, &limit);
}
#endif

void restrict_child(const LimitedChild::Limits& limits) {
    // the parent hears requests to stop, and ends its children
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) std::signal(signal, SIG_IGN);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int nowhere = open("/dev/null", O_WRONLY); // a heap error is reported by the parent
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    // SIGXCPU at the first limit names the cause
    const rlimit no_core{0, 0}, time{limits.seconds, limits.seconds + 1};
    setrlimit(RLIMIT_CORE, &no_core);
    setrlimit(RLIMIT_CPU, &time);
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGXCPU})
        std::signal(signal, SIG_DFL);
    std::signal(SIGPIPE, SIG_IGN);
    limit_memory_of_child(limits.bytes);
}

} // namespace

void LimitedChild::Pipe::write(const void* data, std::size_t size) {
    const auto* next = static_cast<const char*>(data);
    while (size > 0) {
        const std::size_t part = std::min(size, pipe_size - waiting_.size());
        waiting_.insert(waiting_.end(), next, next + part);
        if (waiting_.size() == pipe_size) flush();
        next += part;
        size -= part;
    }
}

void LimitedChild::Pipe::flush() {
    for (std::size_t done = 0; done < waiting_.size();) {
        const ssize_t written =
            ::write(descriptor_, waiting_.data() + done, waiting_.size() - done);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) throw OutputError("the pipe is closed");
        done += static_cast<std::size_t>(written);
    }
    waiting_.clear();
}

LimitedChild::LimitedChild(const Limits& limits, Work work)
    : limits_(limits), work_(std::move(work)) {
    start();
}

void LimitedChild::start() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
        throw OutputError(fmt::format("cannot start a process: {}", std::strerror(errno)));
    ++started_;
    id_ = fork();
    if (id_ < 0) {
        const int why = errno;
        close(ends[0]);
        close(ends[1]);
        throw OutputError(fmt::format("cannot start a process: {}", std::strerror(why)));
    }
    if (id_ > 0) {
        close(ends[1]);
        pipe_ = ends[0];
        return;
    }
    close(ends[0]);
    restrict_child(limits_);
    try {
        Pipe to_parent(ends[1]);
        work_(to_parent);
        to_parent.flush();
    } catch (const std::exception&) {
        _exit(failed);
    }
    _exit(0); // without destructors and without writing the buffers that the parent will write
}

LimitedChild::~LimitedChild() {
    if (pipe_ >= 0) close(pipe_);
    if (id_ >= 0) end();
}

void LimitedChild::end() {
    kill(id_, SIGKILL);
    while (waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
    }
    id_ = -1;
}

void LimitedChild::read(void* data, std::size_t size) {
    auto* next = static_cast<char*>(data);
    while (size > 0) {
        if (taken_ == received_.size()) receive();
        const std::size_t part = std::min(size, received_.size() - taken_);
        std::memcpy(next, received_.data() + taken_, part);
        taken_ += part;
        next += part;
        size -= part;
    }
}

/// Waits until the child has sent something or has ended.
void LimitedChild::wait() {
    double used = 0;
    for (int seconds = 0; seconds < longest_wait;) {
        pollfd from_child{pipe_, POLLIN, 0};
        const int found = poll(&from_child, 1, 1000);
        if (found > 0) return;
        if (found < 0) continue; // a signal
        ++seconds;
        const double before = std::exchange(used, processor_time(id_));
        if (used - before > 1e-3 || has_sent_ || started_ == most_children) continue;
        end();
        close(std::exchange(pipe_, -1));
        start();
        used = 0;
    }
    end();
    throw OutputError(fmt::format("it takes more than {} s", longest_wait));
}

void LimitedChild::receive() {
    wait();
    received_.resize(pipe_size);
    ssize_t found = -1;
    do found = ::read(pipe_, received_.data(), received_.size());
    while (found < 0 && errno == EINTR);
    received_.resize(static_cast<std::size_t>(std::max<ssize_t>(found, 0)));
    taken_ = 0;
    has_sent_ = true;
    if (received_.empty()) throw OutputError(reason_of(wait_for_end()));
}

int LimitedChild::wait_for_end() {
    int status = 0;
    while (waitpid(id_, &status, 0) < 0)
        if (errno != EINTR) throw OutputError("its reader was lost");
    id_ = -1;
    return status;
}

std::string LimitedChild::reason_of(int status) const {
    if (WIFEXITED(status))
        return WEXITSTATUS(status) == out_of_memory || WEXITSTATUS(status) == failed
                   ? fmt::format("it needs more than {:.0f} MiB of memory",
                                 static_cast<double>(limits_.bytes) / 0x1p20)
                   : "its content is damaged: memory errors in the library that reads it";
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU) return fmt::format("it takes more than {} s", limits_.seconds);
    return fmt::format("its content is damaged: the library that reads it ended with signal {} "
                       "({})",
                       signal, strsignal(signal));
}

} // namespace bris
