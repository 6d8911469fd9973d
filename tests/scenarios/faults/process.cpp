#include "tests/scenarios/faults/process.hpp"

#include "engine/io/whole_file.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <fcntl.h>
#include <linux/close_range.h>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace bris {

namespace {

double now() {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void redirect(int stream, const std::filesystem::path& file, int flags) {
    const int opened = open(file.c_str(), flags, 0600);
    dup2(opened, stream);
    close(opened);
}

} // namespace

Process::Process(const std::vector<std::string>& words, const std::function<bool()>& prepare)
    : began_(now()) {
    std::vector<std::string> command = words;
    command.front() = std::string(BRIS_BINARIES "/") + command.front();
    std::vector<char*> pointers;
    for (std::string& word : command) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    const auto out = folder_ / "out", err = folder_ / "err";
    int begun[2];
    if (pipe(begun) != 0) throw std::runtime_error("no pipe");
    id_ = fork();
    if (id_ != 0) {
        close(begun[1]);
        begun_ = begun[0];
        return;
    }
    redirect(STDIN_FILENO, "/dev/null", O_RDONLY);
    redirect(STDOUT_FILENO, out, O_WRONLY | O_CREAT);
    redirect(STDERR_FILENO, err, O_WRONLY | O_CREAT);
    // what the starter of the tests left open, and the pipe
    close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
    if (!prepare || prepare()) execv(pointers[0], pointers.data());
    _exit(127);
}

Process::~Process() {
    close(begun_);
    if (ended_) return;
    kill(id_, SIGKILL);
    waitpid(id_, nullptr, 0);
}

void Process::send(int signal) const {
    char none = 0; // the other end is closed when the program begins, or does not
    while (read(begun_, &none, 1) < 0 && errno == EINTR) {
    }
    kill(id_, signal);
}

Outcome Process::wait(double seconds) {
    int status = 0;
    bool hung = false;
    rusage used{};
    while (wait4(id_, &status, hung ? 0 : WNOHANG, &used) == 0) {
        hung = now() - began_ > seconds;
        if (hung)
            kill(id_, SIGKILL);
        else
            usleep(1000);
    }
    Outcome outcome = ended(status, hung);
    for (const timeval& time : {used.ru_utime, used.ru_stime})
        outcome.processor_time +=
            static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    return outcome;
}

double Process::processor_time() const {
    clockid_t clock{};
    timespec used{};
    if (clock_getcpuclockid(id_, &clock) != 0 || clock_gettime(clock, &used) != 0) return 0;
    return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

Outcome Process::ended(int status, bool hung) {
    ended_ = true;
    Outcome outcome;
    outcome.hung = hung;
    outcome.seconds = now() - began_;
    if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
    outcome.out = read_whole(folder_ / "out");
    outcome.err = read_whole(folder_ / "err");
    return outcome;
}

Outcome run_process(const std::vector<std::string>& words, const std::function<bool()>& prepare,
                    double seconds) {
    return Process(words, prepare).wait(seconds);
}

bool is_one_line_of(const std::string& text, const std::string& program) {
    return text.starts_with(program + ": ") && text.ends_with('\n') &&
           std::ranges::count(text, '\n') == 1;
}

} // namespace bris
