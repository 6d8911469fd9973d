#include "engine/parallel.hpp"
#include "engine/team.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

using namespace bris;

TEST_SUITE("engine/team") {
    TEST_CASE("a thread takes its own chunks from the front, then those of others from the back") {
        detail::Division division(3);
        const auto taken_by = [&](unsigned thread, std::size_t most) {
            struct Taken {
                std::vector<std::size_t> chunks;
                std::size_t most;
            } taken{{}, most};
            const auto take = [](void* to, std::size_t chunk) {
                auto& t = *static_cast<Taken*>(to);
                t.chunks.push_back(chunk);
                if (t.chunks.size() == t.most) throw std::runtime_error("enough");
            };
            try {
                division.work(thread, take, &taken);
            } catch (const std::runtime_error&) {
            }
            return taken.chunks;
        };
        using Chunks = std::vector<std::size_t>;
        for (int loop = 0; loop < 2; ++loop) {
            division.divide(10);
            CHECK(taken_by(1, 2) == Chunks{3, 4});
            CHECK(taken_by(0, 4) == Chunks{0, 1, 2, 5});
            CHECK(taken_by(2, 10) == Chunks{6, 7, 8, 9});
            CHECK(taken_by(1, 10).empty());
        }
        division.divide(1);
        CHECK(taken_by(0, 10) == Chunks{0});
    }

    TEST_CASE("what a chunk throws reaches the caller, and the next loop runs") {
        Threads team(3);
        for (const std::size_t bad : {0u, 7u, 19u}) {
            std::vector<int> seen(20, 0);
            team.run([&] {
                CHECK_THROWS_WITH_AS(for_chunks(20, 1,
                                                [&](std::size_t chunk, std::size_t, std::size_t) {
                                                    if (chunk == bad)
                                                        throw std::runtime_error("bad chunk");
                                                }),
                                     "bad chunk", std::runtime_error);
                for_chunks(20, 1,
                           [&](std::size_t chunk, std::size_t, std::size_t) { ++seen[chunk]; });
            });
            CHECK(std::count(seen.begin(), seen.end(), 1) == 20);
        }
    }

    TEST_CASE("what the work itself throws ends it, and the threads serve the next work") {
        Threads team(3);
        std::atomic<int> done{0};
        const auto ten_chunks = [&] {
            for_chunks(10, 1, [&](std::size_t, std::size_t, std::size_t) { ++done; });
        };
        CHECK_THROWS_WITH_AS(team.run([&] {
            ten_chunks();
            throw std::runtime_error("bad work");
        }),
                             "bad work", std::runtime_error);
        team.run(ten_chunks);
        CHECK(done == 20);
    }

    TEST_CASE("threads that left during a pause are called again") {
        std::atomic<int> calls{0};
        std::vector<std::thread> threads;
        detail::Team team(2, [&](const auto& help) {
            ++calls;
            threads.emplace_back(help);
        });
        std::atomic<int> sum{0};
        const auto add = [](void* to, std::size_t chunk) {
            *static_cast<std::atomic<int>*>(to) += static_cast<int>(chunk);
        };
        for (int loop = 0; calls < 3; ++loop) {
            sum = 0;
            team.run(10, add, &sum);
            REQUIRE(sum == 45);
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            REQUIRE(loop < 1000);
        }
        team.leave();
        for (auto& thread : threads) thread.join();
    }

    TEST_CASE("many short loops on more threads than there are processors lose no chunk") {
        Threads team(8);
        std::size_t missing = 0;
        team.run([&] {
            for (int loop = 0; loop < 3000; ++loop) {
                const std::size_t chunks = 1 + static_cast<std::size_t>(loop) % 19;
                std::vector<int> seen(chunks, 0);
                for_chunks(chunks, 1,
                           [&](std::size_t chunk, std::size_t, std::size_t) { ++seen[chunk]; });
                missing +=
                    chunks - static_cast<std::size_t>(std::accumulate(seen.begin(), seen.end(), 0));
            }
        });
        CHECK(missing == 0);
    }
}
