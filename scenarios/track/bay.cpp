#include "scenarios/track/bay.hpp"

#include "engine/interrupt.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/resume.hpp"
#include "scenarios/ballast_box/load_turns.hpp"
#include "scenarios/ballast_box/start_box.hpp"
#include "scenarios/ballast_box/tie_under_rails.hpp"
#include "scenarios/ballast_box/track_slice.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/scene.hpp"

#include <algorithm>
#include <tuple>
#include <vector>

namespace bris {

namespace {

constexpr auto numbers_path = "bay/numbers";
constexpr std::uint64_t block_steps = 100; // between two looks whether the user has asked to stop

} // namespace

Bay::Bay(const BallastBox& box, const Common& common)
    : box_(seated_by_rails(box)), common_(common), simulation_(make_box_simulation(box_, common_)),
      test_(simulation_, box_, common_.seed) {}

void Bay::prepare(const ReportProgress& report) {
    Run run(simulation_, common_, "bay", report);
    const BoxBed bed(simulation_, common_, settings_of_state(box_, common_));
    bed.begin(run, simulation_, box_, {});
    run.go(test_.preparation(save_bed(run, [&bed] { bed.keep(); })));
    for (const char* file : {"bed.ckpt.h5", "bay.ckpt.h5"}) // whoever wants them asks the store
        std::filesystem::remove(common_.out / file);
}

void Bay::advance_turn() {
    const std::uint64_t steps = box_.steps_per_cycle / 2;
    for (std::uint64_t done = 0; done < steps;) {
        const std::uint64_t now = std::min(block_steps, steps - done);
        simulation_.advance(now);
        done += now;
        if (interrupted()) throw Interrupted("interrupted");
    }
    check_stable_step(simulation_.world());
}

double Bay::load(double force, unsigned axles) {
    const auto height = [this] { return height_of_tie(simulation_.world()); };
    const double before = height(), least = dead_load;
    std::vector<double> turns{least};
    for (unsigned k = 0; k < axles; ++k) turns.insert(turns.end(), {force, least});
    World& world = simulation_.world();
    const auto steps = static_cast<double>(box_.steps_per_cycle / 2);
    test_.begin_passage(world, load_through(turns, steps * world.resource<Clock>().dt));
    for (unsigned k = 0; k < axles; ++k) {
        advance_turn();
        const double loaded = height();
        advance_turn();
        raise_masses(simulation_.world());
        stiffness_ = (force - least) / (height() - loaded);
    }
    return before - height();
}

void Bay::save(const std::filesystem::path& path) const {
    Checkpoint checkpoint{common_.scenario, simulation_.step(), common_.settings,
                          simulation_.snapshot()};
    put_fields(checkpoint.state, numbers_path, std::tie(stiffness_));
    write_checkpoint(path, checkpoint);
}

void Bay::resume(const std::filesystem::path& path) {
    const Checkpoint from = checkpoint_to_resume(path, common_.scenario, common_.settings);
    if (from.state.find("fields/box") != nullptr) add_fields(simulation_, box_);
    simulation_.restore(from.state);
    get_fields(from.state, numbers_path, std::tie(stiffness_));
}

} // namespace bris
