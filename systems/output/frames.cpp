#include "systems/output/frames.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/over_ranks.hpp"
#include "engine/memory.hpp"

#include <bit>
#include <functional>
#include <span>
#include <string_view>
#include <utility>

namespace bris {

namespace {

/// NAME_WHAT.vtkhdf beside NAME.vtkhdf, and NAME_WHAT_from_N.vtkhdf beside NAME_from_N.vtkhdf.
std::filesystem::path beside(const std::filesystem::path& run_file, const std::string& what) {
    const auto [name, part] = name_and_part(run_file);
    return run_file.parent_path() / (name + "_" + what + part + run_file.extension().string());
}

template <class T>
std::size_t hash_of(const std::vector<T>& values) {
    const std::span bytes = std::as_bytes(std::span(values));
    return std::hash<std::string_view>{}(
        {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

} // namespace

FrameWriter::FrameWriter(const std::filesystem::path& path, const std::vector<NamedValue>& meta,
                         const Extras& extras)
    : file_(path) {
    file_.add_meta(meta);
    if (extras.surfaces) surfaces_.emplace(beside(path, "surfaces"), meta);
    if (extras.contacts) contacts_.emplace(beside(path, "contacts"), meta);
}

void FrameWriter::add(const World& world) {
    add(world, frame_of_bodies(world));
    return_free_memory();
}

void FrameWriter::add(const World& world, BodyFrame frame) {
    if (surfaces_) surfaces_->add(world, frame);
    if (contacts_) contacts_->add(world, frame);
    const RowsOfRanks ranks(frame.ids, OverRanks(world).is_divided());
    begin_part(ranks, frame);
    // one field after the other, so that the first rank never has all of them
    std::vector<float> centres;
    for (const Vec3& x : std::exchange(frame.positions, {})) append_vector(centres, x);
    ranks.gather(centres);
    file_.begin_frame(std::exchange(centres, {}), frame.corners);
    const auto put = [&](const std::string& name, unsigned each, std::vector<float>& values,
                         const std::string& unit = "") {
        ranks.gather(values);
        file_.put_field({name, each, std::exchange(values, {}), unit});
    };
    put("velocity", 3, frame.velocities, "m/s");
    put("angular_velocity", 3, frame.angular_velocities, "rad/s");
    put("coordination", 1, frame.coordination);
    if (world.table<Bodies>().has<Orientation>()) put("orientation", 4, frame.orientations);
    file_.end_frame(frame.time);
}

/// Begins a part unless the bodies and facets are those of the frame before.
void FrameWriter::begin_part(const RowsOfRanks& ranks, BodyFrame& frame) {
    ranks.gather(frame.radii);
    ranks.gather(frame.shapes);
    const auto ids = std::move(frame.ids), shapes = std::move(frame.shapes);
    const auto radii = std::move(frame.radii);
    // a hash takes no memory, as a copy of all bodies would on the first rank
    const std::size_t hash = hash_of(ids) ^ std::rotl(hash_of(radii), 1);
    if (frames() > 0 && hash == hash_of_bodies_ && frame.quads() == quads_) return;
    hash_of_bodies_ = hash;
    quads_ = frame.quads();
    std::vector<RunFile::Labels> labels{{"id", ids}};
    if (!shapes.empty()) labels.push_back({"shape", shapes});
    file_.begin_part(ids.size(), quads_, labels, {{"radius", 1, radii, "m"}});
}

} // namespace bris
