#include "tests/verification/cases.hpp"
#include "tests/verification/impacts.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris::detail {

namespace {

struct Elastic {
    const char* name;
    Material material;
    double radius, speed, overlap, force, time;
    bool pair;
};

void check_elastic(Checks& checks, const Elastic& c, const Impact& impact) {
    const ImpactResult r = run_experiment(impact);
    const std::string name = c.name;
    checks.relative(name + ": largest overlap", "m", c.overlap, r.largest_overlap, 1e-4, 1e-5);
    checks.relative(name + ": largest force", "N", c.force, r.largest_force, 1e-4, 1e-5);
    checks.relative(name + ": contact time", "s", c.time, r.contact_time, 1e-4, 1e-5);
    checks.absolute(name + ": restitution", "", 1, r.normal_restitution, 1e-4);
    if (impact.target != Target::sphere) return;
    checks.absolute(name + ": change of momentum", "", 0, r.momentum_change, 1e-15, 1e-15);
    checks.absolute(name + ": change of angular momentum", "", 0, r.angular_momentum_change, 1e-13,
                    1e-13);
}

} // namespace

// materials of Chung and Ooi (2011), tests 1 and 2; overlap, force and contact time by Hertz (1882)
void verify_elastic_impacts(Checks& checks) {
    const Elastic list[]{{"glass pair", elastic("glass", 4.8e10, 0.20, 2800), 0.01, 20,
                          2.741127021e-04, 1.069688898e+04, 4.033945569e-05, true},
                         {"limestone pair", elastic("limestone", 2.0e10, 0.25, 2500), 0.01, 20,
                          3.683040256e-04, 7.108241280e+03, 5.420100493e-05, true},
                         {"Al alloy on wall", elastic("Al alloy", 7.0e10, 0.30, 2699), 0.1, 0.2,
                          4.971717524e-05, 1.136985831e+04, 7.316566406e-04, false},
                         {"Mg alloy on wall", elastic("Mg alloy", 4.0e10, 0.35, 1800), 0.1, 0.2,
                          5.212328832e-05, 7.232681026e+03, 7.670659052e-04, false},
                         {"Al oxide on wall", elastic("Al oxide", 3.8e11, 0.23, 4000), 0.0025, 3.9,
                          8.088808264e-06, 6.153515695e+02, 6.104509907e-06, false},
                         {"cast iron on wall", elastic("cast iron", 1.0e11, 0.25, 7000), 0.0025,
                          3.9, 1.718871359e-05, 5.067602331e+02, 1.297208055e-05, false}};
    for (const Elastic& c : list) {
        Impact s = on_wall(c.material, c.radius, c.speed, LawName::hertz_mindlin);
        if (c.pair) {
            s.target = Target::sphere;
            s.partner_radius = c.radius;
            s.partner_material = c.material;
            s.partner_share = 0.5;
        }
        s.steps_per_contact = 100;
        check_elastic(checks, c, s);
    }
}

void verify_impact_scaling(Checks& checks) {
    const Material glass = elastic("glass", 4.8e10, 0.20, 2800);
    const auto at = [&](double speed) {
        Impact s = on_wall(glass, 0.01, speed, LawName::hertz_frictionless);
        s.steps_per_contact = 400;
        return run_experiment(s);
    };
    const ImpactResult slow = at(0.01), fast = at(10);
    checks.absolute("Hertz, 0.01 to 10 m/s: exponent of speed in the largest force", "", 1.2,
                    std::log(fast.largest_force / slow.largest_force) / std::log(1e3), 1e-4);
    checks.absolute("Hertz, 0.01 to 10 m/s: exponent of speed in the contact time", "", -0.2,
                    std::log(fast.contact_time / slow.contact_time) / std::log(1e3), 1e-4);
    for (const double e : {1.0, 0.5}) {
        Material m = linear_material(1e6);
        m.restitution = e;
        Impact s = on_wall(m, 0.01, 1, LawName::linear_viscous);
        s.partner_material = m;
        s.steps_per_contact = 1000;
        const double b = damping_ratio(e, Tension::allowed),
                     exact = normal_contact(s).time() / std::sqrt(1 - b * b);
        for (const double speed : {0.01, 1.0}) {
            s.speed = speed;
            checks.relative(fmt::format("linear, e = {}, {} m/s: contact time", e, speed), "s",
                            exact, run_experiment(s).contact_time, 5e-4, 5e-4);
        }
    }
    // an undamped contact converges with second order in dt: errors at 100 and 200 steps
    const auto error = [&](double steps) {
        Impact s = on_wall(glass, 0.01, 1, LawName::hertz_frictionless);
        s.steps_per_contact = steps;
        return std::abs(run_experiment(s).largest_overlap / normal_contact(s).largest_overlap() -
                        1);
    };
    checks.absolute("Hertz, 1 m/s: order in dt of the largest overlap", "", 2,
                    std::log2(error(100) / error(200)), 0.2);
}

namespace {

/// Restitution with the largest error among three phases of a time step at which the contact
/// begins, since this phase is a matter of chance.
double worst_restitution(Impact s, double expected) {
    double worst = expected;
    for (const double phase : {0.1, 0.5, 0.9}) {
        s.phase = phase;
        const double e = run_experiment(s).normal_restitution;
        if (std::abs(e - expected) > std::abs(worst - expected)) worst = e;
    }
    return worst;
}

struct Restitution {
    double in, cut;
};
// nominal restitution, and its exact value if tension is cut (Schwager and Poeschel 2007)
constexpr Restitution map[]{{0.1, 0.25272938}, {0.2, 0.32486285}, {0.3, 0.39714050},
                            {0.5, 0.55028317}, {0.7, 0.71820136}, {0.9, 0.90202607},
                            {0.98, 0.98008106}};

} // namespace

void verify_restitution(Checks& checks) {
    const char* const names[]{"tension allowed", "tension cut", "tension calibrated"};
    for (const LawName law : {LawName::linear_viscous, LawName::hertz_mindlin_viscous})
        for (const Restitution& e : map)
            for (const Tension tension : {Tension::allowed, Tension::cut, Tension::calibrated}) {
                Material m = linear_material(1e6);
                m = is_hertz(law) ? elastic("Al oxide", 3.8e11, 0.23, 4000) : m;
                m.restitution = e.in;
                Impact s = on_wall(m, 0.0025, 3.9, law);
                if (!is_hertz(law)) s.partner_material = m;
                s.policy.tension = tension;
                const double expected = tension == Tension::cut ? e.cut : e.in;
                const auto name = fmt::format("{}, e = {}, {}", is_hertz(law) ? "Hertz" : "linear",
                                              e.in, names[static_cast<std::size_t>(tension)]);
                s.steps_per_contact = 50;
                checks.absolute(name + ", dt = t_c/50: restitution", "", expected,
                                worst_restitution(s, expected), 5e-3, 3.8e-3);
                if (e.in != 0.5) continue;
                s.steps_per_contact = 1000;
                checks.absolute(name + ", dt = t_c/1000: restitution", "", expected,
                                worst_restitution(s, expected), 2e-4, 2.1e-4);
            }
    Material iron = elastic("cast iron", 1.0e11, 0.25, 7000); // the second material of test 3
    for (const double e : {0.2, 0.6, 1.0}) {
        iron.restitution = e;
        Impact s = on_wall(iron, 0.0025, 3.9, LawName::hertz_mindlin_viscous);
        s.steps_per_contact = 200;
        checks.absolute(fmt::format("cast iron, e = {}, dt = t_c/200: restitution", e), "", e,
                        worst_restitution(s, e), 8.6e-4, 8.6e-4);
    }
}

} // namespace bris::detail
