// Cost of each feature: a settled bed of spheres runs with one feature more at a time. Blocks of
// steps are interleaved over the variants. Each variant gives one CSV line with the median and the
// minimum of its blocks, and with the coordination number and floor force as a check of the
// physics.
#include "components/membrane.hpp"
#include "components/platen.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/scenario.hpp"
#include "engine/simulation.hpp"
#include "engine/stopwatch.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/sphere_bed.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/energy_budget.hpp"
#include "systems/fusion/fuse.hpp"
#include "systems/output/frames.hpp"
#include "systems/output/porosity.hpp"
#include "systems/output/quantities.hpp"
#include "systems/steps.hpp"
#include "tests/support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace {

using namespace bris;

struct Benchmark {
    unsigned spheres = 2000, rounds = 9;
    std::uint64_t steps = 400;
    unsigned timing_threads = 1;
    bool one_pass = true, overlap = false;
    std::string variant;

    void declare_options(auto& option) {
        option("spheres", spheres, "", "Number of spheres in the bed.", within(100, 1e6));
        option("rounds", rounds, "", "Number of timed blocks of each variant.", within(1, 1000));
        option("steps", steps, "", "Number of time steps in a block.", within(1, 1e9));
        option("timing_threads", timing_threads, "", "Number of threads that are timed.",
               within(1, 4096));
        option("one_pass", one_pass, "",
               "Run systems that work row by row in one pass over the rows.");
        option("overlap", overlap, "", "Run systems that share no data at once, as a task graph.");
        option("variant", variant, "", "Part of the name of the variants to run; all if empty.");
    }
};

enum class Also {
    nothing,
    energy_budget,
    damping,
    facets,
    sensors,
    frames,
    porosity,
    membrane,
    servo,
    servo_and_sensors
};

struct Variant {
    const char* name;
    const char* against; ///< the variant with which it is compared
    LawName law;
    Also also = Also::nothing;
};

constexpr Variant variants[] = {
    {"frictionless spheres, planes, weight", "", LawName::linear_frictionless},
    {"friction", "frictionless spheres, planes, weight", LawName::linear},
    {"dashpots", "friction", LawName::linear_viscous},
    {"rolling and twisting resistance", "dashpots", LawName::linear_rolling},
    {"friction and couple of edges", "dashpots", LawName::linear_edges},
    {"Hertz and Mindlin", "dashpots", LawName::hertz_mindlin_viscous},
    {"edges that yield", "Hertz and Mindlin", LawName::hertz_edges},
    {"local damping", "dashpots", LawName::linear_viscous, Also::damping},
    {"energy budget", "dashpots", LawName::linear_viscous, Also::energy_budget},
    {"floor of 64 facets", "dashpots", LawName::linear_viscous, Also::facets},
    {"ten sensors, a record each 20 steps", "dashpots", LawName::linear_viscous, Also::sensors},
    {"a frame written every 100 steps", "dashpots", LawName::linear_viscous, Also::frames},
    {"porosity measured every 100 steps", "dashpots", LawName::linear_viscous, Also::porosity},
    {"membrane of 8 x 12 and platen, held", "dashpots", LawName::linear_viscous, Also::membrane},
    {"the same, driven by servos", "membrane of 8 x 12 and platen, held", LawName::linear_viscous,
     Also::servo},
    {"the same, with ten sensors", "the same, driven by servos", LawName::linear_viscous,
     Also::servo_and_sensors},
};

/// Material of the bed, with the additional constants that the law needs.
Material grain_of(LawName law) {
    Material grain{.name = "grain",
                   .density = SphereBed{}.density,
                   .normal_stiffness = 2e6,
                   .shear_stiffness = 4e6 / 7,
                   .friction = 0.5,
                   .young_modulus = 5e8,
                   .poisson_ratio = 0.25,
                   .rolling_friction = 0.1,
                   .twisting_friction = 0.1,
                   .contact_strength = 5e6,
                   .cone_half_angle = 1.2,
                   .friction_rise = 0.5,
                   .friction_half_pressure = 5e6,
                   .friction_half_force = 1,
                   .couple_arm = 1e-3,
                   .couple_force = 1};
    if (is_hertz(law))
        grain.restitution = 0.3;
    else {
        grain.normal_damping = 5838;
        grain.shear_damping = 2919;
    }
    return grain;
}

