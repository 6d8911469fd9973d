#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/forecast/forecast_results.hpp"
#include "scenarios/forecast/passage_forecast.hpp"
#include "scenarios/monitoring/passage.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/monitoring/passing_rock.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>

using namespace bris;
using namespace bris::testing;

namespace {

/// Movements of a site whose two rocks are deflected under the next train as 150 and 200 kN would
/// do by the compliances of the last one, to a few per cent.
MemberMovements site(Random& random) {
    MemberMovements m;
    for (const double load : {150e3, 200e3}) {
        const double compliance = 1e-8 * std::exp(0.4 * random.normal());
        m.last.rocks.push_back({0, 0, compliance});
        m.next.rocks.push_back({load * compliance * std::exp(0.05 * random.normal()), 0, 0});
    }
    m.next.tie.settlement = 1e-4 * (3 + random.normal());
    return m;
}

std::vector<MemberMovements> sixteen(std::uint64_t seed) {
    Random random(seed, 1);
    std::vector<MemberMovements> members;
    for (int k = 0; k < 16; ++k) members.push_back(site(random));
    return members;
}

const std::vector<std::string> three_names{"a", "b", "c"};

std::string error_of(const TemporaryDirectory& folder, const std::string& rows) {
    const auto file = folder / "movements.csv";
    std::ofstream(file) << "sensor,compliance_um_per_kN,deviation_um_per_kN\n" << rows;
    return message_of<InputError>([&] { read_movements(file, three_names); });
}

} // namespace

