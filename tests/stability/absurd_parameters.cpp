// S20: absurd scenes and options are refused before the first step. The message names the quantity
// and states its range.
#include "engine/errors.hpp"
#include "engine/options.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

#include <functional>
#include <limits>

namespace bris {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN(),
                 infinite = std::numeric_limits<double>::infinity();

/// Counts how often something was refused correctly, and keeps the first failure.
struct Tally {
    std::string what;
    unsigned tries = 0, refused = 0;
    std::string example = {}, failed = {};

    void add(const std::string& name, const std::string& attempt, const std::string& message) {
        ++tries;
        const bool named = message.find(name) != std::string::npos &&
                           message.find("expected") != std::string::npos &&
                           message.find("found") != std::string::npos &&
                           message.find('\n') == std::string::npos;
        refused += named ? 1u : 0u;
        if (named && example.empty()) example = message;
        if (!named && failed.empty()) failed = fmt::format("{}: \"{}\"", attempt, message);
    }
    StressRow row() const {
        return {
            "S20", what, fmt::format("all {} are refused with name, range and value", tries),
            fmt::format("{} refused, {}", refused,
                        failed.empty() ? "for example \"" + example + "\"" : "but not " + failed),
            refused == tries};
    }
};

void add_materials(StressRows& rows, LawName law, const char* title) {
    struct Field {
        const char* name;
        double Material::*member;
        std::vector<double> absurd;
    };
    std::vector<Field> fields{
        {"density", &Material::density, {-1, none, infinite, -infinite}},
        {"friction", &Material::friction, {-1e-9, -1, none, infinite}},
        {"normal damping", &Material::normal_damping, {-1, none, infinite}},
        {"shear damping", &Material::shear_damping, {-1, none, infinite}},
        {"restitution", &Material::restitution, {-0.1, 1.0001, 2, none, infinite}},
        {"Poisson", &Material::poisson_ratio, {-1, -2, 0.51, 1, none, infinite}},
        {"rolling friction", &Material::rolling_friction, {-1, none}},
        {"twisting friction", &Material::twisting_friction, {-1, none}},
        {"shear stiffness", &Material::shear_stiffness, {-1, none, infinite}}};
    const std::vector<double> positive{0, -1, none, infinite, -infinite};
    fields.push_back(is_hertz(law)
                         ? Field{"modulus", &Material::young_modulus, positive}
                         : Field{"normal stiffness", &Material::normal_stiffness, positive});
    Tally tally{title};
    for (const Field& f : fields)
        for (const double value : f.absurd) {
            World world = tumbling({.bodies = 3});
            auto& materials = world.resource<Materials>();
            for (Material& m : materials.list) m.young_modulus = 1e9;
            materials.list[0].*f.member = value;
            materials.mix();
            tally.add(f.name, fmt::format("{} = {}", f.name, value),
                      refusal_of([&] { check_scene(world, law); }));
        }
    rows.push_back(tally.row());
}

void add_bodies(StressRows& rows) {
    Tally tally{"bodies"};
    const auto attempt = [&](const std::string& name, double value, Grains grains,
                             const std::function<void(World&)>& change) {
        World world = tumbling({.grains = grains, .bodies = 3});
        change(world);
        tally.add(name, fmt::format("{} = {}", name, value),
                  refusal_of([&] { check_scene(world, LawName::linear); }));
    };
    for (const double v : {none, infinite}) {
        attempt("position", v, Grains::spheres,
                [&](World& w) { value_of<Position>(w, 1).y() = v; });
        attempt("velocity", v, Grains::spheres,
                [&](World& w) { value_of<Velocity>(w, 1).y() = v; });
        attempt("angular velocity", v, Grains::spheres,
                [&](World& w) { value_of<AngularVelocity>(w, 1).y() = v; });
        attempt("gravity", v, Grains::spheres,
                [&](World& w) { w.resource<Gravity>().value.x() = v; });
    }
    for (const double v : {0.0, -1.0, none, infinite}) {
        attempt("mass", v, Grains::spheres, [&](World& w) { value_of<Mass>(w, 1) = v; });
        attempt("mass", v, Grains::clumps, [&](World& w) { value_of<InertialMass>(w, 1) = v; });
        attempt("inertia", v, Grains::spheres,
                [&](World& w) { value_of<SphereInertia>(w, 1) = v; });
        attempt("inertia", v, Grains::clumps,
                [&](World& w) { value_of<InertialInertia>(w, 1).z() = v; });
        attempt("radius", v, Grains::spheres,
                [&](World& w) { w.column<Spheres, LocalBall>()[1].radius = v; });
        attempt("overlap", v, Grains::spheres, [&](World& w) { w.resource<Limits>().overlap = v; });
    }
    for (const double v : {-1e-5, none, infinite})
        attempt("step", v, Grains::spheres, [&](World& w) { w.resource<Clock>().dt = v; });
    for (const double v : {-0.1, 1.0, none})
        attempt("local damping", v, Grains::spheres,
                [&](World& w) { w.add_resource(LocalDamping{v}); });
    attempt("orientation", 2, Grains::clumps,
            [&](World& w) { value_of<Orientation>(w, 1).coeffs() *= 2; });
    attempt("material", 7, Grains::spheres, [&](World& w) { value_of<MaterialOf>(w, 1) = 7; });
    tally.add("body", "an empty scene",
              refusal_of([] { check_scene(make_world(Grains::spheres), LawName::linear); }));
    tally.add("density", "a grain without density", refusal_of([] {
                  World world = make_world(Grains::spheres);
                  add_sphere(world, Vec3::Zero(), 1,
                             world.resource<Materials>().add(linear_material(1, 1, 0, 0)));
              }));
    rows.push_back(tally.row());
}

/// Options of a scenario with a bed of grains.
struct Absurd {
    unsigned grains = 100;
    double radius = 0.01, friction = 0.5, restitution = 0.8;
    std::string law = "linear";
    void declare_options(Options& option) {
        option("grains", grains, "", "Number of grains.", within(1, 50e6));
        option("radius", radius, "m", "Radius of a grain.", above(0));
        option("friction", friction, "", "Coulomb friction coefficient.", at_least(0));
        option("restitution", restitution, "", "Coefficient of restitution.", within(0, 1));
        option("law", law, "", "Contact law.", {"linear", "hertz"});
    }
};

void add_options(StressRows& rows) {
    Tally tally{"options"};
    const std::vector<std::pair<std::string, std::vector<std::string>>> absurd{
        {"--grains",
         {"0", "-1", "1e9", "1000000000", "nan", "inf", "many", "", "3.5", "99999999999999999999"}},
        {"--radius", {"0", "-0.01", "nan", "inf", "-inf", "1e309", "ten", "", "0x", "1,5"}},
        {"--friction", {"-1e-300", "-1", "nan", "inf", "1e400"}},
        {"--restitution", {"-0.001", "1.001", "nan", "1e308"}},
        {"--law", {"", "Linear", "cubic"}},
        {"--frictoin", {"0.5"}}};
    for (const auto& [flag, values] : absurd)
        for (const std::string& value : values) {
            Absurd settings;
            Options options;
            settings.declare_options(options);
            tally.add(flag, flag + " " + value,
                      refusal_of([&] { options.parse({flag + "=" + value}); }));
        }
    rows.push_back(tally.row());
}

} // namespace

StressRows stress_absurd_parameters(const StressSettings&) {
    StressRows rows;
    add_materials(rows, LawName::linear_viscous, "materials of a linear law");
    add_materials(rows, LawName::hertz_mindlin_viscous, "materials of a Hertz law");
    add_bodies(rows);
    add_options(rows);
    World sound = tumbling({.grains = Grains::clumps, .bodies = 3});
    const std::string message = refusal_of([&] { check_scene(sound, LawName::linear_viscous); });
    rows.push_back({"S20", "a valid scene", "accepted", message.empty() ? "accepted" : message,
                    message.empty()});
    return rows;
}

} // namespace bris
