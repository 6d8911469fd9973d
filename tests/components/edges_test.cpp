#include "components/elasticity.hpp"
#include "components/laws/table.hpp"
#include "engine/errors.hpp"
#include "scenarios/specimens/rock_edges.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/contact/energy_budget.hpp"
#include "systems/output/quantities.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

/// Rock of the check values: E = 10 GPa, nu = 0.2, strength 60 MPa, cone of 85 degrees, tip of 0.1
/// m.
Material rock() {
    Material m{.name = "rock", .friction = 0.5, .young_modulus = 1e10, .poisson_ratio = 0.2};
    m.contact_strength = 6e7;
    m.cone_half_angle = 85 * pi / 180;
    m.edge_radius = 0.1;
    return m;
}

/// One contact between two materials under the law, the same in all lanes.
struct Contact {
    Materials materials;
    ContactPolicy policy;
    double dt = 1e-5, inverse_mass = 1e-6, radius = 0.05;
    SpringLanes spring{};
    RollLanes roll{};
    Lane worn{};

    explicit Contact(const Material& a, const Material& b = rock()) {
        materials.add(a);
        materials.add(b);
        policy = materials.policy;
    }
    const LawRow& hertz() const { return materials.hertz_pairs[1]; }
    const EdgeRow& edges() const { return materials.edge_pairs[1]; }

    template <class L = HertzEdges>
    ForceLanes step(double overlap, double closing = 0, const Vec3& sliding = Vec3::Zero(),
                    const Vec3& turning = Vec3::Zero()) {
        ContactLanes c{lanes(0),     lanes(0), lanes(1), lanes(overlap), lanes(inverse_mass),
                       lanes(radius)};
        c.closing = lanes(closing);
        c.ux = c.vx = lanes(sliding.x());
        c.vz = lanes(-closing);
        c.wx = lanes(turning.x());
        c.wz = lanes(turning.z());
        const LawRow& row = L::Normal::rows(materials)[1];
        const RollingRow& r = materials.rolling_pairs[1];
        const EdgeRow& e = edges();
        CoefficientLanes k{lanes(row.kn), lanes(row.ks), lanes(row.friction), {}, {}, {}, {}};
        k.edges = {lanes(e.yield_ratio), lanes(e.blunting),        lanes(e.radius),
                   lanes(e.rise),        lanes(e.easing_pressure), lanes(e.easing_force),
                   lanes(e.arm),         lanes(e.couple_easing)};
        const RollingLanes rolling{lanes(r.rolling_friction), lanes(r.twisting_friction),
                                   lanes(r.stiffness_ratio), lanes(r.damping_ratio)};
        const LawStep with(policy, dt, true);
        if constexpr (L::has_wear)
            return L::force(c, k, rolling, with, spring, roll, worn);
        else
            return L::force(c, k, rolling, with, spring, roll);
    }
};

/// Force (N) of a first loading to the overlap d, once the edge yields: 4/3 E* h^3 R^2.
double first_loading(double modulus, double h, double f, double tip, double d) {
    const double radius = (d + tip * f) / (h * h + f);
    return 4.0 / 3 * modulus * h * h * h * radius * radius;
}

} // namespace

