#include "scenarios/ensemble/model_specimen.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "engine/random.hpp"
#include "engine/signal/attitude.hpp"
#include "scenarios/rocks/refill_clump.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/triaxial/specimen_state.hpp"
#include "systems/broadphase/lists.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace bris {

namespace {

// first of the random streams, one for each body: beyond the ids of bodies that other streams use
constexpr std::uint64_t placing_stream = std::uint64_t{1} << 40;
// Standard deviations of ln q, from 0.1 to 1 % of strain, from a truth of the same friction: of
// another packing (tests/performance/packing_campaign), of rocks of 8 spheres, and of rocks
// displaced by 2 mm (four seeds of 400 rocks each).
constexpr double scatter_of_packings = 0.35, scatter_of_shapes = 0.3, scatter_of_places = 0.25;

/// Refills the shapes of rocks and sensor rocks with other spheres; a shape that both have is
/// refilled only once.
void refill(TriaxialScene& scene, unsigned spheres, unsigned threads, std::uint64_t seed) {
    if (spheres == 0) return;
    std::vector<Clump> of_sensors;
    for (const Clump& clump : scene.smart_rocks)
        if (std::ranges::count(scene.clumps, clump.name, &Clump::name) == 0)
            of_sensors.push_back(clump);
    const std::size_t library = scene.clumps.size();
    std::vector<Clump> all = scene.clumps;
    all.insert(all.end(), of_sensors.begin(), of_sensors.end());
    run_ensemble(all.size(), threads,
                 [&](std::size_t k) { all[k] = refilled(all[k], spheres, seed); });
    for (Clump& clump : scene.smart_rocks) {
        const Clump& like = *std::ranges::find(all, clump.name, &Clump::name);
        clump = scaled(like, clump.sieve / like.sieve);
    }
    scene.clumps.assign(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(library));
}

/// Places the free bodies of a World as those of a true specimen with the same rocks, displaced and
/// rotated by the mismatch.
void put_rocks(World& world, const World& truth, const ModelMismatch& mismatch,
               std::uint64_t seed) {
    const auto from = rows_by_id(truth.column<Bodies, BodyId>()),
               to = rows_by_id(world.column<Bodies, BodyId>());
    const auto& specimen = world.resource<Specimen>();
    const auto put = [&](EntityId id) {
        Random random(seed, placing_stream + id);
        const Row r = to[id], t = from[id];
        world.column<Bodies, Position>()[r] =
            truth.column<Bodies, Position>()[t] + mismatch.placement * random.direction();
        world.column<Bodies, Orientation>()[r] =
            exponential_map(mismatch.rotation * random.direction()) *
            truth.column<Bodies, Orientation>()[t];
        world.column<Bodies, MotionOf>()[r] = static_cast<std::uint32_t>(Motion::free);
        world.column<Bodies, Growth>()[r] = 1;
    };
    for (const EntityId id : specimen.smart_rocks) put(id);
    for (const EntityId id : specimen.rocks) put(id);
    world.column<Bodies, Position>()[to[specimen.top]] =
        truth.column<Bodies, Position>()[from[truth.resource<Specimen>().top]];
}

void take_poses(World& world, const World& from) {
    const auto rows = rows_by_id(from.column<Bodies, BodyId>()),
               to = rows_by_id(world.column<Bodies, BodyId>());
    for (std::size_t id = 0; id < to.size(); ++id) {
        world.column<Bodies, Position>()[to[id]] = from.column<Bodies, Position>()[rows[id]];
        world.column<Bodies, Orientation>()[to[id]] = from.column<Bodies, Orientation>()[rows[id]];
        world.column<Bodies, MotionOf>()[to[id]] = from.column<Bodies, MotionOf>()[rows[id]];
        world.column<Bodies, Growth>()[to[id]] = from.column<Bodies, Growth>()[rows[id]];
    }
}

} // namespace

double ModelMismatch::specimen_scatter() const {
    if (packing > 0) return scatter_of_packings;
    if (spheres > 0) return scatter_of_shapes;
    return any() ? scatter_of_places : 0;
}

