#include "scenarios/python/steered_simulation.hpp"

#include "components/pair.hpp"
#include "engine/errors.hpp"
#include "engine/io/checkpoint.hpp"
#include "scenarios/python/arrays.hpp"
#include "scenarios/specimens/start.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/stable_step.hpp"

#include <fmt/format.h>

#include <pybind11/stl.h>
#include <vector>

namespace bris {

namespace py = pybind11;

namespace {

constexpr auto scenario_of_checkpoints = "python";

LawName law_named(const std::string& name) {
    const auto& names = law_names();
    for (std::size_t k = 0; k < names.size(); ++k)
        if (names[k] == name) return static_cast<LawName>(k);
    throw InputError(
        fmt::format("law: expected one of {}, found {}", fmt::join(names, ", "), name));
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

/// Columns of the table of contacts that Python sees.
struct ContactColumns {
    std::vector<std::string> kind;
    std::vector<EntityId> owner, partner;
    std::vector<double> point, force, normal_force, overlap;
};

template <class Pairs>
void add_contacts(const World& world, const char* kind, ContactColumns& to) {
    if (!world.has<Pairs>()) return;
    const auto near = world.column<typename Pairs::Near, NearPair>();
    const auto force = world.column<typename Pairs::Near, PairForce>();
    const auto rows = world.column<Pairs, PairRows>();
    const auto body = world.column<Listed, ListedBody>();
    const auto id = world.column<Bodies, BodyId>();
    world.resource<NearIndex<Pairs>>().for_touching([&](Row k) {
        const ForceRow& f = force[k];
        to.kind.emplace_back(kind);
        to.owner.push_back(id[body[near[k].owner]]);
        to.partner.push_back(id[rows[near[k].pair].partner_body]);
        to.point.insert(to.point.end(), {f.px, f.py, f.pz});
        to.force.insert(to.force.end(), {f.fx, f.fy, f.fz});
        to.normal_force.push_back(f.normal_force);
        to.overlap.push_back(f.overlap);
    });
}

template <class T>
py::array array_of(const std::vector<T>& values, std::size_t columns = 1) {
    return py::array_t<T>(shape_of(values.size() / columns, columns), values.data());
}

} // namespace

SteeredSimulation::SteeredSimulation(SceneBuilder& scene, const std::string& law, unsigned threads)
    : simulation_(start(scene.take(), {.law = law_named(law), .threads = threads})) {
    const double longest = stable_step_of_first_contact(world()), dt = world().resource<Clock>().dt;
    require(dt <= longest,
            fmt::format("scene: expected a step of at most {:.4g} s, the stable step of a first "
                        "contact, found {:.4g} s",
                        longest, dt));
}

void SteeredSimulation::require_no_views() const {
    if (*views_ > 0)
        throw py::buffer_error(
            fmt::format("{} arrays still show columns of this simulation, which steps may move to "
                        "other memory: copy what is kept, and delete the arrays",
                        *views_));
}

void SteeredSimulation::advance(std::uint64_t steps) {
    require_no_views();
    if (moved_)
        invalidate_lists(world());
    else if (written_)
        show_velocities(world());
    moved_ = written_ = false;
    const py::gil_scoped_release release;
    simulation_.advance(steps);
}

std::uint64_t SteeredSimulation::fingerprint() const {
    return bris::fingerprint(simulation_.snapshot());
}

py::array SteeredSimulation::view(const py::object& self, const std::string& table,
                                  const std::string& column, bool write) {
    struct Token {
        std::shared_ptr<int> views;
        py::object simulation;
    };
    Column& found = column_named(world(), table, column);
    if (write) {
        moved_ = moved_ || column == Position::name || column == Orientation::name;
        written_ = true;
    }
    ++*views_;
    const py::capsule owner(new Token{views_, self}, [](void* memory) {
        const std::unique_ptr<Token> token(static_cast<Token*>(memory));
        --*token->views;
    });
    return view_of(found, owner, write);
}

py::dict SteeredSimulation::state() const { return arrays_of(simulation_.snapshot()); }

py::dict SteeredSimulation::contacts() const {
    ContactColumns all;
    const World& world = simulation_.world();
    add_contacts<SpherePairs>(world, "sphere", all);
    add_contacts<FacetPairs>(world, "facet", all);
    add_contacts<PlanePairs>(world, "plane", all);
    add_contacts<MembranePairs>(world, "membrane", all);
    py::dict columns;
    columns["kind"] = py::cast(all.kind);
    columns["owner"] = array_of(all.owner);
    columns["partner"] = array_of(all.partner);
    columns["point"] = array_of(all.point, 3);
    columns["force"] = array_of(all.force, 3);
    columns["normal_force"] = array_of(all.normal_force);
    columns["overlap"] = array_of(all.overlap);
    return columns;
}

void SteeredSimulation::save(const std::filesystem::path& path) const {
    write_checkpoint(path, {scenario_of_checkpoints,
                            simulation_.world().resource<Clock>().step,
                            {},
                            simulation_.snapshot()});
}

void SteeredSimulation::load(const std::filesystem::path& path) {
    require_no_views();
    simulation_.restore(read_checkpoint(path).state);
    moved_ = written_ = false;
}

} // namespace bris
