#include "systems/output/record.hpp"

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/membrane_surface.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/io/csv.hpp"
#include "engine/options.hpp"
#include "engine/ordering.hpp"
#include "systems/output/contacts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

namespace bris {

namespace {

/// Bodies touched by each body id; a partner that touches in many places counts once.
template <class Pairs>
void count_partners(const World& world, std::vector<float>& count) {
    PairNames last{nobody, nobody, 0, 0};
    for (const TouchingPair& pair : touching_pairs<Pairs>(world)) {
        if (pair.names.owner != last.owner || pair.names.partner != last.partner) {
            count[pair.names.owner] += 1;
            count[pair.names.partner] += 1;
        }
        last = pair.names;
    }
}

std::vector<float> coordination_by_id(const World& world) {
    std::vector<float> count(world.table<Bodies>().size());
    for_each_kind_of_pair([&]<class Pairs>() { count_partners<Pairs>(world, count); });
    return count;
}

void append(std::vector<float>& list, const Vec3& v) {
    for (int k = 0; k < 3; ++k) list.push_back(static_cast<float>(v[k]));
}

// Places from the State alone: they hold before the first step and after a restore, too.

void add_facet_corners(const World& world, const std::vector<Row>& rows, std::vector<Vec3>& corners) {
    if (!world.has<Facets>()) return;
    const auto id = world.column<Facets, FacetId>();
    const auto host = world.column<Facets, HostId>();
    const auto shape = world.column<Facets, LocalFacet>();
    const auto position = world.column<Bodies, Position>();
    corners.resize(4 * shape.size());
    for (std::size_t f = 0; f < shape.size(); ++f)
        for (std::size_t k = 0; k < 4; ++k)
            corners[4 * id[f] + k] = position[rows[host[f]]] + shape[f].corners[k];
}

// strips of the membrane from middle to middle of the rings, with half a ring at each end
void add_membrane_corners(const World& world, std::vector<Vec3>& corners) {
    if (!world.has<Elements>()) return;
    const auto& membrane = world.resource<Membrane>();
    const MembraneSurface surface(membrane, world.column<Elements, ElementRadius>().data());
    // where the planes of a sector and of the next one meet
    const auto corner = [&](int ring, int sector) {
        const int next = (sector + 1) % surface.sectors;
        const Vec3 &a = surface.outward[sector], &b = surface.outward[next];
        const double det = a.x() * b.y() - a.y() * b.x(), ra = surface.radius_at(ring, sector), rb = surface.radius_at(ring, next);
        const double height = std::clamp(surface.middle(ring), 0.0, surface.rings * surface.ring_height);
        return Vec3((ra * b.y() - rb * a.y()) / det, (rb * a.x() - ra * b.x()) / det, height);
    };
    for (int ring = -1; ring < surface.rings; ++ring)
        for (int sector = 0; sector < surface.sectors; ++sector) {
            const int before = (sector + surface.sectors - 1) % surface.sectors;
            corners.insert(corners.end(), {corner(ring, sector), corner(ring, before), corner(ring + 1, before), corner(ring + 1, sector)});
        }
}

} // namespace

BodyFrame frame_of_bodies(const World& world) {
    const Table& bodies = world.table<Bodies>();
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto coordination = coordination_by_id(world);
    std::vector<char> carries(rows.size(), 0);
    for (const EntityId parent : world.column<Spheres, ParentId>()) carries[parent] = 1;
    const Clock& clock = world.resource<Clock>();
    const auto velocity = bodies.column<Velocity>();
    const auto acceleration = bodies.column<Acceleration>();

    BodyFrame frame;
    frame.time = clock.time();
    for (EntityId id = 0; id < rows.size(); ++id) {
        if (carries[id] == 0) continue;
        const Row row = rows[id];
        frame.ids.push_back(id);
        frame.positions.push_back(bodies.column<Position>()[row]);
        frame.radii.push_back(static_cast<float>(bodies.column<BoundingRadius>()[row]));
        append(frame.velocities, velocity[row] + 0.5 * clock.dt * acceleration[row]);
        append(frame.spins, bodies.column<Spin>()[row]);
        frame.coordination.push_back(coordination[id]);
        if (bodies.has<ShapeOf>()) frame.shapes.push_back(bodies.column<ShapeOf>()[row]);
        if (!bodies.has<Orientation>()) continue;
        const Quat& q = bodies.column<Orientation>()[row];
        for (const double part : {q.w(), q.x(), q.y(), q.z()})
            frame.orientations.push_back(static_cast<float>(part));
    }
    add_facet_corners(world, rows, frame.corners);
    add_membrane_corners(world, frame.corners);
    return frame;
}

View view_of_bodies(const World& world, const BodyFrame& frame,
                    const std::function<Colour(std::size_t place)>& colour) {
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    std::vector<std::optional<Colour>> colours(rows.size());
    for (std::size_t place = 0; place < frame.ids.size(); ++place)
        colours[static_cast<std::size_t>(frame.ids[place])] = colour(place);
    const Table& bodies = world.table<Bodies>();
    const auto parent = world.column<Spheres, ParentId>();
    const auto ball = world.column<Spheres, LocalBall>();
    View view;
    for (std::size_t s = 0; s < ball.size(); ++s) {
        if (!colours[parent[s]]) continue;
        const Row row = rows[parent[s]];
        Vec3 centre = ball[s].centre;
        if (bodies.has<Orientation>()) centre = bodies.column<Orientation>()[row] * centre;
        view.balls.push_back(
            {bodies.column<Position>()[row] + centre, ball[s].radius, *colours[parent[s]]});
    }
    for (std::size_t q = 0; q < frame.quads(); ++q)
        view.quads.push_back({frame.corners[4 * q], frame.corners[4 * q + 1],
                              frame.corners[4 * q + 2], frame.corners[4 * q + 3]});
    return view;
}

FrameWriter::FrameWriter(const std::filesystem::path& path, const std::vector<NamedValue>& meta)
    : file_(path) {
    file_.add_meta(meta);
}

void FrameWriter::add(const BodyFrame& frame) {
    if (frames() == 0 || frame.ids != ids_ || frame.radii != radii_ || frame.quads() != quads_) {
        std::vector<RunFile::Labels> labels{{"id", frame.ids}};
        if (!frame.shapes.empty()) labels.push_back({"shape", frame.shapes});
        file_.begin_part(frame.ids.size(), frame.quads(), labels, {{"radius", 1, frame.radii}});
        ids_ = frame.ids;
        radii_ = frame.radii;
        quads_ = frame.quads();
    }
    std::vector<RunFile::Field> fields{{"velocity", 3, frame.velocities},
                                       {"spin", 3, frame.spins},
                                       {"coordination", 1, frame.coordination}};
    if (!frame.orientations.empty()) fields.push_back({"orientation", 4, frame.orientations});
    file_.add_frame({frame.time, frame.positions, frame.corners, fields});
}

Series::Series(std::string name, std::vector<RunFile::Column> columns)
    : name_(std::move(name)), columns_(std::move(columns)), values_(columns_.size()) {}

void Series::add(std::initializer_list<double> row) {
    if (row.size() != columns_.size())
        throw std::logic_error(fmt::format("series {}: {} numbers for {} columns", name_,
                                           row.size(), columns_.size()));
    std::size_t k = 0;
    for (const double value : row) values_[k++].push_back(value);
}

const std::vector<double>& Series::column(const std::string& name) const {
    for (std::size_t k = 0; k < columns_.size(); ++k)
        if (columns_[k].name == name) return values_[k];
    throw std::logic_error(fmt::format("series {} has no column {}", name_, name));
}

void Series::save(Archive& archive) const {
    for (std::size_t k = 0; k < columns_.size(); ++k)
        archive.put("series/" + name_ + "/" + columns_[k].name,
                    std::span<const double>(values_[k]));
}

void Series::load(const Archive& archive) {
    for (std::size_t k = 0; k < columns_.size(); ++k) {
        values_[k] = archive.get<double>("series/" + name_ + "/" + columns_[k].name);
        require(
            values_[k].size() == values_[0].size(),
            fmt::format("checkpoint: series {}: expected columns of one length, found {} and {}",
                        name_, values_[0].size(), values_[k].size()));
    }
}

void Series::write_csv(const std::filesystem::path& path) const {
    std::vector<std::string> names;
    for (const auto& column : columns_) names.push_back(key_with_unit(column.name, column.unit));
    std::vector<std::vector<double>> table(rows());
    for (std::size_t r = 0; r < table.size(); ++r)
        for (const auto& values : values_) table[r].push_back(values[r]);
    bris::write_csv(path, names, table);
}

void Series::write_track(RunFile& file) const {
    file.add_track(name_, columns_);
    std::vector<double> row(columns_.size());
    for (std::size_t r = 0; r < rows(); ++r) {
        for (std::size_t k = 0; k < row.size(); ++k) row[k] = values_[k][r];
        file.add_row(name_, row);
    }
    file.flush();
}

CheckpointKeeper::CheckpointKeeper(Settings settings)
    : settings_(std::move(settings)), last_(std::chrono::steady_clock::now()) {}

Checkpoint CheckpointKeeper::checkpoint_of(const Simulation& simulation) const {
    Checkpoint checkpoint{settings_.scenario, simulation.world().resource<Clock>().step,
                          settings_.settings, simulation.snapshot()};
    if (settings_.also) settings_.also(checkpoint.state);
    return checkpoint;
}

void CheckpointKeeper::attend(const Simulation& simulation) {
    if (interrupted()) {
        save(simulation);
        throw Interrupted(fmt::format("interrupted at step {}; go on with --resume {}",
                                      simulation.world().resource<Clock>().step,
                                      settings_.path.string()));
    }
    const std::chrono::duration<double> since = std::chrono::steady_clock::now() - last_;
    if (since.count() >= settings_.interval) save(simulation);
}

void CheckpointKeeper::save(const Simulation& simulation) {
    write_checkpoint(settings_.path, checkpoint_of(simulation));
    last_ = std::chrono::steady_clock::now(); // after the writing: a slow disk gets its rest
}

std::filesystem::path CheckpointKeeper::save_stopped(const Simulation& simulation) const {
    std::string name = settings_.path.filename().string();
    const std::string end = ".ckpt.h5";
    if (name.ends_with(end)) name.resize(name.size() - end.size());
    const auto path = settings_.path.parent_path() / (name + ".stopped" + end);
    write_checkpoint(path, checkpoint_of(simulation));
    return path;
}

namespace {

/// Of a folder of results, the checkpoint that was written last.
std::filesystem::path last_checkpoint(const std::filesystem::path& folder) {
    std::filesystem::path last;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (!name.ends_with(".ckpt.h5") || name.find(".stopped.") != std::string::npos) continue;
        if (last.empty() || entry.last_write_time() > std::filesystem::last_write_time(last)) last = entry.path();
    }
    require(!last.empty(), fmt::format("--resume: expected a checkpoint NAME.ckpt.h5 in '{}', found none", folder.string()));
    return last;
}

} // namespace

