#include "components/outline.hpp"
#include "engine/random.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

using namespace bris;

namespace {

const Vec3 low(0, 0, 0), high(1, 2, 3);

struct Body {
    Vec3 position;
    double reach;
};

std::vector<Body> random_bodies(std::size_t count, std::uint64_t seed) {
    Random draw(seed, 1);
    std::vector<Body> bodies(count);
    for (Body& b : bodies) {
        const Vec3 share(draw.uniform(), draw.uniform(), draw.uniform());
        // some lie outside of the cross-section, as bodies do that have moved since it was measured
        b.position = low + (1.4 * share - Vec3::Constant(0.2)).cwiseProduct(high - low);
        b.reach = draw.uniform() < 0.1 ? 0.3 : 0.03;
    }
    return bodies;
}

} // namespace

TEST_SUITE("components/outline") {
    TEST_CASE("every body that touches one of a slab reaches into its outline, whatever the axis") {
        for (const int axis : {0, 1, 2}) {
            const std::vector<Body> slab = random_bodies(80, 1), others = random_bodies(2000, 2);
            Outline outline(axis, low, high);
            for (const Body& b : slab) outline.add(b.position, b.reach);
            const Outline empty(axis, low, high);
            std::size_t touching = 0, found = 0;
            for (const Body& b : others) {
                bool touches = false;
                for (const Body& a : slab)
                    touches = touches || (a.position - b.position).norm() <= a.reach + b.reach;
                touching += touches ? 1u : 0u;
                found += outline.may_touch(b.position, b.reach) ? 1u : 0u;
                if (touches) REQUIRE(outline.may_touch(b.position, b.reach));
                REQUIRE_FALSE(empty.may_touch(b.position, b.reach)); // has no bodies
            }
            CHECK(touching > 80);
            CHECK(found < others.size());
        }
    }

    TEST_CASE(
        "a large body beside a cut needs the small ones in front of it, but not those beside it") {
        Outline outline(0, low, high);
        outline.add(Vec3(0.4, 1, 1.5), 0.2);
        CHECK(outline.may_touch(Vec3(0.6, 1, 1.5), 0.01));
        CHECK_FALSE(outline.may_touch(Vec3(0.62, 1, 1.5), 0.01));
        CHECK_FALSE(outline.may_touch(Vec3(0.6, 1.3, 1.5), 0.01));
        CHECK_FALSE(outline.may_touch(Vec3(0.6, 1, 1.2), 0.01));
        outline.clear();
        CHECK_FALSE(outline.may_touch(Vec3(0.4, 1, 1.5), 0.2));
    }

    TEST_CASE("outlines put together are that of all their bodies, with the extent of the slab") {
        Outline here(2, low, high), there = here, both = here;
        const std::vector<Body> bodies = random_bodies(60, 3);
        double down = -1e9, up = -1e9;
        for (std::size_t k = 0; k < bodies.size(); ++k) {
            (k % 3 == 0 ? here : there).add(bodies[k].position, bodies[k].reach);
            both.add(bodies[k].position, bodies[k].reach);
            down = std::max(down, bodies[k].reach - bodies[k].position.z());
            up = std::max(up, bodies[k].reach + bodies[k].position.z());
        }
        here.add(there);
        for (std::size_t k = 0; k < here.numbers().size(); ++k)
            REQUIRE(here.numbers()[k] == both.numbers()[k]);
        CHECK(both.extent().down == doctest::Approx(down).epsilon(1e-8));
        CHECK(both.extent().up == doctest::Approx(up).epsilon(1e-8));
    }
}
