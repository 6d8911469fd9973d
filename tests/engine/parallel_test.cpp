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
}
