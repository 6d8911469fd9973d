#include "engine/errors.hpp"
#include "engine/signal/imu.hpp"
#include "scenarios/records/quality_control_report.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>

using namespace bris;

namespace {

namespace fs = std::filesystem;

const Vec3 earth(0, 0, -9.80665);

/// Ten seconds of a rock that is at rest for two and then oscillates; each rock has another
/// attitude.
Recording recording(unsigned id, const ImuModel& model = imu_preset("smartrock-like")) {
    Recording r;
    Random random(4, id);
    const Quat q = random.rotation();
    r.info.id = id;
    r.info.qw = q.w();
    r.info.qx = q.x();
    r.info.qy = q.y();
    r.info.qz = q.z();
    r.info.sampling_rate = model.rate;
    r.info.force_noise = model.noise.force;
    r.info.rate_noise = model.noise.rate;
    Imu imu(model, earth, 1, id);
    for (int k = 0; k < 10 * model.rate; ++k) {
        const double t = k / model.rate, w = t > 2 ? 3 + id : 0;
        const ImuSample s = imu.sample(
            t, {.orientation = q,
                .acceleration = Vec3(0.5 * std::sin(w * t), 0, 0.2 * std::sin(1.7 * w * t)),
                .angular_velocity = Vec3(0.1 * std::sin(w * t), 0, 0)});
        if (s.lost) continue;
        r.time.push_back(s.time);
        r.sequence.push_back(s.sequence);
        r.force.push_back(s.force);
        r.rate.push_back(s.rate);
    }
    return r;
}

bool says(const std::vector<Finding>& findings, Finding::Kind kind, const std::string& check,
          const std::string& text = "") {
    return std::ranges::any_of(findings, [&](const Finding& f) {
        return f.kind == kind && f.check == check && f.text.find(text) != std::string::npos;
    });
}
bool refuses(const Recording& r, const std::string& check, const std::string& text = "") {
    const auto findings = check_recordings({r}, earth);
    INFO(quality_control_report(findings, {r}));
    CHECK_FALSE(accepted(findings, r.info.id));
    return says(findings, Finding::Kind::refusal, check, text);
}

fs::path written(const char* name, const std::string& text) {
    static const TemporaryDirectory folder;
    const fs::path path = folder / name;
    std::ofstream(path) << text;
    return path;
}

} // namespace

