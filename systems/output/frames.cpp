#include "systems/output/frames.hpp"

namespace bris {

namespace {

/// NAME_WHAT.vtkhdf beside NAME.vtkhdf, and NAME_WHAT_from_N.vtkhdf beside NAME_from_N.vtkhdf.
std::filesystem::path beside(const std::filesystem::path& run_file, const std::string& what) {
    const auto [name, part] = name_and_part(run_file);
    return run_file.parent_path() / (name + "_" + what + part + run_file.extension().string());
}

} // namespace

FrameWriter::FrameWriter(const std::filesystem::path& path, const std::vector<NamedValue>& meta,
                         const Extras& extras)
    : file_(path) {
    file_.add_meta(meta);
    if (extras.surfaces) surfaces_.emplace(beside(path, "surfaces"), meta);
    if (extras.contacts) contacts_.emplace(beside(path, "contacts"), meta);
}

void FrameWriter::add(const World& world, const BodyFrame& frame) {
    if (frames() == 0 || frame.ids != ids_ || frame.radii != radii_ || frame.quads() != quads_) {
        std::vector<RunFile::Labels> labels{{"id", frame.ids}};
        if (!frame.shapes.empty()) labels.push_back({"shape", frame.shapes});
        file_.begin_part(frame.ids.size(), frame.quads(), labels,
                         {{"radius", 1, frame.radii, "m"}});
        ids_ = frame.ids;
        radii_ = frame.radii;
        quads_ = frame.quads();
    }
    std::vector<RunFile::Field> fields{{"velocity", 3, frame.velocities, "m/s"},
                                       {"angular_velocity", 3, frame.angular_velocities, "rad/s"},
                                       {"coordination", 1, frame.coordination}};
    if (!frame.orientations.empty()) fields.push_back({"orientation", 4, frame.orientations});
    file_.add_frame({frame.time, frame.positions, frame.corners, fields});
    if (surfaces_) surfaces_->add(world, frame);
    if (contacts_) contacts_->add(world, frame);
}

} // namespace bris
