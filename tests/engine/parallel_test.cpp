#include "engine/parallel.hpp"
#include "engine/random.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

using namespace bris;

TEST_SUITE("engine/parallel") {
    TEST_CASE("chunks cover every row once for any number of threads and any grain") {
        for (const unsigned threads : {1u, 2u, 3u, 7u})
            for (const std::size_t n : {0u, 1u, 7u, 1000u, 4096u})
                for (const std::size_t grain : {1u, 7u, 256u, 5000u}) {
                    std::vector<int> seen(n, 0);
                    std::vector<int> chunk_seen((n + grain - 1) / grain, 0);
                    bool cut_as_told = true;
                    Threads team(threads);
                    team.run([&] {
                        for_chunks(
                            n, grain, [&](std::size_t chunk, std::size_t first, std::size_t last) {
                                ++chunk_seen[chunk];
                                if (first != chunk * grain || last != std::min(n, first + grain))
                                    cut_as_told = false;
                                for (std::size_t i = first; i < last; ++i) ++seen[i];
                            });
                    });
                    CHECK(cut_as_told);
                    CHECK(std::count(seen.begin(), seen.end(), 1) ==
                          static_cast<std::ptrdiff_t>(n));
                    CHECK(std::count(chunk_seen.begin(), chunk_seen.end(), 1) ==
                          static_cast<std::ptrdiff_t>(chunk_seen.size()));
                }
    }

    TEST_CASE("a loop inside the body of another loop runs completely") {
        Threads team(3);
        std::vector<int> sums(20, 0);
        team.run([&] {
            for_chunks(20, 1, [&](std::size_t outer, std::size_t, std::size_t) {
                std::vector<int> inner(50, 0);
                for_chunks(50, 7, [&](std::size_t, std::size_t first, std::size_t last) {
                    for (std::size_t i = first; i < last; ++i) inner[i] = 1;
                });
                for (const int i : inner) sums[outer] += i;
            });
        });
        CHECK(sums == std::vector<int>(20, 50));
    }

    TEST_CASE("sum_in_order() is correct and has the same bits for any number of threads") {
        Random random(11, 0);
        std::vector<double> terms(10'000);
        long double exact = 0;
        for (double& t : terms)
            exact += static_cast<long double>(t = random.uniform(-1, 1) *
                                                  std::exp2(random.uniform(-30, 30)));
        std::set<double> sums;
        for (const unsigned threads : {1u, 2u, 3u, 7u}) {
            Threads team(threads);
            team.run([&] {
                sums.insert(
                    sum_in_order(terms.size(), 0.0, [&](std::size_t i) { return terms[i]; }));
            });
        }
        CHECK(sums.size() == 1);
        // blocks of 1024: at most 1024 + 10 roundings of sums not larger than n 2^30
        CHECK(std::abs(*sums.begin() - static_cast<double>(exact)) < 1100 * 1.2e-16 * 1e4 * 0x1p30);
    }
}
