// Compares the engine with exact solutions: every group of checks, with the numbers that fail; or
// one impact of the user's own sphere with its law integrated in fine steps.
#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/report.hpp"
#include "engine/run.hpp"
#include "tests/verification/cases.hpp"
#include "tests/verification/impacts.hpp"
#include "tests/verification/table.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace {

using namespace bris;

constexpr const char* own_impact = "impact";

struct Verify {
    std::string only;
    bool list = false;
    Impact impact = detail::on_wall(detail::elastic("sphere", 5e9, 0.25, 2650, 0.5, 0.5), 0.02, 1,
                                    LawName::hertz_mindlin_viscous);
    double angle = 20, tolerance = 0.01; // degrees; share

    Verify() { impact.steps_per_contact = 100; }
    void declare_options(auto& option) {
        std::vector<std::string> names{"", own_impact};
        for (const VerificationCase& c : verification_cases()) names.emplace_back(c.name);
        option(
            "case", only, "",
            "Run one group of checks only. Empty: run all groups. impact: one impact of a sphere "
            "of your own.",
            names);
        option("list", list, "",
               "Print the groups with the sources of their exact values and end.");
        option.group("An impact of your own (--case impact)");
        Material& m = impact.material;
        option("radius", impact.radius, "m", "Radius of the sphere that hits a rigid wall.",
               above(0, 1e3));
        option("speed", impact.speed, "m/s", "Speed of the sphere.", above(0, 1e4));
        option("angle", angle, "degrees", "Angle between the velocity and the normal of the wall.",
               within(1, 89));
        option("friction", m.friction, "", "Coulomb friction coefficient.", within(0, 100));
        option("restitution", m.restitution, "", "Coefficient of restitution.", above(0, 1));
        option("young_modulus", m.young_modulus, "Pa", "Young's modulus.", above(0, 1e20));
        option("poisson_ratio", m.poisson_ratio, "", "Poisson's ratio.", above(-1, 0.5));
        option("density", m.density, "kg/m3", "Density.", above(0, 1e6));
        option("steps_per_contact", impact.steps_per_contact, "",
               "Number of time steps in the undamped contact time.", above(1, 1e8));
        option("tolerance", tolerance, "",
               "Largest relative error of the impact, as a share. Above it the check fails.",
               above(0, 1));
    }
    /// The wall has the sphere's own restitution and friction.
    Impact complete() const {
        Impact s = detail::on_wall(impact.material, impact.radius, impact.speed, impact.law);
        s.angle = angle * detail::degree;
        s.steps_per_contact = impact.steps_per_contact;
        return s;
    }
};

std::vector<Check> run_checks(const Verify& settings, const Common& common) {
    if (settings.only == own_impact)
        return verify_impact(own_impact, settings.complete(), settings.tolerance);
    std::vector<std::string> names;
    for (const VerificationCase& c : verification_cases())
        if (settings.only.empty() || settings.only == c.name) names.emplace_back(c.name);
    std::vector<Check> checks;
    run_cases(common, names, [&](std::size_t k) {
        for (Check& check : verify(names[k])) checks.push_back(std::move(check));
    });
    return checks;
}

void check_options(const Verify& settings, const Common&) { check(settings.complete()); }

void run(const Verify& settings, const Common& common) {
    if (settings.list) {
        for (const VerificationCase& c : verification_cases())
            fmt::print("{:<16} {}\n", c.name, c.source);
        return;
    }
    const std::vector<Check> checks = run_checks(settings, common);
    write_whole(common.out / "verification.csv", csv_of(checks));
    Report results;
    add_checks(results, checks);
    results.show({"checks", "failing"});
    results.show_sentence(table_of(closest_to_tolerance(checks, 9)));
    results.show_sentence("All numbers with their exact values and tolerances are in " +
                          (common.out / "verification.csv").string() + ".");
    report_results(common, results);
    if (const std::string failing = names_of_failing(checks); !failing.empty())
        throw SimulationError("verify: these checks fail: " + failing);
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Verify>(
        argc, argv,
        {"verify", "Compares the engine with exact solutions.", "its runs are short",
         "it runs many small scenes, which --list prints"},
        check_options, run, [](const Verify&, const Common&) { return std::string(); });
}
