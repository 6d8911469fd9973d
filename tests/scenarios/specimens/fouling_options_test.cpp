#include "scenarios/specimens/fouling_options.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

TEST_SUITE("specimens/fouling_options") {
    TEST_CASE("kinds of fines state what is theirs, and the order that tests have found") {
        const auto of = [](const char* kind) { return of_kind({.kind = kind}); };
        const LocalFouling dry{0.4, 0}, wet{0.4, 1};
        const auto mineral = of("mineral"), clay = of("clay"), coal = of("coal");
        // dry dust of the ballast costs no strength; soil at a VCI of 40 % 36 % of its tangent
        CHECK(mineral.law.friction_factor(dry) == 1);
        CHECK(clay.law.friction_factor(dry) == doctest::Approx(0.64).epsilon(1e-3));
        CHECK(coal.settings.density < 0.6 * clay.settings.density);
        for (const auto* fines : {&mineral, &clay, &coal}) {
            CHECK(fines->law.friction_factor(wet) < fines->law.friction_factor(dry));
            CHECK(fines->law.stiffness_factor(wet) < fines->law.stiffness_factor(dry));
            CHECK(fines->law.stiffness_factor(dry) < 1);
        }
        CHECK(clay.law.stiffness_factor(wet) < mineral.law.stiffness_factor(wet));
        // assumed: as the options say
        FoulingOptions given{.law = {.friction_loss = 0.2}};
        CHECK(of_kind(given).law.friction_loss == 0.2);
    }

    TEST_CASE("a kind of fines takes no other law beside its own") {
        FoulingOptions o{.p4 = 10, .kind = "clay"};
        CHECK(refusal_of([&] { check_fouling(o); }) == "");
        o.law.wet_cushion = 3;
        CHECK(refusal_of([&] { check_fouling(o); }).starts_with("--fouling-kind: expected none"));
        o.kind = "assumed";
        CHECK(refusal_of([&] { check_fouling(o); }) == "");
    }
}
