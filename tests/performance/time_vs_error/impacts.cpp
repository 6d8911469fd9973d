// S1: a sphere hits a rigid wall. The wall time is that of a whole impact with the construction of
// its scene, so short runs have the same cost, and the number of steps says more. A linear dashpot
// acts at once: for e = 0.2 the largest force is nearly that at the first touch, and the recorded
// force of the first step, a mean over the step times its share, does not measure it
// (share_of_kick).
#include "engine/choice.hpp"
#include "scenarios/collision/impact.hpp"
#include "scenarios/collision/peak.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "tests/performance/time_vs_error/scene.hpp"

#include <cmath>

namespace bris::time_vs_error {

namespace {

struct Exact {
    double overlap, force, time;
}; // m, N, s

/// Solution of m x'' + c x' + k x = 0 from x = 0 with speed v. Each derivative shifts the phase by
/// acos(-b).
Exact linear_impact(const NormalContact& c, double b) {
    const double omega = std::sqrt(c.stiffness / c.mass), root = std::sqrt(1 - b * b),
                 turn = std::acos(-b);
    const double at = std::max(
        0.0, 2 * pi - 3 * turn); // omega_d t of the largest force; 0 (first touch) for b >= 1/2
    const double force = at > 0 ? std::exp(-b / root * at) : 2 * b;
    return {c.speed / omega * std::exp(-b / root * std::atan2(root, b)),
            c.mass * omega * c.speed * force, pi / (omega * root)};
}

/// Hertz contact with the dashpot of Tsuji, Tanaka and Ishida (1992), integrated by the Runge-Kutta
/// method of fourth order. The relative error of 1e-8 at 20 000 steps is negligible.
Exact hertz_impact(const NormalContact& c, double b) {
    if (b == 0) return {c.largest_overlap(), c.largest_force(), c.time()};
    const double h = c.time() / 20'000;
    const auto force = [&](double x, double v) {
        const double depth = std::max(x, 0.0), tangent = 1.5 * c.stiffness * std::sqrt(depth);
        return c.stiffness * depth * std::sqrt(depth) +
               2 * std::sqrt(5.0 / 6) * b * std::sqrt(tangent * c.mass) * v;
    };
    double x = 0, v = c.speed, t = 0;
    Peak overlap, largest;
    do {
        const double a1 = -force(x, v) / c.mass, v2 = v + 0.5 * h * a1;
        const double a2 = -force(x + 0.5 * h * v, v2) / c.mass, v3 = v + 0.5 * h * a2;
        const double a3 = -force(x + 0.5 * h * v2, v3) / c.mass, v4 = v + h * a3;
        const double a4 = -force(x + h * v3, v4) / c.mass;
        x += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
        v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
        t += h;
        overlap.add(x);
        largest.add(force(x, v));
    } while (x > 0);
    return {overlap.value(), largest.value(), t - x / v};
}

Impact impact_of(const Settings& settings) {
    const bool hertz = settings.word("law").starts_with("hertz");
    // aluminium oxide as in Chung and Ooi (2011), test 3
    Material m = linear_material(1e6, 0, 0, 4000);
    m.young_modulus = 3.8e11;
    m.poisson_ratio = 0.23;
    m.restitution = settings.number("restitution");
    Impact s;
    s.radius = 0.0025;
    s.speed = 3.9;
    s.material = m;
    s.partner_material = hertz ? rigid_material() : m;
    s.partner_material.restitution = m.restitution;
    s.law = named<LawName>(settings.word("law"));
    s.steps_per_contact = 1 / settings.number("step");
    return s;
}

Outcome run(const Settings& settings, std::uint64_t seed) {
    Impact impact = impact_of(settings);
    // the phase of a step at which the contact begins is a matter of chance: the phases of the
    // seeds are evenly spread
    const double golden = 0.5 * (std::sqrt(5.0) - 1) * static_cast<double>(seed);
    impact.phase = golden - std::floor(golden);
    ImpactResult r;
    Outcome outcome;
    outcome.wall_time = median_time(51, 0.2, [&] { r = run_experiment(impact); });
    const double e = settings.number("restitution"), b = damping_ratio(e, Tension::allowed);
    const NormalContact contact = normal_contact(impact);
    const Exact exact = contact.hertz ? hertz_impact(contact, b) : linear_impact(contact, b);
    outcome.steps = r.steps;
    outcome.contacts = 1;
    outcome.measured = {{r.largest_overlap, exact.overlap},
                        {r.largest_force, exact.force},
                        {r.contact_time, exact.time},
                        {r.normal_restitution, e}};
    outcome.fingerprint = fingerprint_of(outcome.measured);
    return outcome;
}

} // namespace

Scene single_impacts() {
    Scene scene{"S1",
                "single impacts",
                {{"step", "0.02"}, {"law", "hertz_frictionless"}, {"restitution", "1"}},
                {},
                {},
                run,
                "impact"};
    scene.kinds = {{"overlap", 0.01, true, true},
                   {"force", 0.01, true, true},
                   {"contact_time", 0.01, true, true},
                   {"restitution", 5e-3, false, true}};
    const std::vector<std::string> steps{"0.1", "0.05", "0.02", "0.01", "0.005", "0.002", "0.001"};
    for (const bool hertz : {false, true})
        for (const char* e : {"1", "0.9", "0.5", "0.2"}) {
            const std::string kind = hertz ? "hertz" : "linear";
            const std::string law = std::string(e) == "1" ? kind + "_frictionless"
                                    : hertz               ? "hertz_mindlin_viscous"
                                                          : "linear_viscous";
            scene.knobs.push_back({"step, " + kind + ", e = " + e,
                                   "step",
                                   steps,
                                   {{"law", law}, {"restitution", e}}});
        }
    return scene;
}

} // namespace bris::time_vs_error
