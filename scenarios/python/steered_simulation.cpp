#include "scenarios/python/steered_simulation.hpp"

#include "engine/errors.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/stopwatch.hpp"
#include "scenarios/python/arrays.hpp"
#include "scenarios/python/initialised.hpp"
#include "scenarios/python/process.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/start.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/contact_list.hpp"
#include "systems/recorder/record_motion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <pybind11/stl.h>
#include <variant>
#include <vector>

namespace bris {

namespace py = pybind11;
using namespace py::literals;

namespace {

constexpr auto scenario_of_checkpoints = "python";

LawName law_named(const std::string& name) {
    const auto& names = texts_of(LawName{});
    for (std::size_t k = 0; k < names.size(); ++k)
        if (names[k] == name) return static_cast<LawName>(k);
    throw InputError(
        fmt::format("law: expected one of {}, found {}", fmt::join(names, ", "), name));
}

unsigned checked(unsigned threads) {
    constexpr unsigned most = 1024;
    require(threads <= most, fmt::format("threads: expected at most {}, found {}", most, threads));
    return threads;
}

Column& column_named(World& world, const std::string& table, const std::string& column) {
    for (const auto& named : world.tables()) {
        if (named.table->name() != table) continue;
        for (const auto& c : named.table->columns())
            if (c->type().name == column && c->type().is_state) return *c;
    }
    throw InputError(fmt::format("simulation: expected a table and a column of its State, found "
                                 "{}.{}",
                                 table, column));
}

/// Sets a flag for as long as it lives.
class Busy {
public:
    explicit Busy(bool& flag) : flag_(flag) { flag_ = true; }
    Busy(const Busy&) = delete;
    Busy& operator=(const Busy&) = delete;
    ~Busy() { flag_ = false; }

private:
    bool& flag_;
};

template <class T>
py::array array_of(const std::vector<T>& values, std::size_t columns = 1) {
    return py::array_t<T>(shape_of(values.size() / columns, columns), values.data());
}

} // namespace

SteeredSimulation::SteeredSimulation(SceneBuilder& scene, const std::string& law, unsigned threads)
    : simulation_(start(scene.complete(), {.law = law_named(law), .threads = checked(threads)})),
      several_threads_(threads != 1) {
    const double longest = stable_step_of_first_contact(world()), dt = world().resource<Clock>().dt;
    require(dt <= longest,
            fmt::format("scene: expected a step of at most {:.4g} s, the stable step of a first "
                        "contact, found {:.4g} s",
                        longest, dt));
    if (world().has_resource<InertialRecorders>()) start_recording(world());
    scene_ = fmt::format("{} {:016x}", law, fingerprint());
    scene.close();
}

const Simulation& SteeredSimulation::idle() const {
    if (busy_)
        throw BusyError("another thread is running time steps of this simulation; wait until its "
                        "call of advance has returned");
    return simulation_;
}

void SteeredSimulation::require_no_views() const {
    if (*views_ > 0)
        throw py::buffer_error(
            fmt::format("{} arrays still show columns of this simulation, which steps may move to "
                        "other memory: copy what is kept, and delete the arrays",
                        *views_));
}

void SteeredSimulation::advance(std::uint64_t steps) {
    Simulation& simulation = idle();
    require_no_views();
    if (several_threads_) require_threads();
    written_.take_up(world(), false);
    const Busy busy(busy_); // ends after the lock has been taken again
    // in pieces of about a tenth of a second, so that Ctrl-C can end it
    for (std::uint64_t piece = 1; steps > 0;) {
        require_going_on();
        piece = std::min(piece, steps);
        const auto began = this_instant();
        {
            const WithoutLock others_run;
            simulation.advance(piece);
        }
        steps -= piece;
        piece = seconds_since(began) < 0.05 ? 2 * piece : std::max<std::uint64_t>(1, piece / 2);
    }
    require_going_on();
}

std::uint64_t SteeredSimulation::fingerprint() const {
    return bris::fingerprint(idle().snapshot());
}

py::array SteeredSimulation::view(const py::object& self, const std::string& table,
                                  const std::string& column, bool write) {
    struct Token {
        std::shared_ptr<int> views;
        py::object simulation;
    };
    Column& found = column_named(world(), table, column);
    if (write) written_.hand_out(table, found);
    ++*views_;
    const py::capsule owner(new Token{views_, self}, [](void* memory) {
        const std::unique_ptr<Token> token(static_cast<Token*>(memory));
        --*token->views;
    });
    return view_of(found, owner, write);
}

py::dict SteeredSimulation::state() const { return arrays_of(idle().snapshot()); }

py::dict SteeredSimulation::contacts() const {
    std::vector<std::string> kind;
    std::vector<EntityId> owner, partner;
    std::vector<double> point, force, normal_force, overlap;
    for (const Contact& c : contacts_of(idle().world())) {
        kind.emplace_back(contact_kinds[c.kind]);
        owner.push_back(c.owner);
        partner.push_back(c.partner);
        point.insert(point.end(), c.point.begin(), c.point.end());
        force.insert(force.end(), c.force.begin(), c.force.end());
        normal_force.push_back(c.normal_force);
        overlap.push_back(c.overlap);
    }
    py::dict columns;
    columns["kind"] = py::cast(kind);
    columns["owner"] = array_of(owner);
    columns["partner"] = array_of(partner);
    columns["point"] = array_of(point, 3);
    columns["force"] = array_of(force, 3);
    columns["normal_force"] = array_of(normal_force);
    columns["overlap"] = array_of(overlap);
    return columns;
}

py::list SteeredSimulation::recordings(bool exact) const {
    const World& scene = idle().world();
    require(scene.has_resource<InertialRecorders>(),
            "recordings: expected a scene with inertial sensors (add_recorder), found none");
    py::list all;
    for (const InertialRecorder& recorder : scene.resource<InertialRecorders>().list) {
        std::vector<double> time, force, rate;
        std::vector<std::uint8_t> saturated;
        for (const ImuSample& s : (exact ? recorder.exact : recorder.device).samples) {
            if (s.lost) continue;
            time.push_back(s.time);
            force.insert(force.end(), s.force.begin(), s.force.end());
            rate.insert(rate.end(), s.rate.begin(), s.rate.end());
            saturated.push_back(s.saturated ? 1 : 0);
        }
        all.append(py::dict("body"_a = recorder.body, "time"_a = array_of(time),
                            "force"_a = array_of(force, 3), "rate"_a = array_of(rate, 3),
                            "saturated"_a = array_of(saturated)));
    }
    return all;
}

void SteeredSimulation::save(const std::filesystem::path& path) {
    written_.take_up(world(), *views_ > 0);
    write_checkpoint(path, {scenario_of_checkpoints,
                            idle().world().resource<Clock>().step,
                            {{"scene", scene_}},
                            idle().snapshot()});
}

void SteeredSimulation::load(const std::filesystem::path& path) {
    Simulation& simulation = idle();
    require_no_views();
    const Checkpoint checkpoint = read_checkpoint(path);
    const auto scene = std::ranges::find(checkpoint.settings, "scene", &NamedValue::key);
    const auto* name =
        scene == checkpoint.settings.end() ? nullptr : std::get_if<std::string>(&scene->value);
    require(checkpoint.scenario == scenario_of_checkpoints && name != nullptr && *name == scene_,
            fmt::format("load: expected a checkpoint of this scene and law, found '{}', one of {}",
                        path.string(),
                        checkpoint.scenario == scenario_of_checkpoints ? "another scene or law"
                                                                       : checkpoint.scenario));
    simulation.restore(checkpoint.state);
    written_.forget();
}

} // namespace bris
