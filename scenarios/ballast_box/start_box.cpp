#include "scenarios/ballast_box/start_box.hpp"

#include "components/kinds.hpp"
#include "engine/errors.hpp"
#include "engine/memory.hpp"
#include "engine/resume.hpp"
#include "scenarios/ballast_box/box_run.hpp"
#include "scenarios/specimens/memory_estimate.hpp"
#include "scenarios/specimens/start.hpp"
#include "systems/fields/fouling.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

Simulation make(const BallastBox& box, const Common& common, bool divides) {
    check_box(box);
    World world = make_box_world(box, common.seed);
    const auto bodies = static_cast<double>(world.table<Bodies>().size());
    require_memory("rock_scale", bodies, bytes_of_rocks(bodies, 30), common.memory_limit);
    return start(std::move(world),
                 {.law = LawName::linear_viscous, .threads = common.threads, .divides = divides});
}

} // namespace

Simulation make_box_simulation(const BallastBox& box, const Common& common) {
    return make(box, common, true);
}

Simulation make_undivided_box(const BallastBox& box, const Common& common) {
    return make(box, common, false);
}

std::string explain_box(const BallastBox& box, const Common& common) {
    Simulation simulation = make_box_simulation(box, common);
    if (fouling_of(box).any()) add_fields(simulation, box); // when the ties are seated
    return simulation.schedule().explain();
}

std::vector<std::string_view> settings_of_state(const BallastBox& box, const Common& common) {
    std::vector<std::string_view> keys;
    if (box.is_mixed() && fouling_of(box).any()) return keys; // the bed has them
    keys = {"run", "saturation", "fines"};
    for (const NamedValue& setting : common.settings)
        if (setting.key.starts_with("fouling_")) keys.push_back(setting.key);
    return keys;
}

void resume_box(Run& run, Simulation& simulation, const BallastBox& box, const Common& common,
                const std::vector<std::string_view>& may_differ) {
    if (common.resume.empty()) return;
    const Checkpoint from =
        checkpoint_to_resume(common.resume, common.scenario, common.settings, may_differ);
    if (from.state.find("fields/box") != nullptr) add_fields(simulation, box);
    run.resume(common.resume, may_differ);
}

namespace {

constexpr auto bed_file = "bed.ckpt.h5";
// 3: fines in a table of their own, 2: without wet stones, 1: nor the stiffness of the bed
constexpr auto kind_of_bed = "bed_4";

} // namespace

BoxBed::BoxBed(const Simulation& simulation, const Common& common,
               std::vector<std::string_view> after_bed,
               const std::vector<std::string_view>& of_named_bed)
    : common_(common), after_bed_(std::move(after_bed)),
      store_(common, simulation, kind_of_bed, after_bed_) {
    after_bed_.insert(after_bed_.end(), of_named_bed.begin(), of_named_bed.end());
}

void BoxBed::begin(Run& run, Simulation& simulation, const BallastBox& box,
                   const std::vector<std::string_view>& may_differ) const {
    Common from = common_;
    from.resume = store_.from();
    const bool is_bed = common_.resume.empty() || common_.resume.filename() == bed_file;
    resume_box(run, simulation, box, from, is_bed ? after_bed_ : may_differ);
    const bool asks_for_fines = box.is_mixed() && fouling_of(box).any();
    require(
        !is_bed || asks_for_fines || !simulation.world().has_resource<Fouling>(),
        fmt::format("--resume: expected a bed that was made without fines, found '{}' with them",
                    from.resume.string()));
}

void BoxBed::keep() const { store_.keep(common_.out / bed_file); }

} // namespace bris