World bed_under(const Benchmark& s, LawName law) {
    SphereBed bed;
    bed.spheres = s.spheres;
    World world = make_sphere_bed(bed);
    world.resource<Materials>() = {};
    world.resource<Materials>().add(grain_of(law));
    return world;
}

/// The spheres of that bed inside a cylinder, with a membrane around them and a platen on top
/// instead of the box.
World bed_in_membrane(const Variant& v, double radius, const std::vector<Vec3>& positions) {
    const SphereBed bed;
    World world = make_world(Grains::spheres);
    const auto grain = world.resource<Materials>().add(grain_of(v.law));
    double top = 0;
    for (const Vec3& position : positions) {
        if (position.head<2>().norm() > radius - bed.radius) continue;
        add_sphere(world, position, bed.radius, grain);
        top = std::max(top, position.z() + bed.radius);
    }
    constexpr double pressure = 5e3; // about that of the bed's own weight
    Membrane membrane;
    membrane.ring_height = top / membrane.rings;
    membrane.target_pressure = pressure;
    membrane.contact_stiffness = bed.normal_stiffness;
    membrane.largest_step = 1e-4 * radius;
    add_membrane(world, std::move(membrane), radius, grain);
    add_plane(world, add_boundary(world, Vec3::Zero(), grain), Vec3::Zero(), Vec3(0, 0, 1));
    Platen platen;
    platen.plane = add_plane(world, add_boundary(world, Vec3(0, 0, top), grain, Motion::servo),
                             Vec3::Zero(), Vec3(0, 0, -1));
    platen.controlled = true;
    platen.target_pressure = pressure;
    platen.contact_stiffness = bed.normal_stiffness;
    platen.largest_step = 1e-4 * radius;
    world.add_resource(platen);
    world.add_resource<Gravity>();
    world.resource<Clock>().dt = bed.step;
    return world;
}

/// Stops membrane and platen in their present positions.
void hold(World& world) {
    world.resource<Membrane>().active = false;
    std::ranges::fill(world.column<Elements, ElementSpeed>(), 0.0);
    world.resource<Platen>().controlled = false;
    world.resource<Platen>().speed = 0;
}

/// Positions (m) of the spheres of a settled bed, in the order of their ids.
std::vector<Vec3> settled(const Benchmark& s) {
    World world = bed_under(s, LawName::linear_viscous);
    add_lists(world, LawName::linear_viscous);
    world.add_resource(LocalDamping{0.5});
    world.resource<Gravity>().value *= 10;
    Simulation simulation(std::move(world), steps(LawName::linear_viscous), 1);
    simulation.advance(10000);
    simulation.world().resource<Gravity>().value /= 10;
    simulation.advance(20000);
    return frame_of_bodies(simulation.world()).positions;
}

struct Case {
    Variant variant;
    std::unique_ptr<Simulation> simulation;
    std::unique_ptr<FrameWriter> frames;
    double spheres = 0;
    std::vector<double> wall = {}; ///< s, of each block
};

void add_ten_sensors(World& world) {
    std::vector<EntityId> hosts;
    const auto spheres = static_cast<EntityId>(world.table<Spheres>().size());
    std::vector<std::vector<TimedMeasurement>> samples(10);
    const double dt = world.resource<Clock>().dt;
    for (EntityId k = 0; k < 10; ++k) {
        hosts.push_back(k * (spheres / 10));
        for (unsigned n = 1; n < 50000; ++n) {
            Measured m;
            m.velocity = Vec3::Zero();
            samples[k].push_back({20 * n * dt, m});
        }
    }
    add_sensors(world, hosts, std::move(samples), {});
}

Case make_case(const Benchmark& s, const Variant& v, const std::vector<Vec3>& positions) {
    World world = bed_under(s, v.law);
    const double half = world.resource<Limits>().high.x();
    for (std::size_t k = 0; k < positions.size(); ++k)
        world.column<Bodies, Position>()[k] = positions[k];
    const bool in_membrane =
        v.also == Also::membrane || v.also == Also::servo || v.also == Also::servo_and_sensors;
    if (in_membrane) world = bed_in_membrane(v, half, positions);
    if (v.also == Also::facets) add_facet_floor(world, -half, half, 8, 0);
    if (v.also == Also::damping) world.add_resource(LocalDamping{0.1});
    add_lists(world, v.law);
    if (v.also == Also::energy_budget) add_energy_budget(world);
    if (v.also == Also::sensors || v.also == Also::servo_and_sensors) add_ten_sensors(world);
    const auto spheres = static_cast<double>(world.table<Spheres>().size());
    Case c{v,
           std::make_unique<Simulation>(
               std::move(world), steps(v.law, v.also == Also::energy_budget), s.timing_threads,
               ScheduleSettings{.overlap = s.overlap, .fused = s.one_pass, .least_rows = 0}),
           nullptr, spheres};
    c.simulation->advance(
        std::max<std::uint64_t>(s.steps, 12000)); // until it is at rest, with warm caches and lists
    if (v.also == Also::membrane) hold(c.simulation->world());
    return c;
}

