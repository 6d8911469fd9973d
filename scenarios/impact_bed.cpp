// A steel ball strikes a bed of spheres: case 3 of Dosta et al. (2024), Comput. Phys. Commun.
// 296:109066. The ball has a diameter of 20 mm and a speed of 5 m/s, and starts with its centre at
// a height of 0.06 m. The bed has 25 000, 50 000 or 100 000 spheres of diameter 2 mm in a box of
// 0.10 x 0.06 m, open at the top. Hertz-Mindlin contacts, no rolling resistance, no global damping.
// The paper's initial states (Zenodo 8252892) are not available: here the bed is poured from a
// shaken lattice, hardened and brought to rest. Its height therefore differs from the paper's and
// is written to the results. In the reference curves the ball meets the bed at about 0.031 and
// 0.132 m above the floor for 25 000 and 100 000 spheres: those beds are loose or heaped, with a
// solid fraction of 0.53 to 0.56. --fill-friction-factor makes a bed looser. In the shallow beds
// the ball is stopped by spheres that it squeezes against the floor, by a third of their radius and
// more.
#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "engine/memory.hpp"
#include "engine/ordering.hpp"
#include "engine/random.hpp"
#include "engine/report.hpp"
#include "scenarios/bulk/bulk_run.hpp"
#include "scenarios/specimens/lattice.hpp"
#include "scenarios/specimens/memory_estimate.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/broadphase/lists.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace {

using namespace bris;

struct ImpactTest {
    unsigned spheres = 25000;
    double diameter = 0.002, ball_diameter = 0.02, speed = 5, length = 0.10, width = 0.06;
    BulkSettings bulk{
        .duration = 0.1, .sample_interval = 5e-4, .bed = {.step = 1e-6, .longest_rest = 0.03}};

    void declare_options(auto& option) {
        option.group("Impact");
        option("spheres", spheres, "",
               "Number of spheres in the bed (25 000, 50 000 or 100 000 in the paper).",
               within(10, 5e6));
        option("diameter", diameter, "m", "Diameter of the spheres.", within(1e-4, 0.02));
        option("ball_diameter", ball_diameter, "m", "Diameter of the steel ball.",
               within(1e-3, 0.05));
        option("speed", speed, "m/s", "Downward speed of the ball at time 0.", within(0, 100));
        option("length", length, "m", "Length of the box along x.", above(0, 100));
        option("width", width, "m", "Width of the box along y.", above(0, 100));
        bulk.declare_options(option);
    }
};

constexpr double box_floor = -0.0902431,
                 drop = 0.06; // m: heights of the floor, as in the paper's mesh, and of the ball
constexpr double shake = 0.3; // m/s, random velocity that destroys the order of the lattice
constexpr EntityId box = 0, ball = 1;

World make_world_of(const ImpactTest& t, std::uint64_t seed) {
    World world = make_world(Grains::spheres);
    const BulkMaterials materials = add_bulk_materials(world);
    const Vec3 low(-t.length / 2, -t.width / 2, box_floor), high(t.length / 2, t.width / 2, 0.3);
    add_boundary(world, Vec3::Zero(), materials.steel); // the box
    for (int a = 0; a < 3; ++a) add_plane(world, box, low[a] * Vec3::Unit(a), Vec3::Unit(a));
    for (int a = 0; a < 2; ++a) add_plane(world, box, high[a] * Vec3::Unit(a), -Vec3::Unit(a));
    (void)add_sphere(world, Vec3(0, 0, high.z()), t.ball_diameter / 2, materials.steel,
                     Motion::fixed); // above the bed until time 0
    const double r = t.diameter / 2;
    std::uint64_t made = 0;
    const auto everywhere = [&](const Vec3& x) {
        return (x - low).head(2).minCoeff() > 1.05 * r && (high - x).head(2).minCoeff() > 1.05 * r;
    };
    for (const Vec3& site :
         lattice_sites({low, high, 1.1 * t.diameter, 0.02, seed}, t.spheres, everywhere)) {
        const EntityId id = add_sphere(world, site, r, materials.m1);
        world.column<Bodies, Velocity>()[id] =
            shake * Random(seed, 1000000000 + made++).direction(); // rows are still ids
    }
    auto& limits = world.resource<Limits>();
    // grains may splash higher than the box, whose walls are planes without an upper rim
    const double reach = std::max({0.3, t.length / 2 + 0.01, t.width / 2 + 0.01});
    limits.low = Vec3(-reach, -reach, low.z() - 0.01);
    limits.high = Vec3(reach, reach, 1);
    limits.overlap = 0.9; // grains are squeezed between ball and floor
    world.add_resource<Gravity>();
    world.add_resource<BedState>();
    return world;
}

