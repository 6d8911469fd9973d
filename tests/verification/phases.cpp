#include "engine/random.hpp"
#include "tests/verification/cases.hpp"
#include "tests/verification/impacts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris::detail {

namespace {

constexpr std::uint64_t phase_stream = 1;

/// Restitution of a linear contact whose normal force ends at zero (Schwager and Poeschel 2007,
/// eq. 21), which is also that of a Hertz contact with Tsuji's dashpot of the same nominal
/// restitution. Valid for damping ratios below 1/sqrt(2), a nominal restitution above 0.043.
double restitution_without_tension(double nominal) {
    const double b = damping_ratio(nominal, Tension::allowed), root = std::sqrt(1 - b * b);
    return std::exp(-b / root * (pi - std::atan2(2 * b * root, 1 - 2 * b * b)));
}

enum class Partner { equal, threefold, plane };

Impact impact_of(LawName law, Tension tension, Partner partner, double restitution) {
    Material m = is_hertz(law) ? elastic("glass", 4.8e10, 0.2, 2800) : linear_material(1e6);
    m.restitution = restitution;
    Impact s;
    s.law = law;
    s.policy.tension = tension;
    s.material = s.partner_material = m;
    s.radius = 0.01;
    s.partner_radius = partner == Partner::threefold ? 0.03 : 0.01;
    s.target = partner == Partner::plane ? Target::plane : Target::sphere;
    s.partner_share = partner == Partner::plane ? 0 : 0.3;
    s.speed = 1;
    return s;
}

/// Largest error of restitution over random phases of a time step at which the contact begins.
double worst_error(Impact s, double expected, double steps, int phases) {
    s.steps_per_contact = steps;
    double worst = 0;
    for (int k = 0; k < phases; ++k) {
        s.phase = Random(phase_stream, static_cast<std::uint64_t>(k)).uniform();
        worst = std::max(worst, std::abs(run_experiment(s).normal_restitution - expected));
    }
    return worst;
}

} // namespace

void verify_phases(Checks& checks) {
    const char* const policies[]{"tension allowed", "tension cut", "tension calibrated"};
    const char* const partners[]{"equal spheres", "radii 1:3", "plane"};
    for (const LawName law : {LawName::linear_viscous, LawName::hertz_mindlin_viscous})
        for (const Tension tension : {Tension::allowed, Tension::cut, Tension::calibrated})
            for (const Partner partner : {Partner::equal, Partner::threefold, Partner::plane})
                for (const double e : {0.2, 0.35, 0.5, 0.85}) {
                    const Impact s = impact_of(law, tension, partner, e);
                    const double expected =
                        tension == Tension::cut ? restitution_without_tension(e) : e;
                    const auto name =
                        fmt::format("{}, {}, {}, e = {}", is_hertz(law) ? "Hertz" : "linear",
                                    policies[static_cast<std::size_t>(tension)],
                                    partners[static_cast<std::size_t>(partner)], e);
                    checks.absolute(name +
                                        ", dt = t_c/50, 400 phases: largest error of restitution",
                                    "", 0, worst_error(s, expected, 50, 400), 1.5e-3);
                    const double coarse = worst_error(s, expected, 100, 25),
                                 fine = worst_error(s, expected, 800, 25);
                    checks.at_least(name + ": order in dt, t_c/100 to t_c/800", "", 1.8,
                                    std::log2(coarse / fine) / 3);
                }
}

} // namespace bris::detail