TEST_SUITE("contact/edges") {
    TEST_CASE("conical damage has the overlap, force and radius of the published check values") {
        struct Check {
            double overlap, force, radius;
        };
        // E = 10 GPa, nu = 0.2, s = 60 MPa, a = 85 degrees, R0 = 0.1 and 0.05 m; computed apart
        // from this code from the equations of Harkness et al. (2016)
        for (const auto& [partner_tip, check] :
             {std::pair{0.0, Check{5.61227e-5, 459.1828, 0.1056368}},
              std::pair{0.1, Check{7.43693e-5, 168.4617, 0.0639842}}}) {
            Material partner = rock();
            partner.edge_radius = partner_tip; // 0: a plane
            Contact contact(rock(), partner);
            const ForceLanes f = contact.step(check.overlap);
            CHECK(f.z[0] == about(check.force).epsilon(1e-5));
            CHECK(double{contact.worn[0]} == about(check.radius).epsilon(1e-5));
            const Blunted<double> edge = blunt(contact.edges(), check.overlap, contact.radius, 0.0);
            CHECK(2 * contact.hertz().kn / pi * std::sqrt(edge.overlap / edge.radius) ==
                  about(6e7).epsilon(1e-12));
        }
        Material rigid{.name = "rigid", .young_modulus = 1e30};
        Contact on_rigid(rock(), rigid);
        CHECK(on_rigid.step(5.61227e-5).z[0] == about(129.70).epsilon(1e-4));
        CHECK(double{on_rigid.worn[0]} == about(0.112286).epsilon(1e-5));
    }

    TEST_CASE("a blunted contact loads, unloads and loads again along the closed form, and yields "
              "where the pressure of Hertz reaches the strength") {
        Contact contact{rock()};
        const double modulus = contact.hertz().kn, h = contact.edges().yield_ratio,
                     f = contact.edges().blunting, tip = 0.05, deepest = 4e-5,
                     yields_at = h * h * tip;
        CHECK(4.0 / 3 * modulus * std::sqrt(tip) * std::pow(yields_at, 1.5) ==
              about(std::pow(pi, 3) * tip * tip * std::pow(6e7, 3) / (6 * modulus * modulus))
                  .epsilon(1e-12));
        const double worn = (deepest + tip * f) / (h * h + f);
        const auto elastic = [&](double d, double radius) {
            return 4.0 / 3 * modulus * std::sqrt(radius) *
                   std::pow(std::max(d - (radius - tip) * f, 0.0), 1.5);
        };
        double work = 0, taken = 0, before = 0, at = 0;
        const auto go_to = [&](double overlap) { // the work by the trapezoidal rule
            const ForceLanes force = contact.step(overlap, (overlap - at) / contact.dt);
            work += 0.5 * (force.z[0] + before) * (overlap - at);
            taken += force.work.wear[0];
            before = force.z[0];
            at = overlap;
            return force.z[0];
        };
        constexpr int n = 4000;
        for (int k = 2; k <= n; ++k) { // the first step of a contact has a part of the force
            const double d = deepest * k / n, exact = d < yields_at
                                                          ? elastic(d, tip)
                                                          : first_loading(modulus, h, f, tip, d);
            const double found = go_to(d);
            if (k > 3) CHECK(found == about(exact).epsilon(1e-8));
        }
        for (int k = n; k-- > 1;) {
            const double d = deepest * k / n;
            const double found = go_to(d), exact = elastic(d, worn);
            // the step in which the force ends is corrected for the part of it that had no contact
            CHECK(std::abs(found - exact) <=
                  (exact > 0 ? 1e-8 * exact : 1e-6 * elastic(deepest, worn)));
            CHECK(double{contact.worn[0]} == about(worn).epsilon(1e-12));
        }
        CHECK(work == about(taken).epsilon(2e-4)); // what the cycle took, edges have dissipated
        CHECK(taken > 0);
        (void)go_to(deepest / 2);
        const auto rest_at = [&](double overlap) {
            (void)go_to(overlap);
            return go_to(overlap);
        };
        for (const double d : {0.8 * deepest, 0.999 * deepest})
            CHECK(rest_at(d) == about(elastic(d, worn)).epsilon(1e-8));
        CHECK(rest_at(1.5 * deepest) ==
              about(first_loading(modulus, h, f, tip, 1.5 * deepest)).epsilon(1e-8));
        (void)contact.step(-1e-6, -1e-6 / contact.dt);
        // surfaces that have parted meet as if for the first time
        CHECK(double{contact.worn[0]} == 0);
        CHECK(double{contact.spring.stiffness[0]} == 0);
    }

    TEST_CASE("the energy of a contact that yields is the integral of its unloading") {
        Contact contact{rock()};
        const double deepest = 4e-5;
        (void)contact.step(deepest);
        const double worn = contact.worn[0];
        const auto energy = [&](double overlap) {
            return elasticity_of(traits(LawName::hertz_edges), contact.materials, 1, overlap,
                                 contact.radius, worn)
                .energy;
        };
        double work = 0, before = contact.step(deepest).z[0];
        constexpr int n = 4000;
        for (int k = n; k-- > 1;) {
            const double now = contact.step(deepest * k / n).z[0];
            work += 0.5 * (now + before) * deepest / n;
            before = now;
        }
        CHECK(energy(deepest) == about(work).epsilon(1e-5));
        CHECK(energy(deepest / n) == 0);
        CHECK(energy(deepest) < // the edge has dissipated the rest
              elasticity_of(traits(LawName::hertz_mindlin), contact.materials, 1, deepest, 0.05,
                            Worn::never)
                  .energy);
    }

    TEST_CASE("damage takes energy up to h^2 = 5 f, and would create it beyond") {
        for (const double degrees : {60.0, 85.0, 89.0, 89.5}) {
            Material m = rock();
            m.cone_half_angle = degrees * pi / 180;
            Contact contact(m, m);
            const EdgeRow& e = contact.edges();
            const bool is_passive = e.yield_ratio * e.yield_ratio < 5 * e.blunting;
            CHECK(is_passive == (degrees < 89.3));
            CHECK(damage_is_passive(e) == is_passive);
            CHECK((contact.step(1e-3).work.wear[0] > 0) == is_passive);
        }
    }

    TEST_CASE("friction falls with the mean pressure of a Hertz contact, and with the force of a "
              "linear one") {
        Material m = rock();
        m.normal_stiffness = m.shear_stiffness = 1e9;
        m.contact_strength = 0;
        m.friction_rise = 0.4;
        m.friction_half_pressure = 3e7;
        m.friction_half_force = 60;
        for (const double overlap : {1e-7, 1e-6, 1e-5, 1e-4}) {
            Contact hertz(m, m), linear(m, m);
            ForceLanes f{}, g{};
            for (int k = 0; k < 2000; ++k) {
                f = hertz.step(overlap, 0, Vec3(3 * std::sqrt(overlap), 0, 0));
                g = linear.step<LinearEdges>(overlap, 0, Vec3(1, 0, 0));
            }
            const double force =
                             4.0 / 3 * hertz.hertz().kn * std::sqrt(0.05) * std::pow(overlap, 1.5),
                         pressure = force / (pi * 0.05 * overlap);
            CHECK(-f.x[0] == about((0.5 + 0.4 / (1 + pressure / 3e7)) * force).epsilon(1e-12));
            const double push = 5e8 * overlap;
            CHECK(-g.x[0] == about((0.5 + 0.4 / (1 + push / 60)) * push).epsilon(1e-12));
        }
    }

    TEST_CASE("a yielded contact has a mean pressure of two thirds of the strength") {
        Contact contact{rock()};
        const double force = contact.step(5e-5).z[0];
        const Blunted<double> edge = blunt(contact.edges(), 5e-5, 0.05, 0.0);
        CHECK(force / (pi * edge.radius * edge.overlap) == about(2.0 / 3 * 6e7).epsilon(1e-12));
    }

    TEST_CASE("the couple of edges has its own arm, and approaches its strength") {
        Material m = rock();
        m.normal_stiffness = m.shear_stiffness = 1e9;
        m.contact_strength = 0;
        m.rolling_friction = 0.8;
        m.twisting_friction = 0.5;
        m.couple_arm = 0.004;
        m.couple_force = 60;
        for (const double overlap : {1e-8, 1e-7, 1e-5}) {
            Contact hertz(m, m), linear(m, m);
            ForceLanes f{}, g{};
            for (int k = 0; k < 3000; ++k) {
                f = hertz.step(overlap, 0, Vec3::Zero(), Vec3(100, 0, 100));
                g = linear.step<LinearEdges>(overlap, 0, Vec3::Zero(), Vec3(100, 0, 100));
            }
            for (const ForceLanes* found : {&f, &g}) {
                const double force = found->normal[0], most = 0.004 * force / (1 + force / 60);
                CHECK(force > 0);
                CHECK(-found->torque_x[0] == about(0.8 * most).epsilon(1e-12));
                CHECK(-found->torque_z[0] == about(0.5 * most).epsilon(1e-12));
            }
        }
    }

    TEST_CASE("without coefficients of edges the law is that of Hertz and Mindlin, to the bit") {
        Material m = rock();
        m.contact_strength = 0;
        m.edge_radius = 0;
        Contact edges(m, m), plain(m, m);
        for (int k = 0; k < 200; ++k) {
            const double overlap = 1e-5 * std::sin(0.05 * k), closing = 5e-2 * std::cos(0.05 * k);
            const Vec3 sliding(0.1 * std::cos(0.3 * k), 0, 0);
            const ForceLanes f = edges.step(overlap, closing, sliding, Vec3(1, 0, 2)),
                             g = plain.step<HertzMindlinViscous>(overlap, closing, sliding);
            CHECK(f.x[0] == g.x[0]);
            CHECK(f.z[0] == g.z[0]);
            CHECK(f.torque_x[0] == 0);
        }
    }

    TEST_CASE("a contact is at yield while it is loaded, and not after it was unloaded a little") {
        World world = make_world(Grains::spheres);
        Material m = rock();
        m.density = 1e30; // so heavy that no force moves it
        const auto material = world.resource<Materials>().add(m);
        add_sphere(world, Vec3::Zero(), 0.1, material);
        const EntityId led = add_sphere(world, Vec3(0, 0, 0.2), 0.1, material, Motion::prescribed);
        constexpr double dt = 1e-5, speed = 0.1;
        Simulation simulation = begin(
            std::move(world),
            {.dt = dt, .law = LawName::hertz_edges, .energy_budget = true, .unlimited = true});
        const auto go = [&](double velocity, unsigned steps) {
            value_of<DriveVelocity>(simulation.world(), led) = Vec3(0, 0, velocity);
            simulation.advance(steps);
            return share_at_yield(simulation.world());
        };
        CHECK(go(-speed, 10) == 0); // 10 um: the edge yields at 16
        CHECK(go(-speed, 30) == 1);
        const double wear = dissipated_in_contacts(simulation.world());
        CHECK(wear > 0);
        CHECK(go(speed, 2) == 0);
        CHECK(go(-speed, 4) == 1);
    }

    TEST_CASE("edges are refused by name under a law that does not read them") {
        const auto refusal = [](const RockEdges& edges, LawName law) -> std::string {
            try {
                require_edges_are_read(edges, law);
            } catch (const InputError& error) {
                return error.what();
            }
            return "";
        };
        CHECK(refusal({}, LawName::linear) == "");
        CHECK(refusal({.couple_arm = 0.005}, LawName::linear_edges) == "");
        CHECK(refusal({.contact_strength = 1e9}, LawName::hertz_edges) == "");
        CHECK(refusal({.couple_arm = 0.005}, LawName::hertz_mindlin) ==
              "--law: expected linear_edges or hertz_edges, as --contact-strength, --friction-rise "
              "or --couple-arm is given, found hertz_mindlin");
        CHECK(
            refusal({.contact_strength = 1e9}, LawName::linear_edges) ==
            "--contact-strength: expected --law hertz_edges, as other contacts do not yield, found "
            "linear_edges");
    }

    TEST_CASE("coefficients of edges are saved, and a boundary without edges has no part in them") {
        Materials materials;
        materials.add(rock());
        Material wall{.name = "wall", .friction = 0.3, .young_modulus = 1e30};
        materials.add(wall);
        Archive archive;
        materials.save(archive);
        Materials other;
        other.list.resize(2);
        other.load(archive);
        CHECK(other.list[0].contact_strength == 6e7);
        CHECK(other.list[1].contact_strength == 0);
        const EdgeRow& e = materials.edge_pairs[1];
        CHECK(e.radius == 0.1); // a flat wall
        CHECK(e.yield_ratio == about(0.5 * pi * 6e7 / materials.hertz_pairs[1].kn));
        CHECK(e.arm == 0);
        materials.list[0].friction_rise = 0.2;
        materials.mix();
        CHECK(materials.edge_pairs[0].rise == 0.2);
        CHECK(materials.edge_pairs[1].rise == 0);
        materials.set_pair(0, 0, {.friction = 0.25}); // half of the friction: half of its rise
        CHECK(materials.edge_pairs[0].rise == about(0.1));
        materials.weaken({{.pair = 0, .friction = 0.5, .stiffness = 0.5}});
        CHECK(materials.edge_pairs[4].rise == about(0.05));
        CHECK(materials.edge_pairs[4].yield_ratio == materials.edge_pairs[0].yield_ratio);
    }
}
