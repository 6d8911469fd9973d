#include "engine/child_program.hpp"

#include "engine/errors.hpp"
#include "engine/stopwatch.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>

namespace bris {

namespace {

constexpr auto glance = std::chrono::milliseconds(20);
constexpr double longest_end = 20; // s

pid_t start(const std::vector<std::string>& words, const ChildProgram::Settings& s) {
    std::vector<std::string> copies = words;
    std::vector<char*> pointers;
    for (std::string& word : copies) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t streams;
    posix_spawn_file_actions_init(&streams);
    if (s.input >= 0) posix_spawn_file_actions_adddup2(&streams, s.input, STDIN_FILENO);
    if (s.output >= 0) posix_spawn_file_actions_adddup2(&streams, s.output, STDOUT_FILENO);
    if (s.is_silent)
        posix_spawn_file_actions_addopen(&streams, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    if (s.own_group) posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    std::signal(SIGCHLD, SIG_DFL); // were it ignored, the exit code would be lost
    pid_t id = 0;
    const int error =
        posix_spawnp(&id, pointers[0], &streams, &attributes, pointers.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&streams);
    if (error != 0)
        throw OutputError(fmt::format("cannot start '{}': {}", words[0], std::strerror(error)));
    return id;
}

} // namespace

std::filesystem::path this_program() {
    std::error_code error;
    return std::filesystem::read_symlink("/proc/self/exe", error);
}

ChildProgram::ChildProgram(const std::vector<std::string>& words, const Settings& settings)
    : cleanup_([this] { send(SIGTERM); }) {
    id_ = start(words, settings);
}

void ChildProgram::note_end(int status) {
    id_ = 0;
    code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

bool ChildProgram::runs() {
    int status = 0;
    if (id_ > 0 && waitpid(id_, &status, WNOHANG) == id_) note_end(status);
    return id_ > 0;
}

int ChildProgram::wait() {
    int status = 0;
    while (id_ > 0)
        if (waitpid(id_, &status, 0) == id_)
            note_end(status);
        else if (errno != EINTR)
            id_ = 0;
    return code_;
}

void ChildProgram::send(int signal) const {
    const pid_t id = id_;
    if (id > 0) kill(id, signal);
}

ChildProgram::~ChildProgram() {
    if (!runs()) return;
    send(SIGTERM);
    const Instant began = this_instant();
    while (runs() && seconds_since(began) < longest_end) std::this_thread::sleep_for(glance);
    if (!runs()) return;
    send(SIGKILL);
    (void)wait();
}

} // namespace bris