TEST_SUITE("forecast/passage_forecast") {
    TEST_CASE("a recorded rock is forecast from its own movement, another one from the members") {
        const auto members = sixteen(3);
        const PassageForecast f = forecast_passage(members, {{1, 2e-8, 2e-10}});
        REQUIRE(f.rocks.size() == 2);
        CHECK(f.rocks[1].quantile(0.5) == about(4e-3).epsilon(0.05));
        CHECK(f.rocks[1].probability_above(3e-3) > 0.99);
        CHECK(f.rocks[1].probability_above(5e-3) < 0.01);
        CHECK(f.rocks[0].logarithm.scale == f.rocks[0].members.scale);
        CHECK(f.rocks[0].logarithm.scale > 5 * f.rocks[1].logarithm.scale);
        CHECK(f.settlement.centre == about(3e-4).epsilon(0.3));
    }

    TEST_CASE("bands of 90 % contain nine of ten sites that follow the members' distribution") {
        int inside = 0, sites = 0;
        for (std::uint64_t seed = 10; seed < 60; ++seed) {
            const auto members = sixteen(seed);
            Random random(seed, 2);
            for (int k = 0; k < 20; ++k, ++sites) {
                const MemberMovements truth = site(random);
                const auto f = forecast_passage(
                    members, recorded(truth.last, {}, 1000 * seed + std::uint64_t(k)));
                const double found = truth.next.rocks[0].deflection;
                inside += found > f.rocks[0].quantile(0.05) && found < f.rocks[0].quantile(0.95);
            }
        }
        CHECK(inside == about(0.9 * sites).epsilon(0.04));
    }

    TEST_CASE("a forecast says in words when it extrapolates, or when nothing was recorded") {
        ForecastResults r{.names = {"a", "b"}, .rock = 1, .threshold = 2e-3, .members = sixteen(3)};
        const auto sentences = [&](const std::vector<RecordedMovement>& recordings) {
            r.forecast = forecast_passage(r.members, recordings);
            return sentence_of(r);
        };
        CHECK(sentences({{1, 1e-8, 1e-10}}).starts_with("under the next train the rock b is "));
        CHECK(sentences({{1, 1e-8, 1e-10}}).find('\n') == std::string::npos);
        CHECK(sentences({{1, 1e-7, 1e-9}}).find("the forecast extrapolates") != std::string::npos);
        CHECK(sentences({}).ends_with("it was not recorded: this is what the members say"));
    }

    TEST_CASE("members left out are forecast without themselves") {
        auto members = sixteen(5);
        members[4].next.rocks[0].deflection *= 100; // must not help its own forecast
        const auto all = forecasts_of_members(members, 0, 0.05);
        REQUIRE(all.size() == 16);
        CHECK(all[4].found > 20 * all[4].forecast.quantile(0.95));
    }

    TEST_CASE("errors of recordings have the stated size, and rocks at rest are left out") {
        PassageMovements m;
        m.rocks.assign(2000, {0, 0, 1e-8});
        m.rocks.front().compliance = 0;
        const auto all = recorded(m, {.relative = 0.1, .noise = 5e-10}, 4);
        REQUIRE(all.size() == 1999);
        double squares = 0;
        for (const RecordedMovement& r : all) squares += std::pow(r.compliance - 1e-8, 2);
        const double deviation = std::hypot(1e-9, 5e-10);
        CHECK(std::sqrt(squares / 1999) == about(deviation).epsilon(0.05));
    }

    TEST_CASE("compliances come from recordings that are sound and of the train; the others are "
              "counted and say why") {
        const TemporaryDirectory folder;
        const PassingTrain passing{
            train_named("inspection"),
            20,
            {.bending = 1.58e7, .tie_support = 3e7, .spacing = 0.61, .tie_weight = 3790},
            800};
        const LoadHistory load =
            passing_load(passing.train, passing.speed, passing.rails, passing.dead_load);
        Passage passage{"passage_01", {}};
        for (unsigned id = 1; id <= 4; ++id)
            passage.recordings.push_back(recording_under(load, "smartrock-like", 1, id));
        for (Vec3& f : passage.recordings[1].force) f /= 9.81; // in g, not in m/s2
        for (std::size_t k = 500; k < 800; ++k)                // stuck
            passage.recordings[2].force[k] = passage.recordings[2].force[500];
        Random random(7, 1);
        const Vec3 rest = passage.recordings[3].force.front();
        for (Vec3& f : passage.recordings[3].force) // nothing but noise
            f = rest + 0.3 * Vec3(random.normal(), random.normal(), random.normal());
        write_passages(folder.path(), {passage}, "test");
        const std::vector<std::string> names{"a", "b", "c", "d"};
        const FolderOfMovements found = movements_in(folder.path(), passing, names);
        REQUIRE(found.movements.size() == 1);
        CHECK(found.movements[0].sensor == 0);
        CHECK(found.movements[0].compliance == about(0.8e-8).epsilon(0.25));
        REQUIRE(found.recordings.size() == 4);
        const auto sentence = [&](std::size_t k) {
            return sentence_of(found.recordings[k], names[found.recordings[k].sensor]);
        };
        CHECK(sentence(0).starts_with("sensor 1 (a) fits the train: goodness of fit 0."));
        CHECK(sentence(1).starts_with("sensor 2 (b) is left out: refused by quality control: "));
        CHECK(sentence(2).find("stuck") != std::string::npos);
        CHECK(sentence(3).starts_with("sensor 4 (d) is left out: it fits the train no better "));

        ForecastResults r{.names = {"a", "b", "c", "d"},
                          .rock = 1,
                          .threshold = 2e-3,
                          .members = sixteen(3),
                          .recordings = found.recordings};
        r.forecast = forecast_passage(r.members, {{0, 1e-8, 1e-10}});
        CHECK(sentence_of(r).find("\n1 of 4 recordings are used, the others are left out\n") !=
              std::string::npos);
        CHECK(sentence_of(r).ends_with(
            "it has no recording of this train: this is what the members say"));
    }

    TEST_CASE("a file of movements is read back, and errors name its line") {
        const TemporaryDirectory folder;
        const std::vector<RecordedMovement> some{{0, 1.25e-8, 5e-10}, {2, 4e-9, 2e-10}};
        write_movements(folder / "out.csv", some, three_names);
        const auto back = read_movements(folder / "out.csv", three_names);
        REQUIRE(back.size() == 2);
        CHECK(back[1].sensor == 2);
        CHECK(back[0].compliance == about(1.25e-8));
        CHECK(back[1].deviation == about(2e-10));

        CHECK(error_of(folder, "").ends_with("expected at least one sensor rock, found none"));
        CHECK(error_of(folder, "1,1,0.1\n4,1,0.1\n")
                  .ends_with("movements.csv:3: expected a sensor from 1 to 3, found 4"));
        CHECK(error_of(folder, "1,1,0.1\n1,1,0.1\n")
                  .ends_with(":3: expected one line for each sensor, found 1"));
        CHECK(error_of(folder, "1,1e3,0.1\n")
                  .ends_with(
                      ":2: expected a compliance_um_per_kN above 0 and at most 500, found 1000"));
        CHECK(error_of(folder, "1,,0.1\n").find(":2: expected a compliance_um_per_kN") !=
              std::string::npos);
        CHECK(error_of(folder, "1,1,2\n")
                  .ends_with("expected a deviation_um_per_kN of at least 0 and at most the "
                             "compliance, found 2"));
    }
}
