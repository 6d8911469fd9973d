#include "engine/interrupt.hpp"
#include "engine/io/unfinished_file.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/stopwatch.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <functional>
#include <optional>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

using namespace bris;

namespace {

void pause(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

[[noreturn]] void compute_for_ever() {
    for (volatile unsigned k = 0;;) k = k + 1;
}

/// Ends in order, as a run does that has saved its state.
void end_when_asked(double look_every = 0.01) {
    while (!interrupted()) pause(look_every);
    _exit(7);
}

/// A process that catches requests to stop while it works.
class Program {
public:
    explicit Program(const std::function<void()>& work) {
        int begun[2];
        REQUIRE(pipe(begun) == 0);
        id_ = fork();
        if (id_ == 0) {
            for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
                dup2(open("/dev/null", O_WRONLY), stream);
            const CatchInterrupts catching("test");
            (void)!write(begun[1], "b", 1);
            work();
            _exit(8);
        }
        char byte = 0;
        REQUIRE(read(begun[0], &byte, 1) == 1);
        close(begun[0]);
        close(begun[1]);
        pause(0.05);
    }
    ~Program() {
        kill(id_, SIGKILL);
        (void)waitpid(id_, nullptr, 0);
    }
    Program(const Program&) = delete;

    void send(int signal) {
        if (kill(id_, signal) == 0 && !sent_) sent_ = this_instant();
    }
    /// Exit code; -1: a signal ended it, or it did not end within `seconds`.
    int code(double seconds = 30) {
        const Instant began = this_instant();
        int status = 0;
        pid_t ended = 0;
        while ((ended = waitpid(id_, &status, WNOHANG)) == 0 && seconds_since(began) < seconds)
            pause(0.005);
        took_ = sent_ ? seconds_since(*sent_) : 0;
        return ended == id_ && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    double took() const { return took_; } ///< s, from the first signal to the end

private:
    pid_t id_ = 0;
    std::optional<Instant> sent_;
    double took_ = 0;
};

} // namespace

namespace {
volatile std::sig_atomic_t heard = 0;
}

TEST_SUITE("engine/interrupt") {
    TEST_CASE("a call of another program hears an interrupt, which that program gets afterwards") {
        struct sigaction own {
        }, before{};
        own.sa_handler = [](int) { heard = heard + 1; };
        sigaction(SIGINT, &own, &before);
        heard = 0;
        {
            const InterruptibleCall call, inner;
            CHECK_FALSE(interrupted());
            raise(SIGINT);
            CHECK(interrupted());
            CHECK(heard == 0);
        }
        CHECK(heard == 1);
        CHECK_FALSE(interrupted());
        { const InterruptibleCall quiet; }
        CHECK(heard == 1);
        sigaction(SIGINT, &before, nullptr);
    }
}

#ifndef __SANITIZE_THREAD__ // which knows no threads in a process that was forked

TEST_SUITE("engine/interrupt") {
    TEST_CASE("the first request ends a program that has nothing to save, wherever it is") {
        for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGXCPU}) {
            CAPTURE(signal);
            Program computes([] { compute_for_ever(); });
            Program waits([] {
                ::pause();
                ::pause();
            });
            computes.send(signal);
            waits.send(signal);
            CHECK(computes.code() == 130);
            CHECK(computes.took() < 2);
            CHECK(waits.code() == 130);
            CHECK(waits.took() < 2);
        }
    }

    TEST_CASE("whoever looks ends in order") {
        Program program([] { end_when_asked(); });
        program.send(SIGINT);
        CHECK(program.code() == 7);
    }

    TEST_CASE("a run with a state worth saving has time to come to the place where it saves, and "
              "nothing ends it while it saves") {
        Program late([] {
            const SavesWhenInterrupted saves("continue");
            end_when_asked(1);
        });
        Program slow([] {
            const SavesWhenInterrupted saves("continue");
            while (!interrupted()) pause(0.01);
            const Saving saving;
            const Instant began = this_instant();
            while (seconds_since(began) < 4) {
            }
            _exit(7);
        });
        Program deaf([] {
            const SavesWhenInterrupted saves("continue");
            compute_for_ever();
        });
        for (Program* program : {&late, &slow, &deaf}) program->send(SIGTERM);
        CHECK(late.code() == 7);
        CHECK(deaf.code() == 130);
        CHECK(slow.code() == 7);
    }

    TEST_CASE("once a run has saved its state, the rest of the program has no more time") {
        Program program([] {
            {
                const SavesWhenInterrupted saves("continue");
                while (!interrupted()) pause(0.01);
            }
            compute_for_ever();
        });
        program.send(SIGINT);
        CHECK(program.code() == 130);
        CHECK(program.took() < 2);
    }

    TEST_CASE("a second interrupt ends a program that saves at once, a second termination five "
              "seconds after the first: queueing systems send one twice") {
        const auto save = [] {
            const Saving saving;
            for (int k = 0; k < 80; ++k) pause(0.1);
            _exit(7);
        };
        Program again(save), twice(save), later(save), other(save);
        again.send(SIGTERM);
        pause(0.5); // two that wait together are delivered in order of their numbers
        again.send(SIGINT);
        for (Program* program : {&twice, &later, &other}) program->send(SIGTERM);
        twice.send(SIGTERM);
        CHECK(again.code() == 130);
        CHECK(again.took() < 2);
        pause(5.5);
        later.send(SIGTERM);
        other.send(SIGUSR1);
        CHECK(later.code() == 130);
        CHECK(twice.code() == 7);
        CHECK(other.code() == 7);
    }

    TEST_CASE("files that are not complete are removed, and the action of every cleanup that "
              "still exists is done") {
        const TemporaryDirectory folder;
        const auto name = [&](const char* file) { return (folder / file).string(); };
        write_whole(folder / "before", "old");
        Program program([&] {
            UnfinishedFile first(folder / "before"), second(folder / "new");
            std::ofstream(first.path()) << "half";
            std::ofstream(second.path()) << "half";
            {
                UnfinishedFile whole(folder / "whole");
                std::ofstream(whole.path()) << "whole";
                whole.put_in_place();
            }
            {
                const Cleanup over([&] { std::ofstream(name("over")) << ""; });
            }
            const Cleanup lives([&] { std::ofstream(name("lives")) << ""; });
            compute_for_ever();
        });
        program.send(SIGINT);
        REQUIRE(program.code() == 130);
        CHECK(read_whole(folder / "before") == "old");
        CHECK(read_whole(folder / "whole") == "whole");
        CHECK(std::filesystem::exists(folder / "lives"));
        CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 3);
    }

    TEST_CASE("a child process without a thread that watches ends at its first signal") {
        Program program([] {
            const pid_t child = fork();
            if (child == 0) compute_for_ever();
            pause(0.05);
            kill(child, SIGTERM);
            int status = 0;
            waitpid(child, &status, 0);
            _exit(WIFEXITED(status) ? WEXITSTATUS(status) : 9);
        });
        CHECK(program.code() == 130);
    }
}

#endif