/// Height (m) of the highest grain within the distance `reach` (m) of the vertical axis.
double surface(const World& world, double reach) {
    double top = box_floor;
    const auto position = world.column<Bodies, Position>();
    const auto radius = world.column<Bodies, BoundingRadius>();
    const auto id = world.column<Bodies, BodyId>();
    for (Row b = 0; b < id.size(); ++b)
        if (id[b] > ball && position[b].head(2).norm() < reach)
            top = std::max(top, position[b].z() + radius[b]);
    return top;
}

/// Twice the mean height of all grains above the floor, which is the height of a level bed, m.
double bed_height(const World& world) {
    double sum = 0, count = 0;
    const auto position = world.column<Bodies, Position>();
    for (const Row b : in_order_of_ids(world.column<Bodies, BodyId>())) {
        if (world.column<Bodies, BodyId>()[b] <= ball) continue;
        sum += position[b].z() - box_floor;
        ++count;
    }
    return 2 * sum / std::max(1.0, count);
}

void let_go(World& world, const ImpactTest& t) {
    const Row row = row_of_body(world, ball);
    const double dt = world.resource<Clock>().dt, r = t.ball_diameter / 2;
    const double top = surface(world, r + t.diameter);
    require(
        top < drop - r,
        fmt::format(
            "impact_bed: expected a bed below the ball at {:.4f} m, found its surface at {:.4f} m",
            drop - r, top));
    world.column<Bodies, MotionOf>()[row] = static_cast<std::uint32_t>(Motion::free);
    world.column<Bodies, Position>()[row] = Vec3(0, 0, drop);
    world.column<Bodies, Velocity>()[row] =
        Vec3(0, 0, -t.speed) - 0.5 * dt * world.resource<Gravity>().value; // leapfrog: at -dt/2
    invalidate_lists(world);
}

/// Height of the bed when the ball is released.
struct BedHeight {
    static constexpr auto name = "bed_height";
    static constexpr bool is_state = true;
    double mean = 0, top = 0; ///< m above the floor
    void save(Archive& archive) const { put_fields(archive, "bed_height", std::tie(mean, top)); }
    void load(const Archive& archive) { get_fields(archive, "bed_height", std::tie(mean, top)); }
};

struct BallSample {
    double time, displacement, velocity;
    static constexpr auto columns() {
        using S = BallSample;
        return std::array{Sampled{&S::time, "time", "s"},
                          Sampled{&S::displacement, "displacement", "m"},
                          Sampled{&S::velocity, "velocity", "m/s"}};
    }
};
using BallCurve = SeriesOf<BallSample>;

BulkCase make_case(const ImpactTest& t, std::uint64_t seed, BallCurve& curve) {
    BulkCase c{.world = make_world_of(t, seed), .curve = curve};
    c.world.add_resource<BedHeight>();
    c.begin = [=](World& world) {
        world.resource<BedHeight>() = {bed_height(world),
                                       surface(world, t.ball_diameter / 2) - box_floor};
        let_go(world, t);
    };
    c.sample = [&curve](const World& world) {
        const Row row = row_of_body(world, ball);
        const Clock& clock = world.resource<Clock>();
        curve.add({.time = clock.time(),
                   .displacement = world.column<Bodies, Position>()[row].z() - drop,
                   .velocity = world.column<Bodies, Velocity>()[row].z() +
                               0.5 * clock.dt * world.column<Bodies, Acceleration>()[row].z()});
    };
    c.description = [&curve] {
        return fmt::format("ball at {:.4f} m", curve[&BallSample::displacement].back());
    };
    c.colour = [](const World& world, Row row) {
        if (world.column<Bodies, BodyId>()[row] == ball) return Colour{90, 90, 90};
        return scale_colour(std::min(1.0, world.column<Bodies, Velocity>()[row].norm()));
    };
    return c;
}

