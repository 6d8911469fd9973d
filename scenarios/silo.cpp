// A silo discharges through its orifice: case 1 of Dosta et al. (2024), Comput. Phys. Commun.
// 296:109066. 100 000 spheres of diameter 4 mm in a cylinder of radius 0.1 m on a cone of 45
// degrees; Hertz-Mindlin contacts, no rolling resistance, no global damping. The paper's initial
// states (Zenodo 8252892) are not available: here the bed is poured from a shaken lattice onto a
// plate that closes the orifice, hardened and brought to rest (see bulk_bed.hpp), so its density
// and its surface differ from the paper's. The plate is removed at once at time 0. The facets of
// the wall form a polygon of the circle's area.
#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/over_ranks.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "engine/estimation/linear_fit.hpp"
#include "engine/memory.hpp"
#include "engine/random.hpp"
#include "engine/report.hpp"
#include "scenarios/bulk/bulk_run.hpp"
#include "scenarios/specimens/lattice.hpp"
#include "scenarios/specimens/memory_estimate.hpp"
#include "scenarios/specimens/retire.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/vessels.hpp"
#include "systems/broadphase/lists.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace {

using namespace bris;

struct SiloTest {
    std::string orifice = "large", material = "M1";
    unsigned spheres = 100000, sectors = 64;
    double diameter = 0.004;
    std::vector<double> window{0.5, 3.5};
    double other_rate = 0;
    BulkSettings bulk{
        .duration = 5, .sample_interval = 0.02, .bed = {.step = 3e-6, .longest_rest = 0.05}};

    void declare_options(auto& option) {
        option.group("Silo");
        option("orifice", orifice, "",
               "Size of the orifice. large: radius 0.03 m. small: radius 0.02 m.",
               {"large", "small"});
        option("material", material, "", "Material of the spheres.", {"M1", "M2"});
        option("spheres", spheres, "", "Number of spheres.", within(10, 5e6));
        option("diameter", diameter, "m", "Diameter of the spheres.", within(1e-4, 0.02));
        option("sectors", sectors, "", "Number of flat sectors of the wall.", within(8, 720));
        option("window", window, "s",
               "Start and end of the time window in which the discharge rate is fitted, separated "
               "by a comma.",
               within(0, 1e6));
        option("other_rate", other_rate, "1/s",
               "Discharge rate through the other orifice, for the ratio of large to small. 0: not "
               "known.",
               within(0, 1e9));
        bulk.declare_options(option);
    }
};

// lip and rim as in the paper's meshes
Silo silo_of(const SiloTest& t) {
    if (t.orifice == "large")
        return {.radius = 0.1,
                .orifice_radius = 0.03,
                .lip = -0.0554222,
                .barrel = -0.0554222 + 0.07,
                .top = 0.314578,
                .sectors = t.sectors};
    return {.radius = 0.1,
            .orifice_radius = 0.02,
            .lip = -0.0593008,
            .barrel = -0.0593008 + 0.08,
            .top = 0.320699,
            .sectors = t.sectors};
}

/// Count of retired spheres, which the state of the bodies does not contain.
struct Outflow {
    static constexpr auto name = "outflow";
    static constexpr bool is_state = true;
    double retired = 0; ///< spheres that fell below the silo and were removed from the scene
    void save(Archive& archive) const { put_fields(archive, "outflow", std::tie(retired)); }
    void load(const Archive& archive) { get_fields(archive, "outflow", std::tie(retired)); }
};

constexpr double retire_below = 0.03; // m under the lip, as in the open re-runs of this case
constexpr double shake = 0.5;         // m/s, random velocity that destroys the lattice's order

World make_world_of(const SiloTest& t, std::uint64_t seed) {
    World world = make_world(Grains::spheres);
    const BulkMaterials materials = add_bulk_materials(world);
    const Silo silo = silo_of(t);
    (void)add_silo(world, silo,
                   materials.steel); // bodies 0 and 1: they keep their ids when spheres retire
    const double r = t.diameter / 2, clear = r + 0.002 * silo.radius;
    const auto inside = [&](const Vec3& x) {
        const double out = std::hypot(x.x(), x.y()),
                     from_cone = (silo.orifice_radius + x.z() - silo.lip - out) * std::sqrt(0.5);
        return out < silo.radius - clear && from_cone > clear && x.z() > silo.lip + clear;
    };
    const Vec3 low(-silo.radius, -silo.radius, silo.lip), high(silo.radius, silo.radius, silo.top);
    const auto material = t.material == "M1" ? materials.m1 : materials.m2;
    EntityId made = 0;
    for (const Vec3& site :
         lattice_sites({low, high, 1.1 * t.diameter, 0.02, seed}, t.spheres, inside)) {
        const EntityId id = add_sphere(world, site, r, material);
        world.column<Bodies, Velocity>()[id] =
            shake *
            Random(seed, std::uint64_t{1000000000} + made++).direction(); // rows are still ids
    }
    auto& limits = world.resource<Limits>();
    limits.low = Vec3(-0.3, -0.3, silo.lip - 0.3); // spheres are retired far above this
    limits.high = Vec3(0.3, 0.3, silo.top + 0.1);
    limits.overlap = 0.5; // grains are soft while they are poured
    world.add_resource<Gravity>();
    world.add_resource<BedState>();
    world.add_resource<Outflow>();
    return world;
}

