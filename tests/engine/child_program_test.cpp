#include "engine/child_program.hpp"
#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/stopwatch.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <csignal>
#include <fcntl.h>
#include <unistd.h>

using namespace bris;

TEST_SUITE("engine/child_program") {
    TEST_CASE("a program takes its input from an open file and prints into another one, and its "
              "exit code is known") {
        const TemporaryDirectory folder;
        write_whole(folder / "in", "five words\n");
        const int in = open((folder / "in").c_str(), O_RDONLY | O_CLOEXEC),
                  out = open((folder / "out").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
        ChildProgram child({"sh", "-c", "cat; exit 5"}, {.input = in, .output = out});
        CHECK(child.wait() == 5);
        CHECK_FALSE(child.runs());
        CHECK(child.exit_code() == 5);
        close(in);
        close(out);
        CHECK(read_whole(folder / "out") == "five words\n");
    }

    TEST_CASE("a program that a signal has ended says which") {
        ChildProgram child({"sleep", "100"});
        CHECK(child.runs());
        CHECK(child.exit_code() == -1);
        child.send(SIGUSR1);
        CHECK(child.wait() == 128 + SIGUSR1);
    }

    TEST_CASE("a program ends with its object") {
        const Instant began = this_instant();
        { const ChildProgram child({"sleep", "100"}); }
        CHECK(seconds_since(began) < 15);
    }

    TEST_CASE("a program that is not there is named") {
        CHECK_THROWS_WITH_AS(ChildProgram({"no-such-program"}),
                             "cannot start 'no-such-program': No such file or directory",
                             OutputError);
    }
}