void run_block(const Benchmark& s, Case& c) {
    const bool looks = c.variant.also == Also::frames || c.variant.also == Also::porosity;
    if (c.variant.also == Also::frames)
        c.frames = std::make_unique<FrameWriter>(
            std::filesystem::temp_directory_path() / "features.vtkhdf", std::vector<NamedValue>{});
    const auto began = this_instant();
    for (std::uint64_t done = 0; done < s.steps;) {
        const std::uint64_t next = looks ? std::min<std::uint64_t>(100, s.steps - done) : s.steps;
        c.simulation->advance(next);
        done += next;
        if (c.frames) c.frames->add(c.simulation->world());
        if (c.variant.also == Also::porosity)
            porosity(c.simulation->world(), {0.05, 0.02, 0.1}, 60);
    }
    c.wall.push_back(seconds_since(began));
    c.frames.reset();
}

std::size_t systems_of(const Case& c) {
    const std::string text = c.simulation->schedule().explain();
    const std::string run = text.substr(0, text.find("systems left out"));
    std::size_t count = 0;
    for (std::size_t at = run.find("reads "); at != std::string::npos;
         at = run.find("reads ", at + 1))
        ++count;
    return count;
}

void report(const Benchmark& s, const Common& common, std::vector<Case>& cases) {
    std::string csv =
        "feature,against,spheres,steps,rounds,systems,median_ns_per_particle_step,least_ns_per_"
        "particle_step,cost_ns_per_particle_step,coordination,floor_force_over_weight\n";
    fmt::print("{:38} {:>8} {:>10} {:>10} {:>10} {:>8} {:>12}\n", "", "systems", "median ns",
               "least ns", "cost ns", "Z", "floor/weight");
    const auto median = [&](const Case& c) {
        auto wall = c.wall;
        std::sort(wall.begin(), wall.end());
        return wall[wall.size() / 2] / (static_cast<double>(s.steps) * c.spheres) * 1e9;
    };
    for (const Case& c : cases) {
        const auto base = std::find_if(cases.begin(), cases.end(), [&](const Case& b) {
            return std::string(b.variant.name) == c.variant.against;
        });
        const double now = median(c), cost = base == cases.end() ? 0 : now - median(*base);
        const double least = *std::min_element(c.wall.begin(), c.wall.end()) /
                             (static_cast<double>(s.steps) * c.spheres) * 1e9;
        const Quantities q = compute_quantities(c.simulation->world());
        const std::size_t count = systems_of(c);
        fmt::print("{:38} {:8} {:10.1f} {:10.1f} {:10.1f} {:8.3f} {:12.4f}\n", c.variant.name,
                   count, now, least, cost, q.coordination, q.boundary_force.z() / q.weight.z());
        csv += fmt::format("\"{}\",\"{}\",{},{},{},{},{:.4g},{:.4g},{:.4g},{:.6g},{:.6g}\n",
                           c.variant.name, c.variant.against, c.spheres, s.steps, s.rounds, count,
                           now, least, cost, q.coordination, q.boundary_force.z() / q.weight.z());
    }
    write_whole(common.out / "features.csv", csv);
}

void run(const Benchmark& s, const Common& common) {
    const std::vector<Vec3> positions = settled(s);
    std::vector<Case> cases;
    for (const Variant& v : variants)
        if (std::string_view(v.name).find(s.variant) != std::string_view::npos)
            cases.push_back(make_case(s, v, positions));
    for (unsigned round = 0; round < s.rounds; ++round)
        for (Case& c : cases) run_block(s, c);
    report(s, common, cases);
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Benchmark>(argc, argv,
                                   {"features", "Measures the cost of each feature of a scene.",
                                    "it takes some minutes", "it runs several scenes"},
                                   run);
}