/// Free spheres: of all ranks, if each has a part of the world.
struct Counted {
    std::size_t above = 0, below = 0, fallen = 0; ///< below the lip, and so far that they go
    std::vector<Row> rows_of_fallen;              ///< in this part
};

Counted count(const World& world, double lip) {
    Counted c;
    const OverRanks ranks(world);
    const auto motion = world.column<Bodies, MotionOf>();
    const auto x = world.column<Bodies, Position>();
    for (Row b = 0; b < motion.size(); ++b) {
        if (motion[b] != static_cast<std::uint32_t>(Motion::free)) continue;
        const bool falls = x[b].z() < lip - retire_below;
        if (falls) c.rows_of_fallen.push_back(b);
        if (!ranks.counts(b)) continue;
        ++(x[b].z() > lip ? c.above : c.below);
        if (falls) ++c.fallen;
    }
    ranks.add({&c.above, &c.below, &c.fallen});
    return c;
}

struct SiloSample {
    double time, above, out, in_scene; ///< s; numbers of spheres
    static constexpr auto columns() {
        using S = SiloSample;
        return std::array{Sampled{&S::time, "time", "s"}, Sampled{&S::above, "above", ""},
                          Sampled{&S::out, "out", ""}, Sampled{&S::in_scene, "in_scene", ""}};
    }
};
using SiloCurve = SeriesOf<SiloSample>;

BulkCase make_case(const SiloTest& t, std::uint64_t seed, SiloCurve& curve) {
    BulkCase c{.world = make_world_of(t, seed), .curve = curve};
    const double lip = silo_of(t).lip;
    const std::size_t all = t.spheres;
    constexpr EntityId plate = 1;
    c.begin = [=](World& world) { take_away(world, plate, Vec3(0, 0, -10)); };
    c.sample = [=, &curve](const World& world) {
        const Counted now = count(world, lip);
        const auto retired = static_cast<std::size_t>(world.resource<Outflow>().retired);
        if (now.above + now.below + retired != all)
            throw SimulationError(fmt::format(
                "silo: expected {} spheres, found {} above the lip, {} below and {} retired", all,
                now.above, now.below, retired));
        curve.add({.time = world.resource<Clock>().time(),
                   .above = static_cast<double>(now.above),
                   .out = static_cast<double>(now.below + retired),
                   .in_scene = static_cast<double>(now.above + now.below)});
    };
    c.edit = [=](World& world) {
        const Counted now = count(world, lip);
        if (now.fallen == 0) return;
        world.resource<Outflow>().retired += static_cast<double>(now.fallen);
        (void)retire_bodies(world, now.rows_of_fallen); // wall and plate come first: ids 0 and 1
    };
    c.is_over = [=](const World& world) { return count(world, lip).above == 0; };
    c.description = [&curve] {
        return fmt::format("{:.0f} spheres above the lip", curve[&SiloSample::above].back());
    };
    c.colour = [](const World& world, Row row) {
        return scale_colour(std::min(1.0, world.column<Bodies, Velocity>()[row].norm() / 0.15));
    };
    return c;
}

// Number of spheres above the lip for the large orifice and M1 by LIGGGHTS from the paper's initial
// state, and mean rates (open re-runs of the case, peclet-examples 897965c, MIT).
const std::vector<double> reference_time{0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4, 4.3};
const std::vector<double> reference_above{100000, 88542, 76015, 63550, 51271,
                                          39070,  27007, 15080, 3953,  96};
constexpr double reference_large = 24504, reference_small = 7737; // 1/s: LIGGGHTS; MUSEN
constexpr double paper_rate = 23200, paper_ratio = 3.10; // 1/s +-5 %, +-0.06: mean of eight codes

/// Discharge rate (1/s) after Beverloo, Leniger and van de Velde (1961): C = 0.58, k = 1.4, solid
/// fraction 0.6.
double beverloo_rate(const SiloTest& t, double orifice_radius) {
    const double open = 2 * orifice_radius - 1.4 * t.diameter,
                 volume = pi / 6 * std::pow(t.diameter, 3);
    return 0.58 * 0.6 / volume * std::sqrt(9.81) * std::pow(open, 2.5);
}

