#include "engine/loop_times.hpp"
#include "engine/parallel.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

using namespace bris;

TEST_SUITE("engine/loop_times") {
    TEST_CASE(
        "a timed loop runs every chunk once, in order and on the calling thread, in the chunks "
        "of its team") {
        Threads team(5);
        team.run([&] {
            std::vector<std::size_t> order;
            std::set<std::thread::id> ran;
            LoopTimes times;
            const auto loop = [&](std::size_t chunks) {
                for_chunks(chunks, 1, [&](std::size_t chunk, std::size_t, std::size_t) {
                    order.push_back(chunk);
                    ran.insert(std::this_thread::get_id());
                    // a loop within a chunk belongs to the chunk
                    for_chunks(3, 1, [&](std::size_t, std::size_t, std::size_t) {
                        ran.insert(std::this_thread::get_id());
                    });
                });
            };
            CHECK(team_size() == 5);
            loop(20);
            loop(1); // not a parallel loop
            loop(4);
            REQUIRE(times.loops().size() == 3); // that of three chunks within the loop of one, too
            CHECK(times.loops()[0].size() == 20);
            CHECK(times.loops()[1].size() == 3);
            CHECK(times.loops()[2].size() == 4);
            CHECK(order.size() == 25);
            CHECK(std::is_sorted(order.begin(), order.begin() + 20));
            CHECK(ran == std::set{std::this_thread::get_id()});
        });
    }

    TEST_CASE("the time of chunks and the time outside of them add up to that of the whole") {
        Threads team(2);
        team.run([&] {
            const auto pause = [](int ms) {
                std::this_thread::sleep_for(std::chrono::milliseconds(ms));
            };
            LoopTimes times;
            const auto loop = [&] {
                for_chunks(2, 1, [&](std::size_t chunk, std::size_t, std::size_t) {
                    pause(chunk == 0 ? 5 : 20);
                });
            };
            const Instant began = this_instant();
            loop();
            pause(15);
            loop();
            const double whole = seconds_since(began);
            double in_chunks = 0;
            for (const auto& chunks : times.loops()) {
                CHECK(chunks[0] >= 0.005);
                CHECK(chunks[1] >= 0.02);
                in_chunks += chunks[0] + chunks[1];
            }
            CHECK(times.outside() >= 0.015);
            CHECK(in_chunks + times.outside() == doctest::Approx(whole).epsilon(0.02));
        });
    }

    TEST_CASE("the time on several threads follows from who takes which chunk") {
        // halves 1 + 2 and 3 + 4: the first thread is free at 3, when the other has begun its last
        const std::vector<double> four{1, 2, 3, 4};
        CHECK(time_on_threads(four, 1) == 10);
        CHECK(time_on_threads(four, 2) == 7);
        CHECK(time_on_threads(four, 4) == 4);
        CHECK(time_on_threads(four, 9) == 4);
        // 1 + 1 and 5 + 4 + 3: the first takes 3 from the back
        CHECK(time_on_threads(std::vector<double>{1, 1, 5, 4, 3}, 2) == 9);
        std::vector<double> equal(64, 0.5);
        CHECK(time_on_threads(equal, 16) == 2);
        equal.push_back(0.5);
        CHECK(time_on_threads(equal, 16) == 2.5);
    }
}
