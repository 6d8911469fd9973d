#include "engine/state.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "systems/recorder/record_motion.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <complex>

using namespace bris;
using namespace bris::testing;

namespace {

const Vec3 earth(0, 0, -9.81);

struct Rock {
    World world;
    EntityId body;
};

Rock make_rock(const Vec3& gravity) {
    World world = make_world(Grains::clumps);
    Material m = linear_material(1e5, 5e4, 0.5);
    m.restitution = 0.2;
    const auto material = add_material(world, m);
    const Clump shape = scaled(small_rock(), 0.05);
    const EntityId body = add_clump(world, shape, 0, Vec3(0, 0, 0.1),
                                    exponential_map(Vec3(0.4, 0.1, -0.8)), material);
    if (gravity.norm() > 0) world.add_resource<Gravity>({gravity});
    return {std::move(world), body};
}

const std::vector<ImuSample>& samples_of(const Simulation& sim) {
    return sim.world().resource<InertialRecorders>().list.at(0).device.samples;
}

} // namespace

TEST_SUITE("recorder") {
    TEST_CASE("free fall reads 0, also of a spinning rock, and its angular velocity is read") {
        Rock rock = make_rock(earth);
        add_recorder(rock.world, rock.body, {.rate = 500, .noise = {}}, earth, 1);
        set_angular_velocity(rock.world, rock.body, Vec3(3, -2, 5));
        Simulation sim = begin(std::move(rock.world), {.dt = 3e-5});
        start_recording(sim.world());
        sim.advance(3000); // 90 ms
        const auto& samples = samples_of(sim);
        CHECK(samples.size() == 45);
        for (const ImuSample& s : samples) {
            CHECK(s.force.norm() < 1e-12);
            CHECK(s.rate.norm() > 1);
        }
        const Quat q = exponential_map(Vec3(0.4, 0.1, -0.8));
        CHECK((samples[0].rate - q.conjugate() * Vec3(3, -2, 5)).norm() < 1e-12);
    }

    TEST_CASE("a device without errors beside a noisy one tells motion from noise") {
        Rock rock = make_rock(earth);
        const ImuModel model = imu_preset("smartrock-like");
        add_recorder(rock.world, rock.body, model, earth, 1);
        Simulation sim = begin(std::move(rock.world), {.dt = 3e-5});
        start_recording(sim.world());
        sim.advance(100'000); // 3 s of free fall: the force is 0, the device reads its errors
        const auto& recorder = sim.world().resource<InertialRecorders>().list.at(0);
        REQUIRE(recorder.exact.samples.size() == recorder.device.samples.size());
        const auto count = static_cast<double>(recorder.device.samples.size());
        Vec3 mean = Vec3::Zero();
        for (const ImuSample& s : recorder.device.samples) mean += s.force / count;
        double squares = 0;
        for (std::size_t k = 0; k < recorder.device.samples.size(); ++k) {
            CHECK(recorder.exact.samples[k].force.norm() < 1e-12);
            CHECK(recorder.exact.samples[k].rate.norm() < 1e-12);
            squares += (recorder.device.samples[k].force - mean).squaredNorm() / (3 * count);
        }
        // white noise of a density, sampled at the rate; rounding to 16 bits adds little
        CHECK(std::sqrt(squares) == about(model.noise.force * std::sqrt(model.rate)).epsilon(0.1));
    }

    TEST_CASE("a rock at rest reads 1 g in the direction of its attitude") {
        Rock rock = make_rock(earth);
        add_floor(rock.world, 0);
        add_recorder(rock.world, rock.body, {.rate = 200, .bandwidth = 80, .noise = {}}, earth, 1);
        Simulation sim = begin(std::move(rock.world), {.dt = 2e-5, .law = LawName::linear_viscous});
        sim.advance(150'000); // 3 s
        start_recording(sim.world());
        sim.advance(5'000);
        const ImuSample& last = samples_of(sim).back();
        const Vec3 up = value_of<Orientation>(sim, rock.body) * last.force;
        CHECK((up - Vec3(0, 0, 9.81)).norm() < 1e-6 * 9.81);
        CHECK(last.rate.norm() < 1e-6);
    }

    TEST_CASE("a lever arm on a body that spins and is shaken reads the analytic specific force") {
        // about a principal axis: a = A sin(wt) along x, w^2 r towards the axis, mounting turned
        constexpr double spin = 12, frequency = 15, amplitude = 40, mass = 20;
        const Vec3 arm(0.03, -0.02, 0.01);
        const Quat mounting = exponential_map(Vec3(0.5, -0.3, 0.9));
        World world = make_world(Grains::clumps);
        const auto material = add_material(world, linear_material(1e5));
        const EntityId body = add_block(world, Vec3::Zero(), Quat(Quat::Identity()),
                                        Vec3(0.3, 0.2, 0.1), mass, material);
        set_angular_velocity(world, body, Vec3(0, 0, spin));
        add_load(world, body,
                 {.force = Vec3(mass * amplitude, 0, 0),
                  .history = {.mean = 0, .amplitude = 1, .frequency = frequency}});
        const double torque = 3, inertia = block_inertia(Vec3(0.3, 0.2, 0.1), mass).z();
        add_load(world, body, {.couple = Vec3(0, 0, torque)});
        world.add_resource<Gravity>({earth});
        add_recorder(world, body, {.rate = 1000, .noise = {}, .arm = arm, .mounting = mounting},
                     earth, 1);
        Simulation sim = begin(std::move(world), {.dt = 1e-5});
        start_recording(sim.world());
        sim.advance(30'000);
        // velocities given at the start are those of half a step before it; the first sample does
        // not know the torque yet
        const double twist = torque / inertia, early = spin + 0.5 * twist * 1e-5;
        double worst_force = 0, worst_rate = 0;
        for (const ImuSample& s : samples_of(sim)) {
            if (s.sequence == 0) continue;
            const double t = s.time, w = early + twist * t, angle = early * t + 0.5 * twist * t * t;
            const Vec3 a(amplitude * std::sin(2 * pi * frequency * t), 0, 0);
            const Quat q = exponential_map(Vec3(0, 0, angle));
            const Vec3 omega(0, 0, w), alpha(0, 0, twist);
            const Vec3 force = q.conjugate() * a + alpha.cross(arm) + omega.cross(omega.cross(arm));
            worst_force = std::max(worst_force, (s.force - mounting.conjugate() * force).norm());
            worst_rate = std::max(worst_rate, (s.rate - mounting.conjugate() * omega).norm());
        }
        MESSAGE("largest errors ", worst_force, " m/s2 of 40 and ", worst_rate, " rad/s");
        CHECK(samples_of(sim).size() == 300);
        CHECK(worst_force < 1e-6 * amplitude);
        CHECK(worst_rate < 1e-6 * spin);
    }

    TEST_CASE("the low pass acts on the motion before it is sampled") {
        // a sine above the sampling rate reads gain / sqrt(1 + (f/fc)^2) of its amplitude
        constexpr double frequency = 330, amplitude = 50, mass = 2, cutoff = 80;
        World world = make_world(Grains::clumps);
        const auto material = add_material(world, linear_material(1e5));
        const EntityId body = add_block(world, Vec3::Zero(), Quat(Quat::Identity()),
                                        Vec3(0.1, 0.1, 0.1), mass, material);
        add_load(world, body,
                 {.force = Vec3(mass * amplitude, 0, 0),
                  .history = {.mean = 0, .amplitude = 1, .frequency = frequency}});
        add_recorder(world, body, {.rate = 200, .bandwidth = cutoff, .noise = {}}, Vec3::Zero(), 1);
        Simulation sim = begin(std::move(world), {.dt = 5e-6});
        start_recording(sim.world());
        sim.advance(100'000);
        const std::complex<double> gain = 1.0 / std::complex<double>(1, frequency / cutoff);
        double worst = 0;
        for (const ImuSample& s : samples_of(sim)) {
            if (s.time < 0.1) continue; // the transient, exp(-2 pi fc t)
            const double exact =
                std::imag(amplitude * gain * std::polar(1.0, 2 * pi * frequency * s.time));
            worst = std::max(worst, std::abs(s.force.x() - exact));
        }
        // a step of 5e-6 s delays the low pass by half a step: 0.5 % of the phase
        CHECK(worst < 7e-3 * amplitude * std::abs(gain));
    }

    TEST_CASE("samples are taken in the nearest step and stamped by the clock of the sensor") {
        Rock rock = make_rock(Vec3::Zero());
        ImuModel model{.rate = 300, .noise = {}, .clock_offset = 0.5, .clock_drift = 1e-3};
        add_recorder(rock.world, rock.body, model, Vec3::Zero(), 1);
        Simulation sim = begin(std::move(rock.world), {.dt = 7e-5});
        sim.advance(100);
        start_recording(sim.world());
        const double start = sim.world().resource<Clock>().time();
        sim.advance(2000);
        const auto& samples = samples_of(sim);
        CHECK(samples.size() == 42);
        for (std::size_t n = 0; n < samples.size(); ++n) {
            const double true_time = (samples[n].time - 0.5) / 1.001;
            CHECK(std::abs(true_time - start - static_cast<double>(n) / 300) <= 0.5001 * 7e-5);
            CHECK(samples[n].sequence == n);
        }
        CHECK(refusal_of([&] {
                  sim.world().resource<Clock>().dt = 0.01;
                  start_recording(sim.world());
              }).starts_with("inertial recorder: expected a sampling rate up to 100 Hz"));
    }

    TEST_CASE("a resumed run continues the recordings of a noisy device with the same bits") {
        const auto make = [] {
            Rock rock = make_rock(earth);
            add_floor(rock.world, 0);
            ImuModel model = imu_preset("smartrock-like");
            model.rate = 400;
            add_recorder(rock.world, rock.body, model, earth, 3);
            Simulation sim =
                begin(std::move(rock.world), {.dt = 2e-5, .law = LawName::linear_viscous});
            start_recording(sim.world());
            return sim;
        };
        Simulation whole = make();
        whole.advance(6000);
        const Archive saved = whole.snapshot();
        whole.advance(6000);
        Simulation other = make();
        other.restore(saved);
        other.advance(6000);
        CHECK(fingerprint(other.snapshot()) == fingerprint(whole.snapshot()));
        REQUIRE(samples_of(other).size() == samples_of(whole).size());
        CHECK(samples_of(other).back().force == samples_of(whole).back().force);
        CHECK(samples_of(other).size() == 96);
    }
}
