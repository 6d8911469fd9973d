#include "engine/state.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/loads/table.hpp"
#include "systems/output/outer_force.hpp"
#include "systems/output/quantities.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr double spacing = 0.61, bending = 1.58e7, tie_mass = 300, pad = 120e6, dt = 1e-4;

struct Track {
    World world;
    std::vector<EntityId> ties;
};

/// Ties on one-sided supports in their middles, held by guides, so that pad and support in series
/// have the stiffness `of_tie` (N/m).
Track make_track(std::size_t n, double of_tie, double gravity = 0) {
    Track track{make_world(Grains::clumps), {}};
    if (gravity > 0) track.world.add_resource<Gravity>({Vec3(0, 0, -gravity)});
    const auto material = add_material(track.world, linear_material(1e7));
    const double support = 1 / (1 / of_tie - 1 / pad);
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3 at(spacing * static_cast<double>(i), 0, 0);
        const EntityId tie = add_block(track.world, at, Quat(Quat::Identity()),
                                       Vec3(0.27, 2.6, 0.23), tie_mass, material);
        add_patch(track.world, tie,
                  {.anchor = at,
                   .stiffness = support,
                   .damping = std::sqrt(support * tie_mass),
                   .one_sided = true});
        track.ties.push_back(tie);
    }
    return track;
}

Rail rail_on(const Track& track) {
    Rail rail{.bending = bending, .pad = pad};
    for (const EntityId tie : track.ties) rail.seats.push_back({.tie = tie});
    return rail;
}

double middle_of(std::size_t n) { return 0.5 * spacing * static_cast<double>(n - 1); }

} // namespace

