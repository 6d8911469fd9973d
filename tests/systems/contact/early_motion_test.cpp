#include "engine/random.hpp"
#include "systems/contact/early_motion.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace bris;

namespace {

/// Bodies with random numbers of near rows, in random chunks and with random late groups.
struct Scene {
    NearIndex<SpherePairs> index;
    LateBodies late;
    Row bodies;

    explicit Scene(Random& random) : bodies(static_cast<Row>(random.uniform(1, 900))) {
        index.listed_first.push_back(0);
        for (Row b = 0; b < bodies; ++b) {
            const bool lists = random.uniform() < 0.7;
            index.listed_first.push_back(index.listed_first.back() +
                                         (lists ? static_cast<Row>(random.uniform(1, 9)) : 0));
        }
        const double longest = random.uniform(2, 300); // bodies of a chunk: also within a group
        for (Row first = 0; first < bodies;) {
            const Row last = std::min(bodies, first + static_cast<Row>(random.uniform(1, longest)));
            index.chunks.push_back(
                {first, last, index.listed_first[first], index.listed_first[last], 0, 0, 0});
            first = last;
        }
        note_late(random);
    }

private:
    static constexpr Row group = LateBodies::group;

    /// As force_targets.cpp does it: groups of two chunks are late, and others by chance.
    void note_late(Random& random) {
        const Row groups = (bodies + group - 1) / group;
        late.is_late.assign(groups, 0);
        for (const NearChunk& c : index.chunks) {
            const Row last = c.last_body == bodies ? groups : c.last_body / group;
            for (Row g = c.first_body / group; g < last; ++g)
                if (g * group < c.first_body || random.uniform() < 0.2) late.is_late[g] = 1;
        }
    }
};

} // namespace

TEST_SUITE("systems/contact/early_motion") {
    TEST_CASE("every body moves once, and none before the near rows that it lists, whatever the "
              "chunks and blocks") {
        constexpr std::uint64_t seed = 20261201;
        CAPTURE(seed);
        Random random(seed, 1);
        std::size_t early = 0, together = 0;
        for (int k = 0; k < 400; ++k) {
            CAPTURE(k);
            const Scene scene(random);
            std::vector<int> moved(scene.bodies, 0);
            Row done = 0; // near rows before this one
            bool all_done = false, is_late = true;
            const Follower::Pass pass = [&](RowRange rows) {
                for (Row b = rows.first; b < rows.last; ++b) {
                    ++moved[b];
                    is_late = is_late && (all_done || scene.index.listed_first[b + 1] <= done);
                }
                (all_done ? together : early) += rows.last - rows.first;
            };
            Follower follower;
            const Follower::Offer offer(follower, pass);
            REQUIRE(follower.take());
            const detail::EarlyMotion motion(follower, scene.late, scene.index, scene.bodies);
            const Row block = static_cast<Row>(random.uniform(1, 400));
            for (const NearChunk& c : scene.index.chunks) {
                Row group = detail::EarlyMotion::first_group(c);
                for (Row first = c.first; first < c.last; first += block) {
                    done = std::min(first + block, c.last);
                    group = motion.move(c, group, done);
                }
                if (c.first == c.last) motion.move(c, group, c.last);
            }
            all_done = true;
            motion.move_late();
            CHECK(is_late);
            CHECK(std::ranges::count(moved, 1) == static_cast<std::ptrdiff_t>(scene.bodies));
        }
        CHECK(early > 10000);
        CHECK(together > 10000);
    }

    TEST_CASE("a leading system that throws leaves no pass behind") {
        Follower follower;
        const Follower::Pass pass = [](RowRange) {};
        try {
            const Follower::Offer offer(follower, pass);
            CHECK(follower.take());
            throw 1;
        } catch (int) {
        }
        CHECK_FALSE(follower.take());
    }
}
