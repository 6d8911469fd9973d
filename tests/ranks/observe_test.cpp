#include "engine/errors.hpp"
#include "engine/io/vtkhdf_file.hpp"
#include "engine/ranks.hpp"
#include "engine/rows_of_ranks.hpp"
#include "engine/state.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/retire.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/balance.hpp"
#include "systems/output/body_frame.hpp"
#include "systems/output/quantities.hpp"
#include "systems/output/stress.hpp"
#include "tests/extreme_scenes.hpp"

#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

using namespace bris;

namespace {

/// All numbers of a sample.
std::vector<double> numbers_of(const World& world) {
    const Quantities q = compute_quantities(world);
    const Stresses s = compute_stresses(world);
    const Balance b = compute_balance(world);
    return {q.kinetic_energy,
            q.elastic_energy,
            q.coordination,
            q.mean_overlap,
            q.largest_overlap,
            q.mean_normal_force,
            q.unbalanced_ratio,
            q.boundary_force.x(),
            q.boundary_force.z(),
            q.weight.z(),
            s.contact.axial,
            s.contact.radial,
            s.boundary.axial,
            s.boundary.radial,
            stable_step(world),
            static_cast<double>(q.contacts),
            static_cast<double>(q.body_contacts),
            static_cast<double>(b.contacts),
            static_cast<double>(b.free_bodies),
            static_cast<double>(b.idle_bodies)};
}

std::vector<float> centres_of(const BodyFrame& frame) {
    std::vector<float> centres;
    for (const Vec3& x : frame.positions) append_vector(centres, x);
    return centres;
}

/// Whether the frame of all parts is that of the whole on the first rank, and empty on the others.
bool is_frame_of(const World& part, const World& whole_world) {
    BodyFrame frame = frame_of_bodies(part);
    const BodyFrame whole = frame_of_bodies(whole_world);
    std::vector<float> centres = centres_of(frame);
    const RowsOfRanks ranks(frame.ids, true);
    ranks.gather(centres);
    ranks.gather(frame.shapes);
    ranks.gather(frame.radii);
    ranks.gather(frame.velocities);
    ranks.gather(frame.angular_velocities);
    ranks.gather(frame.orientations);
    ranks.gather(frame.coordination);
    if (!Ranks::is_first()) return frame.ids.empty() && centres.empty() && frame.radii.empty();
    return frame.time == whole.time && frame.ids == whole.ids && frame.shapes == whole.shapes &&
           centres == centres_of(whole) && frame.radii == whole.radii &&
           frame.velocities == whole.velocities &&
           frame.angular_velocities == whole.angular_velocities &&
           frame.orientations == whole.orientations && frame.coordination == whole.coordination &&
           frame.corners == whole.corners;
}

/// A heap that rolls along x, from one slab into the next.
Simulation heap(Grains grains, Walls walls) {
    World world = bed({.grains = grains, .walls = walls, .bodies = 90, .seed = 12});
    world.resource<Gravity>().value = Vec3(30, 0, -30);
    return begin(std::move(world), {.dt = 2e-5, .law = LawName::linear_viscous});
}

/// Rocks on which a block lies that four springs hold.
World loaded_rocks(EntityId& block) {
    World world = bed({.grains = Grains::clumps, .bodies = 60, .seed = 3});
    const Vec3 box = box_of({.grains = Grains::clumps, .bodies = 60});
    const Vec3 at(box.x() / 2, box.y() / 2, 0.75 * box.z());
    const double mass = 0.004; // so light that its step is the shortest
    block = add_block(world, at, Quat(Quat::Identity()), Vec3(0.02, 0.035, 0.015), mass, 1);
    const auto hold = [&](const Vec3& point, const Vec3& anchor, const Vec3& axis) {
        add_patch(world, block,
                  {.point = point,
                   .anchor = anchor + point,
                   .axis = axis,
                   .stiffness = 15,
                   .damping = 1.5});
    };
    for (const double end : {-0.01, 0.01})
        hold(Vec3(end, 0, 0), Vec3(at.x(), at.y(), 0), Vec3::UnitZ()); // draws it down
    for (const Vec3 axis : {Vec3::UnitX(), Vec3::UnitY()}) hold(Vec3::Zero(), at, axis);
    return world;
}

} // namespace