TEST_SUITE("rail") {
    TEST_CASE(
        "the ties under a rail carry the shares of an axle of the beam on discrete supports") {
        // exact shares of the loaded tie and its neighbours, from the beam on many springs; the
        // continuous support of Winkler has P a beta / 2
        struct Shares {
            double of_tie, loaded, first, second;
        };
        constexpr std::size_t n = 31;
        constexpr double load = 100e3;
        for (const Shares& s :
             {Shares{30e6, 0.2862, 0.2231, 0.1205}, Shares{91e6, 0.3769, 0.2505, 0.0881}}) {
            Track track = make_track(n, s.of_tie);
            Rail rail = rail_on(track);
            // far ties would be lifted without dead load, which adds the same to all
            rail.weight = 50e3 / spacing;
            add_rail(track.world, rail);
            Simulation sim = begin(std::move(track.world), {.dt = dt});
            CHECK(stable_step(sim.world()) > dt);
            sim.advance(4000);
            const auto carried = [&] {
                std::vector<double> force;
                for (const EntityId tie : track.ties)
                    force.push_back(value_of<PatchForce>(sim, tie).force.z());
                return force;
            };
            const std::vector<double> before = carried();
            Rail& laid = sim.world().resource<Rails>().list.front();
            laid.axle_positions = {middle_of(n)};
            laid.axle_loads = {load};
            sim.advance(4000);
            const std::vector<double> after = carried();
            const auto share = [&](std::size_t k) { return (after[k] - before[k]) / load; };
            const std::size_t m = n / 2;
            CHECK(share(m) == about(s.loaded).epsilon(2e-4));
            CHECK(share(m - 1) == about(s.first).epsilon(3e-4));
            CHECK(share(m + 1) == about(share(m - 1)).epsilon(1e-9));
            CHECK(share(m + 2) == about(s.second).epsilon(6e-4));
            const double beta = std::pow(s.of_tie / spacing / (4 * bending), 0.25);
            CHECK(share(m) == about(spacing * beta / 2).epsilon(4e-3));
            MESSAGE("shares ", share(m), ", ", share(m + 1), ", ", share(m + 2));
            CHECK(compute_quantities(sim.world()).unbalanced_ratio < 1e-9);
        }
    }

    TEST_CASE("over a tie that has settled the supports carry weight, rail and axle, and the "
              "neighbours its part") {
        constexpr std::size_t n = 21;
        constexpr double load = 150e3, weight = 6.5e3, g = 9.81;
        Track track = make_track(n, 30e6, g);
        Rail rail = rail_on(track);
        rail.weight = weight;
        rail.axle_positions = {middle_of(n)};
        rail.axle_loads = {load};
        const auto settled = track.ties[n / 2];
        auto& patches = track.world.resource<SpringPatches>();
        patches.of_body[value_of<PatchesOf>(track.world, settled) - 1].front().anchor.z() -= 0.02;
        add_rail(track.world, rail);
        Simulation sim = begin(std::move(track.world), {.dt = dt});
        sim.advance(8000);
        double carried = 0;
        for (const EntityId tie : track.ties) carried += value_of<PatchForce>(sim, tie).force.z();
        const double length = spacing * static_cast<double>(n - 1);
        const double all = load + weight * length + tie_mass * g * static_cast<double>(n);
        CHECK(carried == about(all).epsilon(1e-8));
        CHECK(value_of<PatchForce>(sim, settled).force.z() == 0); // it hangs from the rail
        CHECK(value_of<RailForce>(sim, settled).force.z() == about(tie_mass * g).epsilon(1e-6));
        CHECK(value_of<PatchForce>(sim, track.ties[n / 2 - 1]).force.z() > 0.35 * load);
    }

    TEST_CASE("the work of axles that pass is what ties, supports and rail have taken") {
        Track track = make_track(9, 50e6, 9.81);
        Rail rail = rail_on(track);
        rail.weight = 1e4;
        rail.retardation = 1e-4;
        rail.axle_positions = {-1, -2.8};
        rail.axle_loads = {80e3, 60e3};
        rail.axle_speed = 30;
        add_rail(track.world, rail);
        Simulation sim = begin(std::move(track.world), {.dt = 1e-5, .energy_budget = true});
        sim.advance(15'000);
        const Quantities q = compute_quantities(sim.world());
        const ElementWork work = work_of_elements(sim.world());
        double height = 0;
        for (const EntityId tie : track.ties) height += value_of<Position>(sim, tie).z();
        const double stored = q.kinetic_energy + q.elastic_energy + tie_mass * 9.81 * height;
        CHECK(work.lost > 0.05 * work.done);
        CHECK(work.done - work.lost == about(stored).epsilon(1e-3 * work.done / std::abs(stored)));
        double lost = 0;
        for (const EntityId tie : track.ties) lost += value_of<RailLoss>(sim, tie);
        CHECK(lost > 0);
    }

    TEST_CASE("the stiffness of a rail is symmetric, and shifted or tilted ties feel nothing") {
        Track track = make_track(7, 30e6);
        Rail rail = rail_on(track);
        add_rail(track.world, rail);
        const RailResponse response(track.world.resource<Rails>().list.front());
        Eigen::MatrixXd k(7, 7);
        for (Eigen::Index i = 0; i < 7; ++i)
            k.col(i) = -response.of_ties(Eigen::VectorXd::Unit(7, i));
        CHECK(k.diagonal().minCoeff() > 0);
        CHECK((k - k.transpose()).norm() < 1e-10 * k.norm());
        CHECK((k * Eigen::VectorXd::Ones(7)).norm() < 1e-9 * k.norm());
        CHECK((k * Eigen::VectorXd::LinSpaced(7, -1, 1)).norm() < 1e-9 * k.norm());
    }

    TEST_CASE("rails are kept in checkpoints, and unsuitable ones are refused") {
        Track track = make_track(5, 30e6, 9.81);
        Rail rail = rail_on(track);
        rail.axle_positions = {0.5};
        rail.axle_loads = {5e4};
        rail.axle_speed = 5;
        World other = track.world;
        add_rail(track.world, rail);
        Simulation sim = begin(std::move(track.world), {.dt = dt});
        sim.advance(100);
        const Archive saved = sim.snapshot();
        sim.advance(200);
        const auto expected = fingerprint(sim.snapshot());
        sim.world().resource<Rails>().list.front().axle_loads = {0};
        sim.restore(saved);
        sim.advance(200);
        CHECK(fingerprint(sim.snapshot()) == expected);

        const auto refused = [&](auto&& change) {
            Rail wrong = rail;
            change(wrong);
            return refusal_of([&] { add_rail(other, wrong); });
        };
        CHECK(
            refused([](Rail& r) { r.pad = 0; }).starts_with("rail: expected a bending stiffness"));
        CHECK(refused([](Rail& r) {
                  std::swap(r.seats[0], r.seats[1]);
              }).starts_with("rail: expected ties in their order"));
        CHECK(refused([](Rail& r) { r.seats.resize(1); }).starts_with("rail: expected two ties"));
        CHECK(refused([](Rail& r) {
                  r.axle_loads.clear();
              }).starts_with("rail: expected a load for each axle"));
    }
}
