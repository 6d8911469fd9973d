#include "scenarios/ensemble/variant_run.hpp"

#include "engine/signal/attitude.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace bris {

namespace {

void count_fusion(const World& world, ModelRun& run) {
    run.fusion_work += fusion_work(world);
    const Fusion& fusion = world.resource<Fusion>();
    run.analyses = fusion.records;
    for (std::size_t s = 0; s < world.table<Sensors>().size(); ++s) {
        run.accepted += world.column<Sensors, Accepted>()[s];
        run.refused += world.column<Sensors, Refused>()[s];
        run.reduced += world.column<Sensors, Reduced>()[s];
        run.withheld += world.column<Sensors, Withheld>()[s];
    }
}

void record_stage(TriaxialModel& model, ModelRun& run) {
    const auto now = model.poses();
    const TestCurves& curves = model.test().state().curves;
    run.curves.add_row_of(curves, curves.size() - 1);
    run.displacement.emplace_back();
    run.rotation.emplace_back();
    for (std::size_t k = 0; k < now.size(); ++k) {
        run.displacement.back().push_back(now[k].position - model.start()[k].position);
        run.rotation.back().push_back(
            attitude_error(now[k].orientation, model.start()[k].orientation));
    }
}

} // namespace

VariantRun::VariantRun(const TriaxialScene& scene, const TriaxialSettings& settings,
                       const Archive& specimen, ModelVariant variant, ModelWatch watch,
                       CheckpointedRun* checkpoint)
    : scene_(scene), settings_(settings), specimen_(specimen), variant_(std::move(variant)),
      watch_(std::move(watch)), checkpoint_(checkpoint) {
    if (!resume())
        model_ = std::make_unique<TriaxialModel>(scene_, settings_, specimen_, variant_.rocks);
}

void VariantRun::advance_to(std::size_t points) {
    CheckpointTimer never;
    LoopSteps steps{.advance = [&] { return !done_ && run_.curves.size() < points && advance(); },
                    .progress = [&] { return progress(); },
                    .resume_hint = "--resume and the folder of the results"};
    if (checkpoint_ != nullptr) steps.save = [&] { save_checkpoint(); };
    run_loop(steps, checkpoint_ != nullptr ? checkpoint_->timer() : never, watch_.progress);
}

PhaseProgress VariantRun::progress() const {
    PhaseProgress now = model_->test().progress();
    const bool catches_up = model_->stages() < run_.curves.size();
    now.phase = variant_.name + (catches_up ? ", catching up: " : ": ") + now.phase;
    now.work = static_cast<double>(run_.curves.size()); // not less while it catches up
    return now;
}

bool VariantRun::resume() {
    const auto before = checkpoint_ != nullptr ? checkpoint_->resume() : std::nullopt;
    if (!before) return false;
    run_ = load_run(*before);
    wall_before_ = run_.wall_time;
    get_fields(*before, "run/progress", std::tie(applied_, done_));
    if (done_) return true;
    const RockParameters now = applied_ > 0 ? variant_.learned[applied_ - 1].rocks : variant_.rocks;
    model_ = std::make_unique<TriaxialModel>(scene_, settings_, specimen_, now);
    model_->load(variant_, *before);
    return true;
}

void VariantRun::save_checkpoint() {
    if (checkpoint_ == nullptr) return;
    Archive archive = done_ ? Archive{} : model_->save();
    run_.wall_time = wall_before_ + seconds_since(began_);
    save_run(archive, run_);
    put_fields(archive, "run/progress", std::tie(std::as_const(applied_), std::as_const(done_)));
    checkpoint_->save(archive);
}

/// Returns false when the run is over.
bool VariantRun::advance() {
    if (!model_->advance(variant_)) {
        end();
        return false;
    }
    if (model_->stages() > run_.curves.size()) stage();
    return true;
}

void VariantRun::stage() {
    const World& world = model_->world();
    if (run_.curves.empty()) {
        run_.rocks = model_->rocks();
        run_.sensors = model_->sensors();
        run_.start = model_->start();
        run_.shell = model_->shells();
        run_.core_porosity = model_->test().state().core_porosity;
    }
    record_stage(*model_, run_);
    watch_.stage(world, run_.curves[quantity::axial_strain].back());
    if (applied_ == variant_.learned.size() ||
        run_.curves[quantity::axial_strain].back() <
            variant_.learned[applied_].strain - 0.5 * settings_.stage_strain)
        return;
    const RockParameters parameters = variant_.learned[applied_++].rocks;
    run_.steps += world.resource<Clock>().step;
    model_ = std::make_unique<TriaxialModel>(scene_, settings_, specimen_, parameters);
}

void VariantRun::end() {
    const World& world = model_->world();
    run_.boundary_work = model_->boundary_work();
    run_.steps += world.resource<Clock>().step;
    if (world.has_resource<Fusion>()) count_fusion(world, run_);
    run_.wall_time = wall_before_ + seconds_since(began_);
    done_ = true;
    save_checkpoint();
}

} // namespace bris