TEST_SUITE("ranks") {
    TEST_CASE("bodies that are retired from parts leave behind what they leave in the whole") {
        for (const Grains grains : {Grains::spheres, Grains::clumps}) {
            CAPTURE(static_cast<int>(grains));
            Simulation whole = heap(grains, Walls::planes), divided = heap(grains, Walls::planes);
            whole.divide({});
            const auto retire = [](World& world) {
                std::vector<Row> gone; // on ranks also those of which others compute the motion
                const auto id = world.column<Bodies, BodyId>();
                const auto spheres = world.column<Bodies, SpheresOf>();
                for (Row b = 0; b < id.size(); ++b)
                    if (spheres[b].count > 0 && id[b] % 7 == 3) gone.push_back(b);
                return retire_bodies(world, gone).removed();
            };
            for (int time = 0; time < 3; ++time) {
                whole.advance(400);
                divided.advance_unseen(400);
                divided.observe();
                CHECK(retire(divided.divide_now()) == retire(whole.world()));
                whole.prepare();
            }
            whole.advance(400);
            divided.advance_unseen(400);
            divided.observe();
            CHECK(divided.part() != nullptr);
            CHECK(numbers_of(divided.observed()) == numbers_of(whole.world()));
            divided.look();
            CHECK(whole.world().table<Bodies>().size() < 75);
            CHECK(fingerprint(divided.snapshot()) == fingerprint(whole.snapshot()));
        }
    }

    TEST_CASE("samples of parts have the bits of samples of the whole, and change none of the "
              "steps that follow") {
        for (const Grains grains : {Grains::spheres, Grains::clumps})
            for (const Walls walls : {Walls::planes, Walls::facets}) {
                CAPTURE(static_cast<int>(grains));
                CAPTURE(static_cast<int>(walls));
                Simulation whole = heap(grains, walls), divided = heap(grains, walls);
                whole.divide({});
                double contacts = 0, parts = 0;
                for (int sample = 0; sample < 60; ++sample) {
                    whole.advance(37);
                    divided.advance_unseen(37);
                    if (sample % 20 == 19) {
                        divided.look();
                    } else {
                        divided.observe();
                        parts += divided.part() != nullptr ? 1 : 0;
                    }
                    const auto expected = numbers_of(whole.world());
                    CAPTURE(sample);
                    CHECK(numbers_of(divided.observed()) == expected);
                    const World& seen = divided.observed();
                    if (divided.part() != nullptr) {
                        CHECK(is_frame_of(seen, whole.world()));
                        View view = view_by_coordination(seen);
                        gather(view);
                        const std::size_t all = view_by_coordination(whole.world()).balls.size();
                        CHECK(view.balls.size() == all); // that of the whole is the first rank's
                    }
                    contacts = expected[15];
                }
                CHECK(contacts > 20);
                CHECK(parts > 50);
                divided.advance_unseen(37);
                divided.observe();
                divided.look();
                whole.advance(37);
                CHECK_THROWS((void)divided.observed()); // the whole has no records of contacts
                CHECK(divided.snapshot().arrays().size() == whole.snapshot().arrays().size());
                CHECK(fingerprint(divided.snapshot()) == fingerprint(whole.snapshot()));
            }
    }

    TEST_CASE("a world that is divided before its first step has the same bits, and all ranks find "
              "the deepest overlap, which one of them has") {
        Simulation whole = heap(Grains::clumps, Walls::planes),
                   divided = heap(Grains::clumps, Walls::planes);
        whole.divide({});
        World* const part = &divided.divide_now();
        CHECK(part == divided.part());
        CHECK(std::as_const(divided).world().table<Bodies>().size() == 0);
        CHECK(is_frame_of(divided.observed(), whole.world()));
        divided.advance(2000);
        whole.advance(2000);
        const auto message = [](World& world) {
            const double limit = std::exchange(world.resource<Limits>().overlap, 1e-9);
            std::string found;
            try {
                check_overlaps(world);
            } catch (const InputError& error) {
                found = error.what();
            }
            world.resource<Limits>().overlap = limit;
            return found;
        };
        const std::string found = message(divided.divide_now());
        CHECK(found != "");
        invalidate_lists(whole.world()); // which hold where the bodies were
        CHECK(found == message(whole.world()));
        CHECK_FALSE(divided.is_observed()); // the part has no records of contacts
        divided.advance(400);
        whole.advance(400);
        CHECK(fingerprint(divided.snapshot()) == fingerprint(whole.snapshot()));
    }

    TEST_CASE("a free boundary, which all ranks have, counts once in samples of parts, with the "
              "contacts that all have found with it") {
        EntityId block = nobody;
        const auto make = [&] {
            return begin(loaded_rocks(block), {.dt = 2e-5, .law = LawName::linear_viscous});
        };
        Simulation divided = make(), whole = make();
        whole.divide({});
        double touching = 0;
        for (int sample = 0; sample < 40; ++sample) {
            CAPTURE(sample);
            whole.advance(397);
            divided.advance_unseen(397);
            divided.observe();
            REQUIRE(divided.part() != nullptr);
            CHECK(numbers_of(divided.observed()) == numbers_of(whole.world()));
            CHECK(contact_force(divided.observed(), block) == contact_force(whole.world(), block));
            touching += contact_force(whole.world(), block).norm() > 0 ? 1 : 0;
        }
        CHECK(touching > 10);
    }

    TEST_CASE("a scene in which a spring holds a grain is observed as a whole") {
        const auto make = [] {
            EntityId block = nobody;
            World world = loaded_rocks(block);
            const EntityId rock = world.column<Spheres, ParentId>()[0];
            add_patch(world, rock, {.anchor = value_of<Position>(world, rock), .stiffness = 10});
            return begin(std::move(world), {.dt = 2e-5, .law = LawName::linear_viscous});
        };
        Simulation divided = make(), whole = make();
        whole.divide({});
        whole.advance(500);
        divided.advance_unseen(500);
        REQUIRE(divided.part() != nullptr);
        divided.observe();
        CHECK(divided.part() == nullptr);
        CHECK(numbers_of(divided.observed()) == numbers_of(whole.world()));
    }
}
