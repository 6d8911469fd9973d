#include "scenarios/triaxial/triaxial_scene.hpp"

#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/memory.hpp"
#include "engine/state.hpp"
#include "scenarios/records/recorded_test.hpp"
#include "scenarios/rocks/own_rocks.hpp"
#include "scenarios/specimens/memory_estimate.hpp"
#include "scenarios/specimens/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

/// Porosity of the whole specimen minus that of its core: the walls add it in proportion to the
/// size of the rocks over that of the specimen. 0.035 was measured with 400 rocks.
double wall_porosity(std::size_t rocks) {
    return 0.035 * std::cbrt(400.0 / static_cast<double>(rocks));
}

/// Porosity of the mould in which rocks grow to full size: well above that of poured rocks.
constexpr double filled_porosity = 0.55;

std::vector<Clump> sensor_shapes(const Triaxial& t, const std::vector<Clump>& library) {
    std::vector<Clump> shapes;
    for (const Clump& shape : sensor_shapes_named(t.sensor_shape, library, "--sensor-shape"))
        shapes.push_back(scaled(shape, t.specimen.smartrock_size / shape.sieve));
    return shapes;
}

/// Number of sensor rocks with the k-th shape, when they take the shapes in turn.
std::size_t share_of(std::size_t k, std::size_t sensors, std::size_t shapes) {
    return sensors / shapes + (k < sensors % shapes ? 1 : 0);
}

double largest_radius(const std::vector<Clump>& shapes) {
    return std::ranges::max_element(shapes, {}, &Clump::bounding_radius)->bounding_radius;
}

double largest_rock(const TriaxialScene& s) {
    return std::max(std::ranges::max(s.sample.rocks, {}, &RockChoice::sieve).sieve,
                    s.specimen.smartrock_size);
}

/// Throws InputError if the mould is too narrow for its largest rock.
void require_wide(const Triaxial& t, const TriaxialScene& s, std::uint64_t seed) {
    const auto ratio_in = [](const TriaxialScene& scene) {
        return 2 * scene.specimen.radius / largest_rock(scene);
    };
    const double found = ratio_in(s);
    if (found >= t.least_diameter) return;
    const auto refuse = [&](const std::string& enough) {
        throw InputError(fmt::format(
            "--bodies: expected a specimen at least {:g} times as wide as its largest rock of "
            "{:.1f} mm (--least-diameter), found {:.2f} times with {} rocks; grading {} needs {}",
            t.least_diameter, 1e3 * largest_rock(s), found, t.bodies, s.grading.name, enough));
    };
    // rocks of a wide grading are too many to be drawn: they are counted
    constexpr double most_drawn = 20000;
    const double wider = t.least_diameter * s.grading.size_at(1) / (2 * s.specimen.radius);
    const double volume = s.sample.solid_volume * std::pow(wider, 3);
    const double rocks = expected_rocks(s.grading, s.clumps, volume);
    if (rocks > most_drawn) {
        const auto [sieve, of_coarser] = cut_for(s.grading, s.clumps, volume, most_drawn);
        refuse(fmt::format("{:.3g} rocks; without its sieves below {:g} mm, {:.0f}", rocks,
                           1e3 * sieve, std::ceil(of_coarser)));
    }
    Triaxial enough = t; // more rocks reach a larger rock, so that their number is found by trial
    for (double ratio = found; ratio < t.least_diameter;) {
        const double factor = std::pow(t.least_diameter / ratio, 3);
        enough.bodies = 10 * static_cast<unsigned>(std::ceil(0.101 * enough.bodies * factor));
        enough.least_diameter = 0;
        ratio = ratio_in(make_scene(enough, seed));
    }
    refuse(fmt::format("{} rocks", enough.bodies));
}

} // namespace

void check_test(const Triaxial& t) {
    const double stages = t.test.final_axial_strain / t.test.stage_strain;
    require(stages > 0.999 && std::abs(stages - std::round(stages)) < 1e-6 * stages,
            fmt::format(
                "--final-axial-strain: expected a multiple of --stage-strain, found {:g} and {:g}",
                t.test.final_axial_strain, t.test.stage_strain));
    require(traits(t.specimen.law).of_pairs.empty(),
            fmt::format("--law: expected a law without coefficients of pairs, found {}",
                        traits(t.specimen.law).name));
    require_edges_are_read(t.specimen.edges, t.specimen.law);
    const bool latex = t.specimen.membrane == MembraneKind::latex;
    require(latex || t.specimen.latex == LatexSettings{},
            "--latex-thickness, --latex-modulus, --latex-wrinkles, --latex-edge: expected "
            "--membrane latex, found rings");
    require(t.test.move_steps % ramp_parts == 0,
            fmt::format("--move-steps: expected a multiple of {}, found {}", ramp_parts,
                        t.test.move_steps));
    std::vector<std::string> names;
    for (const double pressure : t.confining_pressure) names.push_back(folder_of(pressure));
    std::ranges::sort(names);
    const auto twice = std::ranges::adjacent_find(names);
    require(twice == names.end(),
            "--confining-pressure: expected different pressures, found twice " +
                (twice == names.end() ? "" : *twice));
}

