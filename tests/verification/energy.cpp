#include "scenarios/specimens/small_scene.hpp"
#include "tests/verification/cases.hpp"
#include "tests/verification/cooling.hpp"
#include "tests/verification/gas.hpp"
#include "tests/verification/impacts.hpp"
#include "tests/verification/rest.hpp"

#include <fmt/format.h>

namespace bris::detail {

void verify_gas(Checks& checks) {
    struct Published {
        double steps, hertz, linear;
    };
    // accuracy that a widely used code reports for 64 spheres without friction
    constexpr Published list[]{
        {20, 1.8e-4, 1.8e-3}, {50, 5.1e-5, 1.75e-4}, {100, 3.5e-6, 2.6e-5}, {200, 1.3e-6, 6.9e-6}};
    Gas gas;
    gas.material = linear_material(1e6);
    gas.material.young_modulus = 1e8;
    gas.material.poisson_ratio = 0.25;
    for (const LawName law : {LawName::hertz_frictionless, LawName::linear_frictionless})
        for (const Published& p : list) {
            gas.law = law;
            gas.steps_per_contact = p.steps;
            const GasResult r = run_experiment(gas);
            // where a contact begins or ends the error is of third order or higher, but
            // simultaneous contacts disturb each other
            checks.absolute(fmt::format("{}, dt = t_c/{}: largest relative change of energy",
                                        is_hertz(law) ? "Hertz" : "linear", p.steps),
                            "", 0, r.largest_change, 0.1 * (pi / p.steps) * (pi / p.steps),
                            is_hertz(law) ? p.hertz : p.linear);
            if (p.steps == 20)
                checks.at_least(fmt::format("{}: mean number of touching pairs",
                                            is_hertz(law) ? "Hertz" : "linear"),
                                "", 1, r.contacts);
        }
    gas.steps_per_contact = 200;
    gas.law = LawName::hertz_mindlin;
    gas.material.friction = 0.5;
    checks.at_most("Hertz-Mindlin with friction 0.5: largest relative gain of energy", "", 0,
                   run_experiment(gas).largest_gain, 4e-6, 4e-6);
    gas.law = LawName::hertz_mindlin_viscous;
    gas.material.restitution = 0.8;
    const GasResult damped = run_experiment(gas);
    checks.at_most("restitution 0.8: largest rise of energy between samples", "", 0,
                   damped.largest_rise, 4e-6);
    checks.at_most("restitution 0.8: fraction of energy left", "", 0.9, damped.last);

    for (const double factor : {2.0, 0.5}) {
        const StiffeningResult r = run_experiment(Stiffening{.factor = factor});
        checks.relative(fmt::format("stiffness times {} during contact: added energy", factor), "",
                        r.exact, r.injected, 1e-4);
        checks.relative(fmt::format("stiffness times {} during contact: restitution", factor), "",
                        std::sqrt(factor), r.restitution, 1e-3);
    }
}

void verify_cooling(Checks& checks) {
    Cooling s;
    s.material = linear_material(1e5);
    s.material.young_modulus = 1e8;
    s.material.poisson_ratio = 0.25;
    s.material.restitution = 0.9;
    // a gas of 512 spheres is chaotic: single runs scatter between 0.9995 and 0.9999
    constexpr unsigned runs = 4;
    for (const LawName law : {LawName::linear_viscous, LawName::hertz_mindlin_viscous}) {
        s.law = law;
        double sum = 0;
        for (s.seed = 1; s.seed <= runs; ++s.seed) sum += run_experiment(s).r_squared;
        checks.at_least(
            fmt::format("{}, restitution 0.9: R^2 of 1/sqrt(T) over time, T from 1/2 to "
                        "1/20, mean of {} runs",
                        is_hertz(law) ? "Hertz" : "linear", runs),
            "", 0.9997, sum / runs);
    }
}

void verify_rest(Checks& checks) {
    for (const double ratio : {3.0, 10.0, 50.0}) {
        const RestResult r = run_experiment(SmallBetweenLarge{.ratio = ratio});
        const auto name = [&](const char* what) {
            return fmt::format("sphere at rest between two spheres {} times as large: {}", ratio,
                               what);
        };
        checks.absolute(name("speed over sqrt(g r)"), "", 0, r.speed, 1e-9);
        checks.absolute(name("displacement over r"), "", 0, r.travel, 1e-9);
        checks.absolute(name("resultant force over weight"), "", 0, r.unbalanced, 1e-9);
    }
    const TripodResult tripod = run_experiment(Tripod{});
    checks.relative("clump at rest on three of its spheres: overlap over weight / 3 k", "", 1,
                    tripod.overlap, 1e-9);
    checks.absolute("clump at rest on three of its spheres: tilt", "rad", 0, tripod.tilt, 1e-9);
    checks.relative("clump at rest on three of its spheres: force on the floor over weight", "", 1,
                    tripod.floor_force, 1e-9);
    const PackingResult r = run_experiment(Packing{});
    checks.at_most("packing at rest: unbalanced force ratio", "", 1e-11, r.unbalanced_ratio);
    checks.absolute("packing at rest: force on the box over weight", "", 1, 1 + r.floor_force_error,
                    1e-6);
    checks.absolute("packing at rest: stress mismatch (boundary vs. contact)", "", 0,
                    r.stress_mismatch, 1e-10);
}

} // namespace bris::detail
