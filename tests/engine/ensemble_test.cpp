#include "engine/ensemble.hpp"
#include "engine/state.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>

using namespace bris;

TEST_SUITE("engine/ensemble") {
    TEST_CASE("every job runs once, and never more jobs run at once than requested") {
        for (const unsigned at_once : {0u, 1u, 2u, 7u, 50u}) {
            std::vector<std::atomic<int>> runs(23);
            std::atomic<int> now{0}, most{0};
            run_ensemble(runs.size(), at_once, [&](std::size_t job) {
                const int running = ++now;
                for (int seen = most;
                     seen < running && !most.compare_exchange_weak(seen, running);) {
                }
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
                ++runs[job];
                --now;
            });
            CAPTURE(at_once);
            CHECK(std::all_of(runs.begin(), runs.end(), [](const auto& n) { return n == 1; }));
            if (at_once > 0) CHECK(most <= static_cast<int>(at_once));
        }
        run_ensemble(0, 3, [](std::size_t) { FAIL("there is no job"); });
    }

    TEST_CASE(
        "the error of the lowest-numbered job is thrown after all running jobs have finished") {
        std::atomic<int> started{0}, ended{0};
        const auto job = [&](std::size_t number) {
            ++started;
            // the higher number fails first
            std::this_thread::sleep_for(std::chrono::milliseconds(number == 1 ? 40 : 5));
            ++ended;
            if (number == 1 || number == 2) throw std::runtime_error(std::to_string(number));
        };
        CHECK_THROWS_WITH(run_ensemble(1000, 3, job), "1");
        CHECK(started == ended);
        CHECK(started < 1000);
        started = ended = 0;
        CHECK_THROWS_WITH(run_ensemble(1000, 1, job), "1");
        CHECK(started == 2); // one at a time: no job starts after the failure
    }

    TEST_CASE("a simulation reaches the same state alone and beside others") {
        const auto state = [](std::uint64_t seed) {
            Simulation sim = begin(bed({.bodies = 30, .seed = seed}),
                                   {.dt = 2e-5, .law = LawName::linear_viscous});
            sim.advance(300);
            return fingerprint(sim.snapshot());
        };
        std::vector<std::uint64_t> together(4);
        run_ensemble(together.size(), 2, [&](std::size_t job) { together[job] = state(job + 1); });
        for (std::size_t job = 0; job < together.size(); ++job)
            CHECK(together[job] == state(job + 1));
        CHECK(together[0] != together[1]);
    }
}