std::string ModelMismatch::name() const {
    std::string text = "model";
    if (packing > 0) text += fmt::format("_packing_{}", packing);
    if (spheres > 0) text += fmt::format("_{}_spheres", spheres);
    if (placement > 0) text += fmt::format("_{:.9g}_mm", 1e3 * placement);
    if (rotation > 0) text += fmt::format("_{:.9g}_rad", rotation);
    return text;
}

Common common_of_packing(const Common& common, const std::string& folder, std::uint64_t seed) {
    Common own = common;
    own.out /= folder;
    own.resume = common.resume / folder;
    if (common.resume.empty() || !std::filesystem::exists(own.resume / "specimen.ckpt.h5"))
        own.resume.clear();
    std::filesystem::create_directories(own.out);
    own.seed = seed;
    for (NamedValue& v : own.settings)
        if (v.key == "seed") v.value = seed;
    return own;
}

StartDifference start_difference(const ModelRun& a, const ModelRun& b) {
    require(a.start.size() == b.start.size(),
            "starts: expected runs with the same number of rocks");
    StartDifference apart;
    for (std::size_t k = 0; k < a.start.size(); ++k) {
        const double distance = (a.start[k].position - b.start[k].position).squaredNorm();
        const double angle =
            attitude_error(a.start[k].orientation, b.start[k].orientation).squaredNorm();
        apart.distance += distance;
        apart.angle += angle;
        if (k >= a.sensors) continue;
        apart.sensor_distance += distance;
        apart.sensor_angle += angle;
    }
    const auto all = static_cast<double>(a.start.size()),
               sensors = static_cast<double>(std::max<std::size_t>(1, a.sensors));
    return {std::sqrt(apart.distance / all), std::sqrt(apart.sensor_distance / sensors),
            std::sqrt(apart.angle / all), std::sqrt(apart.sensor_angle / sensors)};
}

PreparedSpecimen make_another_packing(const Triaxial& described, const TriaxialSettings& settings,
                                      const TriaxialScene& scene, unsigned spheres,
                                      const Common& common, const ReportProgress& report) {
    PreparedSpecimen another{make_scene(described, common.seed), {}};
    another.scene.poses = scene.poses;
    refill(another.scene, spheres, common.threads, common.seed);
    another.state = make_specimen(another.scene, settings, common, report).state;
    return another;
}

Relaxed fill_like(Simulation& simulation, TriaxialTest& test, const TriaxialScene& scene,
                  const PreparedSpecimen& truth, const ModelMismatch& mismatch,
                  std::uint64_t seed) {
    Simulation true_one = make_simulation(in_mould(truth.scene), 1);
    true_one.restore(truth.state);
    World pushed = make_triaxial_world(in_mould(scene).specimen, scene.clumps, scene.smart_rocks,
                                       scene.sample.rocks, scene.poses);
    put_rocks(pushed, true_one.world(), mismatch, seed);
    const Relaxed relaxed = relax(pushed, LawName::linear, {.longest = 200000});
    if (!relaxed.done) throw SimulationError("the model's specimen: " + relaxed.left);
    take_poses(simulation.world(), pushed);
    test.begin_compacted();
    return relaxed;
}

PreparedSpecimen make_model_specimen(const Triaxial& described, const TriaxialSettings& settings,
                                     const PreparedSpecimen& truth, const ModelMismatch& mismatch,
                                     const Common& common, const ReportProgress& report) {
    const bool packed_anew = mismatch.packing > 0;
    Common own =
        common_of_packing(common, mismatch.name(), packed_anew ? mismatch.packing : common.seed);
    own.settings.emplace_back("model_specimen", mismatch.name());
    if (packed_anew)
        return make_another_packing(described, settings, truth.scene, mismatch.spheres, own,
                                    report);
    PreparedSpecimen model{truth.scene, {}};
    refill(model.scene, mismatch.spheres, common.threads, common.seed);
    model.state = make_specimen(model.scene, settings, own, report,
                                [&](Simulation& simulation, TriaxialTest& test) {
                                    (void)fill_like(simulation, test, model.scene, truth, mismatch,
                                                    common.seed);
                                })
                      .state;
    return model;
}

} // namespace bris
