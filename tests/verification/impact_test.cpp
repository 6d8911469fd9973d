#include "engine/errors.hpp"
#include "scenarios/collision/impact.hpp"
#include "scenarios/specimens/scene.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("verification/impact") {
    TEST_CASE("a step in which a strong dashpot would reverse the velocity is refused, and the "
              "number of steps in the message is sufficient") {
        struct Case {
            LawName law;
            double restitution, steps;
        };
        for (const auto& [law, restitution, steps] :
             {Case{LawName::linear_viscous, 1e-4, 100},
              Case{LawName::hertz_mindlin_viscous, 0.05, 5}}) {
            Impact s;
            s.law = law;
            s.target = Target::sphere;
            s.material = linear_material(1e6);
            s.material.young_modulus = 1e9;
            s.material.poisson_ratio = 0.25;
            s.material.restitution = restitution;
            s.partner_material = s.material;
            s.policy.tension = Tension::calibrated;
            s.steps_per_contact = steps;
            CAPTURE(static_cast<int>(law));
            std::string what;
            try {
                (void)run_experiment(s);
            } catch (const InputError& error) {
                what = error.what();
            }
            const auto named = what.find("not enough, ");
            REQUIRE(named != std::string::npos);
            s.steps_per_contact = std::stod(what.substr(named + 12));
            const double e = run_experiment(s).normal_restitution;
            CHECK(e >= 0);
            CHECK(e < 0.2);
            s.material.restitution = s.partner_material.restitution = 0.5;
            s.steps_per_contact = 20;
            CHECK_NOTHROW((void)run_experiment(s));
        }
    }
}