Checkpoint resume(Simulation& simulation, const std::filesystem::path& given,
                  const std::string& scenario, const std::vector<NamedValue>& settings,
                  std::initializer_list<std::string_view> may_differ) {
    const std::filesystem::path path = std::filesystem::is_directory(given) ? last_checkpoint(given) : given;
    require(path.filename().string().find(".stopped.") == std::string::npos,
            fmt::format("--resume: expected a checkpoint to go on from, found '{}', the state in which a run was stopped; "
                        "it is there to be looked at", path.string()));
    Checkpoint checkpoint = read_checkpoint(path);
    const auto always = settings_that_may_differ();
    std::vector<std::string_view> keys(always.begin(), always.end());
    keys.insert(keys.end(), may_differ.begin(), may_differ.end());
    require_same_run(path, checkpoint, scenario, settings, keys);
    simulation.restore(checkpoint.state);
    return checkpoint;
}

void add_quantities(Summary& summary, const Quantities& q) {
    summary.add("contacts", q.contacts);
    summary.add("coordination", q.coordination);
    summary.add("kinetic_energy_J", q.kinetic_energy);
    summary.add("elastic_energy_J", q.elastic_energy);
    summary.add("mean_overlap_m", q.mean_overlap);
    summary.add("largest_overlap_m", q.largest_overlap);
    summary.add("mean_normal_force_N", q.mean_normal_force);
    summary.add("unbalanced_ratio", q.unbalanced_ratio);
}

std::string hexadecimal(std::uint64_t fingerprint) { return fmt::format("{:016x}", fingerprint); }

} // namespace bris