// Open re-runs from the paper's initial states (peclet-examples 897965c, MIT): lowest displacement
// (m) by LIGGGHTS and by MUSEN, and points of MUSEN's curves. In the shallow beds the end of the
// motion is chaotic.
struct Reference {
    unsigned spheres;
    double liggghts, musen;
    std::vector<double> time, displacement;
};
const std::array<Reference, 3> references{{
    {25000,
     -0.13891,
     -0.13802,
     {0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1},
     {0, -0.050491, -0.101962, -0.138024, -0.120219, -0.101400, -0.083562, -0.066707, -0.050835,
      -0.035944, -0.022034}},
    {50000, -0.13859, -0.13895, {}, {}},
    {100000,
     -0.09088,
     -0.09053,
     {0, 0.005, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.08, 0.1},
     {0, -0.022796, -0.040800, -0.067976, -0.081290, -0.088188, -0.090506, -0.090491, -0.090488,
      -0.090488}},
}};

void report(const ImpactTest& t, BulkRun& run, const BallCurve& curve) {
    using S = BallSample;
    const auto &time = curve[&S::time], &depth = curve[&S::displacement];
    const auto least = std::ranges::min_element(depth);
    const BedHeight& height = run.world().resource<BedHeight>();
    Report summary;
    summary.add("least_displacement_m", *least);
    summary.add("time_of_least_displacement_s",
                time[static_cast<std::size_t>(least - depth.begin())]);
    summary.add("final_displacement_m", depth.back());
    summary.add("final_speed_m_per_s", std::abs(curve[&S::velocity].back()));
    summary.show({"least_displacement_m", "final_displacement_m", "final_speed_m_per_s"});
    summary.add("bed_mean_height_m", height.mean);
    summary.add("bed_height_below_ball_m", height.top);
    const double volume = t.spheres * pi / 6 * std::pow(t.diameter, 3);
    summary.add("bed_solid_fraction", volume / (t.length * t.width * height.mean));
    summary.add("depth_below_bed_m",
                box_floor + height.top - (drop + *least - t.ball_diameter / 2));
    summary.add("contact_time_over_step",
                hertz_contact_time(t.diameter / 2, 2500, t.bulk.bed.stiffness * 1e9, 1) /
                    t.bulk.bed.step);
    std::vector<Curve> curves{curve.curve(&S::displacement, fmt::format("{} spheres", t.spheres))};
    for (const Reference& r : references) {
        if (r.spheres != t.spheres || t.diameter != 0.002) continue;
        summary.add("reference_least_displacement_liggghts_m", r.liggghts);
        summary.add("reference_least_displacement_musen_m", r.musen);
        summary.add("least_displacement_error", *least / (0.5 * (r.liggghts + r.musen)) - 1);
        summary.show({"least_displacement_error"});
        if (!r.time.empty())
            curves.push_back({.label = "MUSEN",
                              .x = r.time,
                              .y = r.displacement,
                              .style = Curve::Style::points});
    }
    for (const Curve& reference : run.reference()) curves.push_back(reference);
    run.report(summary, {{.title = "Displacement of the ball",
                          .x_label = "time (s)",
                          .y_label = "vertical displacement (m)",
                          .curves = curves},
                         curve.plot(&S::velocity, "Vertical velocity of the ball")});
}

void check_options(const ImpactTest& t, const Common& common) {
    require_memory("spheres", t.spheres, bytes_of_spheres(t.spheres), common.memory_limit);
    check_bulk(t.bulk, common);
}

void run(const ImpactTest& t, const Common& common) {
    BallCurve curve("curve");
    run_bulk(common, t.bulk, make_case(t, common.seed, curve),
             [&](BulkRun& bulk) { report(t, bulk, curve); });
}

std::string explain(const ImpactTest& t, const Common& common) {
    BallCurve curve("curve");
    return start_case(make_case(t, common.seed, curve).world, common).schedule().explain();
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<ImpactTest>(
        argc, argv,
        {"impact_bed", "A steel ball strikes a bed of spheres (Dosta et al. 2024, case 3)."},
        check_options, run, explain);
}