namespace {

/// A scene with the mould for so many sensor rocks, which are not yet placed.
TriaxialScene scene_for(const Triaxial& t, std::uint64_t seed, std::size_t sensors) {
    const std::vector<Clump> library = clumps_of(t.clumps);
    TriaxialScene s;
    s.smart_rocks = sensor_shapes(t, library);
    s.clumps = rocks_among(library);
    s.grading = grading_named(t.grading);
    s.specimen = t.specimen;
    s.specimen.seed = seed;
    s.specimen.friction = t.test.friction;
    require(sensors < t.bodies,
            fmt::format("--bodies: expected more than the {} sensor rocks, found {}", sensors,
                        t.bodies));
    s.sample = sample_rocks(s.grading, s.clumps, t.bodies - sensors, seed);
    double solids = s.sample.solid_volume;
    for (std::size_t k = 0; k < s.smart_rocks.size(); ++k)
        solids += static_cast<double>(share_of(k, sensors, s.smart_rocks.size())) *
                  s.smart_rocks[k].volume;
    const double porosity = std::min(t.test.core_porosity() + wall_porosity(t.bodies), 0.9);
    s.specimen.radius = radius_for(solids, porosity, s.specimen.sectors);
    s.specimen.looseness = std::max(1.0, (1 - porosity) / (1 - filled_porosity));
    s.specimen.height = 4 * s.specimen.radius;
    return s;
}

SensorRoom room_in(const TriaxialScene& s) {
    return {s.specimen.radius, s.specimen.height, largest_radius(s.smart_rocks)};
}

} // namespace

TriaxialScene make_scene(const Triaxial& t, std::uint64_t seed) {
    const auto given =
        t.sensor_poses.empty() ? t.recorded_poses : read_sensor_poses(t.sensor_poses);
    const std::size_t sensors =
        given.empty() ? smart_rock_count(room_in(scene_for(t, seed, 10))) : given.size();
    TriaxialScene s = scene_for(t, seed, sensors);
    s.poses =
        given.empty() ? smart_rock_poses(room_in(s), seed, sensors) : placed_in(room_in(s), given);
    require_wide(t, s, seed);
    return s;
}

std::vector<std::string> problems_of_recorded_poses(const Triaxial& t, std::uint64_t seed) {
    return placing_problems(room_in(scene_for(t, seed, t.recorded_poses.size())), t.recorded_poses);
}

void require_memory_for(const Triaxial& t, unsigned worlds, std::uint64_t limit,
                        double stages_kept) {
    constexpr double spheres_each = 30;            // per rock of the clump library
    constexpr double motion = 2 * sizeof(Vec3);    // displacement and rotation of a rock in a stage
    const unsigned at_once = std::max(worlds, 2U); // a specimen and the copy that is tried
    require_memory(
        "bodies", t.bodies,
        bytes_of_rocks(t.bodies, spheres_each, at_once) + motion * stages_kept * t.bodies, limit);
}

TriaxialScene in_mould(TriaxialScene scene) {
    scene.specimen.law = LawName::linear;
    scene.specimen.membrane = MembraneKind::rings;
    return scene;
}

Simulation make_simulation(const TriaxialScene& s, unsigned threads) {
    World world = make_triaxial_world(s.specimen, s.clumps, s.smart_rocks, s.sample.rocks, s.poses);
    Simulation simulation =
        start(std::move(world), {.law = s.specimen.law, .threads = threads, .energy_budget = true});
    simulation.world().add_resource<TriaxialState>();
    return simulation;
}

namespace {

template <class Pairs>
void forget_springs(World& world) {
    if (world.has<Pairs>() && world.table<Pairs>().template has<Spring>())
        std::ranges::fill(world.column<Pairs, Spring>(), SpringRow{});
}

/// A specimen that was prepared within rigid elements has no sleeve yet.
void add_sleeve_of(const World& world, Archive& specimen) {
    const Archive own = save_state(world);
    for (const Archive::Array& array : own.arrays())
        if (specimen.find(array.path) == nullptr) specimen.put(array);
}

} // namespace

void restore_specimen(Simulation& simulation, const TriaxialScene& scene, const Archive& specimen) {
    World& world = simulation.world();
    Archive state = specimen;
    add_absent_columns(state, world);
    if (world.has<Nodes>()) add_sleeve_of(world, state);
    simulation.restore(state);
    give_constants_of_law(world, scene.specimen);
    if (world.has<Nodes>()) put_on_latex(world, scene.specimen);
    if (!is_hertz(scene.specimen.law)) return;
    forget_springs<SpherePairs>(world);
    forget_springs<PlanePairs>(world);
    forget_springs<MembranePairs>(world);
}

void refuse_friction(const Triaxial& settings) {
    require(settings.test.friction == TriaxialSettings{}.friction,
            "--friction: not used by this scenario, which estimates it; expected --model-friction, "
            "the median of the prior");
}

Triaxial with_recorded_poses(Triaxial test, const std::filesystem::path& recordings) {
    for (const SensorInfo& info : read_sensor_infos(recordings))
        test.recorded_poses.push_back(
            {.position = info.is_placed() ? info.placed_position() : info.position(),
             .orientation = info.is_placed() ? info.placed_attitude() : info.attitude(),
             .is_relative = info.is_placed(),
             .where = fmt::format("--recordings: sensor {}", info.id)});
    return test;
}

void require_sensor_for_each(const std::vector<SmartRockPose>& poses,
                             const std::vector<SensorInfo>& infos) {
    require(infos.size() == poses.size(),
            fmt::format("--recordings, --sensor-poses: expected one file rock_NN.txt for each of "
                        "the model's {} sensor rocks, found {}",
                        poses.size(), infos.size()));
}

std::string explain_triaxial(const Triaxial& settings, const Common& common) {
    return make_simulation(make_scene(settings, common.seed), 1).schedule().explain();
}

} // namespace bris