TEST_SUITE("sensors/quality_control") {
    TEST_CASE("recordings of sensors as declared are accepted, and missing samples are reported") {
        const std::vector<Recording> all{recording(1), recording(2), recording(3)};
        const auto findings = check_recordings(all, earth);
        INFO(quality_control_report(findings, all));
        for (const Recording& r : all) CHECK(accepted(findings, r.info.id));
        CHECK(says(findings, Finding::Kind::note, "gaps"));
        CHECK(says(findings, Finding::Kind::note, "clock", "2e-05"));
        const Recording ideal = recording(4, imu_preset("ideal"));
        CHECK(quality_control_report(check_recordings({ideal}, earth), {ideal}) ==
              "sensor 4: accepted, 2000 samples\n");
    }

    TEST_CASE("a recording in other units, signs or axes than declared is refused with the "
              "reason") {
        const Recording good = recording(1);
        Recording r = good;
        for (Vec3& f : r.force) f /= 9.80665;
        CHECK(refuses(r, "gravity", "in g"));
        r = good;
        for (Vec3& f : r.force) f *= 9.80665;
        CHECK(refuses(r, "gravity", "not in g"));
        r = good;
        for (Vec3& f : r.force) f = -f;
        CHECK(refuses(r, "frame", "reversed"));
        r = good;
        for (Vec3& f : r.force) f = Vec3(f.y(), f.z(), f.x());
        CHECK(refuses(r, "frame", "degrees off"));
    }

    TEST_CASE("rocks with exchanged ids are refused because their attitudes contradict the "
              "metadata") {
        Recording a = recording(1), b = recording(2);
        std::swap(a.force, b.force);
        std::swap(a.rate, b.rate);
        std::swap(a.time, b.time);
        std::swap(a.sequence, b.sequence);
        const auto findings = check_recordings({a, b}, earth);
        CHECK_FALSE(accepted(findings, 1));
        CHECK_FALSE(accepted(findings, 2));
        CHECK(says(findings, Finding::Kind::refusal, "frame"));
    }

    TEST_CASE("two sensors with the same recording are both refused") {
        const Recording a = recording(1);
        Recording b = a;
        b.info.id = 7;
        const auto findings = check_recordings({a, b, recording(3)}, earth);
        CHECK_FALSE(accepted(findings, 1));
        CHECK_FALSE(accepted(findings, 7));
        CHECK(accepted(findings, 3));
        CHECK(says(findings, Finding::Kind::refusal, "same", "sensor 7"));
    }

    TEST_CASE(
        "samples that are not finite, stuck, saturated, out of order or repeated are refused") {
        const Recording good = recording(1);
        Recording r = good;
        r.rate[700].y() = std::numeric_limits<double>::infinity();
        CHECK(refuses(r, "numbers", "found 1"));
        r = good;
        r.attitude.assign(r.size(), r.info.attitude());
        r.attitude[7].coeffs().setZero();
        CHECK(refuses(r, "attitude", "found 1"));
        r = good;
        for (std::size_t k = 900; k < 1100; ++k) r.force[k] = r.force[900];
        CHECK(refuses(r, "stuck"));
        r = good;
        r.info.force_range = 5;
        CHECK(refuses(r, "saturation"));
        r = good;
        std::swap(r.time[500], r.time[501]);
        CHECK(refuses(r, "order"));
        r = good;
        r.time[500] = r.time[501];
        CHECK(refuses(r, "twice"));
        r = good;
        for (double& t : r.time) t *= 1.01;
        CHECK(refuses(r, "clock", "0.01"));
        r = good;
        r.info.sampling_rate = 1000; // as if four of five samples had been lost
        CHECK(refuses(r, "gaps", "80 %"));
        r.time.resize(1);
        CHECK(refuses(r, "length"));
    }

    TEST_CASE("times in another unit than declared, and a recording without any channel, are "
              "refused; fields that are not used are said once") {
        Recording r = recording(1);
        for (double& t : r.time) t *= 1e-3; // ms read as s would be 1e3
        CHECK(refuses(r, "rate", "found 2e+05 by the times: is t in another unit?"));
        r = recording(1);
        r.force.clear();
        r.rate.clear();
        CHECK(refuses(r, "channels", "found none"));
        Recording a = recording(1), b = recording(2);
        a.unused = b.unused = {"clock", "note"};
        const auto findings = check_recordings({a, b}, earth);
        CHECK(accepted(findings, 1));
        CHECK(quality_control_report(findings, {a, b})
                  .find("sensors 1, 2: fields: 2 of the file are not used: clock, note\n") !=
              std::string::npos);
    }

    TEST_CASE("a lasting jump of the displacement is refused, a single outlier is not") {
        Recording r = recording(1);
        Random random(9, 1);
        for (std::size_t k = 0; k < r.size(); ++k)
            r.displacement.push_back(1e-4 *
                                     Vec3(random.normal(), random.normal(), random.normal()));
        CHECK(accepted(check_recordings({r}, earth), 1));
        r.displacement[500].x() += 0.05;
        CHECK(accepted(check_recordings({r}, earth), 1));
        for (std::size_t k = 600; k < r.size(); ++k) r.displacement[k].y() += 0.02;
        CHECK(refuses(r, "jump", "jumps by"));
        for (std::size_t k = 500; k < 800; ++k) r.displacement[k] = Vec3::Zero();
        CHECK(refuses(r, "stuck", "displacement"));
    }

    TEST_CASE("a recording with only a few samples is checked without an error") {
        Recording r = recording(1);
        for (const std::size_t samples : {2u, 3u}) {
            r.time.resize(samples);
            r.sequence.resize(samples);
            r.force.resize(samples);
            r.rate.resize(samples);
            CHECK_NOTHROW(check_recordings({r}, earth));
        }
        r.sequence = {5, 4, 6};
        CHECK(refuses(r, "order"));
    }

    TEST_CASE("noise of the accelerometer other than declared is reported, not refused") {
        Recording r = recording(1);
        r.info.force_noise *= 10;
        const auto findings = check_recordings({r}, earth);
        CHECK(accepted(findings, 1));
        CHECK(says(findings, Finding::Kind::note, "noise", "declared"));
    }

    TEST_CASE("metadata and recordings are converted to SI units and body axes") {
        const fs::path meta = written("bris_rock_3.toml",
                                      "id = 3\nx = 0.1\nforce_unit = \"g\"\nrate_unit = \"deg/s\"\n"
                                      "mounting_w = 0.7071067811865476\nmounting_z = "
                                      "0.7071067811865476\nsampling_rate = 100\n");
        const SensorInfo info = read_sensor_info(meta);
        CHECK(info.position().x() == 0.1);
        const fs::path csv =
            written("bris_rocks.csv", "# a "
                                      "comment\nt,id,ax,ay,az,gx,gy,gz,strain,temp\n0,3,1,0,0,180,"
                                      "0,0,0.01,20\n0.01,3,,0,0,0,0,0,0.02,20\n");
        const auto all = read_recordings(csv, {info});
        REQUIRE(all.size() == 1);
        REQUIRE(all[0].size() == 2);
        CHECK((all[0].force[0] - Vec3(0, 9.80665, 0)).norm() < 1e-12); // sensor x is body y
        CHECK((all[0].rate[0] - Vec3(0, pi, 0)).norm() < 1e-12);
        CHECK_FALSE(all[0].force[1].allFinite());
        CHECK(all[0].strain[1] == 0.02);
        CHECK(all[0].displacement.empty());
    }

    TEST_CASE("invalid files of recordings are refused with file, line and what was found") {
        const SensorInfo info{.id = 3};
        CHECK_THROWS_WITH_AS(
            (void)read_recordings(written("bris_id.csv", "t,id\n0,3\n0,4\n"), {info}),
            doctest::Contains("bris_id.csv:3: id: expected the id of a metadata file, found 4"),
            InputError);
        CHECK_THROWS_WITH_AS((void)read_recordings(written("bris_id.csv", "t,id\n0,3.5\n"), {info}),
                             doctest::Contains("expected a non-negative whole number, found 3.5"),
                             InputError);
        CHECK_THROWS_WITH_AS(
            (void)read_recordings(written("bris_id.csv", "t,id,ax\n0,3,1\n"), {info}),
            doctest::Contains("ay"), InputError);
        CHECK_THROWS_WITH_AS(
            (void)read_recordings(written("bris_id.csv", "t,id\n0,3\n"), {info, info}),
            doctest::Contains("found two"), InputError);
        CHECK_THROWS_WITH_AS(
            (void)read_sensor_info(written("bris_rock.toml", "id = 3\nqw = 0.5\n")),
            doctest::Contains("unit quaternion"), InputError);
        CHECK_THROWS_WITH_AS(
            (void)read_sensor_info(written("bris_rock.toml", "id = 3\nsampling_rate = -1\n")),
            doctest::Contains("bris_rock.toml:2"), InputError);
    }

    TEST_CASE("numbers of a file that are not finite are counted, and the first is reported with "
              "file and line") {
        const SensorInfo info{.id = 3};
        const auto found = [&](const std::string& text) {
            const auto all = read_recordings(written("bris_none.csv", text), {info});
            return quality_control_report(check_recordings(all, earth), all);
        };
        const std::string force =
            found("t,id,ax,ay,az\n0,3,0,0,9.8\n0.005,3,inf,0,9.8\n0.010,3,nan,0,9.8\n");
        INFO(force);
        CHECK(force.find("sensor 3: refused: numbers: expected finite numbers, found 2 that are "
                         "not; ax ay az: the first at ") == 0);
        CHECK(force.find("bris_none.csv:3\n") != std::string::npos);
        const std::string report =
            found("t,id,strain,temp,ax,ay,az\n0,3,0,20,0,0,9.8\n0.005,3,nan,20,0,0,9.8\n0.010,3,0,"
                  "inf,0,0,9.8\n0.015,3,-inf,20,0,0,9.8\n");
        INFO(report);
        CHECK(report.find("refused") == std::string::npos);
        CHECK(report.find(
                  "sensor 3: numbers: 2 of 4 samples have no number; strain: the first at ") !=
              std::string::npos);
        CHECK(report.find("bris_none.csv:3\n") != std::string::npos);
        CHECK(
            report.find("sensor 3: numbers: 1 of 4 samples have no number; temp: the first at ") !=
            std::string::npos);
        CHECK(found("t,id,temp,ax,ay,az\n0,3,,0,0,9.8\n0.005,3,,0,0,9.8\n").find("temp") ==
              std::string::npos); // this sensor has none
    }
}