void add_rates(Report& summary, const SiloTest& t, const SiloCurve& curve) {
    const auto &time = curve[&SiloSample::time], &above = curve[&SiloSample::above];
    // leave out the last spheres, which have no head of grains above them
    const auto last =
        std::ranges::find_if(above, [&](double n) { return n < 0.02 * t.spheres; }) - above.begin();
    const double from = t.window[0],
                 to = std::min(
                     t.window[1],
                     time[static_cast<std::size_t>(std::max<std::ptrdiff_t>(last, 1) - 1)]),
                 middle = 0.5 * (from + to);
    const auto points = std::ranges::count_if(time, [&](double x) { return x >= from && x <= to; });
    if (points < 8) return; // the run is too short for a fit
    const LinearFit fit = fit_line(time, above, from, to);
    summary.add("window_end_s", to);
    summary.add("discharge_rate_per_s", -fit.slope);
    summary.add("discharge_rate_standard_error_per_s", fit.slope_error);
    // both halves show whether the rate depends on the head of grains
    summary.add("discharge_rate_first_half_per_s", -fit_line(time, above, from, middle).slope);
    summary.add("discharge_rate_second_half_per_s", -fit_line(time, above, middle, to).slope);
    summary.add("beverloo_rate_per_s", beverloo_rate(t, silo_of(t).orifice_radius));
    summary.show(
        {"discharge_rate_per_s", "discharge_rate_standard_error_per_s", "beverloo_rate_per_s"});
    if (t.material == "M1" && t.diameter == 0.004) {
        const double reference = t.orifice == "large" ? reference_large : reference_small;
        summary.add("reference_rate_per_s", reference);
        summary.add("rate_error", -fit.slope / reference - 1);
        if (t.orifice == "large")
            summary.add("rate_error_to_mean_of_paper", -fit.slope / paper_rate - 1);
    }
    if (t.other_rate > 0) {
        const double ratio =
            t.orifice == "large" ? -fit.slope / t.other_rate : -t.other_rate / fit.slope;
        summary.add("ratio_large_to_small", ratio);
        summary.add("ratio_error_to_paper", ratio / paper_ratio - 1);
    }
}

void report(const SiloTest& t, BulkRun& run, const SiloCurve& curve) {
    using S = SiloSample;
    const auto &time = curve[&S::time], &above = curve[&S::above], &out = curve[&S::out];
    Report summary;
    add_rates(summary, t, curve);
    const auto almost = std::ranges::find_if(above, [&](double n) { return n < 0.01 * t.spheres; });
    summary.add("time_to_one_percent_left_s",
                almost == above.end() ? std::numeric_limits<double>::quiet_NaN()
                                      : time[static_cast<std::size_t>(almost - above.begin())]);
    summary.add("spheres_above", above.back());
    summary.add("spheres_out", out.back());
    summary.show({"spheres_above", "spheres_out"});
    summary.add("contact_time_over_step",
                hertz_contact_time(t.diameter / 2, t.material == "M1" ? 2500 : 2000,
                                   t.bulk.bed.stiffness * (t.material == "M1" ? 1e9 : 0.5e9), 1) /
                    t.bulk.bed.step);
    std::vector<Curve> curves{
        curve.curve(&S::above, fmt::format("{} orifice, {}", t.orifice, t.material))};
    if (t.orifice == "large" && t.material == "M1" && t.spheres == 100000)
        curves.push_back({.label = "LIGGGHTS",
                          .x = reference_time,
                          .y = reference_above,
                          .style = Curve::Style::points});
    for (const Curve& reference : run.reference()) curves.push_back(reference);
    std::vector<double> middle, rate;
    for (std::size_t k = 5; k < time.size(); k += 5) {
        middle.push_back(0.5 * (time[k] + time[k - 5]));
        rate.push_back((above[k - 5] - above[k]) / (time[k] - time[k - 5]));
    }
    run.report(summary, {{.title = "Spheres above the orifice",
                          .x_label = "time (s)",
                          .y_label = "number",
                          .curves = curves},
                         {.title = "Discharge rate",
                          .x_label = "time (s)",
                          .y_label = "discharge rate (1/s)",
                          .curves = {{.x = middle, .y = rate}}}});
}

void check_options(const SiloTest& t, const Common& common) {
    require_memory("spheres", t.spheres, bytes_of_spheres(t.spheres), common.memory_limit);
    require(t.window.size() == 2 && t.window[0] < t.window[1],
            "--window: expected two times, the second one later");
    check_bulk(t.bulk, common);
}

void run(const SiloTest& t, const Common& common) {
    SiloCurve curve("curve");
    run_bulk(common, t.bulk, make_case(t, common.seed, curve),
             [&](BulkRun& bulk) { report(t, bulk, curve); });
}

std::string explain(const SiloTest& t, const Common& common) {
    SiloCurve curve("curve");
    return start_case(make_case(t, common.seed, curve).world, common).schedule().explain();
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<SiloTest>(
        argc, argv,
        {.name = "silo",
         .description = "A silo discharges through its orifice (Dosta et al. 2024, case 1).",
         .divides = true},
        check_options, run, explain);
}
