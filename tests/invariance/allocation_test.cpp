#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<std::uint64_t> allocations{0};

void* counted_or_null(std::size_t size) noexcept {
    ++allocations;
    return std::malloc(size > 0 ? size : 1);
}

void* counted(std::size_t size) {
    if (void* memory = counted_or_null(size)) return memory;
    throw std::bad_alloc();
}
} // namespace

// counts the allocations of the whole test binary
void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    return counted_or_null(size);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
    return counted_or_null(size);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

using namespace bris;
using namespace bris::testing;

TEST_SUITE("invariance/allocation") {
    TEST_CASE("a step that does not rebuild or prune lists allocates no memory") {
        for (const Grains grains : {Grains::spheres, Grains::clumps})
            for (const Walls walls : {Walls::planes, Walls::facets}) {
                World world = bed({.grains = grains, .walls = walls, .bodies = 40, .seed = 5});
                world.add_resource(LocalDamping{0.3});
                Simulation sim =
                    begin(std::move(world), {.dt = 2e-5, .law = LawName::linear_viscous});
                sim.advance(500);
                // a call of advance() may allocate its own closure, which is measured without a
                // step
                sim.advance(0);
                std::uint64_t before = allocations;
                sim.advance(0);
                const std::uint64_t of_the_call = allocations - before;
                unsigned counted_steps = 0;
                std::uint64_t worst = 0, with_lists = 0;
                const auto& state = sim.world().resource<ListState>();
                for (int k = 0; k < 1000; ++k) {
                    const std::uint64_t prunes = state.prunes;
                    before = allocations;
                    sim.advance(1);
                    const std::uint64_t here = allocations - before - of_the_call;
                    if (state.prunes == prunes) {
                        ++counted_steps;
                        worst = std::max(worst, here);
                    } else {
                        with_lists = std::max(with_lists, here);
                    }
                }
                CHECK(counted_steps > 100);
                CHECK(worst == 0);
                CHECK(with_lists > 0); // shows that the counter works
            }
    }

    TEST_CASE("rebuilding and pruning the lists does not need more allocations than before") {
        // a change that raises a number on purpose updates it here
        for (const auto& [grains, most] :
             {std::pair{Grains::spheres, 5276ul}, std::pair{Grains::clumps, 12443ul}}) {
            Simulation sim =
                begin(bed({.grains = grains, .walls = Walls::facets, .bodies = 40, .seed = 5}),
                      {.dt = 2e-5, .law = LawName::linear_viscous});
            sim.advance(500);
            const std::uint64_t before = allocations,
                                rebuilds = sim.world().resource<ListState>().rebuilds;
            sim.advance(2000);
            CHECK(sim.world().resource<ListState>().rebuilds > rebuilds + 5);
            CHECK(allocations - before <= most);
        }
    }
}
