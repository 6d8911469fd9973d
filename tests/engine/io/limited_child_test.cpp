#include "engine/errors.hpp"
#include "engine/io/limited_child.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <thread>
#include <unistd.h>
#include <vector>

using namespace bris;

namespace {

constexpr LimitedChild::Limits limits{.bytes = std::uint64_t{64} << 20, .seconds = 1};

template <class Work>
std::string reason(Work&& work) {
    LimitedChild child(limits, work);
    int received = 0;
    try {
        child.read(&received, sizeof received);
        return {};
    } catch (const OutputError& error) {
        return error.what();
    }
}

} // namespace

TEST_SUITE("engine/io/limited_child") {
    TEST_CASE("a child passes on more than a pipe holds") {
        std::vector<int> sent(1 << 20, 7), received(sent.size());
        LimitedChild child(limits, [&](LimitedChild::Pipe& pipe) {
            pipe.write(sent.data(), sent.size() * sizeof(int));
        });
        child.read(received.data(), received.size() * sizeof(int));
        CHECK(received == sent);
    }

    TEST_CASE("a child that crashes, takes much memory or does not end is reported as such") {
        CHECK(reason([](LimitedChild::Pipe&) { std::abort(); }).find("damaged") !=
              std::string::npos);
#ifndef __SANITIZE_THREAD__ // whose allocator does not call the child's limit after a fork
        CHECK(reason([](LimitedChild::Pipe& pipe) {
                  const std::vector<char> large(std::size_t{1} << 28, 1);
                  pipe.write(large.data(), large.size());
              }) == "it needs more than 64 MiB of memory");
#endif
        CHECK(reason([](LimitedChild::Pipe&) {
                  while (true) asm volatile("");
              }) == "it takes more than 1 s");
    }

    TEST_CASE("a child that waits in vain is replaced by one that does its work") {
        const TemporaryDirectory folder;
        LimitedChild child(limits, [&](LimitedChild::Pipe& pipe) {
            if (std::filesystem::create_directory(folder / "began"))
                while (true) pause(); // the first one
            pipe.write("done", 4);
        });
        std::string answer(4, ' ');
        child.read(answer.data(), answer.size());
        CHECK(answer == "done");
    }

    TEST_CASE("a child that has sent something may wait") {
        LimitedChild child(limits, [](LimitedChild::Pipe& pipe) {
            pipe.write("a", 1);
            pipe.flush();
            std::this_thread::sleep_for(std::chrono::seconds(4));
            pipe.write("b", 1);
        });
        std::string answer(2, ' ');
        child.read(answer.data(), answer.size());
        CHECK(answer == "ab");
    }

    TEST_CASE("a child that nobody listens to is ended") {
        const auto child = std::make_unique<LimitedChild>(limits, [](LimitedChild::Pipe&) {
            while (true) pause();
        });
        CHECK(child != nullptr); // its destructor returns
    }
}
