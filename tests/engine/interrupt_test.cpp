#include "engine/interrupt.hpp"

#include <doctest/doctest.h>

#include <csignal>
#include <sys/wait.h>
#include <unistd.h>

using namespace bris;

namespace {

/// Exit code of a process that does not look whether it is to stop, and is sent two signals.
int code_after(int first, unsigned seconds, int second) {
    const pid_t child = fork();
    if (child == 0) {
        catch_interrupts();
        raise(first);
        for (unsigned left = seconds; left > 0;) left = sleep(left);
        raise(second);
        _exit(interrupted() ? 7 : 8);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

} // namespace

TEST_SUITE("engine/interrupt") {
    TEST_CASE("a second request ends a process that does not heed the first: an interrupt at once, "
              "a termination after five seconds") {
        CHECK(code_after(SIGTERM, 0, SIGINT) == 130);
        CHECK(code_after(SIGTERM, 0, SIGTERM) == 7); // as a queueing system sends it
        CHECK(code_after(SIGTERM, 6, SIGTERM) == 130);
        CHECK(code_after(SIGTERM, 6, SIGUSR1) == 7);
    }
}
